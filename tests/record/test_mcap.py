"""The file format of the black box: any MCAP tool reads it, a crash costs only what was not yet on disk, and the limit costs old bulk first."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.reader import make_reader

from pluto_bt.blackboard import TOPICS
from pluto_bt.blackboard.messages import LaserScan, Message, Pose, SonarState, TreeState, read_only
from pluto_bt.record.codec import decode, encode, schema_of
from pluto_bt.record.mcap_chunk import Bulk
from pluto_bt.record.mcap_reader import McapFile
from pluto_bt.record.mcap_writer import CHUNK_NS, McapWriter
from pluto_bt.record.repair import repair

FLOATS = st.floats(width=64)  # with NaN and the infinities


@given(FLOATS, st.lists(FLOATS, max_size=20))
def test_a_message_comes_back_bit_for_bit(number: float, ranges: list[float]) -> None:
    for message in (Pose(number, (number, 1.0, 0.1, -number, 0.0, 5e-324), (number,) * 9, 3), SonarState(0.5, tuple(ranges)),
                    LaserScan(number, 0.1, number, read_only(ranges), 4)):  # fmt: skip
        again = decode(encode(message), type(message))
        for name in message.__struct_fields__:
            before, after = np.array(getattr(message, name)), np.array(getattr(again, name))
            assert np.array_equal(before, after, equal_nan=before.dtype.kind == "f"), name
            assert before.dtype.kind != "f" or np.array_equal(np.signbit(before[~np.isnan(before)]), np.signbit(after[~np.isnan(after)])), name


@pytest.mark.parametrize("kind", {topic.type for topic in TOPICS}, ids=lambda kind: kind.__name__)
def test_every_topic_has_a_schema_without_references(kind: type[Message]) -> None:
    text = schema_of(kind).decode()
    assert text.startswith('{"type":"object"') and "$ref" not in text
    assert ('"nodes":{"type":"array","items":{"type":"object"' in text) == (kind is TreeState)


def filled(path: Path, seconds: int, limit_bytes: int = 1 << 40, finish: bool = True) -> McapWriter:
    """A file with three kinds of messages, ten a second each."""
    rng = np.random.default_rng(1)
    writer = McapWriter(path, limit_bytes)
    channels = {bulk: writer.channel(bulk.name, "numbers", b'{"type":"object"}') for bulk in Bulk}
    writer.metadata("about", {"answer": "42"})
    writer.attachment("mission.xml", "application/xml", b"<root/>")
    writer.message(channels[Bulk.KEPT], Bulk.KEPT, 0, 0, b'{"n":0}')
    for i in range(seconds * 10):
        for bulk in (Bulk.LOG, Bulk.WHOLE, Bulk.THINNED):
            writer.message(channels[bulk], bulk, i * 100_000_000, i, encode({"n": i, "noise": rng.random(20).tolist()}))
        writer.flush(i * 100_000_000)
    if finish:
        writer.finish()
    return writer


def seen_by_the_library(path: Path) -> list[tuple[str, int, int]]:
    reader = make_reader(io.BytesIO(path.read_bytes()), validate_crcs=True)
    assert next(iter(reader.iter_metadata())).metadata["answer"] == "42"
    assert next(iter(reader.iter_attachments())).data == b"<root/>"
    summary = reader.get_summary()
    messages = [(channel.topic, message.log_time, message.sequence) for _, channel, message in reader.iter_messages()]
    assert summary is not None and summary.statistics is not None and summary.statistics.message_count == len(messages)
    return messages


def test_the_library_reads_what_we_write(tmp_path: Path) -> None:
    filled(tmp_path / "a.mcap", 12)
    messages = seen_by_the_library(tmp_path / "a.mcap")
    assert [number for topic, _, number in messages if topic == "WHOLE"] == list(range(120))
    file = McapFile(tmp_path / "a.mcap")
    assert sorted((line.topic, line.time_ns, line.sequence) for line in file.lines()) == sorted(messages) and file.is_whole


def test_at_the_limit_the_oldest_bulk_goes_and_what_the_rest_needs_stays(tmp_path: Path) -> None:
    writer = filled(tmp_path / "a.mcap", 120, limit_bytes=500_000)
    assert writer.dropped and (tmp_path / "a.mcap").stat().st_size <= 500_000
    of = {topic: [number for name, _, number in seen_by_the_library(tmp_path / "a.mcap") if name == topic] for topic in Bulk.__members__}
    assert of["KEPT"] == [0] and of["LOG"] == list(range(1200)), "the log still fits"
    assert of["THINNED"] == list(range(1200 - len(of["THINNED"]), 1200)) and len(of["THINNED"]) < 100, "of the thinned only the newest is left"
    assert of["WHOLE"] == list(range(1200 - len(of["WHOLE"]), 1200)) and 100 < len(of["WHOLE"]) < 1200, "without holes"


@settings(max_examples=60, deadline=None)
@given(share=st.floats(0.0, 1.0))
def test_a_file_cut_anywhere_is_read_as_far_as_it_goes(share: float, tmp_path_factory: pytest.TempPathFactory) -> None:
    path = tmp_path_factory.getbasetemp() / "whole.mcap"
    if not path.exists():
        filled(path, 12)
    data = path.read_bytes()
    cut = tmp_path_factory.getbasetemp() / "cut.mcap"
    cut.write_bytes(data[: max(8, round(share * len(data)))])
    file = McapFile(cut)
    numbers = [line.sequence for line in file.lines() if line.topic == "LOG"]
    assert numbers == list(range(len(numbers)))


def test_a_killed_writer_loses_two_seconds_at_most_and_repair_makes_the_file_whole(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    filled(path, 12, finish=False)
    file = McapFile(path)
    newest_ns = max(line.time_ns for line in file.lines())
    assert not file.is_whole and 11_900_000_000 - newest_ns <= CHUNK_NS
    with pytest.raises(Exception, match=r".*"):
        seen_by_the_library(path)
    assert repair(file, path) == len(seen_by_the_library(path))


def test_a_bad_chunk_costs_no_other_one(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    writer = filled(path, 12)
    chunk = next(chunk for chunk in writer._chunks if chunk.bulk is Bulk.LOG)
    data = bytearray(path.read_bytes())
    data[chunk.at.chunk_start_offset + 100] ^= 0xFF
    path.write_bytes(data)
    file = McapFile(path)
    numbers = [line.sequence for line in file.lines() if line.topic == "LOG"]
    assert 80 < len(numbers) < 120 and numbers[-1] == 119
    assert file.is_damaged and not file.is_whole, "also if its index at the end is good"


@pytest.mark.parametrize("byte", [0, 1, 3, 8, 33, 37, 41, 45, 60])  # opcode, length, checksum, compression, length of data, data
def test_wherever_a_chunk_is_hit_all_others_are_read_and_the_file_as_it_was_stays(tmp_path: Path, byte: int) -> None:
    path = tmp_path / "a.mcap"
    writer = filled(path, 30)
    chunk = [chunk for chunk in writer._chunks if chunk.bulk is Bulk.LOG][2]
    data = bytearray(path.read_bytes())
    data[chunk.at.chunk_start_offset + byte] ^= 0x55
    path.write_bytes(data)
    file = McapFile(path)
    numbers = [line.sequence for line in file.lines() if line.topic == "LOG"]
    lost = sorted(set(range(300)) - set(numbers))
    assert file.is_damaged and not file.is_whole and len(lost) <= 21, "two seconds are in a chunk"
    assert repair(file, path) == len(seen_by_the_library(path))
    assert (tmp_path / "a.mcap.damaged").read_bytes() == data


@settings(max_examples=40, deadline=None)
@given(flips=st.lists(st.tuples(st.floats(0.1, 0.99), st.integers(1, 255)), min_size=1, max_size=20))
def test_damage_anywhere_costs_what_it_hits_and_no_more(flips: list[tuple[float, int]], tmp_path_factory: pytest.TempPathFactory) -> None:
    path = tmp_path_factory.getbasetemp() / "long.mcap"
    if not path.exists():
        filled(path, 120)
    data = bytearray(path.read_bytes())
    for share, bits in flips:
        data[int(share * len(data))] ^= bits
    hit = tmp_path_factory.getbasetemp() / "hit.mcap"
    hit.write_bytes(data)
    file, whole = McapFile(hit), McapFile(path)
    lines, wanted = list(file.lines()), {(line.topic, line.sequence): line.data for line in whole.lines()}
    assert all(wanted[line.topic, line.sequence] == line.data for line in lines), "what is read is what was written"
    chunk = 1 + max(sum(1 for line in wanted if line[0] == bulk.name and line[1] < 21) for bulk in Bulk)
    assert len(wanted) - len(lines) <= 2 * chunk * len(flips)
