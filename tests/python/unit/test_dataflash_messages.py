"""Messages and readers of dataflash logs as objects: attributes, copies, memory, errors."""

from __future__ import annotations

import copy
import gc
import io
import json
import subprocess
import sys
import tracemalloc
import weakref
from pathlib import Path
from typing import Any

import mavwire
import numpy as np
import pytest
from dataflash_writer import Log, record, sample
from mavwire import DFReader, mavutil
from mavwire.CSVReader import CSVReader


@pytest.fixture
def log(tmp_path: Path) -> Any:
    """The sample, open."""
    with mavutil.mavlink_connection(sample().write(tmp_path / "t.bin")) as reader:
        yield reader


def test_a_set_column_is_the_messages(log: Any) -> None:
    message = log.recv_match(type="GPS")
    before = message.get_msgbuf()
    message.Lat = 2.5
    message.Status = 6
    assert (message.Lat, message.Status) == (2.5, 6)
    assert message._elements == [5_000_000, 0, 6, 100_000, 2200, 25_000_000.0]
    assert message.get_msgbuf() == before[:12] + b"\x06" + before[13:-4] + (25_000_000).to_bytes(
        4, "little"
    )
    message.Status = 300
    assert message.get_msgbuf() is None
    message.note = "mine"
    assert (message.note, vars(message)) == ("mine", {"note": "mine"})
    del message.note
    assert not hasattr(message, "note")
    with pytest.raises(AttributeError, match="^Nope$"):
        message.Nope  # noqa: B018


@pytest.mark.parametrize(
    ("form", "columns", "line", "values"),
    [
        ("QMBB", "TimeUS,Mode,ModeNum,Rsn", "700, AUTO, 3, 1", (700, 3, 3, 1)),
        ("QMBB", "TimeUS,Mode,ModeNum,Rsn", "700, 3, 3, 1", (700, 3, 3, 1)),
        ("QMB", "TimeUS,Mode,Rsn", "700, AUTO, 1", None),
        ("QMB", "TimeUS,Way,ModeNum", "700, AUTO, 1", None),
        ("QZB", "TimeUS,Mode,ModeNum", "700, AUTO, 3", None),
        ("QLcZ", "TimeUS,Lat,Alt,Text", "700, -35.25, 1.5, hi", (700, -352500000, 150, "hi")),
    ],
)
def test_a_line_of_a_text_log_as_a_record(
    tmp_path: Path, form: str, columns: str, line: str, values: tuple[Any, ...] | None
) -> None:
    """The name of a mode has no number but in the column beside it."""
    path = tmp_path / "t.log"
    head = "FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns"
    path.write_text(f"{head}\nFMT, 129, 99, ONE, {form}, {columns}\nONE, {line}\n")
    with mavutil.mavlink_connection(str(path)) as log:
        message = log.recv_match(type="ONE")
    assert message.get_msgbuf() == (values and record(129, form, *values))


def test_the_mode_of_a_changed_message_is_its_number(tmp_path: Path) -> None:
    """A message that was not changed is the record that stands in the log."""
    log = Log().define("MODE", "QMBB", "TimeUS,Mode,ModeNum,Rsn").add("MODE", 1, 4, 7, 1)
    with mavutil.mavlink_connection(log.write(tmp_path / "t.bin")) as reader:
        message = reader.recv_match(type="MODE")
        assert message.get_msgbuf()[11:] == b"\4\7\1"
        message.Mode = "LAND"
        message.ModeNum = 9
        assert message.get_msgbuf()[11:] == b"\t\t\1"


def test_names_that_are_not_interned_are_found(log: Any) -> None:
    message = log.recv_match(type="IMU")
    name = "".join(["Acc", "X"])
    assert getattr(message, name) == message.AccX == 1.5


def test_columns_do_not_hide_what_every_message_has(tmp_path: Path) -> None:
    log = Log().define("ODD", "BBB", "fmt,get_type,_timestamp").add("ODD", 1, 2, 3)
    with mavutil.mavlink_connection(log.write(tmp_path / "odd.bin")) as reader:
        message = reader.recv_match(type="ODD")
        assert message.get_type() == "ODD"
        assert message.fmt.name == "ODD"
        assert message.to_dict() == {
            "mavpackettype": "ODD", "fmt": 1, "get_type": 2, "_timestamp": 3
        }  # fmt: skip


def test_copies_are_apart(log: Any) -> None:
    message = log.recv_match(type="IMU")
    twin = copy.copy(message)
    twin.AccX = 9.0
    assert (message.AccX, twin.AccX, twin._timestamp) == (1.5, 9.0, message._timestamp)


