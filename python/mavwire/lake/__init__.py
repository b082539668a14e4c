"""Lakes: many logs as one Delta Lake table for each message type.

    from mavwire import lake

    lake.ingest("logs/**/*.tlog", "flights")  # again, it adds only new and changed logs
    polars.scan_delta("flights/ATTITUDE")
    lake.tables("flights")  # the version of each table, in which every log is whole

Needs `pip install 'mavwire[lake]'`. `planning` says which logs are to do, `doing` makes files of a part
of them, `committing` makes these visible; `runners` do parts here, on processes, or on Dask.
"""

from .compacting import compact
from .ingesting import ingest
from .ledger import tables

__all__ = ["compact", "ingest", "tables"]
