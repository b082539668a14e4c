"""A filter of `scan_polars` that keeps 1% of the rows, beside the same filter on the whole frame.

The logs are the messages of one type of the flight that the other rows read, over and over. Both ways work in turns, in
one process; the ratio is the median of the ratios of their CPU times. Their frames must be equal.
"""

from __future__ import annotations

from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from time import process_time
from typing import Any

import corpus
import mavwire
import polars as pl
from polars.testing import assert_frame_equal

LOG_BYTES = 40_000_000
RUNS = 7
TYPES = {
    "RC_CHANNELS": "chan1_raw",
    "SYS_STATUS": "current_battery",
    "BATTERY_STATUS": "current_battery",
}
"""Message types, and the field that is filtered by."""
WAYS: dict[str, dict[str, Any]] = {
    "as sent": {},
    "SI": {"units": "si"},
    "SI and names": {"units": "si", "enums": "names"},
}


def log_of(path: Path, flight: str, name: str) -> None:
    """A log of one type, its times from 2020 on."""
    frames = [bytes(msg.get_msgbuf()) for msg in mavwire.open_log(flight).messages(name)]
    size = sum(map(len, frames)) + 8 * len(frames)
    with path.open("wb") as file:
        for number in range(LOG_BYTES // size * len(frames)):
            time = 1_577_836_800_000_000 + number * 1000
            file.write(time.to_bytes(8, "big") + frames[number % len(frames)])


def ratio(lazy: Any, field: str) -> float:
    """How many times as fast the pushed filter is."""
    values = lazy.select(field).collect().to_series()
    chosen = pl.col(field) > values.quantile(0.99)
    ratios = []
    for _ in range(RUNS):
        start = process_time()
        pushed = lazy.filter(chosen).collect()
        middle = process_time()
        whole = lazy.collect().filter(chosen)
        ratios.append((process_time() - middle) / (middle - start))
        assert_frame_equal(pushed, whole, check_exact=True)
        assert 0.005 < len(whole) / len(values) < 0.015
    return median(ratios)


def main() -> None:
    flight = corpus.prepare(50_000, "mavwire").tlog
    with TemporaryDirectory() as folder:
        path = Path(folder) / "log.tlog"
        for name, field in TYPES.items():
            log_of(path, flight, name)
            cells = []
            for title, how in WAYS.items():
                lazy = mavwire.scan_polars(path, name, **how)
                cells.append(f"{title} {ratio(lazy, field):.1f}x")
            columns = len(lazy.collect_schema())
            print(f"{name} ({columns} columns): {', '.join(cells)}")


if __name__ == "__main__":
    main()
