"""Makes a black box whole that was cut short by a crash, or damaged."""

from __future__ import annotations

import itertools
import os
from pathlib import Path

from pluto_bt.record.mcap_chunk import Bulk
from pluto_bt.record.mcap_reader import McapFile
from pluto_bt.record.mcap_writer import McapWriter


def repair(file: McapFile, to: Path) -> int:
    """Write all that can be read to `to`, with an index; the messages saved.

    `to` may be the file itself: it is replaced in one go. If something in it is damaged it stays beside, as `kept_as` says.

    Raises: OSError if `to` cannot be written.
    """
    draft = to.with_name(to.name + ".new")
    writer = McapWriter(draft)
    channels: dict[str, int] = {}
    count = 0
    for line in file.lines():
        if line.topic not in channels:
            known = next(channel for channel in file.channels.values() if channel.topic == line.topic)
            schema = file.schemas.get(known.schema_id)
            name, data = (line.topic, b"{}") if schema is None else (schema.name, schema.data)
            channels[line.topic] = writer.channel(line.topic, name, data)
        writer.message(channels[line.topic], Bulk.LOG, line.time_ns, line.sequence, line.data)
        count += 1
    for attachment in file.attachments.values():
        writer.attachment(attachment.name, attachment.media_type, attachment.data)
    for name, values in file.metadata.items():
        writer.metadata(name, values)
    writer.finish()
    if file.is_damaged and to.exists() and to.samefile(file.path):
        os.replace(to, kept_as(to))
    os.replace(draft, to)
    return count


def kept_as(path: Path) -> Path:
    """The name under which a damaged file stays: FILE.damaged, or the first number behind it that is free."""
    names = (path.with_name(f"{path.name}.damaged{number or ''}") for number in itertools.count())
    return next(name for name in names if not name.exists())
