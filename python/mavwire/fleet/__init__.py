"""Fleets of logs on Dask: any number of logs to files, on all processors of one or many machines.

    from mavwire import fleet

    fleet.to_parquet("logs/**/*.tlog", "out")            # a cluster on this machine
    fleet.to_parquet("s3://bucket/*.tlog", "s3://bucket/out", client)
    fleet.dask_frame("logs/*.tlog", "ATTITUDE", columns=["timestamp", "roll"])

Needs `distributed` (`pip install 'mavwire[fleet]'`), and pandas and pyarrow for `dask_frame`.
"""

from __future__ import annotations

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from .decoding import decode
    from .frames import dask_frame
    from .running import convert, to_parquet

__all__ = ["convert", "dask_frame", "decode", "to_parquet"]
_MODULES = {
    "convert": "running",
    "dask_frame": "frames",
    "decode": "decoding",
    "to_parquet": "running",
}


def __getattr__(name: str) -> Any:
    """Runs on a cluster are imported when they are used: lakes need less of this package."""
    if name not in _MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib import import_module

    value = getattr(import_module(f"{__name__}.{_MODULES[name]}"), name)
    globals()[name] = value
    return value
