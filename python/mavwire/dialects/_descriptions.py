"""Where descriptions come from.

The definitions that come with mavwire carry facts alone. Prose is the user's to add: XML in the folder that ``MDEF`` names,
a set stored by ``mavwire definitions sync``, or the XML that an installed pymavlink carries as package data. It is read
when somebody first asks for a description, and never otherwise. Where there is none, mavwire's own summaries take its place.
"""

from __future__ import annotations

import os

# Imports for types or rare calls would take most of the time of importing this module.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path
    from typing import Any

    from mavwire._native import Dialect


def stored_folder() -> Path:
    """The folder that ``mavwire definitions sync`` fills."""
    from pathlib import Path

    from mavwire.dialects._installed import data_folder

    return Path(data_folder()) / "definitions"


def _folders() -> Iterator[list[Path]]:
    """Folders that are read together, the first ones first."""
    from pathlib import Path

    if "MDEF" in os.environ:
        yield [Path(os.environ["MDEF"]) / "v1.0"]
    yield sorted(stored_folder().glob("*"))
    if (installed := installed_folder()) is not None:
        yield [installed]


def installed_folder() -> Path | None:
    """The folder with the definitions of an installed pymavlink."""
    from mavwire import _alias_metadata

    installed = _alias_metadata.installed_folder()
    return None if installed is None else installed / "pymavlink/dialects/v20"


_summaries: dict[str, dict[str, str]] = {}


def summaries() -> dict[str, dict[str, str]]:
    """mavwire's own lines on ``messages``, ``commands`` and ``enums``: name -> summary."""
    if not _summaries:
        import tomllib
        from pathlib import Path

        file = Path(__file__).resolve().parent.parent / "_data" / "summaries.toml"
        _summaries.update(tomllib.loads(file.read_text(encoding="utf-8")))
    return _summaries


def summary(kind: str, name: str) -> str:
    """The summary of one of them, or an empty text."""
    return summaries()[kind].get(name, "")


def of_messages(native: Dialect) -> dict[str, tuple[str, dict[str, str]]]:
    """The descriptions of messages and their fields, by name: the definitions' own, or those found elsewhere."""
    texts = Texts(native.name)
    found = {}
    for name, _ in native.messages():
        message, fields = texts.of(native, name)
        found[name] = message, {field: text for field, text in fields.items() if text}
    return found


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
        for folders in _folders():
            whole: dict[str, Any] = {}
            for folder in folders:
                file = folder / f"{self._dialect}.xml"
                # The union of all dialects has no file there, and neither has a user's own dialect.
                files = (
                    [file]
                    if file.is_file()
                    else [folder / "all.xml", *sorted(folder.glob("*.xml"))]
                )
                whole = _read(files, whole)
            if whole:
                return whole
        return None

    def of(self, native: Dialect, name: str) -> tuple[str, dict[str, str]]:
        """Those of a message and its fields: the definition's own, or those found elsewhere."""
        message, fields = native.descriptions(name)
        return (message, fields) if message or any(fields.values()) else self.message(name)

    def message(self, name: str) -> tuple[str, dict[str, str]]:
        """Description of a message and of its fields by name."""
        texts: tuple[str, dict[str, str]] = self._find()["messages"].get(name, ("", {}))
        return texts[0] or summary("messages", name), texts[1]

    def entry(self, enum: str, name: str) -> str:
        """Description of an enum entry."""
        text = self._entry(enum, name)[0]
        return text or (summary("commands", name) if enum == "MAV_CMD" else "")

    def params(self, enum: str, name: str) -> dict[int, str]:
        """Descriptions of a command's parameters by number."""
        return self._entry(enum, name)[1]

    def _entry(self, enum: str, name: str) -> tuple[str, dict[int, str]]:
        texts: tuple[str, dict[int, str]] = self._find()["enums"].get(enum, {}).get(name, ("", {}))
        return texts


def _read(files: list[Path], whole: dict[str, Any]) -> dict[str, Any]:
    """The whole, and the descriptions of several files with those that they include. The first ones count."""
    from mavwire._native import describe
    from mavwire.dialects import _sources

    seen: set[str] = set()
    for file in files:
        if file.stem in seen:
            continue
        try:
            main, sources = _sources.collect(file, None)
            part = describe(main, sources)
        except (OSError, ValueError):  # unreadable, too large, or no definitions
            continue
        seen |= sources.keys()
        enums = whole.get("enums", {})
        for enum, entries in part["enums"].items():
            enums[enum] = entries | enums.get(enum, {})
        whole = {"messages": part["messages"] | whole.get("messages", {}), "enums": enums}
    return whole
