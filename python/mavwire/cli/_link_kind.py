"""The kind of a link or log as mavutil gives it."""

from __future__ import annotations

from typing import Any


def kind_of(link: Any) -> str:
    """The kind of a link or log: "telemetry", "dataflash" or "CSV"."""
    if hasattr(link, "mav"):
        return "telemetry"
    return "CSV" if hasattr(link, "message_type") else "dataflash"
