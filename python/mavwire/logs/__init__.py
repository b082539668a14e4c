"""Reading telemetry logs without the machinery of a link.

`open_log(path)` gives the messages of a log one after the other, and nothing else: no flight mode,
no parameters, no table of newest messages. That is what makes it fast. Programs that want those
read the log with `mavutil.mavlink_connection`.
"""

from __future__ import annotations

from .telemetry import LogFormatError, TelemetryLog, open_log

__all__ = ["LogFormatError", "TelemetryLog", "open_log"]
