"""Pictures of a mission: as text, for browsers, for Groot2; with or without statuses."""

from pluto_bt.trees.dump.dump import FORMATS, PICTURES, draw, dump
from pluto_bt.trees.dump.model import Drawn, drawn, folded, hang_below, nested
from pluto_bt.trees.dump.palette import nodes_table, nodes_xml

__all__ = ["FORMATS", "PICTURES", "Drawn", "draw", "drawn", "dump", "folded", "hang_below", "nested", "nodes_table", "nodes_xml"]
