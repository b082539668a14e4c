"""The table of `mavwire bridge --status`."""

from __future__ import annotations

from mavwire.cli._errors import CommandError

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from mavwire.bridge import Bridge


class StatusTable:
    """Links and components with their rates since the last look; call it to bring it up to date."""

    def __init__(self, bridge: Bridge) -> None:
        try:
            from rich.live import Live
        except ImportError:
            raise CommandError("--status needs rich: pip install 'mavwire[cli]'") from None
        self._bridge = bridge
        self._before: dict[str, Any] = {"uptime": 0.0, "links": [], "components": []}
        self._live = Live(self._tables(bridge.stats()), auto_refresh=False, transient=False)
        self._live.start()

    def __call__(self) -> None:
        self._live.update(self._tables(self._bridge.stats()), refresh=True)

    def close(self) -> None:
        """Leave the table as it is."""
        self._live.stop()

    def _tables(self, stats: dict[str, Any]) -> Any:
        from rich.console import Group
        from rich.table import Column, Table

        names = [Column(name, overflow="fold") for name in ("link", "peer", "state")]
        counts = ("in/s", "out/s", "p99 ms", "dropped", "overrun", "duplicates", "junk bytes")
        links = Table(*names, *(Column(name, justify="right", overflow="fold") for name in counts))
        components = Table("system", "component", "in/s", "lost", "duplicates", "age", "links")
        for row in link_rows(stats, self._before):
            links.add_row(*row)
        for row in component_rows(stats, self._before):
            components.add_row(*row)
        self._before = stats
        return Group(links, components)


def link_rows(stats: dict[str, Any], before: dict[str, Any]) -> list[list[str]]:
    """A row for each link, with rates since `before`."""
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
            one["name"], one["peer"] or "", state, *(f"{rate:.0f}" for rate in rates),
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