def test_readers_and_messages_are_freed(tmp_path: Path) -> None:
    reader = mavutil.mavlink_connection(sample().write(tmp_path / "t.bin"))
    messages = list(iter(reader.recv_msg, None))
    messages[3].extra = reader
    watch, message_watch = weakref.ref(reader), weakref.ref(messages[3])
    mavutil.mavfile_global = None
    reader.filehandle.close()
    del reader, messages
    gc.collect()
    assert watch() is None
    assert message_watch() is None


def test_what_is_read_while_conditions_change_the_reader(log: Any) -> None:
    """A condition may rewind, close or replace what it is asked about."""

    class Rewinding(type(log)):  # type: ignore[misc]
        def check_condition(self, condition: str) -> bool:
            self.messages = {}
            return super().check_condition("1 > 0")  # type: ignore[no-any-return]

    other = Rewinding(log.filehandle.name)
    assert other.recv_match(condition="x", type="IMU").AccX == 1.5
    assert other.messages == {}
    other.close()
    with pytest.raises(ValueError, match="closed"):
        other.recv_msg()


def test_a_clock_of_ones_own(log: Any) -> None:
    class Clock(DFReader.DFReaderClock_usec):
        def set_message_timestamp(self, m: Any) -> None:
            m._timestamp = 42.0

    log.rewind()
    log.clock = Clock()
    assert log.recv_msg()._timestamp == 42.0
    log.clock = DFReader.DFReaderClock_usec()
    log.clock.set_timebase(100)
    assert log.recv_match(type="GPS", strict=True)._timestamp == 105.0


def test_messages_made_from_scratch() -> None:
    fmt = DFReader.DFFormat(1, "TST", 0, "QBcZ", "TimeUS,I,C,T")
    message = DFReader.DFMessage(fmt, [1, 2, 300, "abc"], True, None)
    assert str(message) == "TST {TimeUS : 1, I : 2, C : 3.0, T : abc}"
    assert message.get_msgbuf() == record(1, "QBcZ", 1, 2, 300, "abc")
    with pytest.raises(IndexError):
        str(DFReader.DFMessage(fmt, [1], True, None))
    with pytest.raises(AttributeError):
        message._timestamp  # noqa: B018
    with pytest.raises(Exception, match="Unsupported format char: 'y' in message BAD"):
        DFReader.DFFormat(1, "BAD", 0, "y", "A")
    with pytest.raises(ValueError, match="300 bytes|needs? 259|fields need"):
        DFReader.DFFormat(1, "BIG", 0, "ZZZZ", "A,B,C,D")


def test_records_can_be_written_for_the_log(log: Any) -> None:
    fmt = log.add_format(DFReader.DFFormat(0, "NEW", 0, "QBf", "TimeUS,I,V"))
    assert fmt.type == 254
    described = log.make_format_msgbuf(fmt)
    assert described[:5] == b"\xa3\x95\x80\xfe\x10"
    assert log.make_msgbuf(fmt, (1, 2, 3.5)) == record(254, "QBf", 1, 2, 3.5)


def test_unpackers_take_records_apart(log: Any) -> None:
    """Of the types of which there are records, as pymavlink's."""
    assert set(log.unpackers) == {number for number in range(256) if log.counts[number]}
    start = log.offsets[162][0] + 3
    body = log.data_map[start : start + log.formats[162].len - 3]
    first = log.recv_match(type="IMU")
    assert log.unpackers[162](body)[:2] == (first.TimeUS, first.I)


def test_seeking(log: Any) -> None:
    log.offset = log.offsets[162][1]
    assert log.recv_msg().I == 1
    log.rewind()
    log.skip_to_type({"IMU"}, strict=True)
    assert log.offset == log.offsets[162][0]
    assert log.recv_msg().get_type() == "IMU"
    log.skip_to_type({"IMU"})
    log.skip_to_type({"IMU"})
    assert log.offset == log.offsets[162][2]
    assert log.type_nums == [162]
    assert log.counts[162] == 3


def test_progress_is_told_and_may_raise(tmp_path: Path) -> None:
    path = (
        Log().define("X", "Q", "TimeUS").raw(record(1, "Q", 7) * 200_000).write(tmp_path / "x.bin")
    )
    told: list[int] = []
    DFReader.DFReader_binary(path, progress_callback=told.append).close()
    assert told == sorted(set(told))
    assert told[-1] == 100

    def stop(percent: int) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        DFReader.DFReader_binary(path, progress_callback=stop)


