"""Reading logs without the machinery of a link.

`open_log(path)` gives the messages of a log one after the other, and nothing else: no flight mode,
no parameters, no table of newest messages. That is what makes it fast. Programs that want those
read the log with `mavutil.mavlink_connection`.

`read(path)` and `log["ATTITUDE"]` give whole message types as tables of columns, `scan` gives them
in batches, `scan_polars` as a polars LazyFrame, and `convert` writes them to files.
"""

from .dataflash import DataflashLog
from .format_error import LogFormatError
from .query import Query
from .reading import read, scan
from .scanning import scan_polars
from .table import Table
from .telemetry import TelemetryLog, open_log
from .unknown import UnknownMessageWarning

__all__ = [
    "DataflashLog",
    "LogFormatError",
    "Query",
    "Table",
    "TelemetryLog",
    "UnknownMessageWarning",
    "open_log",
    "read",
    "scan",
    "scan_polars",
]
