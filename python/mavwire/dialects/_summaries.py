"""What the messages, commands and enums of common traffic are for, in mavwire's own words: one line each.

The lines are in ``_data/summaries.toml``, which is read when somebody first asks for a description.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

FILE = Path(__file__).resolve().parent.parent / "_data" / "summaries.toml"


@cache
def load() -> dict[str, dict[str, str]]:
    """``messages``, ``commands`` and ``enums``: name -> summary."""
    import tomllib

    with FILE.open("rb") as source:
        return tomllib.load(source)


def message(name: str) -> str:
    """Summary of a message, or an empty text."""
    return load()["messages"].get(name, "")


def command(name: str) -> str:
    """Summary of an entry of ``MAV_CMD``, or an empty text."""
    return load()["commands"].get(name, "")


def enum(name: str) -> str:
    """Summary of an enum, or an empty text."""
    return load()["enums"].get(name, "")
