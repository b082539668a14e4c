"""Reader of CSV files as logs, with the names and behaviour of pymavlink's CSVReader."""

import sys

from ._dataflash.csv_log import CSVFormat, CSVMessage, CSVReader
from ._hooks import IN_STANDARD_MODULE, ReplaceableModule, make_replaceable


class _CSVReader(ReplaceableModule):
    _users = ("mavwire._dataflash",)
    _not_called = {  # noqa: RUF012
        **dict.fromkeys(("csv", "os"), IN_STANDARD_MODULE),
        "mavutil": "replace the function in mavwire.mavutil itself",
    }


make_replaceable(sys.modules[__name__], _CSVReader)

__all__ = ["CSVFormat", "CSVMessage", "CSVReader"]
