"""Names of message types in options, and warnings for unknown ones: a misspelt name matches nothing."""

from __future__ import annotations

from collections.abc import Iterable
from fnmatch import fnmatchcase
from typing import TYPE_CHECKING, Any

from mavwire._log_link import kind_of
from mavwire.cli._errors import tell

if TYPE_CHECKING:
    from mavwire.cli._reading import Reading

# Types of messages without a definition.
WITHOUT_DEFINITION = ("BAD_DATA", "UNKNOWN")
# Characters of patterns.
WILDCARDS = frozenset("*?[")


def unknown(
    names: Iterable[str], log: Any, what: str = "message type", patterns: bool = False
) -> list[str]:
    """A warning for each name that is no message type of a log or of its dialect. `patterns` says
    that names may be patterns: each that matches no type gets a warning too.
    """
    from mavwire import mavutil
    from mavwire._text import did_you_mean

    kind = kind_of(log)
    if kind == "telemetry":
        prefix = "MAVLINK_MSG_ID_"
        known = [one.removeprefix(prefix) for one in vars(mavutil.mavlink) if prefix in one]
        place = f"dialect {mavutil.current_dialect}"
    else:
        known = [log.message_type] if kind == "CSV" else list(log.name_to_id)
        place = "this log"
    said = []
    for name in names:
        if name.startswith(WITHOUT_DEFINITION) or name in known:
            continue
        if not (patterns and WILDCARDS & set(name)):
            said.append(f"no {what} {name!r} in {place}{did_you_mean(name.upper(), known)}")
        elif not any(fnmatchcase(one, name) for one in (*known, *WITHOUT_DEFINITION)):
            said.append(f"no {what} matches {name!r} in {place}")
    return said


def tell_unknown_in(condition: str, log: Reading) -> None:
    """Warn of names in a condition that are neither message types nor functions: it never holds."""
    from mavwire.plots.expressions import read_by

    for problem in unknown(sorted(read_by(condition)[0]), log.link, "message type or function"):
        tell(f"mavwire {log.command}: --condition: {problem}")


def wanted(text: str | None, log: Reading) -> list[str] | None:
    """The types that an option names, between commas; None for all. Warns of unknown ones."""
    if text is None:
        return None
    names = text.split(",")
    tell_unknown(names, log)
    return names


def tell_unknown(names: Iterable[str], log: Reading) -> None:
    """Warn of names that are no message types."""
    for problem in unknown(filter(None, names), log.link):
        tell(f"mavwire {log.command}: {problem}")
