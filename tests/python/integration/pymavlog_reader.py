"""Logs read by pymavlog, which reads them through pymavlink; prints what it found as JSON.

python pymavlog_reader.py LOG...
"""

from __future__ import annotations

import json
import sys
from typing import Any

from pymavlog import MavLog, MavTLog


def columns(series: Any) -> dict[str, list[str]]:
    """The values of each column, as text: NaN equals itself then."""
    return {name: [str(value) for value in values] for name, values in series.raw_fields.items()}


def found(path: str) -> dict[str, Any]:
    """Everything that pymavlog tells of a log."""
    log = MavTLog(path) if path.endswith(".tlog") else MavLog(path)
    log.parse()
    return {
        "count": log.message_count,
        "between": [str(log.start_timestamp), str(log.end_timestamp)],
        "types": sorted(log.types),
        "messages": {name: columns(log.get(name)) for name in sorted(log.types) if log.get(name)},
    }


if __name__ == "__main__":
    print(json.dumps({path: found(path) for path in sys.argv[1:]}))
