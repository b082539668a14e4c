"""Names and texts from logs in files of tables, as folders, and on terminals."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import mavwire
import pytest
from compat.tool_runs import Log
from dataflash_writer import FMT, fmt, record
from mavwire import cli
from mavwire._ftp.local import last_name, local_name
from mavwire._text import printable
from mavwire.dialects.v20 import all as mavlink
from mavwire.logs.conversion import convert

TEXTS = ["=1+1", "+a", "-cmd|' /C calc'!A0", "@SUM(A1)", "\tx", "-5", "ok", "a=1"]
SAFE = ["'=1+1", "'+a", "'-cmd|' /C calc'!A0", "'@SUM(A1)", "'\tx", "-5", "ok", "a=1"]


@pytest.fixture
def texts(tmp_path: Path) -> str:
    log = Log(tmp_path / "texts.tlog")
    for number, text in enumerate(TEXTS):
        log.add(float(number), mavlink.MAVLink_statustext_message(6, text.encode()))
    log.add(9, mavlink.MAVLink_sys_status_message(1, 1, 1, 1, 1, -1, -1, 0, 0, 0, 0, 0, 0))
    return str(log.done())


def cells(path: Path, column: str) -> list[str]:
    with path.open(newline="") as file:
        return [row[column] for row in csv.DictReader(file)]


def test_cells_of_converted_files_are_no_formulas(texts: str, tmp_path: Path) -> None:
    command = ["convert", texts, "--format", "csv", "--quiet"]
    for options, wanted in (([], SAFE), (["--no-csv-safe"], TEXTS)):
        out = tmp_path / str(len(options))
        assert cli.main([*command, "-o", str(out), *options]) == 0
        assert cells(out / "STATUSTEXT/texts.csv", "text") == wanted
        assert cells(out / "SYS_STATUS/texts.csv", "current_battery") == ["-1"]


def test_cells_of_a_written_table_are_no_formulas(texts: str, tmp_path: Path) -> None:
    table = mavwire.open_log(texts)["STATUSTEXT"]
    for options, wanted in (({}, SAFE), ({"csv_safe": False}, TEXTS)):
        table.write(tmp_path / "texts.csv", **options)
        assert cells(tmp_path / "texts.csv", "text") == wanted


def test_a_dump_guards_cells_where_that_is_wanted(texts: str, capsys: Any) -> None:
    command = ["dump", "--format", "csv", "--types", "STATUSTEXT", "--csv_sep", ";", texts]
    for options, wanted in (([], TEXTS), (["--csv-safe"], SAFE)):
        assert cli.main([*command, *options]) == 0
        lines = capsys.readouterr().out.splitlines()
        assert [line.split(";")[2] for line in lines[1:]] == wanted


def dataflash(path: Path, names: list[str]) -> Path:
    """A log with a record of each type."""
    content = FMT
    numbers = [n for n in range(1, 256) if n != 128]
    for number, name in zip(numbers, names, strict=False):
        content += fmt(number, name, "Q", "TimeUS") + record(number, "Q", 1_000_000)
    path.write_bytes(content)
    return path


def test_folders_are_no_devices(tmp_path: Path) -> None:
    log = dataflash(tmp_path / "a.BIN", ["NUL", "con", "COM1", "Lpt9", "AUX", "PRN", "COMX", "ATT"])
    (row,) = convert([log], tmp_path / "out")
    assert row.error is None
    folders = {Path(file).parts[0] for file in row.files} - {"FMT"}
    wanted = {"%4EUL", "%63on", "%43OM1", "%4Cpt9", "%41UX", "%50RN", "COMX", "ATT"}
    assert folders == wanted


def test_a_log_does_not_make_thousands_of_files(tmp_path: Path) -> None:
    names = [f"T{number:03X}" for number in range(1100)]
    ids = [1 + number % 120 for number in range(len(names))]
    described = (
        fmt(number, name, "Q", "TimeUS") + record(number, "Q", 1_000_000)
        for number, name in zip(ids, names, strict=True)
    )
    log = tmp_path / "a.BIN"
    log.write_bytes(FMT + b"".join(described))
    (row,) = convert([log], tmp_path / "out", format="csv")
    told = "more than 1000 message types, and each would become a file: choose some types"
    assert row.error == told
    assert not row.files
    assert not list((tmp_path / "out").rglob("*.csv"))
    (row,) = convert([log], tmp_path / "out", format="csv", types=names[:1050])
    assert (row.error, len(row.files)) == (None, 1050)


@pytest.mark.parametrize(
    ("remote", "local"),
    [
        ("/a/NUL", "%4EUL"), ("con.txt", "%63on.txt"), ("Com1 .bin", "%43om1 .bin"), ("COM", "COM"),
        ("lpt10", "lpt10"), ("console", "console"), ("a/aux.tar.gz", "%61ux.tar.gz"),
    ],
)  # fmt: skip
def test_downloads_are_no_devices(remote: str, local: str) -> None:
    assert local_name(remote) == local
    assert last_name(remote) == remote.rpartition("/")[2]


def test_texts_do_not_turn_their_direction_on_terminals() -> None:
    turned = "\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069\u200e\u200f\u061c"
    shown = printable(f"a{turned}b\tשלום é")
    assert shown == "a" + "".join(f"\\u{ord(one):04x}" for one in turned) + "b\tשלום é"
