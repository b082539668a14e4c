"""The table of `mavwire bridge --status`."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any

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
# The columns with names of links, which fold.
LINKS = ("link", "links")
# Of a file or a pipe, where lines are as long as they need to be.
NO_TERMINAL_WIDTH = 10_000


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
        # Lines printed meanwhile go above the table, but not those to a file or a pipe.
        self._live = Live(
            self._tables(bridge.stats()), console=self._console, auto_refresh=False,
            redirect_stderr=is_terminal(sys.stderr),
        )  # fmt: skip
        self._live.start()
        guard_streams()  # till `stop` puts back what it found

    def __call__(self) -> None:
        self._live.update(self._tables(self._bridge.stats()), refresh=True)

    def close(self) -> None:
        """Leave the table as it is."""
        self._live.stop()

    def _tables(self, stats: dict[str, Any]) -> Any:
        from rich.console import Group
        from rich.text import Text

        before, self._before = self._before, stats
        lines = [
            *link_errors(stats),
            *unknown(stats, self._bridge.dialect),
            *(loss.line for loss in losses(stats)),
        ]
        return Group(
            _table(LINK_COLUMNS, link_rows(stats, before), 2),
            *(Text(printable(line)) for line in lines),
            _table(COMPONENT_COLUMNS, component_rows(stats, before), 0),
        )


def _table(columns: tuple[str, ...], rows: list[list[str]], first_number: int) -> Any:
    """A table without the columns of `IF_ANY` in which no row has anything. Names of links fold."""
    from rich import box
    from rich.table import Table
    from rich.text import Text

    table = Table(box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0), pad_edge=False)
    shown = [
        n
        for n, name in enumerate(columns)
        if name not in IF_ANY or any(row[n] not in ("", "0") for row in rows)
    ]
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
    return table


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
