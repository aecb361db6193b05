"""Pictures of a mission: as text, for browsers, for Groot2; with or without statuses."""

from pluto_bt.trees.dump.dump import FORMATS, dump
from pluto_bt.trees.dump.palette import nodes_table, nodes_xml

__all__ = ["FORMATS", "dump", "nodes_table", "nodes_xml"]
