"""`pluto plot FILE`: a recorded run as a picture."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from pluto_bt.commands.options import Parser
from pluto_bt.source import Faults

if TYPE_CHECKING:
    from pluto_bt.commands.map_picture import Driven
    from pluto_bt.maps.world import World
    from pluto_bt.record.box import Box

ENDINGS = (".png", ".svg")


def main(argv: list[str]) -> int:
    """Draw path, speeds, verdicts and leaves."""
    parser = Parser(prog="pluto plot", description="Draw a recorded run: its path, its speeds, what held the robot, which leaves worked.")
    parser.add_argument("file", metavar="FILE.mcap|FILE.log", help="a black box, or a log of CARMEN")
    parser.add_argument("--output", metavar="FILE.png|svg", help="where to (default: FILE.png, beside the recording)")
    parser.add_argument("--world", metavar="W", help="draw it into this world or map, not into the one of the recording")
    args = parser.parse_args(argv)
    from pluto_bt.commands.boxes import read_box
    from pluto_bt.commands.outputs import check_output

    output = args.output or str(Path(args.file).with_suffix(ENDINGS[0]))
    check_output(output, ENDINGS)
    box = read_box(args.file, needs_ticks=False)
    world, driven = seen_from_above(box, args.world)
    from pluto_bt.commands.box_picture import draw_box

    draw_box(output, box, world, driven)
    print(output)
    return 0


def seen_from_above(box: Box, asked: str | None) -> tuple[World, Driven]:
    """The world, and what was driven in it. Raises: InputError for a world that cannot be read."""
    import numpy as np

    from pluto_bt.commands.map_picture import Driven
    from pluto_bt.record.curves import goals_of, seen_of, track_of
    from pluto_bt.record.entries import WATCHED

    world, outline = _surroundings(box, asked)
    result, run = box.result, box.run
    reason = f" ({result['reason']})" if result.get("reason") else ""
    where = f" in {world.name}" if world.name else ""
    end = "" if run.mode == WATCHED else f": {result.get('result') or 'its end is not known'}{reason}"
    contacts = [(contact["x_m"], contact["y_m"]) for contact in result.get("contacts", ())]
    seen_m = np.zeros((0, 2)) if world.files else seen_of(box)
    title = f"{Path(run.mission).name or 'recorded'}{where}{end}"
    return world, Driven(title, track_of(box), np.array(outline).reshape(-1, 2), goals_of(box), contacts, seen_m)


def _surroundings(box: Box, asked: str | None) -> tuple[World, list[tuple[float, float]]]:
    """The world and the robot's outline, from the files in the box."""
    from pluto_bt.files import find_file
    from pluto_bt.maps.load import load_world
    from pluto_bt.maps.world import World
    from pluto_bt.modules.robot_file import load_robot_file

    with box.unpacked() as folder:
        platform = folder / "platform.toml"
        outline = list(load_robot_file(str(platform), box.run.settings).body.outline_m) if platform.is_file() else []
        if asked is None:
            return (load_world(folder / box.run.world, box.run.world) if box.run.world else World("")), outline
    faults = Faults()
    path = find_file("world", asked, faults)
    faults.raise_errors()
    assert path is not None  # else there was a fault
    return load_world(path, asked), outline
