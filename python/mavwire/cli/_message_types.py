"""Names of message types in options, and what to say of those that are none: a misspelt one would go
unnoticed.
"""

from __future__ import annotations

from mavwire.cli._errors import tell
from mavwire.cli._reading import kind_of

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterable
    from typing import Any

    from mavwire.cli._reading import Reading

# What messages are called that are in no definition.
WITHOUT_DEFINITION = ("BAD_DATA", "UNKNOWN")


def unknown(names: Iterable[str], log: Any) -> list[str]:
    """What to say of each name that is no message type of a log, or of the dialect that it is read by."""
    from mavwire import mavutil
    from mavwire._wording import did_you_mean

    kind = kind_of(log)
    if kind == "telemetry":
        prefix = "MAVLINK_MSG_ID_"
        known = [one.removeprefix(prefix) for one in vars(mavutil.mavlink) if prefix in one]
        place = f"dialect {mavutil.current_dialect}"
    else:
        known = [log.message_type] if kind == "CSV" else list(log.name_to_id)
        place = "this log"
    return [
        f"no message type {name!r} in {place}{did_you_mean(name.upper(), known)}"
        for name in names
        if name not in known and not name.startswith(WITHOUT_DEFINITION)
    ]


def wanted(text: str | None, log: Reading) -> list[str] | None:
    """The types that an option names, between commas; None for all. Unknown ones are said."""
    if text is None:
        return None
    names = text.split(",")
    tell_unknown(names, log)
    return names


def tell_unknown(names: Iterable[str], log: Reading) -> None:
    """Say on standard error which names are no message types."""
    for problem in unknown(filter(None, names), log.link):
        tell(f"mavwire {log.command}: {problem}")
