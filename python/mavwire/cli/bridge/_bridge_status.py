"""The table of `mavwire bridge --status`."""

from __future__ import annotations

import signal
import sys
from contextlib import ExitStack
from typing import TYPE_CHECKING, Any

from mavwire._signals import handled
from mavwire._text import drawn_on, guard_streams, is_terminal, printable
from mavwire.cli._errors import CommandError
from mavwire.cli.bridge._bridge_warnings import full_name, losses
from mavwire.logs.unknown import unknown_text

if TYPE_CHECKING:
    from mavwire.bridge import Bridge


LINK_COLUMNS = (
    "link", "state", "in/s", "out/s", "p99 ms", "dropped", "overrun", "duplicates", "junk bytes",
)  # fmt: skip
COMPONENT_COLUMNS = ("system", "component", "in/s", "lost", "duplicates", "age", "links")
# Shown only where there is something: a terminal of 80 columns has no room for zeros.
IF_ANY = ("overrun", "duplicates", "junk bytes")
# What a terminal leaves out that has no room for it, the first of these first.
LEAST_WANTED = ("junk bytes", "duplicates", "overrun", "p99 ms", "out/s", "in/s", "lost")
# The columns with names of links.
LINKS = ("link", "links")
# Columns of a terminal: between two columns of a table, at its edges, and for names of links, which fold.
GAP = 2
EDGES = 2
LEAST_FOR_LINKS = 10
# Of a file or a pipe, where lines are as long as they need to be.
NO_TERMINAL_WIDTH = 10_000
# Signals after which a terminal shows something else than what was drawn: another size, and back from Ctrl-Z.
DISTURBING = tuple(
    getattr(signal, name) for name in ("SIGWINCH", "SIGCONT") if hasattr(signal, name)
)


class StatusTable:
    """Links and components with their rates since the last look; call it to bring it up to date. Without a terminal that
    can be drawn on, `is_live` is false and the table comes with `close`.
    """

    def __init__(self, bridge: Bridge) -> None:
        try:
            from rich.console import Console
            from rich.live import Live
        except ImportError:
            raise CommandError("--status needs rich: pip install 'mavwire[cli]'") from None
        self._bridge = bridge
        self._before: dict[str, Any] = {"uptime": 0.0, "links": [], "components": []}
        terminal = drawn_on(sys.stdout)  # which a guard would not let it redraw
        on_terminal = is_terminal(terminal)  # FORCE_COLOR does not make it one
        width = None if on_terminal else NO_TERMINAL_WIDTH
        self._console = Console(file=terminal, force_terminal=on_terminal, width=width)
        self.is_live = on_terminal and not self._console.is_dumb_terminal
        self._is_disturbed = False
        # What is printed meanwhile goes above the table, but not what goes to a file or a pipe.
        self._live = Live(
            self._tables(bridge.stats()), console=self._console, auto_refresh=False,
            redirect_stderr=is_terminal(sys.stderr),
        )  # fmt: skip
        numbers = DISTURBING if self.is_live else ()
        with ExitStack() as exits:
            exits.enter_context(handled(numbers, self._disturb))
            exits.callback(self._live.stop)
            self._live.start()
            guard_streams()  # till `stop` puts back what it found
            # From here on it is for `close`, which gives the signals back also where the terminal is gone.
            self._exits = exits.pop_all()

    def __call__(self) -> None:
        if self._is_disturbed:
            self._is_disturbed = False
            # At the top, to which drawing then goes back: where the old table began nobody knows any more.
            self._console.clear()
        self._live.update(self._tables(self._bridge.stats()), refresh=True)

    def close(self) -> None:
        """Leave the table as it is."""
        self._exits.close()

    def _disturb(self, number: int, frame: object) -> None:
        self._is_disturbed = True

    def _tables(self, stats: dict[str, Any]) -> Any:
        from rich.console import Group
        from rich.text import Text

        before, self._before = self._before, stats
        width = self._console.width
        lines = [
            *link_errors(stats),
            *unknown(stats, self._bridge.dialect),
            *(loss.line for loss in losses(stats)),
        ]
        return Group(
            *_table(LINK_COLUMNS, link_rows(stats, before), 2, width),
            *(Text(printable(line)) for line in lines),
            *_table(COMPONENT_COLUMNS, component_rows(stats, before), 0, width),
        )


