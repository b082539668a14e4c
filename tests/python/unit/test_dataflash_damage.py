"""Damaged and hostile dataflash logs: nothing intact is lost, nothing hangs, memory stays bounded."""

from __future__ import annotations

import random
import struct
from collections import Counter
from pathlib import Path

import mavwire
import pytest
from dataflash_writer import FMT, HEAD, Log, fmt, record, sample
from mavwire import cli, mavutil
from mavwire.DFReader import DFReader_binary, DFReader_text

RECORDS = [record(1, "QB", number, number % 7) for number in range(40)]
DESCRIPTION = FMT + fmt(1, "CNT", "QB", "TimeUS,N")


def read(path: Path, data: bytes) -> list[str]:
    """The texts of all messages of a log."""
    path.write_bytes(data)
    with DFReader_binary(str(path)) as log:
        messages = [str(message) for message in iter(log.recv_msg, None)]
        assert log.offset == len(data)
        assert len(messages) == log._count
    return messages


def text_of(number: int) -> str:
    return f"CNT {{TimeUS : {number}, N : {number % 7}}}"


@pytest.mark.parametrize("gone", [1, 2, 3, 5, 11, 12, 13, 30])
def test_every_cut_leaves_the_intact_records(tmp_path: Path, gone: int) -> None:
    body = b"".join(RECORDS)
    size = len(RECORDS[0])
    for start in range(4 * size):
        data = DESCRIPTION + body[:start] + body[start + gone :]
        found = read(tmp_path / "cut.bin", data)
        for number in range(len(RECORDS)):
            first, last = number * size, (number + 1) * size
            if last <= start or first >= start + gone:
                assert text_of(number) in found, f"record {number}, {gone} bytes gone at {start}"


def test_junk_between_records(tmp_path: Path) -> None:
    rng = random.Random(1)
    pieces = [HEAD, b"\xa3", HEAD + b"\x63", b"\0" * 700, b"\xff" * 3, rng.randbytes(99)]
    data = DESCRIPTION + b"".join(one + rng.choice(pieces) for one in RECORDS)
    assert set(map(text_of, range(len(RECORDS)))) <= set(read(tmp_path / "junk.bin", data))
    with DFReader_binary(str(tmp_path / "junk.bin")) as log:
        assert 0 < log.junk_bytes < len(data)


def test_any_mutation_is_read_to_its_end(tmp_path: Path) -> None:
    """R67."""
    rng = random.Random(2)
    whole = bytes(sample().data)
    for _ in range(150):
        data = bytearray(whole)
        for _ in range(rng.randint(1, 8)):
            data[rng.randrange(len(data))] = rng.randrange(256)
        del data[rng.randrange(len(data)) :]
        path = tmp_path / "mutated.bin"
        path.write_bytes(bytes(data) or b"x")
        with mavutil.mavlink_connection(str(path)) as log:
            for message in iter(log.recv_msg, None):
                assert str(message)
                assert message.to_dict()["mavpackettype"] == message.get_type()
            log.flightmode_list()


def test_definitions_that_lie_hide_nothing_else(tmp_path: Path) -> None:
    lies = [
        fmt(9, "BAD", "BB", "X,Y", length) for length in (0, 1, 2, 3, 4)
    ] + [
        HEAD + b"\x80" + struct.pack("<BB4s16s64s", 10, 9, b"ODD", b"Q\xff?", b"A,B"),
        fmt(11, b"", "BB", "X,Y"),
        fmt(128, "FMT", "BB", "X,Y"),
    ]  # fmt: skip
    data = DESCRIPTION + b"".join(lies) + b"".join(RECORDS)
    found = read(tmp_path / "lies.bin", data)
    assert found[-len(RECORDS) :] == [text_of(number) for number in range(len(RECORDS))]


def test_a_longer_record_than_its_fields(tmp_path: Path) -> None:
    data = FMT + fmt(9, "LNG", "BB", "X,Y", 8) + (HEAD + b"\x09\x01\x02???") * 3
    assert read(tmp_path / "long.bin", data)[-1] == "LNG {X : 1, Y : 2}"


def test_columns_without_a_format_and_the_other_way_round(tmp_path: Path) -> None:
    log = Log().define("FEW", "B", "X,Y", 1).define("MNY", "BBB", "X", 2).define("NON", "", "", 3)
    log.add("FEW", 1).add("MNY", 2, 3, 4).add("NON")
    found = read(tmp_path / "odd.bin", bytes(log.data))
    assert found[-3:] == ["FEW {X : 1}", "MNY {X : 2}", "NON {}"]


