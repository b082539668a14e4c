"""Messages of MCAP files, JSON or Protocol Buffers, as the reader of the format's makers finds them."""

from __future__ import annotations

import json
import math
from functools import cache
from pathlib import Path
from typing import Any

import pytest

make_reader = pytest.importorskip("mcap.reader").make_reader
descriptor_pb2 = pytest.importorskip("google.protobuf.descriptor_pb2")
message_factory = pytest.importorskip("google.protobuf.message_factory")


def messages(path: Path, topic: str | None = None) -> dict[str, list[tuple[int, int, Any]]]:
    """Time in nanoseconds, sequence and content of each message by topic, checksums verified."""
    found: dict[str, list[tuple[int, int, Any]]] = {}
    with path.open("rb") as file:
        reader = make_reader(file, validate_crcs=True)
        topics = None if topic is None else [topic]
        for schema, channel, one in reader.iter_messages(topics=topics, log_time_order=False):
            assert one.publish_time == one.log_time
            if channel.message_encoding == "json":
                assert schema.encoding == "jsonschema"
                content = json.loads(one.data)
            else:
                assert (channel.message_encoding, schema.encoding) == ("protobuf", "protobuf")
                content = of_protobuf(schema.name, schema.data, one.data)
            row = one.log_time, one.sequence, content
            found.setdefault(channel.topic, []).append(row)
    return found


@cache
def message_class(name: str, descriptor: bytes) -> Any:
    files = descriptor_pb2.FileDescriptorSet.FromString(descriptor).file
    return message_factory.GetMessages(files)[name]


def of_protobuf(name: str, descriptor: bytes, data: bytes) -> dict[str, Any]:
    """What JSON would have."""

    def plain(value: Any) -> Any:
        if isinstance(value, bytes):
            return value.hex()
        return value if not isinstance(value, float) or math.isfinite(value) else None

    message = message_class(name, descriptor).FromString(data)
    return {
        field.name: [plain(one) for one in value] if field.is_repeated else plain(value)
        for field, value in message.ListFields()
    }