def _table(
    columns: tuple[str, ...], rows: list[list[str]], first_number: int, width: int
) -> list[Any]:
    """A table without the columns of `IF_ANY` in which no row has anything, and below it the names of those that there
    is no room for. Names of links fold, and nothing else: numbers stay whole.
    """
    from rich import box
    from rich.table import Table
    from rich.text import Text

    room = {
        name: max(map(len, (name, *(row[n] for row in rows))))
        for n, name in enumerate(columns)
        if name not in IF_ANY or any(row[n] not in ("", "0") for row in rows)
    }
    left_out = _left_out(room, width)
    table = Table(box=box.SIMPLE_HEAD, padding=(0, GAP - 1, 0, 0), pad_edge=False)
    shown = [n for n, name in enumerate(columns) if name in room and name not in left_out]
    for n in shown:
        is_link = columns[n] in LINKS
        table.add_column(
            columns[n],
            justify="right" if n >= first_number and not is_link else "left",
            overflow="fold",
            no_wrap=not is_link,
        )
    for row in rows:
        # In a `Text` brackets are no markup.
        table.add_row(*(Text(printable(row[n])) for n in shown))
    hint = Text(f"no room for: {', '.join(left_out)}", style="dim")
    return [table, hint] if left_out else [table]


def _left_out(room: dict[str, int], width: int) -> list[str]:
    """The columns of `LEAST_WANTED` without which a table is as narrow as that, if it can be."""
    taken = {
        name: GAP + (min(each, LEAST_FOR_LINKS) if name in LINKS else each)
        for name, each in room.items()
    }
    left_out: list[str] = []
    for name in LEAST_WANTED:
        if EDGES - GAP + sum(taken.values()) > width and taken.pop(name, 0):
            left_out.append(name)
    return left_out


def link_rows(stats: dict[str, Any], before: dict[str, Any]) -> list[list[str]]:
    """A row for each link and each peer of one, with rates since `before`."""
    span = max(stats["uptime"] - before["uptime"], 1e-3)
    known = {(one["name"], one["peer"]): one for one in before["links"]}
    rows = []
    for one in stats["links"]:
        last = known.get((one["name"], one["peer"]), {})
        rates = [(one[key] - last.get(key, 0)) / span for key in ("received", "sent")]
        late = one["latency"]["p99"]
        counts = [one[key] for key in ("dropped", "overrun", "duplicates", "junk_bytes")]
        rows.append([
            f"  {one['peer']}" if one["peer"] else one["name"], one["state"], *(f"{rate:.0f}" for rate in rates),
            "" if late is None else f"{late * 1e3:.2f}",
            *("" if count is None else str(count) for count in counts),
        ])  # fmt: skip
    return rows


def link_errors(stats: dict[str, Any]) -> list[str]:
    """A line for each link and peer that has trouble: beside the numbers there is no room for it."""
    return [f"{full_name(one)}: {one['error']}" for one in stats["links"] if one["error"]]


def unknown(stats: dict[str, Any], dialect: Any) -> list[str]:
    """A line for each link and peer with frames that the dialect does not define."""
    lines = []
    for one in stats["links"]:
        counts: dict[tuple[int, int] | None, int] = {}
        for kind in one["unknown"]:
            key = None if kind["id"] is None else (kind["id"], kind["crc_extra"])
            counts[key] = kind["frames"]
        if counts:
            lines.append(f"{full_name(one)}: {unknown_text(counts, dialect)}")
    return lines


def component_rows(stats: dict[str, Any], before: dict[str, Any]) -> list[list[str]]:
    """A row for each component, with its rate since `before`."""
    span = max(stats["uptime"] - before["uptime"], 1e-3)
    known = {(one["system"], one["component"]): one["frames"] for one in before["components"]}
    rows = []
    for one in stats["components"]:
        who = (one["system"], one["component"])
        rate = (one["frames"] - known.get(who, 0)) / span
        age = f"{one['age']:.1f} s"
        counts = (str(one["lost"]), str(one["duplicates"]))
        rows.append([*map(str, who), f"{rate:.0f}", *counts, age, ", ".join(one["links"])])
    return rows
