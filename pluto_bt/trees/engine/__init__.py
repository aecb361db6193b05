"""The tick engine: nodes as py_trees behaviours, ticked by plain method calls."""
