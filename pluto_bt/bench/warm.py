"""Importing this module loads and compiles everything that a run needs: for a server from which runs are forked."""

from __future__ import annotations

from pluto_bt.inputs.reading import Request, read_inputs
from pluto_bt.runner import make_runner

make_runner(read_inputs(Request("t02_go_to_a_place.xml")))
