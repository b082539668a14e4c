"""What `mavwire convert` is asked for beside logs and a format, in Python and on the command line."""

from __future__ import annotations

import errno
import gzip
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import mavwire
import polars as pl
import pytest
from dataflash_writer import sample
from mavwire import cli, traffic
from mavwire.dialects import load
from mavwire.logs import reading
from mavwire.logs.conversion import convert
from mavwire.logs.selection import HEADER


@pytest.fixture(scope="module")
def flight(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("logs") / "flight.tlog"
    traffic.generate(path, 1_000)
    return path


def lines(path: Path) -> list[dict[str, Any]]:
    return [json.loads(line) for line in path.read_text().splitlines()]


def test_fields_units_and_names(flight, tmp_path):
    out = tmp_path / "out"
    command = ["convert", str(flight), "-o", str(out), "--format", "jsonl", "--quiet"]
    readable = ["--fields", "lat,alt,type", "--units", "si", "--enums", "names"]
    assert cli.main([*command, *readable, "--types", "GLOBAL_POSITION_INT,HEARTBEAT"]) == 0
    how = {"units": "si", "enums": "names"}
    tables = mavwire.read(flight, ["GLOBAL_POSITION_INT", "HEARTBEAT"], **how)
    for name, fields in (("GLOBAL_POSITION_INT", ["lat", "alt"]), ("HEARTBEAT", ["type"])):
        found = lines(out / name / "flight.jsonl")
        assert set(found[0]) == {"timestamp", "sysid", "compid", "seq", *fields}
        for field in fields:
            assert [one[field] for one in found] == tables[name][field].tolist()


def test_the_order_of_types_makes_no_other_options(flight, tmp_path):
    for n, types in enumerate([["HEARTBEAT", "ATTITUDE"], ["ATTITUDE", "HEARTBEAT"]] * 2):
        (row,) = convert([flight], tmp_path, types=types, systems=[2, 1][:: 1 if n % 2 else -1])
        assert row.error is None and row.skipped == (n > 0)


def test_files_of_another_output_are_made_anew(flight, tmp_path, monkeypatch):
    from mavwire.logs import conversion

    convert([flight], tmp_path, types="HEARTBEAT")
    monkeypatch.setattr(conversion, "OUTPUT", conversion.OUTPUT + 1)
    assert not convert([flight], tmp_path, types="HEARTBEAT")[0].skipped


@pytest.mark.parametrize(
    ("said", "instead", "same"),
    [
        ('units="m"', 'units="m"', True),
        ('units="m"', 'units="cm"', False),
        ('name="far"', 'name="near"', False),
        ('enum="COLOUR" ', "", False),
        ("uint16_t", "int16_t", False),
        ('invalid="RED"', 'invalid="1"', False),
        ('value="1"', 'value="2"', False),
    ],
)
def test_other_definitions_under_the_same_name_are_other_options(
    flight: Path, tmp_path: Path, said: str, instead: str, same: bool
) -> None:
    text = """<mavlink><enums><enum name="COLOUR"><entry value="1" name="RED"/></enum></enums>
    <messages><message id="200" name="SIGHT">
    <field type="uint16_t" name="far" enum="COLOUR" units="m" invalid="RED">-</field>
    </message></messages></mavlink>"""
    xml = tmp_path / "sights.xml"
    skipped = []
    for definitions in (text, text.replace(said, instead)):
        xml.write_text(definitions)
        [row] = convert([flight], tmp_path / "out", dialect=load(xml), invalid="null")
        assert row.error is None
        skipped.append(row.skipped)
    assert skipped == [False, same]


def test_a_file_that_was_emptied_is_made_anew(flight, tmp_path):
    (row,) = convert([flight], tmp_path, types="HEARTBEAT")
    (name,) = row.files
    content = (tmp_path / name).read_bytes()
    (tmp_path / name).write_bytes(b"")
    assert not convert([flight], tmp_path, types="HEARTBEAT")[0].skipped
    assert (tmp_path / name).read_bytes() == content


@pytest.mark.parametrize("nothing", ["", ",", " , "])
@pytest.mark.parametrize(
    ("command", "option"),
    [("convert", "--types"), ("convert", "--fields"), ("convert", "--systems"),
     ("cut", "--types"), ("cut", "--systems")],
)  # fmt: skip
def test_an_option_that_names_nothing(flight, tmp_path, capsys, command, option, nothing):
    out = tmp_path / "out"
    assert cli.main([command, str(flight), "-o", str(out), option, nothing]) == 1
    assert f"{option} names nothing" in capsys.readouterr().err
    assert not out.exists()


@pytest.mark.parametrize("form", ["parquet", "csv"])
def test_fields_come_in_the_order_in_which_they_are_wanted(flight, tmp_path, form):
    onboard = sample().write(tmp_path / "onboard.BIN")
    wanted = ["Raw", "AccX", "vx", "lon", "lat"]
    convert([flight, onboard], tmp_path / "out", fields=wanted, format=form)
    for path, name, fields in (
        (flight, "GLOBAL_POSITION_INT", ["vx", "lon", "lat"]),
        (onboard, "IMU", ["Raw", "AccX"]),
    ):
        (file,) = (tmp_path / "out" / name).iterdir()
        found = pl.read_parquet(file) if form == "parquet" else pl.read_csv(file)
        table = mavwire.read(path, name, fields=fields)[name]
        assert [one for one in found.columns if one not in HEADER] == fields
        assert table.columns == found.columns
        assert found[fields[0]].to_list() == table[fields[0]].tolist()


def test_fields_are_those_of_any_log(flight, tmp_path):
    onboard = sample().write(tmp_path / "flight.BIN")
    for logs in ([flight, onboard], [onboard, flight], [onboard]):
        rows = convert(logs, tmp_path / "out", fields="AccX")
        assert [row.error for row in rows] == [None] * len(logs)
        for wrong in (["AccX", "nope"], iter(["nope"])):
            with pytest.raises(ValueError, match="has a field 'nope'"):
                convert(logs, tmp_path / "out", fields=wrong)
    with pytest.raises(ValueError, match="no wanted type has a field 'Rol'"):
        convert(onboard, tmp_path / "out", types="IMU", fields="Rol")
    [row] = convert(flight, tmp_path / "out", types="IMU", fields="AccX")
    assert row.error is not None and "IMU" in row.error, "the type is what it lacks"


def test_fields_of_a_log_that_cannot_be_read_are_not_refused(flight, tmp_path):
    onboard = sample().write(tmp_path / "flight.BIN")
    for missing in (tmp_path / "none.BIN", tmp_path):
        for logs in ([missing], [missing, onboard], [flight, missing]):
            rows = convert(logs, tmp_path / "out", fields="AccX")
            assert [row.error is None for row in rows] == [log != missing for log in logs]


def test_no_more_logs_than_a_bound_are_looked_at_for_fields(flight, tmp_path, monkeypatch):
    monkeypatch.setattr(reading, "LOOKED_AT", 2)
    logs = [flight]
    for n in range(2):
        logs.append(tmp_path / f"{n}.tlog")
        logs[-1].write_bytes(flight.read_bytes())
    assert all(row.error is None for row in convert(logs, tmp_path / "out", fields="nope"))
    with pytest.raises(ValueError, match="has a field 'nope'"):
        convert(logs[:2], tmp_path / "few", fields="nope")


def test_fields_are_those_of_the_wanted_types(flight, tmp_path):
    onboard = sample().write(tmp_path / "flight.BIN")
    with pytest.raises(ValueError, match="no wanted message has a field 'AccX'"):
        convert([onboard, flight], tmp_path / "out", types="HEARTBEAT", fields="AccX")


@pytest.mark.parametrize("format", ["parquet", "mcap"])
def test_a_type_that_no_dataflash_log_describes_is_named(tmp_path, capsys, format):
    log = tmp_path / "flight.BIN"
    sample().write(log)
    options = ["-o", str(tmp_path / "out"), "--format", format, "--quiet"]
    assert cli.main(["convert", str(log), *options, "--types", "IMU,NOPE"]) == 1
    said = "mavwire convert: the log describes no record type 'NOPE'\n"
    assert capsys.readouterr().err == said
    assert cli.main(["convert", str(log), *options, "--types", "IMU"]) == 0
    assert capsys.readouterr().err == ""


def test_other_units_and_names_are_other_options(flight, tmp_path):
    options: list[dict[str, Any]] = [{}, {"units": "si"}, {"enums": "names"}, {"fields": "type"}]
    for how in options:
        how["types"] = "HEARTBEAT"
        assert [convert([flight], tmp_path, **how)[0].skipped for _ in range(2)] == [False, True]


def test_names_are_plain_texts_in_an_arrow_file(flight, tmp_path):
    pa = pytest.importorskip("pyarrow")
    (row,) = convert([flight], tmp_path, format="arrow", enums="names")
    assert row.error is None
    table = mavwire.read(flight, enums="names")["HEARTBEAT"]
    with pa.OSFile(str(tmp_path / "HEARTBEAT" / "flight.arrow")) as file:
        found = pa.ipc.open_file(file).read_all()
    for name in ("type", "base_mode"):
        assert found.schema.field(name).type == pa.string()
        assert found[name].to_pylist() == table[name].tolist()


@pytest.mark.parametrize("how", [{"units": "si"}, {"enums": "names"}])
def test_mcap_has_values_as_they_are_sent(flight, tmp_path, how):
    with pytest.raises(ValueError, match="leave units and enums out"):
        convert([flight], tmp_path / "out", format="mcap", **how)
    option = [text for name, value in how.items() for text in (f"--{name}", value)]
    argv = ["convert", str(flight), "-o", str(tmp_path / "out"), "--format", "mcap", *option]
    assert cli.main(argv) == 1
    assert not (tmp_path / "out").exists()


def test_mcap_of_some_fields(flight, tmp_path):
    (row,) = convert([flight], tmp_path, format="mcap", types="HEARTBEAT", fields="type")
    assert row.error is None and row.rows


def test_wrong_fields_are_named_and_those_of_a_dataflash_log_are_not_the_dialects(flight, tmp_path):
    with pytest.raises(ValueError, match="'rol'"):
        convert([flight], tmp_path / "out", fields="rol")
    assert not (tmp_path / "out").exists()
    onboard = sample().write(tmp_path / "flight.BIN")
    (row,) = convert([onboard], tmp_path / "out", format="jsonl", fields="AccX")
    assert row.error is None
    assert set(lines(tmp_path / "out" / "IMU" / "flight.jsonl")[0]) == {"timestamp", "AccX"}


def test_a_name_that_is_not_utf8(flight, tmp_path):
    log = os.fsdecode(os.fsencode(tmp_path) + b"/bad\xff.tlog")
    try:
        shutil.copy(flight, log)
    except OSError:
        pytest.skip("names are UTF-8 here")
    out = tmp_path / "out"
    words = ["convert", log, "-o", str(out), "--types", "HEARTBEAT"]
    command = [sys.executable, "-m", "mavwire"]
    strict = {**os.environ, "PYTHONIOENCODING": "utf-8:strict"}
    for done in ("converted,", "converted before,"):
        ran = subprocess.run([*command, *words], env=strict, capture_output=True, check=False)
        assert (ran.returncode, ran.stderr) == (0, b"")
        assert ran.stdout.startswith(os.fsencode(log) + b": " + done.encode())
    assert (out / "HEARTBEAT" / "bad%FF.parquet").is_file()
    (row,) = json.loads((out / "manifest.json").read_text())["logs"]
    assert (row["path"], row["name"]) == (log, "bad%FF")
    info = subprocess.run([*command, "info", log], env=strict, capture_output=True, check=False)
    assert info.stdout.startswith(os.fsencode(log)) and not info.stderr


@pytest.mark.parametrize("name", [".tlog", "..tlog", "...tlog", ".BIN.gz"])
def test_a_name_of_dots_and_a_suffix(flight, tmp_path, name):
    log, out = tmp_path / name, tmp_path / "out"
    log.write_bytes(
        gzip.compress(flight.read_bytes()) if name.endswith(".gz") else flight.read_bytes()
    )
    (row,) = convert([log], out, types="HEARTBEAT")
    assert row.name == "log" and row.files == {"HEARTBEAT/log.parquet": row.rows}
    assert convert([log], out, types="HEARTBEAT")[0].skipped, "the manifest is one for the next run"


@pytest.mark.parametrize(
    ("log", "out", "said"),
    [
        ("", "out", "a log has an empty name"),
        ("flight.tlog", "", "the folder for the files has an empty name"),
        ("flight.tlog", "file", "file: Not a directory"),
        ("flight.tlog", "leads-nowhere", "leads-nowhere: Not a directory"),
    ],
)
def test_names_that_lead_nowhere(flight, tmp_path, monkeypatch, capsys, log, out, said):
    monkeypatch.chdir(tmp_path)
    shutil.copy(flight, "flight.tlog")
    Path("file").write_text("")
    os.symlink("nowhere", "leads-nowhere")
    assert cli.main(["convert", log, "-o", out]) == 1
    assert capsys.readouterr() == ("", f"mavwire convert: error: {said}\n")
    assert not os.path.lexists("nowhere") and not os.path.lexists("out")


def test_a_compressed_log_that_is_cut_off_is_converted_once(flight, tmp_path, capsys):
    log, out = tmp_path / "cut.tlog.gz", tmp_path / "out"
    log.write_bytes(gzip.compress(flight.read_bytes())[:-2000])
    command = ["convert", str(log), "-o", str(out)]
    assert cli.main(command) == 1
    said = capsys.readouterr().err
    assert "cut.tlog.gz: " in said
    written = {path: path.stat().st_mtime_ns for path in out.glob("*/*")}
    assert written
    assert cli.main(command) == 0
    again = capsys.readouterr()
    assert again.err == said and "converted before" in again.out
    assert {path: path.stat().st_mtime_ns for path in out.glob("*/*")} == written
    log.write_bytes(gzip.compress(flight.read_bytes()))
    assert cli.main(command) == 0
    assert capsys.readouterr().err == ""


def test_info_of_a_raw_stream_says_which_times_it_has(flight, tmp_path, capsys):
    raw = tmp_path / "s.raw"
    messages = list(mavwire.open_log(flight))
    raw.write_bytes(b"".join(msg.get_msgbuf() for msg in messages))
    assert cli.main(["info", str(raw)]) == 0
    assert "time     0.100 to 9.400 s since start, 9.3 s" in capsys.readouterr().out
    clockless = [msg.get_msgbuf() for msg in messages if not hasattr(msg, "time_boot_ms")]
    raw.write_bytes(b"".join(clockless))
    assert cli.main(["info", str(raw)]) == 0
    assert "time     none, a log without times" in capsys.readouterr().out


def test_a_pattern_names_the_logs_that_match(flight, tmp_path, capsys):
    """A file whose name looks like a pattern is itself, and a pattern without a match is missing."""
    logs = [str(tmp_path / "in" / name) for name in ("b.tlog", "a.tlog", "odd[1].tlog")]
    (tmp_path / "in").mkdir()
    for log in logs:
        shutil.copy(flight, log)
    pattern, gone = str(tmp_path / "in" / "?.tlog"), str(tmp_path / "in" / "none*.tlog")
    assert [row.path for row in convert(pattern, tmp_path / "1")] == [logs[1], logs[0]]
    assert [row.path for row in convert(logs[2], tmp_path / "2")] == [logs[2]]
    rows = sum(map(len, mavwire.scan(flight, "ATTITUDE")))
    assert sum(map(len, mavwire.scan(pattern, "ATTITUDE"))) == 2 * rows
    assert cli.main(["convert", pattern, gone, "-o", str(tmp_path / "3"), "--quiet"]) == 1
    said = capsys.readouterr().err
    assert said == f"mavwire convert: {gone}: {os.strerror(errno.ENOENT)}\n"
