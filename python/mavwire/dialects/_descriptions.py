"""Where descriptions come from.

The definitions that come with mavwire carry facts alone. Prose is the user's to add: XML in the folder that ``MDEF`` names,
a set stored by ``mavwire definitions sync``, or the XML that an installed pymavlink carries as package data. It is read
when somebody first asks for a description, and never otherwise. Where there is none, mavwire's own summaries take its place.
"""

from __future__ import annotations

import os

# What is only needed for types, or seldom, would be most of the time of an import.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path
    from typing import Any


def stored_folder() -> Path:
    """The folder that ``mavwire definitions sync`` fills."""
    from pathlib import Path

    base = os.environ.get("XDG_DATA_HOME") or Path.home() / ".local" / "share"
    return Path(base) / "mavwire" / "definitions"


def _candidates(dialect: str) -> Iterator[Path]:
    from pathlib import Path

    if "MDEF" in os.environ:
        yield Path(os.environ["MDEF"]) / "v1.0" / f"{dialect}.xml"
    yield stored_folder() / f"{dialect}.xml"
    from importlib import metadata

    try:
        distribution = metadata.distribution("pymavlink")
    except metadata.PackageNotFoundError:
        return
    yield Path(str(distribution.locate_file(f"pymavlink/dialects/v20/{dialect}.xml")))


class Texts:
    """Descriptions of one dialect, read on first use.

    Where no XML has prose, mavwire's own summaries of messages and commands; else nothing.
    """

    def __init__(self, dialect: str) -> None:
        self._dialect = dialect
        self._loaded: dict[str, Any] | None = None

    def _find(self) -> dict[str, Any]:
        if self._loaded is None:
            self._loaded = self._load() or {"messages": {}, "enums": {}}
        return self._loaded

    def _load(self) -> dict[str, Any] | None:
        from mavwire._native import describe
        from mavwire.dialects import _sources

        for file in _candidates(self._dialect):
            try:
                main, sources = _sources.collect(file, self._dialect)
                return describe(main, sources)
            except (OSError, ValueError):  # unreadable, too large, or no definitions
                continue
        return None

    def message(self, name: str) -> tuple[str, dict[str, str]]:
        """Description of a message and of its fields by name."""
        from mavwire.dialects import _summaries

        texts: tuple[str, dict[str, str]] = self._find()["messages"].get(name, ("", {}))
        return texts[0] or _summaries.summary("messages", name), texts[1]

    def entry(self, enum: str, name: str) -> str:
        """Description of an enum entry."""
        from mavwire.dialects import _summaries

        text = self._entry(enum, name)[0]
        return text or (_summaries.summary("commands", name) if enum == "MAV_CMD" else "")

    def params(self, enum: str, name: str) -> dict[int, str]:
        """Descriptions of a command's parameters by number."""
        return self._entry(enum, name)[1]

    def _entry(self, enum: str, name: str) -> tuple[str, dict[int, str]]:
        texts: tuple[str, dict[int, str]] = self._find()["enums"].get(enum, {}).get(name, ("", {}))
        return texts
