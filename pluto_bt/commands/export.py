"""`pluto export FILE`: the topics of a black box in the formats of other programs."""

from __future__ import annotations

import csv
import json
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, TextIO

from pluto_bt.commands.options import Parser
from pluto_bt.source import Faults, Place, did_you_mean
from pluto_bt.source.faults import fail

if TYPE_CHECKING:
    from pluto_bt.record.box import Box

FORMATS = {"json": ".jsonl", "csv": ".csv", "xml": ".xml", "carmen": ".log"}


def main(argv: list[str]) -> int:
    """Write the recorded values."""
    parser = Parser(prog="pluto export", description="Write the topics of a black box in the formats of other programs.")
    parser.add_argument("file", metavar="FILE.mcap|FILE.log", help="a black box, or a log of CARMEN")
    about = "json: a line a message (default); csv: a table a topic; xml: as the gateway sends them; carmen: odometry and scans"
    parser.add_argument("--format", choices=tuple(FORMATS), default="json", help=about)
    parser.add_argument("--topic", metavar="NAME", action="append", default=[], help="only this topic; may be repeated")
    parser.add_argument("--output", metavar="PATH", help="a file, or for csv of several topics a folder (default: standard output)")
    args = parser.parse_args(argv)
    from pluto_bt.commands.boxes import read_box

    box = read_box(args.file, needs_ticks=False)
    topics = _chosen(box, args.topic, args.format)
    is_folder = args.format == "csv" and len(topics) != 1
    _check_output(args.output, args.format, is_folder)
    if is_folder:
        return tables(box, topics, Path(args.output))
    with _opened(args.output) as out:
        return WRITERS[args.format](box, topics, out)


def _chosen(box: Box, asked: Sequence[str], form: str) -> list[str]:
    """The topics to write. Raises: InputError for one that the file does not have."""
    from pluto_bt.record.entries import TICK, TREE

    recorded = sorted({line.topic for line in box.file.lines()})
    known = recorded if form == "json" else [name for name in recorded if name not in (TICK, TREE)]
    faults = Faults()
    for name in asked:
        if name not in known:
            faults.error(Place(f"--topic {name}"), "unknown-topic", f'"{name}" is not in the recording', expected=", ".join(known) or "nothing",
                         found=name or "nothing", mend=did_you_mean(name, known))  # fmt: skip
    faults.raise_errors()
    return list(asked) or known


def _check_output(output: str | None, form: str, is_folder: bool) -> None:
    from pluto_bt.commands.outputs import check_output

    if not is_folder:
        check_output(output, () if form == "xml" else (FORMATS[form],))
    elif output is None or Path(output).suffix or Path(output).is_file():
        fail(Place(f"--output {output or ''}".rstrip()), "bad-option", "several topics make several tables", expected="--output FOLDER",
             found=output or "nothing", mend="name a folder, or choose one --topic")  # fmt: skip


@contextmanager
def _opened(output: str | None) -> Iterator[TextIO]:
    if output is None:
        yield sys.stdout
        return
    with open(output, "w", encoding="utf-8", newline="") as file:
        yield file
    print(output)


def json_lines(box: Box, topics: Sequence[str], out: TextIO) -> int:
    """Every message as it was recorded, in the order of the file."""
    for line in box.file.lines():
        if line.topic in topics:
            out.write(f'{{"topic":{json.dumps(line.topic)},"t_s":{line.time_ns / 1e9!r},"seq":{line.sequence},"value":{line.data.decode()}}}\n')
    return 0


def one_table(box: Box, topics: Sequence[str], out: TextIO) -> int:
    """One topic as CSV."""
    from pluto_bt.record.tables import table

    csv.writer(out, lineterminator="\n").writerows(table(box.samples(topics)[topics[0]]))
    return 0


def tables(box: Box, topics: Sequence[str], folder: Path) -> int:
    """A file a topic; a slash in its name becomes a hyphen."""
    folder.mkdir(parents=True, exist_ok=True)
    for topic in topics:
        with _opened(str(folder / (topic.replace("/", "-") + FORMATS["csv"]))) as out:
            one_table(box, [topic], out)
    return 0


def xml_values(box: Box, topics: Sequence[str], out: TextIO) -> int:
    """`<value>` elements as the gateway sends them, in the order in which they were written."""
    from pluto_bt.gateway.values import body_of, value_line
    from pluto_bt.record.tables import of_topics

    out.write("<values>\n")
    for topic, sample in of_topics(box.samples(topics)):
        stamp_s = sample.value.stamp_s
        out.write(value_line(topic, sample.seq, stamp_s, sample.written_s - stamp_s, body_of(sample.value)).decode())
    out.write("</values>\n")
    return 0


def carmen_lines(box: Box, topics: Sequence[str], out: TextIO) -> int:
    """A log of CARMEN; 1 if there is nothing to put into it."""
    from pluto_bt.record.carmen import carmen_log

    log = carmen_log(box)
    out.writelines(f"{line}\n" for line in log.lines)
    for why, count in log.left_out.items():
        print(f"pluto export: left out {count} of the scans: {why}", file=sys.stderr)
    if not log.lines:
        print("pluto export: the recording has no odometry", file=sys.stderr)
    return 0 if log.lines else 1


WRITERS = {"json": json_lines, "csv": one_table, "xml": xml_values, "carmen": carmen_lines}