def test_what_tells_the_state_in_columns_of_other_types_tells_nothing(tmp_path: Path) -> None:
    log = Log().define("MSG", "B", "Message", 1).define("PARM", "af", "Name,Value", 2)
    log.define("MODE", "Q", "Hours", 3).define("VER", "N", "BU", 4).define("STAT", "B", "X", 5)
    log.add("MSG", 1).add("PARM", bytes(64), 1.0).add("MODE", 9).add("VER", b"a").add("STAT", 1)
    path = tmp_path / "odd.bin"
    assert len(read(path, bytes(log.data))) == 11
    with DFReader_binary(str(path)) as reader:
        while reader.recv_msg() is not None:
            pass
        assert (reader.params, reader.flightmode, reader.mav_type) == ({}, "UNKNOWN", 1)


def test_a_type_described_again_and_before_it_is_described(tmp_path: Path) -> None:
    data = FMT + record(5, "BB", 1, 2) + fmt(5, "OLD", "BB", "X,Y") + record(5, "BB", 3, 4)
    data += fmt(5, "NEW", "HH", "P,Q") + record(5, "HH", 5, 6)
    found = [text for text in read(tmp_path / "again.bin", data) if not text.startswith("FMT")]
    assert found == ["OLD {X : 1, Y : 2}", "OLD {X : 3, Y : 4}", "NEW {P : 5, Q : 6}"]


def test_all_types_and_equal_names(tmp_path: Path) -> None:
    data = FMT + b"".join(fmt(n, "SAME", "B", "X") for n in range(256) if n != 128)
    data += b"".join(record(n, "B", n) for n in range(256) if n != 128)
    path = tmp_path / "types.bin"
    path.write_bytes(data)
    with DFReader_binary(str(path)) as log:
        messages = list(iter(lambda: log.recv_match(type="SAME"), None))
        assert [message.X for message in messages] == [n for n in range(256) if n != 128]
        assert log.find_unused_format() is None


def test_many_descriptions_and_instances_stay_bounded(tmp_path: Path) -> None:
    log = Log()
    for number in range(6000):
        log.raw(fmt(7, "MANY", "H", f"C{number}"))
    log.define("FMTU", "QBNN", "TimeUS,FmtType,UnitIds,MultIds", 20).define("X", "I", "I", 21)
    log.add("FMTU", 1, 21, "#", "-")
    for number in range(70_000):
        log.add("X", number)
    path = log.write(tmp_path / "many.bin")
    with DFReader_binary(path) as reader:
        assert reader._count == 1 + 6000 + 2 + 1 + 70_000
        assert [fmt.name for fmt in reader._layouts] == ["FMT", *["MANY"] * 16, "FMTU", "X"]
        while reader.recv_msg() is not None:
            pass
        assert len(reader.messages) == 1 << 16


def test_a_file_that_shrinks_while_it_is_read(tmp_path: Path) -> None:
    path = tmp_path / "shrinks.bin"
    path.write_bytes(DESCRIPTION + b"".join(RECORDS) * 2000)
    log = DFReader_binary(str(path))
    assert log.recv_msg() is not None
    path.write_bytes(b"")
    while log.recv_msg() is not None:
        pass
    assert log.recv_match(type="CNT") is None
    for _ in range(2):
        log.close()
        assert log.filehandle.closed


def test_text_that_is_no_log(tmp_path: Path) -> None:
    path = tmp_path / "odd.log"
    head = "FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\nFMT, 1, 9, A, QZ, TimeUS,T\n"
    lines = [
        b"A, 1, good\n", b"A, 2\n", b"A\n", b"\n", b", , ,\n", b"A, x, words\n", b"\xff\xfe, 1\n",
        b"A, 3, caf\xc3\xa9\n", b"A, 4, caf\xe9\n", b"Z" * 300_000 + b"\n", b"A, " * 90_000 + b"\n",
        b"FMT, 300, 1, B, Q, X\n", b"FMT, 2, 9, B, y, X\n", b"FMT, 2\n", b"A, 5, end\n", b"A, 6, cut off",
    ]  # fmt: skip
    path.write_bytes(head.encode() + b"".join(lines))
    with DFReader_text(str(path)) as log:
        messages = [m for m in iter(log.recv_msg, None) if m.get_type() == "A"]
        assert [m.T for m in messages] == ["good", "words", "café", "café", "end"]
        with pytest.raises(ValueError, match="invalid literal"):
            messages[1].TimeUS  # noqa: B018
        assert log.offset == path.stat().st_size


