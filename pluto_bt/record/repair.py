"""Makes a black box whole that was cut short by a crash, and tells what is in one."""

from __future__ import annotations

import os
from pathlib import Path

from pluto_bt.record.mcap_chunk import Bulk
from pluto_bt.record.mcap_reader import McapFile
from pluto_bt.record.mcap_writer import McapWriter


def repair(file: McapFile, to: Path) -> int:
    """Write all that can be read to `to`, with an index; the messages saved. `to` may be the file itself: it is replaced in one go.

    Raises: OSError if `to` cannot be written.
    """
    draft = to.with_name(to.name + ".new")
    writer = McapWriter(draft)
    channels: dict[str, int] = {}
    count = 0
    for line in file.lines():
        if line.topic not in channels:
            known = next(channel for channel in file.channels.values() if channel.topic == line.topic)
            schema = file.schemas[known.schema_id]
            channels[line.topic] = writer.channel(line.topic, schema.name, schema.data)
        writer.message(channels[line.topic], Bulk.LOG, line.time_ns, line.sequence, line.data)
        count += 1
    for attachment in file.attachments.values():
        writer.attachment(attachment.name, attachment.media_type, attachment.data)
    for name, values in file.metadata.items():
        writer.metadata(name, values)
    writer.finish()
    os.replace(draft, to)
    return count