def test_an_empty_file_is_refused(tmp_path: Path) -> None:
    (tmp_path / "e.bin").write_bytes(b"")
    with pytest.raises(ValueError, match="cannot mmap an empty file"):
        mavutil.mavlink_connection(str(tmp_path / "e.bin"))
    with pytest.raises(FileNotFoundError):
        mavutil.mavlink_connection(str(tmp_path / "none.bin"))


def test_units_in_degrees_and_documentation(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    home = tmp_path / ".pymavlink" / "LogMessages"
    home.mkdir(parents=True)
    (home / "Copter.xml").write_text(
        '<loggermessagefile><logformat name="GYR"><description>Rates</description><fields>'
        '<field name="R" units="rad/s"><description>a rate</description></field>'
        '<field name="F"><bitmask><bit name="ONE"><value>1</value></bit><bit name="TWO"><value>2'
        "</value><description>the second</description></bit></bitmask></field>"
        '<field name="E"><enum><element name="HOT"><value>3</value></element></enum></field>'
        "</fields></logformat></loggermessagefile>"
    )
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setenv("LOCALAPPDATA", str(tmp_path))
    log = (
        Log()
        .define("UNIT", "QbZ", "TimeUS,Id,Label", 150)
        .define("MSG", "QZ", "TimeUS,Message", 151)
    )
    log.define("FMTU", "QBNN", "TimeUS,FmtType,UnitIds,MultIds", 152)
    log.define("GYR", "fBB", "R,F,E", 153).add("UNIT", 1, ord("r"), "rad/s")
    log.add("FMTU", 1, 153, "r--", "---").add("MSG", 2, "ArduCopter").add("GYR", 0.5, 2, 3)
    with mavutil.mavlink_connection(log.write(tmp_path / "g.bin")) as reader:
        text = io.StringIO()
        reader.recv_match(type="GYR").dump_verbose(text)
        assert text.getvalue().split("\n")[1:] == [
            "    R: 0.5 rad/s (28.64788975654116 deg/s)",
            "    F: 2 (0x2) ",
            "      TWO: the second",
            "    E: 3 (HOT) ",
            "",
        ]
        assert reader.metadata.get_description("GYR") == "Rates"
        assert reader.metadata.get_description("XXX") == ""


def test_the_alias_gives_the_same_modules() -> None:
    code = (
        "import mavwire; mavwire.install_as_pymavlink(); from pymavlink import DFReader, CSVReader;"
        "import mavwire.DFReader, mavwire.CSVReader;"
        "assert DFReader is mavwire.DFReader and CSVReader is mavwire.CSVReader"
    )
    subprocess.run([sys.executable, "-c", code], check=True, timeout=120)


def test_csv_rows(tmp_path: Path) -> None:
    path = tmp_path / "f.csv"
    path.write_text("T;A;B\n1;2.5;x\n\n2;nan\n3;0x10;y;z\n")
    with mavutil.mavlink_connection(f"csv:{path}") as log:
        rows = list(iter(log.recv_msg, None))
        assert [str(row) for row in rows] == [
            "CSV {T : 1.0, A : 2.5, B : x, }", "CSV {T : 2.0, A : nan, }",
            "CSV {T : 3.0, A : 0x10, B : y, }",
        ]  # fmt: skip
        assert rows[0].to_dict() == {"mavpackettype": "CSV", "T": 1.0, "A": 2.5, "B": "x"}
        assert log._count == 4
        assert log.recv_match(condition="CSV.T>2").T == 3.0
        assert json.dumps(rows[0].line) == '[1.0, 2.5, "x"]'
    (tmp_path / "empty.csv").write_text("")
    with pytest.raises(ValueError, match="no headings"):
        CSVReader(str(tmp_path / "empty.csv"))


def test_a_name_may_be_bytes_or_a_path(tmp_path: Path) -> None:
    path = sample().write(tmp_path / "flight.bin")
    expected = DFReader.DFReader_binary(path)._count
    assert expected > 0
    for name in (path.encode(), Path(path)):
        assert DFReader.DFReader_binary(name)._count == expected  # type: ignore[arg-type]


DESCRIBED = "FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\n"


@pytest.mark.parametrize(
    "lines",
    [
        "FMT, 13, 11, IMU, II, TimeMS,N\nIMU, 5, 6\nFMT, 13, 15, IMU, QI, TimeUS,N\nIMU, 7000, 6\n",
        "FMT, 13, 11, IMU, I, N\nIMU, 6\nFMT, 13, 15, IMU, QI, TimeUS,N\nIMU, 7000, 6\n",
        "FMT, 14, 20, ATT, NI, TimeUS,M\nATT, abc, 3\nFMT, 13, 15, IMU, QI, TimeUS,N\nIMU, 7000, 6\n",
        "FMT, 14, 20, ATT, aI, TimeMS,M\nATT, abc, 3\nFMT, 13, 15, IMU, II, TimeMS,N\nIMU, 7, 6\n",
        f"FMT, 13, 15, IMU, QI, TimeUS,N\nIMU, {'9' * 400}, 6\nIMU, 7000, 6\n",
        "FMT, 1, 15, GPS, NNN, TimeUS,GWk,GMS\nGPS, a, b, c\nFMT, 2, 15, IMU, Q, TimeUS\nIMU, 7000\n",
        f"FMT, 1, 9, GPS, QQ, Week,TimeMS\nGPS, {'9' * 400}, 1\nGPS, {'9' * 401}, 1\n"
        "FMT, 2, 15, IMU, Q, TimeUS\nIMU, 7000\n",
        f"FMT, 1, 9, GPS, QQI, TimeUS,GWk,GMS\nGPS, 5000, {'9' * 400}, 1000\n"
        "FMT, 2, 15, IMU, Q, TimeUS\nIMU, 7000\n",
        f"FMT, 1, 9, GPS, Q, GPSTime\nGPS, {'9' * 400}\nFMT, 2, 15, IMU, Q, TimeUS\nIMU, 7000\n",
        "FMT, 1, 9, GPS, HI, GWk,GMS\nGPS, 1800, 1000\nGPS, 1800, 1200\n"
        "FMT, 2, 15, IMU, Q, TimeUS\nIMU, 7000\n",
        "FMT, 1, 9, TIME, N, StartTime\nTIME, a\nFMT, 2, 9, GPS, Q, GPSTime\nGPS, 7\n"
        "FMT, 3, 15, IMU, QI, TimeUS,N\nIMU, 7000, 6\n",
    ],
)
def test_times_that_are_no_numbers_are_none(tmp_path: Path, lines: str) -> None:
    path = tmp_path / "odd.log"
    path.write_text(DESCRIBED + lines)
    with DFReader.DFReader_text(str(path)) as log:
        found = [(msg.get_type(), msg._timestamp) for msg in iter(log.recv_msg, None)]
    assert found[-1] == ("IMU", pytest.approx(0.007))
    assert len(found) == (DESCRIBED + lines).count("\n")


def test_week_0_of_old_gps_records_is_no_date(tmp_path: Path) -> None:
    log = Log().define("GPS", "BIHI", "Status,TimeMS,Week,T").define("ATT", "If", "TimeMS,Roll")
    log.add("ATT", 100, 1.0).add("GPS", 3, 500, 0, 1000)
    none = log.write(tmp_path / "none.BIN")
    log.add("GPS", 3, 1500, 1800, 2000)
    some = log.write(tmp_path / "some.BIN")
    for path, zero in ((none, 0.0), (some, 1_404_604_782 + 1.5 - 2)):
        with DFReader.DFReader_binary(str(path)) as reader:
            assert reader.recv_match(type="ATT")._timestamp == pytest.approx(zero + 0.1)
        assert mavwire.read(path)["ATT"]["timestamp"].astype(float) / 1e6 == zero + 0.1


def test_columns_of_a_description_in_a_text_log_without_spaces(tmp_path: Path) -> None:
    path = tmp_path / "narrow.log"
    path.write_text(DESCRIBED.replace(", ", ",") + "FMT,13,15,IMU,QI,TimeUS,N\nIMU,5000,6\n")
    with DFReader.DFReader_text(str(path)) as log:
        (imu,) = [m for m in iter(log.recv_msg, None) if m.get_type() == "FMT" and m.Name == "IMU"]
    assert imu.Columns == imu.to_dict()["Columns"] == "TimeUS,N"


def test_gps_messages_that_do_not_say_when_give_rates(tmp_path: Path) -> None:
    log = Log().define("GPS", "BIH", "Status,TimeMS,Week").define("ATT", "h", "Roll")
    for n in range(4):
        log.add("GPS", 3, 1000 + 200 * n, 1800)
        for roll in range(4):
            log.add("ATT", roll)
    path = log.write(tmp_path / "old.BIN")
    zero = 1_404_604_782
    with DFReader.DFReader_binary(str(path)) as reader:
        found = [(m.get_type(), m._timestamp - zero) for m in iter(reader.recv_msg, None)]
    att = [time for kind, time in found if kind == "ATT"]
    by_rates = [1.45, 1.5, 1.55, 1.6, 1.425, 1.45, 1.475, 1.5, 1.625, 1.65, 1.675, 1.7]
    assert att[4:] == pytest.approx(by_rates, abs=1e-5)
    assert np.isnat(mavwire.read(path)["ATT"]["timestamp"]).all()


GPS_TIME = 1_400_000_000
"""Seconds."""


@pytest.mark.parametrize(
    ("order", "expected"),
    [
        ("GATGAT", [0, 0, 0.5]),  # the first TIME and the GPS record in front of it
        ("TATGA", [-0.5, 0, 0]),
        ("GAGA", None),
    ],
)
def test_a_time_record_and_a_gps_record_give_the_clock_in_any_order(
    tmp_path: Path, order: str, expected: list[float] | None
) -> None:
    log = Log().define("TIME", "Q", "StartTime").define("GPS", "QB", "GPSTime,Fix")
    log.define("ATT", "f", "Roll")
    starts, times = iter(range(5_000_000, 9_000_000, 500_000)), iter(range(0, 9_000_000, 200_000))
    for one in order + "A":
        if one == "A":
            log.add("ATT", 1.0)
        elif one == "T":
            log.add("TIME", next(starts))
        else:
            log.add("GPS", GPS_TIME * 1_000_000 + next(times), 3)
    path = log.write(tmp_path / "px4.BIN")
    with DFReader.DFReader_binary(str(path)) as reader:
        found = [m._timestamp for m in iter(reader.recv_msg, None) if m.get_type() == "ATT"]
    columns = mavwire.read(path)["ATT"]["timestamp"]
    if expected is None:
        assert found == pytest.approx([0.02, 0.04, 0.06]) and np.isnat(columns).all()
        return
    assert [time - GPS_TIME for time in found] == pytest.approx(expected, abs=1e-5)
    assert list(columns.astype(int) / 1e6) == pytest.approx(found)


def test_a_week_that_is_no_number_is_none(tmp_path: Path) -> None:
    log = Log().define("GPS", "QdI", "TimeUS,GWk,GMS").define("ATT", "Qf", "TimeUS,Roll")
    for week in (float("nan"), float("inf"), -814.0, 1800.0):
        log.add("GPS", 5_000_000, week, 1000)
    path = log.add("ATT", 5_200_000, 1.0).write(tmp_path / "odd.BIN")
    with DFReader.DFReader_binary(str(path)) as reader:
        assert reader.recv_match(type="ATT")._timestamp == pytest.approx(1_404_604_783.2)
    assert mavwire.read(path)["ATT"]["timestamp"].astype(int).tolist() == [1_404_604_783_200_000]


def test_texts_are_no_weeks(tmp_path: Path) -> None:
    path = tmp_path / "texts.log"
    weeks = "".join(f"GPS, {digit * 2000}, 1\n" for digit in "98")
    path.write_text(f"{DESCRIBED}FMT, 1, 9, GPS, NN, Week,TimeMS\n{weeks}")
    tracemalloc.start()
    with DFReader.DFReader_text(str(path)) as log:
        assert len(list(iter(log.recv_msg, None))) == 4
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 8 << 20


def test_the_last_of_two_columns_of_one_name_may_have_no_value(tmp_path: Path) -> None:
    log = Log().define("FMTU", "QBNN", "TimeUS,FmtType,UnitIds,MultIds", 152)
    log.define("IMU", "QB", "TimeUS,I,I", 162).add("FMTU", 2, 162, "s#", "F-")
    path = log.add("IMU", 4000, 0).add("IMU", 4001, 1).write(tmp_path / "twice.BIN")
    with DFReader.DFReader_binary(str(path)) as reader:
        assert sum(m.get_type() == "IMU" for m in iter(reader.recv_msg, None)) == 2


def test_the_first_time_of_a_log_by_millis_is_no_time_of_the_week(tmp_path: Path) -> None:
    log = Log().define("GPS", "BIHI", "Status,TimeMS,Week,T").define("ATT", "h", "Roll")
    path = log.add("GPS", 3, 1000, 1800, 4000).add("ATT", 1).write(tmp_path / "old.BIN")
    with DFReader.DFReader_binary(str(path)) as reader:
        assert [m._timestamp for m in iter(reader.recv_msg, None)] == [1_404_604_783.0] * 5
    assert set(mavwire.read(path)["FMT"]["timestamp"].astype(int)) == {1_404_604_783_000_000}
