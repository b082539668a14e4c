"""PX4's events: what a vehicle says as numbers, and the file with the words."""

from __future__ import annotations

import json
import lzma
import zlib
from collections.abc import Mapping

from mavwire.component_metadata import Kind
from mavwire.dialects.v20 import upstream

GENERAL_PATH = "/etc/extras/component_general.json.xz"
EVENTS_PATH = "/etc/extras/all_events.json.xz"
COMPONENT = 1
Phrases = Mapping[str, tuple[int, str]]


def event_id(key: str) -> int:
    """The component and 24 bits of a checksum of the name."""
    return COMPONENT << 24 | zlib.crc32(key.encode()) & 0xFFFFFF


def is_event(phrase: str) -> bool:
    """Whether a text has no places for values: arguments of events are numbers."""
    return "{" not in phrase


def message(key: str, severity: int, time: float, sequence: int) -> upstream.MAVLink_event_message:
    """EVENT to everybody; `time` is in seconds since the start."""
    return upstream.MAVLink_event_message(
        0, 0, event_id(key), round(time * 1000) & 0xFFFFFFFF, sequence & 0xFFFF,
        severity << 4 | severity, [0] * 40,
    )  # fmt: skip


def files(phrases: Phrases) -> dict[str, bytes]:
    """The metadata files that a vehicle offers."""
    events = {
        str(event_id(key) & 0xFFFFFF): {"name": key, "message": phrase}
        for key, (_, phrase) in phrases.items()
        if is_event(phrase)
    }
    component = {"namespace": "px4", "event_groups": {"default": {"events": events}}}
    described = {"version": 2, "components": {str(COMPONENT): component}}
    offers = [{"type": Kind.EVENTS, "uri": f"mftp://{EVENTS_PATH}"}]
    general = {"version": 1, "metadataTypes": offers}
    return {GENERAL_PATH: _compressed(general), EVENTS_PATH: _compressed(described)}


def _compressed(content: object) -> bytes:
    return lzma.compress(json.dumps(content).encode())
