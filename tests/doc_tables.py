"""The tables of the guides, made from the program itself. A page holds them between `<!-- table: NAME -->` and `<!-- end -->`.

`python -m tests.doc_tables` writes them anew; `test_docs.py` fails while a page differs from what is made here.
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Iterable
from pathlib import Path

from pluto_bt.behaviours.missing import NAV2_MISSING
from pluto_bt.behaviours.motion_leaf import MOTION_INPUTS, MOTION_OUTPUTS
from pluto_bt.behaviours.reasons import REASONS, WAITING
from pluto_bt.blackboard import TOPICS
from pluto_bt.blackboard.codes import STATUS_ENUMS, code_name
from pluto_bt.cli import COMMANDS
from pluto_bt.commands.run import run_parser
from pluto_bt.gateway.parse import _FROM_CONTENT
from pluto_bt.gateway.proxies import PROXIES, Proxy
from pluto_bt.gateway.requests import ELEMENTS
from pluto_bt.gateway.shell.table import GENERAL, MODULE_ROWS
from pluto_bt.maps import fault_table
from pluto_bt.modules.robot_file import SHIPPED, RobotFile, load_robot_file
from pluto_bt.modules.topic_globals import fields_of
from pluto_bt.result import EXIT_CODES, INTERRUPTED, SUPERVISION, RunResult
from pluto_bt.runtime.parameters import Parameter, describe
from pluto_bt.skills.reasons import CHAIN_REASONS
from pluto_bt.system import MODULES
from pluto_bt.trees.dump.palette import ARROWS, default_text
from pluto_bt.trees.loader.registry import NodeType, node_types
from pluto_bt.trees.ports import PortModel
from tests.doc_texts import RUN_REASONS, STATUS_MEANINGS
from tests.fault_cases import CASES, GOES_ON
from tests.safety_cases import CAUSES
from tests.tutorials import read_tutorials

ROOT = Path(__file__).resolve().parent.parent
PAGES = (*sorted((ROOT / "docs").glob("*.md")), ROOT / "README.md")
_BLOCK = re.compile(r"(<!-- table: ([\w-]+) -->\n)(.*?)(<!-- end -->)", re.DOTALL)


def table(heads: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """A Markdown table."""
    lines = [list(heads), *(list(row) for row in rows)]
    cells = [[cell.replace("|", "\\|").replace("\n", " ") for cell in line] for line in lines]
    return "\n".join(["| " + " | ".join(cells[0]) + " |", "|" + "---|" * len(cells[0]), *("| " + " | ".join(row) + " |" for row in cells[1:])]) + "\n"


# ---------------------------------------------------------------------- missions


def _types(builtin: bool, *kinds: str, of_nav2: bool = False) -> list[NodeType]:
    found = [node for node in node_types().values() if node.builtin is builtin and node.kind in kinds and _is_of_nav2(node) is of_nav2]
    of_others = [node for node in found if not node.is_ours]  # those of other tests
    return sorted((node for node in found if node not in of_others), key=lambda node: node.name)


def _is_of_nav2(node: NodeType) -> bool:
    return node.name in NAV2_MISSING or getattr(node.make, "__module__", "").startswith(("pluto_bt.behaviours.nav2", "pluto_bt.trees.nav2"))


def _port(port: PortModel) -> str:
    default = f", default {default_text(port)}" if port.default is not None else ""
    return f"{ARROWS[port.direction]} `{port.name}` {port.form}{default}" + (f": {port.description}" if port.description else "")


def _ports(node: NodeType) -> str:
    """The ports; those that every motion leaf has stand in one word."""
    common = {*MOTION_INPUTS, *MOTION_OUTPUTS}
    is_motion = common <= set(node.ports)
    own = [_port(port) for port in node.ports.values() if not (is_motion and port.name in common)]
    return "<br>".join([*own, "+ *motion ports*"] if is_motion else own) or "–"


def nodes(builtin: bool, *kinds: str, of_nav2: bool = False) -> str:
    """Node, ports, what it does."""
    types = _types(builtin, *kinds, of_nav2=of_nav2)
    return table(("node", "ports", "what it does"), ((f"`{node.name}`", _ports(node), node.description) for node in types if not node.missing))


def missing_nodes(*, of_nav2: bool) -> str:
    """Nodes that are known by name alone."""
    types = _types(False, "Action", "Condition", of_nav2=of_nav2)
    return table(("node", "what is missing"), ((f"`{node.name}`", node.missing) for node in types if node.missing))


def motion_ports() -> str:
    """What every motion leaf takes and gives."""
    goto = node_types()["GoTo"]
    rows = [goto.ports[name] for name in (*MOTION_INPUTS, *MOTION_OUTPUTS)]
    return table(("port", "form", "default", "meaning"), ((f"{ARROWS[port.direction]} `{port.name}`", port.form,
                 "" if port.default is None else default_text(port), port.description) for port in rows))  # fmt: skip


def topics() -> str:
    """Topics, and the numbers of each for scripts."""
    rows = []
    for topic in TOPICS:
        prefix = topic.name.replace("/", "_").replace("-", "_")
        names = " ".join(_folded(name for name in fields_of(topic.type) if name != "stamp_s"))
        rows.append((f"`{topic.name}`", topic.writer, _seconds(topic.period_s, "on change"), _seconds(topic.stale_after_s, "never"), topic.doc,
                     f"`@{prefix}` + {names}" if names else "–"))  # fmt: skip
    return table(("topic", "writer", "every", "stale after", "meaning", "numbers for scripts"), rows)


def _folded(names: Iterable[str]) -> list[str]:
    """`_force_0 … 3` instead of `_force_0 _force_1 _force_2 _force_3`."""
    last: dict[str, str] = {}  # stem → number of its last item; "" = no number
    for name in names:
        stem, _, number = name.rpartition("_")
        last[stem if number.isdigit() else name] = number if number.isdigit() else ""
    return [f"`_{stem}_0` … `{number}`" if number not in ("", "0") else f"`_{stem}{'_0' if number else ''}`" for stem, number in last.items()]


def _seconds(value: float, none: str) -> str:
    return f"{value:g} s" if value else none


# ---------------------------------------------------------------------- the command line


def commands() -> str:
    """Every command of `pluto`."""
    return table(("command", "what it does"), ((f"`pluto {name}`", text) for name, text in COMMANDS.items()))


def run_options() -> str:
    """The options of `pluto run`, as its parser has them."""
    rows = []
    for action in run_parser()._actions:
        if action.option_strings and action.dest != "help":
            value = action.metavar or ("|".join(action.choices) if action.choices else "")
            rows.append((f"`{action.option_strings[0]}{f' {value}' if value else ''}`", re.sub(r"(<[^>]+>)", r"`\1`", action.help or "")))
    return table(("option", "meaning"), rows)


def result_fields() -> str:
    """The object of `--json`. Raises KeyError for a field that its class does not describe."""
    described = dict(re.findall(r"^        (\w+): (.+)\.$", RunResult.__doc__ or "", re.MULTILINE))
    return table(("field", "meaning"), ((f"`{name}`", described[name].replace("->", "→")) for name in RunResult.__struct_fields__))


# ---------------------------------------------------------------------- worlds, platforms


def faults() -> str:
    """One row for each kind and meaning; the devices that can have it."""
    rows: dict[tuple[str, str, str], list[str]] = {}
    for row in fault_table.FAULTS:
        takes = [f"[{name}]" for name in row.takes if name != "beams"]
        rows.setdefault((row.kind, " ".join([*row.needs, *takes]), row.doc), []).append(row.device)
    order = {kind: number for number, kind in enumerate(fault_table.KINDS)}
    in_order = sorted(rows.items(), key=lambda row: order[row[0][0]])
    cells = ((f"`{kind}`", needs or "–", ", ".join(devices), doc) for (kind, needs, doc), devices in in_order)
    return table(("kind", "needs, [takes]", "devices", "what happens"), cells)


def fault_units() -> str:
    """What `value` means for a device."""
    return table(("device", "`value`"), fault_table.UNITS.items())


def parameters() -> str:
    """Every parameter of a robot file, a table for each TOML table."""
    groups: dict[str, list[Parameter]] = {}
    for row in describe(RobotFile):
        groups.setdefault(row.name.rpartition(".")[0], []).append(row)
    parts = []
    for group, rows in groups.items():
        parts.append(f"\n### {f'[{group}]' if group else 'top of the file'}\n\n" + table(
            ("parameter", "unit", "form", "default", "meaning"),
            ((f"`{row.name.rpartition('.')[2]}`", row.unit or "–", row.kind, row.default or "must be given", row.doc) for row in rows),
        ))  # fmt: skip
    return "".join(parts) + "\n"


def shipped() -> str:
    """The four robot files side by side."""
    robots = [load_robot_file(name) for name in SHIPPED]
    size = ["{:.2f} × {:.2f} m".format(*(max(axis) - min(axis) for axis in zip(*robot.body.outline_m, strict=True))) for robot in robots]
    devices = [", ".join(name for name in robot.devices.__struct_fields__ if getattr(robot.devices, name) is not None) for robot in robots]
    return table(("", *(f"`{robot.name}`" for robot in robots)), (
        ("turns by", *(robot.body.kinematics for robot in robots)),
        ("length × width", *size),
        ("top speed", *(f"{robot.limits.max_speed_mps:g} m/s" for robot in robots)),
        ("top turn rate", *(f"{robot.limits.max_turn_rate_dps:g} °/s" for robot in robots)),
        ("deceleration", *(f"{robot.limits.deceleration_mps2:g} m/s²" for robot in robots)),
        ("devices", *devices),
    ))  # fmt: skip


# ---------------------------------------------------------------------- safety, reasons


def stops() -> str:
    """What stops the robot: what the parameters promise and what was measured."""
    rows = (
        (cause.name, cause.noticed_by, f"{cause.limit_s:.2f} s", f"{cause.measured_s:.1f} s", cause.status, cause.result, cause.clears)
        for cause in CAUSES
    )
    return table(("cause", "noticed by", "at rest within", "measured", "status", "if it does not clear, the run ends", "clears"), rows)


def fault_cases() -> str:
    """What breaks, what becomes of the mission, how soon zero velocity is commanded."""
    rows = (
        (case.name, case.how, "–" if case.zero_within_s == GOES_ON else f"{case.zero_within_s:g} s", case.outcome, case.asked or "–")
        for case in CASES
    )
    return table(("fault, for ever unless said", "noticed by, and then", "zero within", "the run ends", "`why` names"), rows)


def reasons() -> str:
    """The reasons of leaves."""
    of_leaves = {word: reason for word, reason in REASONS.items() if word not in RUN_REASONS or word in WAITING}
    rows = (
        (f"`{word}`", reason.meaning, f"{WAITING[word]:g} s" if word in WAITING else "–", "may help" if reason.retry else "–", reason.cure)
        for word, reason in of_leaves.items()
    )
    return table(("reason", "meaning", "waits", "another try", "cure"), rows)


def chain_reasons() -> str:
    """The reasons in the status of the links."""
    return table(("reason", "meaning"), ((f"`{word}`", meaning) for word, meaning in CHAIN_REASONS.items()))


EXIT_OF = {**dict.fromkeys(SUPERVISION, 3), INTERRUPTED: 130}


def run_reasons() -> str:
    """The reasons that end a run, beside those of the deciding leaf."""
    rows = []
    for word, (result, meaning, cure) in RUN_REASONS.items():
        known = REASONS.get(word)
        exit_code = str(EXIT_OF.get(word, EXIT_CODES[result]))
        rows.append((f"`{word}`", result, exit_code, known.meaning if known else meaning, known.cure if known else cure))
    return table(("reason", "result", "exit", "meaning", "cure"), rows)


def status_codes() -> str:
    """`element[0..3]` of the chain's status."""
    rows = []
    for number, kind in enumerate(STATUS_ENUMS):
        for code in kind:
            meaning, cure = STATUS_MEANINGS[kind.__name__, code.name]
            rows.append((f"[{number}]", str(int(code)), code_name(code), meaning, cure))
    return table(("element", "code", "name", "meaning", "cure"), rows)


