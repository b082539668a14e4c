"""A bridge as a configuration file describes it."""

from __future__ import annotations

from dataclasses import dataclass, field

from mavwire.dialects import UPSTREAM

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from .options import Endpoint, Recording
    from .sidecars import Listen, SinkOptions


@dataclass
class Config:
    """A bridge as a file describes it. `warnings` are lines about what has no effect here."""

    links: list[tuple[str, Endpoint, dict[str, Any]]] = field(default_factory=list)
    """Place in the file, endpoint, options."""
    settings: dict[str, Any] = field(default_factory=dict)
    recording: Recording | None = None
    dialect: Any = UPSTREAM
    """A dialect, or a list of several."""
    json: float | None = None
    """Seconds between two lines of counters that `mavwire bridge` prints."""
    http: Listen | None = None
    metrics: Listen | None = None
    sinks: list[SinkOptions] = field(default_factory=list)
    path: str = ""
    warnings: list[str] = field(default_factory=list)
