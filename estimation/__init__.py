"""Estimators: pure functions on numbers in thin stateful shells. Imports numpy and `pluto_bt.maps` only.

Poses are `(x m, y m, theta rad)` tuples of plain floats and covariances six floats: at 50 Hz, small numpy arrays would cost ten
times the arithmetic that is done with them.
"""
