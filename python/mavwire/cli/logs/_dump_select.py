"""Which messages of a log `mavwire dump` shows: types, sources, conditions, thinned out streams.

The order of the filters, and what BAD_DATA passes through, are mavlogdump's.
"""

from __future__ import annotations

from argparse import Namespace
from fnmatch import fnmatchcase
from typing import Any

from mavwire._log_link import kind_of
from mavwire.cli._message_types import unknown
from mavwire.cli._reading import Reading

# Types that `--meta` shows at any condition: how a dataflash log describes itself.
META = frozenset(("FMT", "FMTU", "UNIT", "MULT", "PARM", "MSG", "MODE", "EV", "CMD", "MAVC", "VER"))
# Types that `--parms` copies into the output beside the wanted ones.
PRESERVED = frozenset(("PARAM_VALUE", "PARM", "FMT", "FMTU", "UNIT", "MULT"))
# The types that `--reduce` thins out: these, and those that begin with one of the prefixes.
STREAMED = frozenset(
    ("AHR2", "ATT", "CTRL", "CTUN", "DSF", "NTUN", "PL", "POS", "RATE", "RFND", "VIBE")
)
STREAMED_PREFIXES = (
    "BAR", "BAT", "CST", "FTS", "GP", "IMT", "IMU", "LOS", "MAG", "MOT", "NKF", "NKQ", "POW",
    "RC", "UBX", "UWB", "XKF",
)  # fmt: skip
# Dataflash types that `--reduce-rate` leaves alone: without them the rest cannot be read.
UNRATED = frozenset(("FMT", "FMTU", "UNIT", "MULT", "PARM", "MSG", "MODE", "VER", "EVT"))


class Selection:
    """The filters of one command line over one log."""

    def __init__(self, args: Namespace, log: Reading) -> None:
        self._args = args
        self._log = log
        self._types = _patterns(args.types)
        self._nottypes = _patterns(args.nottypes)
        self._wanted: dict[str, bool] = {}
        self._counts: dict[str, int] = {}
        self._shown_at: dict[str, float] = {}
        self.visited = self._visited_types()
        self._hides_bad_data = self.visited is not None
        if args.follow:  # other types that fit may come
            self.visited = None

    def _visited_types(self) -> list[str] | None:
        """The types to seek to in an indexed log; None to read every record."""
        if self._types is None:
            return None
        link = self._log.link
        names = () if kind_of(link) == "CSV" else getattr(link, "name_to_id", ())
        return [name for name in names if self._fits(name)] or None

    def wants(self, kind: str) -> bool:
        """Whether messages of this type are shown."""
        if self.visited is not None:
            return kind in self.visited
        answer = self._wanted.get(kind)
        if answer is None:
            answer = self._wanted[kind] = self._fits(kind)
        return answer

    def _fits(self, kind: str) -> bool:
        """BAD_DATA passes the list of wanted types, which only names what an index can find."""
        if kind == "BAD_DATA":
            if self._args.no_bad_data or self._hides_bad_data:
                return False
        elif self._types is not None and not _any_fits(self._types, kind):
            return False
        return self._nottypes is None or not _any_fits(self._nottypes, kind)

    def preserves(self, kind: str) -> bool:
        """Whether the message goes to the output file alone, before any filter."""
        return bool(self._args.parms and self._args.output and kind in PRESERVED)

    def thins_out(self, msg: Any, kind: str) -> bool:
        """Whether `--reduce` or `--reduce-rate` drops this one."""
        return self._is_skipped(kind) or self._is_too_soon(kind, msg)

    def _is_skipped(self, kind: str) -> bool:
        every: int | None = self._args.reduce
        if not every or not (kind in STREAMED or kind.startswith(STREAMED_PREFIXES)):
            return False
        self._counts[kind] = count = self._counts.get(kind, 0) + 1
        # mavlogdump shows none of them for a negative number.
        return every < 0 or count % every != 0

    def _is_too_soon(self, kind: str, msg: Any) -> bool:
        rate = self._args.reduce_rate
        if rate <= 0 or kind in UNRATED:
            return False
        now = msg._timestamp
        # A clock that went back is no reason to wait until it has caught up.
        if 0.0 <= now - self._shown_at.setdefault(kind, now) < 1.0 / rate:
            return True
        self._shown_at[kind] = now
        return False

    def passes(self, msg: Any, kind: str) -> bool:
        """Whether type, condition, source and link are what was asked for."""
        args = self._args
        if not self.wants(kind) or (kind == "BAD_DATA" and msg.reason == "Bad prefix"):
            return False
        if not self._log.holds(args.condition) and not (args.meta and kind in META):
            return False
        return (
            (args.source_system is None or args.source_system == msg.get_srcSystem())
            and (args.source_component is None or args.source_component == msg.get_srcComponent())
            and (args.link is None or args.link == msg._link)
        )


def unknown_types(args: Namespace, log: Any) -> list[str]:
    """A warning for each name in `--types` that is no message type, and no pattern of some."""
    return unknown(filter(None, _patterns(args.types) or ()), log, patterns=True)


def _patterns(text: str | None) -> list[str] | None:
    return None if text is None else text.split(",")


def _any_fits(patterns: list[str], kind: str) -> bool:
    return any(fnmatchcase(kind, pattern) for pattern in patterns)
