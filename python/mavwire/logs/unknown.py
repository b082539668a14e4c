"""Messages that a dialect does not define: how many a log has, and the text that says so."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

SHOWN = 8
"""Kinds that a text names."""


class UnknownMessageWarning(UserWarning):
    """A log has messages that the dialect does not define, so that no table holds them."""


def warn_unknown(counts: Mapping[tuple[int, int] | None, int], path: str) -> None:
    """Warn of the messages of a log that the dialect does not define, as `LogColumns.unknown` counts them."""
    if counts:
        text = f"{path}: left out {unknown_text(named(counts))}"
        warnings.warn(text, UnknownMessageWarning, stacklevel=3)


def named(counts: Mapping[tuple[int, int] | None, int]) -> dict[str, int]:
    """The counts by the text of each kind, the most frequent first."""
    texts = {
        "other kinds" if kind is None else "id {} with CRC_EXTRA {}".format(*kind): count
        for kind, count in counts.items()
    }
    return dict(sorted(texts.items(), key=lambda row: -row[1]))


def unknown_text(counts: Mapping[str, int]) -> str:
    """The text about messages that were left out, with advice."""
    shown = [f"{count:,} of {kind}" for kind, count in list(counts.items())[:SHOWN]]
    if len(counts) > SHOWN:
        shown.append(f"{sum(list(counts.values())[SHOWN:]):,} others")
    return (
        f"{sum(counts.values()):,} messages that the dialect does not define ({', '.join(shown)}):"
        " name a dialect or an XML file that does"
    )
