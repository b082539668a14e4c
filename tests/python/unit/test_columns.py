"""Tables hold exactly what the messages of a log say."""

from __future__ import annotations

import gzip
import pickle
import subprocess
import sys
from datetime import UTC, datetime, timedelta, timezone
from pathlib import Path
from random import Random

import mavwire
import numpy as np
import pytest
from mavwire import traffic
from mavwire._native import LogColumns
from mavwire.dialects.v20 import all as mavlink
from mavwire.logs import reading
from mavwire.logs.conversion import convert
from real_logs import each_log
from unit.column_tools import compare_with_messages, log_of_every_type
from unit.link_tools import T0, heartbeat, pack, record


@pytest.fixture(scope="module")
def flight(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("logs") / "flight.tlog"
    traffic.generate(path, 20_000, systems=2, loss=0.01)
    return path


def statustext(text: bytes, seq: int) -> bytes:
    return record(pack(mavlink.MAVLink_statustext_message(6, text), seq), T0 + 1000 * seq)


def test_every_type_of_the_dialect(tmp_path):
    path = tmp_path / "all.tlog"
    log_of_every_type(path)
    assert compare_with_messages(path) == 3 * len(mavlink.mavlink_map)


def test_a_flight(flight):
    assert compare_with_messages(flight) == 20_000


@pytest.mark.filterwarnings("ignore::mavwire.logs.unknown.UnknownMessageWarning")
@each_log("*.tlog")
def test_real_logs(path):
    info = mavwire.open_log(path).info()
    assert compare_with_messages(path) == info.messages - sum(info.unknown.values())


def test_columns_and_metadata(flight):
    table = mavwire.open_log(flight)["GPS_RAW_INT"]
    assert table.columns[:6] == ["timestamp", "sysid", "compid", "seq", "time_usec", "fix_type"]
    assert table.metadata["lat"] == {"field": "lat", "unit": "degE7"}
    assert table.metadata["fix_type"] == {"field": "fix_type", "enum": "GPS_FIX_TYPE"}
    assert table.metadata["eph"]["multiplier"] == "1E-2"
    assert table.metadata["eph"]["invalid"] == "UINT16_MAX"
    assert table["lat"].dtype == np.int32
    assert table["fix_type"].dtype == np.uint8
    assert table["timestamp"].dtype == np.dtype("datetime64[us]")
    assert table.shape == (len(table), len(table.columns))
    assert table.name in repr(table)


def test_the_field_that_tells_instances_apart(flight):
    table = mavwire.open_log(flight)["BATTERY_STATUS"]
    marked = [name for name, told in table.metadata.items() if "instance" in told]
    assert marked == ["id"]
    assert table.metadata["id"]["instance"] == "true"


def test_a_column_is_a_buffer_of_bytes(flight):
    table = mavwire.open_log(flight)["BATTERY_STATUS"]
    column = table._batches.column("voltages")
    view = memoryview(column)
    assert (view.readonly, view.format, view.nbytes) == (True, "B", 20 * len(table))
    assert (column.dtype, column.elements) == ("u2", 10)
    assert len(column) == 10 * len(table)


def test_numbers_are_views_of_the_tables_memory(flight):
    table = mavwire.open_log(flight)["ATTITUDE"]
    first, second = table["roll"], table["roll"]
    assert np.shares_memory(first, second)
    assert not first.flags.writeable
    kept = first[:5].copy()
    del table, second
    assert (first[:5] == kept).all()


def test_arrays_have_a_second_dimension(flight):
    table = mavwire.open_log(flight)["BATTERY_STATUS"]
    assert table["voltages"].shape == (len(table), 10)
    part = table.slice(3, 5)
    assert (part["voltages"] == table["voltages"][3:8]).all()
    assert (part["timestamp"] == table["timestamp"][3:8]).all()


def test_fields_named_like_the_columns_in_front(tmp_path):
    path = tmp_path / "ping.tlog"
    path.write_bytes(record(pack(mavlink.MAVLink_ping_message(1, 77, 2, 3), 9), T0))
    table = mavwire.read(path)["PING"]
    assert (table["seq"][0], table["seq_"][0]) == (9, 77)
    assert table.metadata["seq_"]["field"] == "seq"
    assert mavwire.read(path, "PING", fields="seq")["PING"].columns[-1] == "seq_"


def test_texts_keep_what_is_not_utf8(tmp_path):
    path = tmp_path / "text.tlog"
    texts = [b"plain", "Grüße".encode(), b"\xff\x80x", b"cut\x00here", b""]
    path.write_bytes(b"".join(statustext(text, n) for n, text in enumerate(texts)))
    table = mavwire.read(path)["STATUSTEXT"]
    assert table["text"].tolist() == ["plain", "Grüße", "\ufffd\ufffdx", "cut", ""]
    assert table["text_raw"].tolist() == [None, None, b"\xff\x80x", b"cut\x00here", None]
    path.write_bytes(b"".join(statustext(text, n) for n, text in enumerate(texts[:2])))
    assert "text_raw" not in mavwire.read(path)["STATUSTEXT"].columns
    (batch,) = mavwire.scan(path, "STATUSTEXT")
    assert batch["text_raw"].tolist() == [None, None], "the columns of batches are always the same"


def test_selection(flight):
    log = mavwire.open_log(flight)
    everything = mavwire.read(flight)
    first, last = (everything["ATTITUDE"]["timestamp"].astype("int64")[[0, -1]] * 1e-6).tolist()
    start, end = first + 5, datetime.fromtimestamp(last - 5, UTC)
    tables = mavwire.read(flight, ["ATTITUDE", "GPS_RAW_INT"], 2, ["roll", "lat"], start, end)
    assert list(tables) == ["ATTITUDE", "GPS_RAW_INT"]
    assert tables["ATTITUDE"].columns == ["timestamp", "sysid", "compid", "seq", "roll"]
    expected = [msg.roll for msg in log.messages("ATTITUDE", 2, start, end)]
    assert 0 < len(expected) < len(everything["ATTITUDE"])
    assert tables["ATTITUDE"]["roll"].tolist() == expected


def test_a_time_as_datetime_is_the_record_that_has_it(tmp_path):
    random = Random(3)
    stamps = sorted(random.randrange(1_500_000_000_000_000, 2**51) for _ in range(300))
    path = tmp_path / "times.tlog"
    path.write_bytes(b"".join(record(heartbeat(n % 256), t) for n, t in enumerate(stamps)))
    log = mavwire.open_log(path)
    epoch = datetime(1970, 1, 1, tzinfo=UTC)
    zones = [UTC, timezone(timedelta(hours=-7))]
    for n, stamp in enumerate(stamps):
        time = (epoch + timedelta(microseconds=stamp)).astimezone(zones[n % 2])
        assert sum(1 for _ in log.messages(start=time)) == len(stamps) - n
        assert sum(1 for _ in log.messages(end=time)) == n
        if n % 30 == 0:
            assert len(mavwire.read(path, start=time)["HEARTBEAT"]) == len(stamps) - n


def test_a_type_that_comes_in_pieces_is_one_table(flight, monkeypatch):
    whole = mavwire.read(flight, enums="names")
    monkeypatch.setattr(reading, "LogColumns", Halves)
    tables = mavwire.read(flight, enums="names")
    assert {name: len(table) for name, table in tables.items()} == {
        name: len(table) for name, table in whole.items()
    }
    for name, table in tables.items():
        for column in table:
            np.testing.assert_array_equal(table[column], whole[name][column])


class Halves:
    """Gives each table in two pieces, as a type that is too large for one array comes."""

    def __init__(self, *arguments):
        self.found = LogColumns(*arguments)
        self.progress = lambda: (0, 0, None, {})

    def __iter__(self):
        for tables in self.found:
            for name, table in tables:
                half = len(table) // 2
                yield [(name, table.slice(0, half))]
                yield [(name, table.slice(half, len(table)))]


def test_types_that_are_not_in_the_log_give_empty_tables(flight):
    table = mavwire.open_log(flight)["WHEEL_DISTANCE"]
    assert len(table) == 0
    assert table["distance"].shape == (0, 16)
    assert set(table.to_numpy()) == set(table.columns)


def test_fields_that_only_some_of_the_types_have(flight):
    tables = mavwire.read(flight, ["ATTITUDE", "WHEEL_DISTANCE"], fields=["roll", "distance"])
    assert [table.columns[4:] for table in tables.values()] == [["roll"], ["distance"]]
    assert len(tables["WHEEL_DISTANCE"]) == 0


@pytest.mark.parametrize(
    ("wanted", "error", "said"),
    [
        ({"types": "ATITUDE"}, ValueError, "did you mean 'ATTITUDE'"),
        ({"types": "ATTITUDE", "fields": "rol"}, ValueError, "'rol'"),
        ({"units": "imperial"}, ValueError, "units"),
        ({"enums": "numbers"}, ValueError, "enums"),
        ({"systems": 256}, ValueError, "256"),
    ],
)
def test_wrong_arguments_are_named(flight, wanted, error, said):
    with pytest.raises(error, match=said):
        mavwire.read(flight, **wanted)
    with pytest.raises(error, match=said):
        mavwire.scan(flight, **wanted)


def test_what_is_no_message_no_column_no_file(flight, tmp_path):
    with pytest.raises(KeyError, match="NOPE"):
        mavwire.open_log(flight)["NOPE"]
    table = mavwire.open_log(flight)["ATTITUDE"]
    with pytest.raises(KeyError, match="no column 'nope'\\W*$"):
        table["nope"]
    for missing in ("rol", ["yaw", "rol"]):
        with pytest.raises(KeyError, match="no column 'rol'; did you mean 'roll'"):
            table[missing]
    with pytest.raises(FileNotFoundError, match="missing"):
        mavwire.read(tmp_path / "missing.tlog")
    with pytest.raises(IsADirectoryError):
        mavwire.read(tmp_path)


def test_si_units(flight):
    plain, si = (mavwire.read(flight, "GPS_RAW_INT", units=units) for units in (None, "si"))
    degrees = [value / 1e7 for value in plain["GPS_RAW_INT"]["lat"].tolist()]
    assert si["GPS_RAW_INT"]["lat"].tolist() == degrees
    assert si["GPS_RAW_INT"].metadata["lat"]["unit"] == "deg"
    assert si["GPS_RAW_INT"]["alt"].tolist() == [
        v / 1e3 for v in plain["GPS_RAW_INT"]["alt"].tolist()
    ]
    assert si["GPS_RAW_INT"]["fix_type"].dtype == np.uint8


def test_enum_names(flight, tmp_path):
    table = mavwire.read(flight, "HEARTBEAT", enums="names")["HEARTBEAT"]
    assert "MAV_TYPE_QUADROTOR" in set(table["type"])
    message = mavlink.MAVLink_heartbeat_message(250, 3, 0x81, 0, 4, 3)
    path = tmp_path / "one.tlog"
    path.write_bytes(record(pack(message, 0), T0))
    row = mavwire.read(path, enums="names")["HEARTBEAT"]
    assert row["type"][0] == "250", "a value without a name keeps its number"
    flags = set(row["base_mode"][0].split("|"))
    assert flags == {"MAV_MODE_FLAG_SAFETY_ARMED", "MAV_MODE_FLAG_CUSTOM_MODE_ENABLED"}


def test_enum_names_in_lists(tmp_path):
    message = mavlink.MAVLink_trajectory_representation_waypoints_message
    lists = [[0.0] * 5] * 11 + [[16, 22, 1, 250, 16]]
    path = tmp_path / "one.tlog"
    frames = [pack(message(0, 5, *lists), seq) for seq in range(2)]
    path.write_bytes(b"".join(record(frame, T0) for frame in frames))
    table = mavwire.read(path, enums="names")["TRAJECTORY_REPRESENTATION_WAYPOINTS"]
    named = ["MAV_CMD_NAV_WAYPOINT", "MAV_CMD_NAV_TAKEOFF", "1", "250", "MAV_CMD_NAV_WAYPOINT"]
    assert table["command"].shape == (2, 5)
    assert table["command"].tolist() == [named] * 2 == table.to_arrow()["command"].to_pylist()
    assert list(table.to_pandas()["command"][1]) == list(np.asarray(table)["command"][1]) == named


def test_a_table_is_asked_for_names(flight):
    table = mavwire.read(flight, "HEARTBEAT")["HEARTBEAT"]
    with pytest.raises(TypeError, match="by its name"):
        table[0]
    assert table.select([]).to_pandas().shape == (len(table), 0)


def test_batches_are_the_whole(flight):
    whole = mavwire.read(flight)
    parts: dict[str, list[mavwire.logs.Table]] = {}
    for batch in mavwire.scan([flight, flight], batch_rows=100):
        parts.setdefault(batch.name, []).append(batch)
    assert parts.keys() == whole.keys()
    for name, table in whole.items():
        for column in table.columns:
            joined = np.concatenate([batch[column] for batch in parts[name]])
            assert joined.tolist() == 2 * table[column].tolist()


def test_a_raw_stream_has_the_times_that_its_messages_carry(flight, tmp_path):
    messages = list(mavwire.open_log(flight))
    path = tmp_path / "flight.raw"
    path.write_bytes(b"".join(msg.get_msgbuf() for msg in messages))
    tables = mavwire.read(path)
    expected = mavwire.read(flight)
    assert tables.keys() == expected.keys()
    clock, times = np.datetime64("NaT"), {name: [] for name in tables}
    for msg in messages:
        if getattr(msg, "time_boot_ms", 0):
            clock = np.datetime64(msg.time_boot_ms * 1000, "us")
        times[msg.get_type()].append(clock)
    for name, table in tables.items():
        np.testing.assert_array_equal(table["timestamp"], np.array(times[name]))
        assert table["seq"].tolist() == expected[name]["seq"].tolist()
    assert not mavwire.open_log(path).info().stamped
    # In blocks, as in one.
    parts = [table["timestamp"] for table in mavwire.scan(path, "HEARTBEAT", batch_rows=7)]
    np.testing.assert_array_equal(np.concatenate(parts), np.array(times["HEARTBEAT"]))


def test_compressed_logs(flight, tmp_path):
    path = tmp_path / "flight.tlog.gz"
    packed = gzip.compress(flight.read_bytes())
    path.write_bytes(packed)
    expected = mavwire.read(flight)["ATTITUDE"]["roll"]
    assert (mavwire.read(path)["ATTITUDE"]["roll"] == expected).all()
    assert (mavwire.open_log(path)["ATTITUDE"]["roll"] == expected).all()
    with pytest.raises(ValueError, match="compressed"):
        next(iter(mavwire.open_log(path)))
    path.write_bytes(packed[: len(packed) // 2])
    found = mavwire.read(path)["ATTITUDE"]["roll"]
    assert 0 < len(found) < len(expected)
    assert (found == expected[: len(found)]).all()
    assert mavwire.open_log(path).info().damage


@pytest.mark.parametrize("behind", [b"junk" * 3, bytes(20_000)])
def test_what_is_behind_a_gzip_file_costs_nothing(flight, tmp_path, behind):
    path = tmp_path / "flight.tlog.gz"
    path.write_bytes(gzip.compress(flight.read_bytes()) + behind)
    info = mavwire.open_log(path).info()
    assert info.damage == "invalid gzip header"
    assert info.messages == mavwire.open_log(flight).info().messages
    (row,) = convert([path], tmp_path / "out")
    assert (row.error, row.rows) == (info.damage, info.messages)


@pytest.mark.parametrize("cut_at", [2, 4, 7, 10, 11])
def test_a_gzip_file_cut_off_in_its_head_is_no_log(flight, tmp_path, cut_at):
    path = tmp_path / "flight.tlog.gz"
    path.write_bytes(gzip.compress(flight.read_bytes())[:cut_at])
    for read in (mavwire.open_log, mavwire.read, lambda log: list(mavwire.scan(log))):
        with pytest.raises(mavwire.logs.LogFormatError, match="a gzip file"):
            read(path)
    assert convert([path], tmp_path / "out")[0].error


def test_damage_costs_no_intact_record(flight, tmp_path):
    random = Random(7)
    original = flight.read_bytes()[:200_000]
    path = tmp_path / "damaged.tlog"
    for _ in range(10):
        damaged = bytearray(original)
        for _ in range(random.randrange(1, 40)):
            at = random.randrange(len(damaged))
            if random.random() < 0.5:
                damaged[at] = random.choice([0xFD, 0xFE, random.randrange(256)])
            else:
                del damaged[at : at + random.randrange(1, 50)]
        path.write_bytes(damaged)
        compare_with_messages(path)


def test_every_cut_of_a_small_log(tmp_path):
    whole = b"".join(statustext(b"text %d" % n, n) for n in range(5))
    ends = [len(b"".join(statustext(b"text %d" % n, n) for n in range(k))) for k in range(6)]
    path = tmp_path / "cut.tlog"
    for cut in range(len(whole) + 1):
        path.write_bytes(whole[:cut])
        tables = mavwire.read(path)
        found = len(tables["STATUSTEXT"]) if tables else 0
        assert found == sum(end <= cut for end in ends[1:]), cut


def test_pickling_and_joining(flight):
    table = mavwire.read(flight, "STATUSTEXT")["STATUSTEXT"]
    again = pickle.loads(pickle.dumps(table))
    assert (again.name, again.columns) == (table.name, table.columns)
    assert again["text"].tolist() == table["text"].tolist()
    assert again.metadata == table.metadata


def test_imports_stay_light():
    code = "import sys, mavwire.mavutil; print([m for m in ('numpy', 'pyarrow', 'polars') if m in sys.modules])"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == "[]"


@pytest.fixture
def raw(flight, tmp_path):
    """The frames of a flight without their times, with damage in between."""
    frames = [bytes(msg.get_msgbuf()) for msg in mavwire.open_log(flight)]
    path = tmp_path / "flight.raw"
    path.write_bytes(b"".join([*frames[:100], b"\xfd damage", *frames[100:]]))
    return path


@pytest.mark.parametrize("resync", ["rescan", "skip"])
def test_messages_of_a_raw_stream(flight, raw, resync):
    log = mavwire.open_log(raw, resync=resync)
    frames = [bytes(msg.get_msgbuf()) for msg in mavwire.open_log(flight)]
    messages = list(log)
    found = [bytes(msg.get_msgbuf()) for msg in messages if msg.get_type() != "BAD_DATA"]
    assert found == frames if resync == "rescan" else set(found) <= set(frames)
    assert len(found) > len(frames) - 50
    assert len(log) == len(messages)
    if resync == "rescan":
        assert log.info().messages == len(log)
        assert compare_times(messages, log.read()) == len(log)


def compare_times(messages, tables):
    rows = dict.fromkeys(tables, 0)
    for msg in messages:
        kind = msg.get_type()
        assert tables[kind]["seq"][rows[kind]] == msg.get_seq()
        stamp = tables[kind]["timestamp"][rows[kind]]
        assert msg._timestamp == (0.0 if np.isnat(stamp) else int(stamp.astype("int64")) * 1e-6)
        rows[kind] += 1
    assert rows == {name: len(table) for name, table in tables.items()}
    return sum(rows.values())


@pytest.mark.parametrize("span", [{"start": 4e9}, {"end": 5e9}, {"start": 4e9, "end": 5e9}])
def test_times_of_what_has_none(raw, tmp_path, span):
    for read in (mavwire.read, lambda path, **span: list(mavwire.scan(path, **span))):
        with pytest.raises(ValueError, match="no time stamps"):
            read(raw, **span)
    with pytest.raises(ValueError, match="no time stamps"):
        list(mavwire.open_log(raw).messages(**span))
    (row,) = convert([raw], tmp_path / "out", **span)
    assert "no time stamps" in str(row.error) and not row.files


def test_a_filter_by_time_finds_nothing_in_a_raw_stream(raw):
    pl = pytest.importorskip("polars")
    lazy = mavwire.scan_polars(raw, "ATTITUDE")
    assert len(lazy.collect()) > 0
    late = pl.datetime(2020, 1, 1, time_zone="UTC")
    assert len(lazy.filter(pl.col("timestamp") >= late).collect()) == 0


@pytest.mark.parametrize("span", [{"start": float("nan")}, {"end": float("nan")}])
def test_no_number_is_no_time(flight, span):
    with pytest.raises(ValueError, match="nan"):
        mavwire.read(flight, **span)
    with pytest.raises(ValueError, match="nan"):
        mavwire.open_log(flight).messages(**span)
