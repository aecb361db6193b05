"""The ground under every floor: source files with positions, and the faults found in them.

Whatever reads a text that a person wrote (missions, worlds, maps, platform files, options) reports through this package, so that
every fault names file, line, column, what was expected, what was found and how to mend it, and all faults are told at once.
It imports nothing of the project.
"""

from pluto_bt.source.faults import Fault, Faults, InputError, Place, PlutoError, did_you_mean, nearest_word
from pluto_bt.source.xml_reader import XmlAttribute, XmlElement, read_xml, read_xml_file

__all__ = [
    "Fault", "Faults", "InputError", "Place", "PlutoError", "XmlAttribute", "XmlElement",
    "did_you_mean", "nearest_word", "read_xml", "read_xml_file",
]  # fmt: skip