# ---------------------------------------------------------------------- gateway, architecture


def requests() -> str:
    """What a client may say."""
    rows = []
    for tag, kind in ELEMENTS.items():
        names = [f"`{name}`" for name in kind.__struct_fields__ if name not in _FROM_CONTENT.get(tag, ()) and name != "id"]
        rows.append((f"`<{tag}>`", " ".join(names) or "–", (kind.__doc__ or "").strip().split("\n")[0]))
    return table(("element", "attributes", "meaning"), rows)


def shell() -> str:
    """What a person may say."""
    return table(("command", "meaning"), ((f"`{row.usage}`", row.doc) for row in GENERAL))


def subshells() -> str:
    """What can be said to one module."""
    rows = sorted(MODULE_ROWS, key=lambda row: row.shell)
    return table(("sub-shell", "command", "meaning"), ((f"`{row.shell}>`", f"`{row.usage}`", row.doc) for row in rows))


def proxies() -> str:
    """Each proxy with its own methods; those that every proxy has stand in the text."""
    rows = []
    for proxy in PROXIES:
        names = [name for kind in reversed(proxy.__mro__) if kind not in Proxy.__mro__ for name in vars(kind) if not name.startswith("_")]
        methods = [name for name in dict.fromkeys(names) if inspect.isfunction(getattr(proxy, name))]
        told = [f"`{name}({', '.join(list(inspect.signature(getattr(proxy, name)).parameters)[1:])})`" for name in methods]
        rows.append((f"`{proxy.__name__}`", f"`{proxy.MODULE}`", " ".join(told), (proxy.__doc__ or "").strip().split("\n")[0]))
    return table(("proxy", "module", "methods", "what it is"), rows)