def test_the_last_value_of_a_text_log_may_be_cut_off(tmp_path: Path) -> None:
    path = tmp_path / "cut.log"
    whole = f"{ODD_TEXT.splitlines()[0]}\nFMT, 1, 9, A, QI, TimeUS,N\nA, 1, 1500\n"
    for rest in ("A, 2, 15", "A, 2, 1500\r", "A, 2"):
        path.write_bytes((whole + rest).encode())
        with DFReader_text(str(path)) as log:
            assert [m.N for m in iter(log.recv_msg, None) if m.get_type() == "A"] == [1500]
        assert mavwire.read(path)["A"]["N"].tolist() == [1500]
        assert mavwire.open_log(path).info().bad_bytes == len(rest)


def test_a_description_of_a_text_log_may_be_cut_off(tmp_path: Path) -> None:
    path = tmp_path / "cut.log"
    head = f"{ODD_TEXT.splitlines()[0]}\nFMT, 1, 9, A, QII, TimeUS,Num,Other\n"
    path.write_text(f"{head}A, 1, 2, 3\nFMT, 1, 9, A, QII, TimeUS,Nu")
    with DFReader_text(str(path)) as log:
        assert log.formats["A"].columns == ["TimeUS", "Num", "Other"]
        assert [m.get_type() for m in iter(log.recv_msg, None)] == ["FMT", "FMT", "A"]
    assert mavwire.read(path)["A"].columns == ["timestamp", "TimeUS", "Num", "Other"]


def test_text_lines_around_bad_ones_come_once(tmp_path: Path) -> None:
    path = tmp_path / "twice.log"
    rows = "".join(f"A, {n}, x\nA, {n}\n" for n in range(50))
    path.write_text("header, x\nFMT, 1, 9, A, QZ, TimeUS,T\n" + rows)
    with DFReader_text(str(path)) as log:
        assert log.counts == {"head": 1, "FMT": 1, "A": 100}
        at = len("header, x\n")
        assert list(log.offsets) == list(log.counts)
        assert log.offsets["FMT"] == [at]
        assert {key: len(found) for key, found in log.offsets.items()} == log.counts
        assert path.read_bytes()[log.offsets["A"][1] :].startswith(b"A, 0\nA, 1, x")
        times = [message.TimeUS for message in iter(lambda: log.recv_match(type="A"), None)]
    assert times == list(range(50))
    assert max(Counter(times).values()) == 1


ODD_TEXT = """FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns
FMT, 5, 11, ATT, Qcc, TimeUS,Roll,Pitch
FMT, 6, 20, GPS, QIH, TimeUS,GMS,GWk
GPS, 1, word, 2000
ATT, notnum, 1, 2
ATT, 1000, 1, 2
ATT, 1500, x, 2
ATT, 2000, 5, 6
"""


