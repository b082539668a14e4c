"""The table of `mavwire bridge --status`."""

from __future__ import annotations

import sys

from mavwire._wording import drawn_on, printable
from mavwire.cli._bridge_warnings import losses
from mavwire.cli._errors import CommandError

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from mavwire.bridge import Bridge


LINK_COLUMNS = (
    "link", "state", "in/s", "out/s", "p99 ms", "dropped", "overrun", "duplicates", "junk bytes",
)  # fmt: skip
COMPONENT_COLUMNS = ("system", "component", "in/s", "lost", "duplicates", "age", "links")
# Shown only where there is something: a terminal of 80 columns has no room for zeros.
IF_ANY = ("overrun", "duplicates", "junk bytes")

# What udpout:255.255.255.255:14550 takes.
ENDPOINT_WIDTH = 28


class StatusTable:
    """Links and components with their rates since the last look; call it to bring it up to date."""

    def __init__(self, bridge: Bridge) -> None:
        try:
            from rich.console import Console
            from rich.live import Live
        except ImportError:
            raise CommandError("--status needs rich: pip install 'mavwire[cli]'") from None
        self._bridge = bridge
        self._before: dict[str, Any] = {"uptime": 0.0, "links": [], "components": []}
        self._live = Live(
            self._tables(bridge.stats()),
            console=Console(file=drawn_on(sys.stdout)),  # which a guard would not let it redraw
            auto_refresh=False,
        )
        self._live.start()

    def __call__(self) -> None:
        self._live.update(self._tables(self._bridge.stats()), refresh=True)

    def close(self) -> None:
        """Leave the table as it is."""
        self._live.stop()

    def _tables(self, stats: dict[str, Any]) -> Any:
        from rich.console import Group
        from rich.text import Text

        before, self._before = self._before, stats
        return Group(
            _table(LINK_COLUMNS, link_rows(stats, before), 2),
            _table(COMPONENT_COLUMNS, component_rows(stats, before), 0),
            *(Text(printable(loss.line)) for loss in losses(stats)),
        )


def _table(columns: tuple[str, ...], rows: list[list[str]], first_number: int) -> Any:
    """A table without the columns of `IF_ANY` in which no row has anything."""
    from rich import box
    from rich.table import Table
    from rich.text import Text

    shown = [
        n
        for n, name in enumerate(columns)
        if name not in IF_ANY or any(row[n] not in ("", "0") for row in rows)
    ]
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for n in shown:
        is_number = n >= first_number and columns[n] != "links"
        table.add_column(
            columns[n],
            justify="right" if is_number else "left",
            overflow="fold",
            min_width=ENDPOINT_WIDTH if columns[n] == "link" else None,
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
        state = f"{one['state']}: {one['error']}" if one["error"] else one["state"]
        late = one["latency"]["p99"]
        counts = [one[key] for key in ("dropped", "overrun", "duplicates", "junk_bytes")]
        rows.append([
            f"  {one['peer']}" if one["peer"] else one["name"], state, *(f"{rate:.0f}" for rate in rates),
            "" if late is None else f"{late * 1e3:.2f}",
            *("" if count is None else str(count) for count in counts),
        ])  # fmt: skip
    return rows


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
