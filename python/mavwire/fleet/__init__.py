"""Fleets of logs on Dask: any number of logs to files, on all processors of one or many machines.

    from mavwire import fleet

    fleet.to_parquet("logs/**/*.tlog", "out")            # a cluster on this machine
    fleet.to_parquet("s3://bucket/*.tlog", "s3://bucket/out", client)
    fleet.dask_frame("logs/*.tlog", "ATTITUDE", columns=["timestamp", "roll"])

Needs `distributed` (`pip install 'mavwire[fleet]'`), and pandas and pyarrow for `dask_frame`.
"""

from typing import TYPE_CHECKING

from mavwire import _lazy

if TYPE_CHECKING:
    from .decoding import decode
    from .frames import dask_frame
    from .running import convert, to_parquet

__all__ = ["convert", "dask_frame", "decode", "to_parquet"]
# Processes of workers use this package and start no cluster.
__getattr__ = _lazy.attributes(
    __name__,
    {"convert": "running", "dask_frame": "frames", "decode": "decoding", "to_parquet": "running"},
)
