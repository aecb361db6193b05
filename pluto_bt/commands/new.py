"""`pluto new`: a first mission or leaf to start from."""

from __future__ import annotations

import re
import sys
from pathlib import Path

from pluto_bt.commands.options import Parser

MISSION = """\
<root BTCPP_format="4" main_tree_to_execute="{name}">
  <!-- Run it: pluto run {file} -->
  <BehaviorTree ID="{name}">
    <Sequence name="there and back">
      <GoTo name="out" goal="{{place}}" timeout_s="60"/>
      <Say text="I am there"/>
      <GoTo name="back" goal="{{home}}" timeout_s="60"/>
    </Sequence>
  </BehaviorTree>
  <TreeNodesModel>
    <SubTree ID="{name}">
      <input_port name="place" type="point" default="5;3.5">where to go, x;y in metres of the map</input_port>
      <input_port name="home" type="point" default="2;3.5">where to come back to</input_port>
    </SubTree>
  </TreeNodesModel>
</root>
"""

LEAF = '''\
"""A leaf of your own. Use it: pluto run MISSION.xml --plugin {module}"""

from py_trees.common import Status
from py_trees.ports import BehaviourWithPorts

from pluto_bt.behaviours.ports import Port


class {name}(BehaviourWithPorts):
    """Succeeds once the battery has fallen below a voltage."""

    INPUT_PORTS = {{"below_v": Port(float, description="voltage to wait for", unit="V", ge=0.0)}}
    OUTPUT_PORTS = {{"voltage_v": Port(float, required=False, description="the voltage then", unit="V")}}

    def setup(self, **kwargs):
        self.robot = kwargs["blackboard"].robot

    def update(self):
        battery = self.robot.newest("ATRV2/Battery") if self.robot else None
        if battery is None:
            self.feedback_message = "no battery seen yet"
            return Status.RUNNING
        self.feedback_message = f"{{battery.voltage_v:.1f}} V"
        if battery.voltage_v >= self.get_input("below_v"):
            return Status.RUNNING
        self._set_output("voltage_v", battery.voltage_v)
        return Status.SUCCESS
'''


def main(argv: list[str]) -> int:
    """Write `NAME.xml` or `NAME.py`, into the folder that NAME begins with, else the working folder; never over an existing file."""
    parser = Parser(prog="pluto new", description="Write a first mission or leaf to start from.")
    parser.add_argument("kind", choices=("mission", "leaf"))
    parser.add_argument("name", metavar="NAME")
    args = parser.parse_args(argv)
    folder, stem = Path(args.name).parent, Path(args.name).stem
    path = folder / (f"{stem}.xml" if args.kind == "mission" else f"{_snake(stem)}.py")
    problem = _problem(args.name, stem, stem if args.kind == "mission" else _camel(stem), path)
    if problem:
        print(f"pluto new: {problem}; nothing was written", file=sys.stderr)
        return 2
    text = MISSION.format(name=stem, file=path) if args.kind == "mission" else LEAF.format(name=_camel(stem), module=path.stem)
    path.write_text(text, encoding="utf-8")
    there = "" if folder == Path() else f" (in {folder})"  # where --plugin finds it
    next_step = f"try: pluto run {path}" if args.kind == "mission" else f"try{there}: pluto run MISSION.xml --plugin {path.stem}"
    print(f"wrote {path}\n{next_step}")
    return 0


def _problem(given: str, stem: str, node_name: str, path: Path) -> str:
    """Why nothing can be made of the name, or ""."""
    from pluto_bt.trees.loader.registry import name_problem, node_types  # heavy

    if not re.fullmatch(r"[A-Za-z_]\w*", stem):
        return f'"{given}" is no name; a letter first, then letters, digits and _'
    if name_problem(node_name):
        return f'"{node_name}" cannot be a name: {name_problem(node_name)}'
    if node_name in node_types():
        return f'"{node_name}" is the name of a node of pluto_bt; choose another, for example My{node_name}'
    if not path.parent.is_dir():
        return f"there is no folder {path.parent}"
    return f"{path} exists already" if path.exists() else ""


def _snake(name: str) -> str:
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name).lower()


def _camel(name: str) -> str:
    return "".join(word[:1].upper() + word[1:] for word in name.split("_"))
