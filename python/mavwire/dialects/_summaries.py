"""Summaries of common messages, commands and enums in mavwire's own words: one line each.

The lines are in ``_data/summaries.toml``. The first request for a description reads it.
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


def summary(kind: str, name: str) -> str:
    """Summary of one of ``messages``, ``commands`` or ``enums``, or an empty text."""
    return load()[kind].get(name, "")
