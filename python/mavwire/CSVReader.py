"""Reader of CSV files as logs, with the names and behaviour of pymavlink's CSVReader."""

from __future__ import annotations

from ._dataflash.csv_log import CSVFormat, CSVMessage, CSVReader

__all__ = ["CSVFormat", "CSVMessage", "CSVReader"]
