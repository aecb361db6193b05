"""Pictures of a mission: as text, for browsers, for Groot2; with or without statuses."""

from pluto_bt.trees.dump.draw import FORMATS, draw
from pluto_bt.trees.dump.palette import nodes_table, nodes_xml

__all__ = ["FORMATS", "draw", "nodes_table", "nodes_xml"]
