"""THE table of commands. Help, completion, usage errors, the docs and every shell (at a terminal, from a pipe, over ssh) are made of it.

A row belongs to every shell, or (`module_rows.py`) to the sub-shell of one module, as the Pluto manual's keyboard interfaces did.
"""

from __future__ import annotations

from pluto_bt.gateway.shell import asking, by_hand, driving, listening, missions, stops, tuning
from pluto_bt.gateway.shell.arguments import choice, number, rest, word
from pluto_bt.gateway.shell.driving import node
from pluto_bt.gateway.shell.module_rows import MODULE_ROWS
from pluto_bt.gateway.shell.row import Row

X, Y, DEG = number("X", "m", low=-1e6, high=1e6), number("Y", "m", low=-1e6, high=1e6), number("DEG", "°")
A_TOPIC = "the name of a topic, or its beginning and *"
TOPIC, TOPICS = word("TOPIC", A_TOPIC, "topic"), rest("TOPIC", A_TOPIC, "topic")
MODULE, MODULE_OR_NONE = word("MODULE", "the name of a module", "module"), word("MODULE", "the name of a module, or nothing", "module", None)
GOAL = word("GOAL", "the name of a goal of the map, home, x,y or x,y,deg", "goal")
NODE, PORTS = word("NODE", "the name of a node", "node"), rest("NAME=VALUE", "an input of the node", "port")
B, H, RADIUS = number("B", "m", low=0.0), number("H", "m", low=0.0), number("RADIUS", "m", None, 0.1)
SIDE, WALL = choice("SIDE", ("left", "right"), "left"), number("DISTANCE", "m", None, 0.0, 5.0)
WHOM, BEHIND = choice("WHOM", ("person", "nearest"), "person"), number("DISTANCE", "m", None, 0.5, 8.0)
MISSION, INPUTS = word("MISSION", "a mission's name, or its file", "mission"), rest("NAME=VALUE", "an input of the mission, or & to let it go on by itself")
HZ, FOR, SECONDS = number("HZ", "Hz", 2.0, 0.0, 1000.0), number("SECONDS", "s", None, 0.0), number("SECONDS", "s", low=0.0, high=1e6)
FILE, REASON = word("FILE", "a new file, or - for this terminal"), rest("REASON", "why, in words")

GENERAL: tuple[Row, ...] = (
    #   name, arguments, meaning, done by
    Row("stop", (MODULE_OR_NONE,), "zero velocity at once, for anyone, at any time; with a name: stop that module", stops.stop),
    Row("goto", (X, Y), "drive straight to a place on the map, around what is in the way", node("GoTo", "goal=2"), drives=True),
    Row("maketurn", (number("DEG", "°", low=-3600.0, high=3600.0),), "turn by this angle, positive = clockwise", node("MakeTurn", "angle_deg"), drives=True),
    Row("moveto", (X, Y), "drive to a place along open paths, around buildings", node("MoveTo", "goal=2"), drives=True),
    Row("navigate", (GOAL,), "plan the way on the map and drive it, to a goal of the map, home, x,y or x,y,deg", driving.navigate, drives=True),
    Row("explore", (B, H), "explore the rectangle ahead, B to either side, H deep; then come home", node("Explore", "rectangle=2"), drives=True),
    Row("investigate", (RADIUS,), "drive to the closest object and around it", node("Investigate", "radius_m"), drives=True),
    Row("wallfollow", (SIDE, WALL), "follow the wall on that side, the camera at that distance", node("WallFollow", "side", "distance_m"), drives=True),
    Row("follow", (WHOM, BEHIND), "follow who or what moves nearest", node("Follow", "target", "distance_m"), drives=True),
    Row("drive", (number("MPS", "m/s", 0.3, 0.01, 2.0),), "drive with the arrow keys, at most so fast; let go, and it stops", by_hand.drive, drives=True),
    Row("do", (NODE, PORTS), "run one node of the library with these inputs", driving.do, drives=True),
    Row("run", (MISSION, INPUTS), "run a mission to its end", missions.run),
    Row("trip2", (), "run the car's scripted trip, trip2.xml", missions.trip2),
    Row("missions", (), "the missions that `run` knows by name", missions.missions),
    Row("pause", (), "pause the mission", missions.order("pause")),
    Row("resume", (), "go on with the mission", missions.order("resume")),
    Row("abort", (), "end the mission", missions.order("abort")),
    Row("status", (), "the mission, and who drives", missions.status),
    Row("pose", (), "where the robot believes to be", asking.pose),
    Row("why", (number("AT", "s of the run", None, 0.0, 1e9),), "why the robot is, or was, not moving", asking.why),
    Row("tree", (), "the tree now", asking.tree),
    Row("get", (TOPIC,), "the newest value of a topic", asking.get),
    Row("watch", (TOPIC, HZ, FOR), "values as they come, at most so often (0 = each)", listening.watch),
    Row("record", (SECONDS, FILE, TOPICS), "write what topics say as JSON, a line a value", listening.record),
    Row("topics", (), "every topic and what it means", asking.topics),
    Row("events", (choice("LEVEL", ("info", "warning", "error"), "info"),), "the last events", asking.events),
    Row("params", (rest("NAME[=VALUE]", "a parameter, or its new value", "param"),), "show parameters, or set them, all or none; `params rollback`, `params save`",
        tuning.params),
    Row("modules", (), "every module and how it is", asking.modules),
    Row("start", (MODULE,), "start a module, and what it needs", asking.module("start")),
    Row("setpose", (X, Y, DEG), "tell the robot where it is", node("SetPose", "pose=3"), drives=True),
    Row("estop", (REASON,), "stop, and stay stopped until `release`", stops.estop),
    Row("release", (), "take the emergency stop back; nothing moves by that", stops.release),
)
ROWS: tuple[Row, ...] = (*GENERAL, *MODULE_ROWS)
SUBSHELLS: tuple[str, ...] = tuple(dict.fromkeys(row.shell for row in MODULE_ROWS))


def rows_in(shell: str) -> dict[str, Row]:
    """What can be said in a sub-shell: its own rows, and those that hold everywhere; its own win."""
    own = {row.name: row for row in MODULE_ROWS if row.shell == shell}
    return own | {row.name: row for row in GENERAL if row.name not in own}


def help_text(shell: str = "") -> str:
    """One line a command; of a sub-shell only its own."""
    rows = [(row.usage, row.doc) for row in ROWS if row.shell == shell]
    rows += [("help [COMMAND]", "this list, or one command of it")]
    if shell:
        rows += [("back", "leave this sub-shell; what can be said everywhere can be said in it")]
    else:
        lists = [", ".join(SUBSHELLS[i : i + 6]) for i in range(0, len(SUBSHELLS), 6)]
        rows += list(zip(lists, ["a module's own commands, as `wrist point 30 10`; `wrist>` opens its sub-shell"] + [""] * len(lists), strict=False))
        rows += [("quit", "leave; the robot goes on with what it does. Ctrl-C stops the robot, always")]
    width = min(36, max(len(usage) for usage, _ in rows))
    return "\n".join(_line(usage, doc, width) for usage, doc in rows)


def _line(usage: str, doc: str, width: int) -> str:
    return f"{usage:<{width}}  {doc}".rstrip() if len(usage) <= width else f"{usage}\n{'':<{width}}  {doc}"
