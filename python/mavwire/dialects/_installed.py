"""Newer definitions that ``mavwire definitions update`` installs for a user: one archive of XML and the facts about it.

The dialect ``upstream`` takes them before its own. An archive that cannot be used is one warning, and mavwire's own
definitions count.
"""

from __future__ import annotations

import os

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Sequence
    from typing import Any

    from mavwire._native import Dialect

# The member of the archive that says what the sets are.
FACTS = "facts.json"
_warned = False


def data_folder() -> str:
    """The user's folder of this package's data."""
    base = os.environ.get("XDG_DATA_HOME") or os.path.expanduser(
        os.path.join("~", ".local", "share")
    )
    return os.path.join(base, "mavwire")


def archive() -> str:
    """The archive in use, if there is one."""
    return os.path.join(data_folder(), "upstream.zip")


def previous() -> str:
    """The archive that was in use before the last update."""
    return os.path.join(data_folder(), "upstream.previous.zip")


def dialect(wire_protocol: str) -> Dialect | None:
    """The dialect ``upstream`` with the installed definitions; None where none are installed or they cannot be used."""
    global _warned
    path = archive()
    if not os.path.lexists(path):
        return None
    from mavwire._native import Dialect

    try:
        return Dialect.upstream_with(read(path)[0], wire_protocol)
    except Exception as error:  # a broken archive may raise anything
        if not _warned:
            import warnings

            _warned = True
            reason = getattr(error, "strerror", None) or error
            hint = "`mavwire definitions update --revert` removes them"
            text = f"{path}: {reason}: definitions not used; {hint}"
            warnings.warn(text, stacklevel=2)
        return None


def read(path: str) -> tuple[list[dict[str, str]], dict[str, Any]]:
    """The sets of an archive, each as texts by base names, and the facts about them."""
    import json
    import zipfile

    from mavwire.dialects import _sources

    sets: dict[str, dict[str, str]] = {}
    with zipfile.ZipFile(path) as file:
        facts: dict[str, Any] = json.loads(file.read(FACTS))
        for info in file.infolist():
            number, _, name = info.filename.partition("/")
            if name.endswith(".xml"):
                data = file.open(info).read(_sources.MAX_BYTES + 1)
                text = _sources.decode(data, info.filename)
                sets.setdefault(number, {})[name.removesuffix(".xml")] = text
    return [*sets.values()], facts


def packed(sets: Sequence[dict[str, str]], facts: dict[str, Any]) -> bytes:
    """The bytes of an archive."""
    import io
    import json
    import zipfile

    data = io.BytesIO()
    with zipfile.ZipFile(data, "w", zipfile.ZIP_DEFLATED) as file:
        file.writestr(FACTS, json.dumps(facts))
        for number, texts in enumerate(sets):
            for name, text in texts.items():
                file.writestr(f"{number}/{name}.xml", text)
    return data.getvalue()
