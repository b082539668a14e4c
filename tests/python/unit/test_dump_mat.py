"""`mavwire dump --format mat`: MATLAB files, read here by what the format's description says."""

from __future__ import annotations

import struct
import zlib
from array import array
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from dataflash_writer import sample
from mavwire import cli, traffic
from mavwire.cli.logs import _dump_mat
from mavwire.dialects.v20 import ardupilotmega as mavlink
from unit.link_tools import record

NUMBERS = {1: "b", 2: "B", 4: "H", 5: "i", 6: "I", 9: "d", 12: "q", 13: "Q"}


def elements(data: bytes) -> list[tuple[int, bytes]]:
    """Type and content of each element."""
    found, at = [], 0
    while at < len(data):
        kind, size = struct.unpack_from("<II", data, at)
        if kind >> 16:
            found.append((kind & 0xFFFF, data[at + 4 : at + 4 + (kind >> 16)]))
            at += 8
            continue
        found.append((kind, data[at + 8 : at + 8 + size]))
        at += 8 + size + (-size % 8 if kind != 15 else 0)
    assert at == len(data)
    return found


def value(data: bytes) -> tuple[str, Any]:
    """Name and content of an array: a dict, a list of lines or of cells, or (shape, numbers)."""
    (_, flags), (_, sizes), (_, name), *rest = elements(data)
    shape = struct.unpack("<2i", sizes)
    kind = flags[0]
    content: Any
    if kind == 2:
        (width,) = struct.unpack("<i", rest[0][1])
        names = [
            rest[1][1][at : at + width].rstrip(b"\0").decode()
            for at in range(0, len(rest[1][1]), width)
        ]
        content = dict(zip(names, (value(one)[1] for _, one in rest[2:]), strict=True))
    elif kind == 1:
        content = [value(one)[1] for _, one in rest]
        assert shape == (len(content), 1)
    else:
        code, raw = rest[0]
        numbers = array(NUMBERS[code], raw).tolist()
        assert len(numbers) == shape[0] * shape[1]
        content = kind, shape, [numbers[at :: shape[0]] for at in range(shape[0])]
        if kind == 4:
            content = ["".join(map(chr, line)) for line in content[2]]
    return name.decode(), content


def read(path: Path) -> dict[str, Any]:
    data = path.read_bytes()
    assert data[124:128] == b"\0\1IM"
    parts = (
        elements(zlib.decompress(content))[0][1] if kind == 15 else content
        for kind, content in elements(data[128:])
    )
    return dict(map(value, parts))


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
    assert found["ATTITUDE"]["time_boot_ms"] == (14, (1, 2), [[1, 2]])
    assert found["ATTITUDE"]["roll"] == (6, (1, 2), [[0.5, 1.5]])
    assert found["STATUSTEXT"]["text"] == ["short       ", "a longer one"]
    assert found["GPS_STATUS"]["satellite_used"] == (14, (1, 20), [[2] * 20])


def test_dataflash(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    log, mat = tmp_path / "log.bin", tmp_path / "log.mat"
    sample().write(log)
    assert cli.main(["dump", "--format", "mat", "--mat_file", str(mat), str(log)]) == 0
    assert capsys.readouterr().out == ""
    found = read(mat)
    assert "FMT" not in found and "PARM" in found
    assert len(found["PARM"]["Name"]) == found["PARM"]["Value"][1][1] > 1


def test_values_of_every_kind(tmp_path: Path) -> None:
    rows: list[dict[str, Any]] = [
        {"big": 1 << 63, "huge": 1, "mixed": 1, "raw": b"ab", "rows": [1, 2.5], "ragged": [1],
         "text": "", "odd": "x", "names": ["a", "b"], "wide": "\U0001f600x"},
        {"big": 0, "huge": -1 << 80, "mixed": 0.5, "raw": b"cd", "rows": [3, 4], "ragged": [2, 3],
         "text": "", "odd": 1, "names": ["c", "d"], "wide": "yz\udcff"},
    ]  # fmt: skip
    table = written(rows, tmp_path / "a.mat")["A"]
    assert table["big"] == (15, (1, 2), [[1 << 63, 0]])
    assert table["huge"] == (6, (1, 2), [[1.0, -float(1 << 80)]])
    assert table["mixed"] == (6, (1, 2), [[1.0, 0.5]])
    assert table["raw"] == (9, (2, 2), [[97, 98], [99, 100]])
    assert table["rows"] == (6, (2, 2), [[1.0, 2.5], [3.0, 4.0]])
    assert table["ragged"] == [(14, (1, 1), [[1]]), (14, (1, 2), [[2, 3]])]
    assert table["text"] == [" ", " "]
    assert table["odd"] == [["x"], (14, (1, 1), [[1]])]
    assert table["names"] == [["a", "b"], ["c", "d"]]
    assert table["wide"] == ["\ufffdx ", "yz\udcff"]


def test_names_that_matlab_cannot_use(tmp_path: Path) -> None:
    found = written([{"_a b": 1, "x_a b": 2, "1": 3}, {"n" * 80: 1, "n" * 90: 2}], tmp_path / "m")
    assert found["A"] == {
        "x_a_b": (14, (1, 1), [[1]]),
        "x_a_b_2": (14, (1, 1), [[2]]),
        "x1": (14, (1, 1), [[3]]),
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
