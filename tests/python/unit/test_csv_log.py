"""CSV files as logs: what is no row costs that row, and no memory."""

from __future__ import annotations

import tracemalloc
from pathlib import Path

import pytest
from mavwire._dataflash.csv_log import MAX_ROW
from mavwire.CSVReader import CSVReader


def rows(path: Path) -> list[list[object]]:
    with CSVReader(str(path)) as log:
        return [msg.line for msg in iter(log.recv_msg, None)]


@pytest.mark.parametrize(
    "endless",
    ["x" * (3 * MAX_ROW), ";" * (MAX_ROW + 1), '"\n' + '";"\n' * (MAX_ROW // 4 + 9)],
    ids=["letters", "cells", "quotes"],
)
def test_a_row_without_end_is_left_out(tmp_path: Path, endless: str) -> None:
    """R67."""
    path = tmp_path / "long.csv"
    path.write_text(f"t;x\n1;2\n{endless}\n3;4\n")
    found = rows(path)
    assert found[0] == [1.0, 2.0]
    assert found[-1] == [3.0, 4.0]
    assert all(len(row) < MAX_ROW for row in found)


def test_the_longest_row_is_read(tmp_path: Path) -> None:
    path = tmp_path / "row.csv"
    cells = ";".join(["7"] * (MAX_ROW // 2))
    path.write_text(f"t;x\n{cells}\n1;2\n")
    assert [len(row) for row in rows(path)] == [MAX_ROW // 2, 2]


def test_a_file_of_one_line_takes_no_memory(tmp_path: Path) -> None:
    path = tmp_path / "sparse.csv"
    with path.open("wb") as file:
        file.write(b"t;x\n1;2\n")
        file.truncate(40 * MAX_ROW)
    tracemalloc.start()
    try:
        assert rows(path) == [[1.0, 2.0]]
        assert tracemalloc.get_traced_memory()[1] < 15 * MAX_ROW
    finally:
        tracemalloc.stop()
    with path.open("wb") as file:
        file.truncate(2 * MAX_ROW)
    with pytest.raises(ValueError, match="no headings"):
        CSVReader(str(path))