def modules() -> str:
    """THE table of modules."""
    rows = ((f"`{row.name}`", row.group, f"{row.period_s:g} s" if row.period_s else "–", ", ".join(row.wakes) or "–", ", ".join(row.needs) or "–",
             "yes" if row.critical else "–", row.device or "–", f"{row.budget_ms:g} ms") for row in MODULES)  # fmt: skip
    return table(("module", "group (thread)", "every", "woken by", "needs", "critical", "only with the device", "budget a step"), rows)


def tutorials() -> str:
    """The tutorial missions, in order."""
    return table(("run it", "new idea"), ((f"`{one.command}`", one.idea) for one in read_tutorials()))


TABLES: dict[str, Callable[[], str]] = {
    "actions": lambda: nodes(False, "Action"),
    "conditions": lambda: nodes(False, "Condition"),
    "controls": lambda: nodes(True, "Control"),
    "decorators": lambda: nodes(True, "Decorator"),
    "builtin-leaves": lambda: nodes(True, "Action", "Condition"),
    "nav2-controls": lambda: nodes(False, "Control", "Decorator", of_nav2=True),
    "nav2-actions": lambda: nodes(False, "Action", of_nav2=True),
    "nav2-conditions": lambda: nodes(False, "Condition", of_nav2=True),
    "missing": lambda: missing_nodes(of_nav2=False),
    "nav2-missing": lambda: missing_nodes(of_nav2=True),
    "motion-ports": motion_ports,
    "topics": topics,
    "commands": commands,
    "run-options": run_options,
    "result-fields": result_fields,
    "fault-cases": fault_cases,
    "fault-units": fault_units,
    "parameters": parameters,
    "shipped": shipped,
    "stops": stops,
    "faults": faults,
    "reasons": reasons,
    "chain-reasons": chain_reasons,
    "run-reasons": run_reasons,
    "status-codes": status_codes,
    "requests": requests,
    "shell": shell,
    "subshells": subshells,
    "proxies": proxies,
    "modules": modules,
    "tutorials": tutorials,
}


def updated(page: str) -> str:
    """The page with every table as it must be. Raises KeyError for a name that nobody makes."""
    return _BLOCK.sub(lambda block: block[1] + TABLES[block[2]]() + block[4], page)


def names_in(page: str) -> list[str]:
    """The names of the tables of a page."""
    return [block[2] for block in _BLOCK.finditer(page)]


if __name__ == "__main__":
    for path in PAGES:
        path.write_text(updated(path.read_text(encoding="utf-8")), encoding="utf-8")