def test_words_in_the_place_of_numbers_cost_their_line_alone(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "odd.log"
    path.write_text(ODD_TEXT)
    with DFReader_text(str(path)) as log:
        assert len(list(iter(log.recv_msg, None))) == 8
    assert cli.main(["dump", str(path)]) == 0
    printed = capsys.readouterr()
    assert "TimeUS : 1000, Roll" in printed.out
    assert "TimeUS : 2000, Roll" in printed.out
    assert printed.err.count("passed over") == 3


def test_a_word_in_the_place_of_an_instance_costs_no_other_line(tmp_path: Path) -> None:
    path = tmp_path / "odd.log"
    lines = [
        "FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns",
        "FMT, 7, 20, FMTU, QBNN, TimeUS,FmtType,UnitIds,MultIds",
        "FMT, 5, 11, IMU, QBf, TimeUS,I,GyrX",
        "FMTU, 1, 5, s#-, F--",
        *(f"IMU, {n}, {instance}, {n}" for n, instance in enumerate([0, 1, "word", "\x10", 1, 0])),
    ]
    path.write_text("\n".join(lines) + "\n")
    with DFReader_text(str(path)) as log:
        times = [message.TimeUS for message in iter(lambda: log.recv_match(type="IMU"), None)]
        assert times == list(range(6))
        kinds = {name for name in log.messages if name.startswith("IMU")}
        assert kinds == {"IMU", "IMU[0]", "IMU[1]"}
        assert (log.messages["IMU[0]"].TimeUS, log.messages["IMU[1]"].TimeUS) == (5, 4)


# Two intact positions, modes and parameters among lines with words, in logs with either clock.
WORDS = """FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns
FMT, 6, 20, GPS, QBIHLLfff, TIME,Status,GMS,GWk,Lat,Lng,Alt,GCrs,Spd
FMT, 7, 20, PARM, QNf, TIME,Name,Value
FMT, 8, 20, MODE, QMB, TIME,Mode,ModeNum
FMT, 9, 20, ATT, Qcc, TIME,Roll,Pitch
PARM, 1, A, word
PARM, word, B, 1.5
PARM, 3, C, 2.5
MODE, 10, 5, word
MODE, 20, 5, 5
GPS, 1000, word, 1000, 2000, 1.5, 2.5, 10, 90, 5
GPS, 2000, 3, 2000, 2000, 1.5, 2.5, 10, 90, 5
GPS, 3000, 3, 3000, 2000, word, 2.5, 10, 90, 5
ATT, 3500, word, 2
GPS, 4000, 3, 4000, 2000, 1.6, 2.5, 10, 90, 5
ATT, 5000, 7, 2
"""


@pytest.mark.parametrize("time", ["TimeUS", "TimeMS"])
@pytest.mark.parametrize(
    ("command", "shown"),
    [
        ("info", "ATT"),
        ("dump", "Roll : 7.0"),
        ("dump --format json", '"Roll": 7.0'),
        ("dump --format csv --types ATT", ",7.0,2.0"),
        ("dump --verbose", "Roll: 7.0"),
        ("dump --condition ATT.Roll>1", "Roll : 7.0"),
        ("dump --output copy.bin", "Roll : 7.0"),
        ("search --condition ATT.Roll>1", "Roll : 7.0"),
        ("search --types ATT", "Roll : 7.0"),
        ("parms", "2.5"),
        ("flightmodes", "MAV.flightmode=5"),
        ("flighttime", "distance travelled: 11"),
        ("summarize", "words.log"),
        ("togpx", "2 points"),
        ("msgstats", "ATT"),
        ("tomfile", "words.m"),
        ("tomfile --condition ATT.Roll>1", "words.m"),
    ],
)
def test_every_tool_passes_over_words_and_reads_the_rest(
    time: str,
    command: str,
    shown: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("words.log").write_text(WORDS.replace("TIME", time))
    assert cli.main([*command.split(), "words.log"]) == 0
    assert shown in capsys.readouterr().out
    if command.startswith("tomfile"):
        assert "ATT.data(1,:)" in Path("words.m").read_text()


def test_a_column_that_a_tool_needs(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    log = Log().define("GPS", "QB", "TimeUS,Status").add("GPS", 1, 3)
    path = log.write(tmp_path / "short.bin")
    assert cli.main(["flighttime", path]) == 1
    error = f"mavwire flighttime: error: {path}: GPS has no column Spd\n"
    assert capsys.readouterr().err == error


def test_a_wrong_condition_over_a_text_log_is_shown_once(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "good.log"
    path.write_text(ODD_TEXT.splitlines()[0] + "\n")
    for verb in ("dump", "search", "tomfile"):
        assert cli.main([verb, "--condition", "float('x')>1", str(path)]) == 1
        error = capsys.readouterr().err
        assert error.startswith(f"mavwire {verb}: error: --condition")
        assert error.count("--condition") == 1


def test_sizes_of_types_in_a_text_log(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "odd.log"
    path.write_text(ODD_TEXT)
    assert cli.main(["msgstats", str(path)]) == 0
    assert "ATT" in capsys.readouterr().out


def test_a_number_of_thousands_of_digits_ends_no_loop(tmp_path: Path) -> None:
    """R67: Python's int() takes no such text."""
    path = tmp_path / "digits.log"
    head = "FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\nFMT, 5, 17, ATT, QI, TimeUS,Yaw\n"
    numbers = ["3", "9" * 30, "9" * 5000, "-" + "9" * 5000, "4"]
    path.write_text(head + "".join(f"ATT, {n}, {one}\n" for n, one in enumerate(numbers, 1000)))
    with DFReader_text(str(path)) as log:
        read = [
            msg.Yaw for msg in iter(lambda: log.recv_match(type="ATT", condition="ATT.Yaw"), None)
        ]
    assert read == [3, int("9" * 30), float("inf"), float("-inf"), 4]
