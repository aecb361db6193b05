"""The script language of BehaviorTree.CPP 4.10 (bt_xml.md, section 9): tokens → terms → values."""

from pluto_bt.trees.script.parser import Program, parse_script
from pluto_bt.trees.script.runner import ScriptRunner
from pluto_bt.trees.script.tokens import ScriptSyntaxError

__all__ = ["Program", "ScriptRunner", "ScriptSyntaxError", "parse_script"]
