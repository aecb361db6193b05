"""`pluto totest FILE`: makes a pytest file of a recorded run, with the files it needs beside it."""

from __future__ import annotations

import math
import re
import shutil
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pluto_bt.commands.options import Parser

if TYPE_CHECKING:
    from pluto_bt.record.box import Box

MOST_STEPS = 200  # of the story; a longer one is told up to here

TEST = '''"""A recorded run as a test: {title}. Made by `pluto totest`; edit it as you like."""

from __future__ import annotations

from pathlib import Path

from pluto_bt.playback import replay_file

HERE = Path(__file__).parent / "{folder}"


def test_{name}_decides_the_same_on_the_recorded_inputs() -> None:
    """The mission, fed with what the robot saw then: every tick must be the same."""
    assert [str(difference) for difference in replay_file(HERE / "run.mcap", mission=HERE / "{mission}")] == []
'''

AGAIN = '''

STORY = [
{story}
]


def test_{name}_goes_the_same_way_in_the_simulator(scenario, tmp_path) -> None:
    """The whole run again, in its world: the same end, and the same leaves ending in the same order."""
    from pluto_bt.playback import story_of

    run = scenario(
        "{folder}/{world}", mission="{folder}/{mission}", platform="{folder}/platform.toml", seed={seed}, start={start!r},{more}
        record=tmp_path / "again.mcap",
    )
    assert (run.result, run.reason, run.collisions) == {end!r}, run.text
    assert story_of(tmp_path / "again.mcap")[:{most}] == STORY
'''


def main(argv: list[str]) -> int:
    """Write the test."""
    parser = Parser(prog="pluto totest", description="Make a pytest file of a recorded run.")
    parser.add_argument("file", metavar="FILE.mcap")
    parser.add_argument("--output", metavar="test_NAME.py", help="the test file (default: test_FILE.py here); its folder of files is made beside it")
    args = parser.parse_args(argv)
    from pluto_bt.commands.boxes import read_box
    from pluto_bt.commands.outputs import check_output

    check_output(args.output, (".py",))
    box = read_box(args.file)
    name = re.sub(r"\W+", "_", Path(args.file).stem).strip("_").lower() or "run"
    to = Path(args.output or f"test_{name}.py")
    try:
        write_test(box, name, to)
    except FileExistsError as error:
        print(f"pluto totest: {error} exists already; nothing was written (--output names another file)", file=sys.stderr)
        return 2
    except OSError as error:
        print(f"pluto totest: cannot write {to}: {error.strerror or error}", file=sys.stderr)
        return 2
    print(f"{to}: run it with `pytest {to}`")
    return 0


def write_test(box: Box, name: str, to: Path) -> None:
    """Write the test file, and beside it a folder with the box and its files.

    Raises:
        FileExistsError: the file or its folder is there: somebody may have edited it.
        OSError: it cannot be written.
    """
    folder = to.with_name(f"{to.stem}_files")
    title = f"{Path(box.run.mission).name} in {Path(box.run.world).name}, {box.result.get('result', 'cut short')}"
    text = TEST.format(title=title, name=name, folder=folder.name, mission=box.run.mission)
    if box.run.mode == "lockstep" and box.result.get("result") in ("SUCCESS", "FAILURE") and not box.run.plugins:
        text += _again(box, name, folder.name)
    for path in (to, folder):
        if path.exists():
            raise FileExistsError(path)
    with box.unpacked() as unpacked:
        shutil.copytree(unpacked, folder)
    shutil.copyfile(box.file.path, folder / "run.mcap")
    to.write_text(text, encoding="utf-8")


def _again(box: Box, name: str, folder: str) -> str:
    from pluto_bt.record.story import ended

    run, result = box.run, box.result
    x_m, y_m, theta_rad = run.start
    more: dict[str, Any] = {"ports": run.ports, "tree": run.tree, "settings": run.settings, "map": f"{folder}/{run.map}" if run.map else None}
    words = "".join(f"\n        {key}={value!r}," for key, value in more.items() if value)
    story = "\n".join(f"    {(one.path, one.status)!r}," for one in ended(box)[:MOST_STEPS])
    return AGAIN.format(
        name=name, folder=folder, world=run.world, mission=run.mission, seed=run.seed, start=f"{x_m!r},{y_m!r},{math.degrees(theta_rad)!r}",
        more=words, end=(result["result"], result["reason"], result["collisions"]), story=story, most=MOST_STEPS,
    )  # fmt: skip
