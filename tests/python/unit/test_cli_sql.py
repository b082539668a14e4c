"""`mavwire sql`: questions to logs, answered by DuckDB."""

from __future__ import annotations

import csv
import json
import shutil
from pathlib import Path

import pytest
from dataflash_writer import FMT, fmt, record
from mavwire import cli
from mavwire.dialects.v20 import common

pytest.importorskip("duckdb")
pytest.importorskip("pyarrow")

Capture = pytest.CaptureFixture[str]


@pytest.fixture
def logs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Two telemetry logs with the altitudes 0, 1, 2 and 100, 101, 102, and heartbeats."""
    monkeypatch.chdir(tmp_path)
    mav = common.MAVLink(None, 1, 1)
    for name, first in (("low.tlog", 0), ("high.tlog", 100)):
        with open(name, "wb") as file:
            for number in range(3):
                hud = common.MAVLink_vfr_hud_message(0, 0, 0, 0, first + number, 0)
                beat = common.MAVLink_heartbeat_message(2, 3, 0, 0, 4, 3)
                for message in (hud, beat):
                    file.write((10**15 + number).to_bytes(8, "big") + message.pack(mav))
    return ["low.tlog", "high.tlog"]


def ask(capsys: Capture, *arguments: str, code: int = 0) -> list[list[str]]:
    """The rows of an answer."""
    assert cli.main(["sql", *arguments]) == code
    return list(csv.reader(capsys.readouterr().out.splitlines()))


def test_types_are_tables_of_all_logs(capsys: Capture, logs: list[str]) -> None:
    query = "select log, max(alt) as highest from vfr_hud group by log order by log;"
    answer = [["log", "highest"], ["high.tlog", "102.0"], ["low.tlog", "2.0"]]
    assert ask(capsys, query, *logs) == answer
    assert ask(capsys, query.replace("vfr_hud", '"*.tlog".VFR_HUD')) == answer


def test_two_tables_and_the_same_one_twice(capsys: Capture, logs: list[str]) -> None:
    query = """
        with pairs as (
            select a.alt from VFR_HUD a join HEARTBEAT using (log, timestamp)
            where a.alt > (select avg(alt) from VFR_HUD))
        select count(*) from pairs
    """
    assert ask(capsys, query, *logs)[1:] == [["3"]]


def test_values_by_name_and_lines_of_json(capsys: Capture, logs: list[str]) -> None:
    query = "select distinct type, system_status from heartbeat"
    assert cli.main(["sql", query, "low.tlog", "--enums", "names", "--format", "jsonl"]) == 0
    row = json.loads(capsys.readouterr().out)
    assert row == {"type": "MAV_TYPE_QUADROTOR", "system_status": "MAV_STATE_ACTIVE"}


@pytest.mark.parametrize("suffix", [".parquet", ".csv", ".jsonl"])
def test_an_answer_goes_to_a_file(capsys: Capture, logs: list[str], suffix: str) -> None:
    out = f"the crew's answer{suffix}"
    assert cli.main(["sql", "select alt from VFR_HUD", *logs, "-o", out]) == 0
    sql_name = out.replace("'", "''")
    assert ask(capsys, f"select sum(alt) from '{sql_name}'")[1:] == [["306.0"]]


def test_logs_of_a_type_may_have_other_columns(capsys: Capture, tmp_path: Path) -> None:
    for name, form, columns, values in (
        ("old.bin", "Qi", "TimeUS,A", (1, 2)),
        ("new.bin", "Qii", "TimeUS,A,B", (3, 4, 5)),
    ):
        data = FMT + fmt(150, "ABC", form, columns) + record(150, form, *values)
        (tmp_path / name).write_bytes(data)
    paths = [str(tmp_path / name) for name in ("old.bin", "new.bin")]
    assert ask(capsys, "select A, B from abc order by A", *paths)[1:] == [["2", ""], ["4", "5"]]


@pytest.mark.parametrize(
    ("query", "message"),
    [
        (
            "select * from ATITUDE",
            "did you mean 'ATTITUDE'?\nmavwire sql: error: ATITUDE could be read from none of the logs",
        ),
        ("selec 1", 'syntax error at or near "selec"'),
        ("select height from VFR_HUD", 'Referenced column "height" not found'),
        ("select 1; select 2", "one SELECT at a time"),
        ("drop table VFR_HUD", "Only SELECT statements"),
    ],
)
def test_errors_say_what_is_wrong(
    capsys: Capture, logs: list[str], query: str, message: str
) -> None:
    assert cli.main(["sql", query, "low.tlog"]) == 1
    assert message in capsys.readouterr().err


def test_a_log_that_cannot_be_read_is_left_out(capsys: Capture, logs: list[str]) -> None:
    shutil.copy(__file__, "text.tlog")
    assert cli.main(["sql", "select count(*) from VFR_HUD", "gone.tlog", "text.tlog", *logs]) == 1
    out, err = capsys.readouterr()
    assert out.endswith("\n6\n")
    assert [line.split(":")[1] for line in err.splitlines()] == [" gone.tlog", " text.tlog"]


def test_a_query_without_logs(capsys: Capture) -> None:
    assert ask(capsys, "select 1 + 1 as two") == [["two"], ["2"]]
    assert cli.main(["sql", "select * from VFR_HUD"]) == 1
    assert "name logs behind the query" in capsys.readouterr().err
    assert cli.main(["sql", "select 1", "-o", "answer.txt"]) == 1
    assert "must end in .parquet, .csv, .jsonl" in capsys.readouterr().err
