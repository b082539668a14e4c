"""`mavwire dump --format mat`: MATLAB files, read here by SciPy."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from dataflash_writer import sample
from mavwire import cli, traffic
from mavwire.cli.logs import _dump_mat
from mavwire.dialects.v20 import ardupilotmega as mavlink
from unit.link_tools import record

scipy_io = pytest.importorskip("scipy.io")


def read(path: Path) -> dict[str, dict[str, Any]]:
    """The structures of a file: texts as a list of lines, numbers as a list of rows, cells as lists."""
    found = scipy_io.loadmat(path)
    return {
        name: {field: plain(table[field][0, 0]) for field in table.dtype.names}
        for name, table in found.items()
        if not name.startswith("__")
    }


def plain(array: Any) -> Any:
    return [plain(one) for one in array.flat] if array.dtype == object else array.tolist()


def written(messages: list[dict[str, Any]], path: Path) -> dict[str, Any]:
    """The file of messages of type A with these values."""
    args = SimpleNamespace(mat_file=str(path), log="none", compress=False)
    with _dump_mat.mat_file(args) as tables:
        for one in messages:
            tables.add(SimpleNamespace(to_dict=lambda one=one: {"mavpackettype": "A", **one}))
    return read(path)


@pytest.mark.parametrize("options", [(), ("-c",)])
def test_telemetry(options: tuple[str, ...], tmp_path: Path) -> None:
    log, mat = tmp_path / "log.tlog", tmp_path / "log.mat"
    sender = mavlink.MAVLink(None)
    messages = [
        mavlink.MAVLink_attitude_message(1, 0.5, -0.5, 0, 0, 0, 0),
        mavlink.MAVLink_statustext_message(6, b"short"),
        mavlink.MAVLink_attitude_message(2, 1.5, -0.5, 0, 0, 0, 0),
        mavlink.MAVLink_statustext_message(4, b"a longer one"),
        mavlink.MAVLink_gps_status_message(2, [1] * 20, [2] * 20, [3] * 20, [4] * 20, [5] * 20),
    ]
    frames = (msg.pack(sender) for msg in messages)
    log.write_bytes(b"".join(record(frame, 1_600_000_000_000_000) for frame in frames))
    assert cli.main(["dump", "--format", "mat", "--mat_file", str(mat), *options, str(log)]) == 0
    found = read(mat)
    assert list(found) == ["ATTITUDE", "STATUSTEXT", "GPS_STATUS"]
    assert found["ATTITUDE"]["time_boot_ms"] == [[1, 2]]
    assert found["ATTITUDE"]["roll"] == [[0.5, 1.5]]
    assert found["STATUSTEXT"]["text"] == ["short       ", "a longer one"]
    assert found["GPS_STATUS"]["satellite_used"] == [[2] * 20]


def test_dataflash(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    log, mat = tmp_path / "log.bin", tmp_path / "log.mat"
    sample().write(log)
    assert cli.main(["dump", "--format", "mat", "--mat_file", str(mat), str(log)]) == 0
    assert capsys.readouterr().out == ""
    found = read(mat)
    assert "FMT" not in found and "PARM" in found
    assert len(found["PARM"]["Name"]) == len(found["PARM"]["Value"][0]) > 1


def test_values_of_every_kind(tmp_path: Path) -> None:
    rows: list[dict[str, Any]] = [
        {"big": 1 << 63, "huge": 1, "mixed": 1, "raw": b"ab", "rows": [1, 2.5], "ragged": [1],
         "odd": "x", "names": ["a", "b"], "wide": "\U0001f600x"},
        {"big": 0, "huge": -1 << 80, "mixed": 0.5, "raw": b"cd", "rows": [3, 4], "ragged": [2, 3],
         "odd": 1, "names": ["c", "d"], "wide": "yz\udcff"},
    ]  # fmt: skip
    table = written(rows, tmp_path / "a.mat")["A"]
    assert table["big"] == [[1 << 63, 0]]
    assert table["huge"] == [[1.0, -float(1 << 80)]]
    assert table["mixed"] == [[1.0, 0.5]]
    assert table["raw"] == [[97, 98], [99, 100]]
    assert table["rows"] == [[1.0, 2.5], [3.0, 4.0]]
    assert table["ragged"] == [[[1]], [[2, 3]]]
    assert table["odd"] == [["x"], [[1]]]
    assert table["names"] == [["a", "b"], ["c", "d"]]
    assert table["wide"] == ["\U0001f600x ", "yz?"]


def test_names_that_matlab_cannot_use(tmp_path: Path) -> None:
    found = written([{"_a b": 1, "x_a b": 2, "1": 3}, {"n" * 80: 1, "n" * 90: 2}], tmp_path / "m")
    assert found["A"] == {
        "x_a_b": [[1]],
        "x_a_b_2": [[2]],
        "x1": [[3]],
    }
    assert list(found["A_2"]) == ["n" * 63, "n" * 57 + "_2"]


@pytest.mark.parametrize("options", ["--condition ATTITUDE.nothing", "--mat_file LOG"])
def test_what_was_there_stays_after_a_failure(
    options: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log, mat = tmp_path / "log.tlog", tmp_path / "log.mat"
    traffic.generate(log, 50)
    before = log.read_bytes()
    mat.write_bytes(b"precious")
    arguments = options.replace("LOG", str(log)).split()
    assert cli.main(["dump", "--format", "mat", "--mat_file", str(mat), *arguments, str(log)]) == 1
    assert capsys.readouterr().err.startswith("mavwire dump: error: ")
    assert (mat.read_bytes(), log.read_bytes()) == (b"precious", before)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["log.mat", "log.tlog"]


def test_a_disk_that_is_full(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    if not Path("/dev/full").exists():
        pytest.skip("there is no /dev/full here")
    log = tmp_path / "log.tlog"
    traffic.generate(log, 50)
    assert cli.main(["dump", "--format", "mat", "--mat_file", "/dev/full", str(log)]) == 1
    assert "--mat_file /dev/full: No space left" in capsys.readouterr().err


def test_scripts_hold_no_types_and_parameters_of_dataflash_logs(tmp_path: Path) -> None:
    """As mavtomfile.py's."""
    log = tmp_path / "log.bin"
    sample().write(log)
    assert cli.main(["tomfile", str(log)]) == 0
    text = (tmp_path / "log.m").read_text()
    assert "FMT." not in text and "PARM." not in text and "IMU.columns" in text
