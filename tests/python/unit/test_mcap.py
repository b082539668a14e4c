"""MCAP files hold what the columns hold, as the reader of the format's makers finds it."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import mavwire
import numpy as np
import pytest
from dataflash_writer import Log, sample
from mavwire import cli, traffic
from mavwire.dialects import _descriptions
from mavwire.dialects.v20 import all as mavlink
from mavwire.logs.conversion import convert
from unit.column_tools import log_of_every_type
from unit.link_tools import T0, heartbeat, pack, record
from unit.mcap_tools import message_class, messages

make_reader = pytest.importorskip("mcap.reader").make_reader
descriptor_pb2 = pytest.importorskip("google.protobuf.descriptor_pb2")

FORMATS = ("mcap", "mcap-json")
EXTRA = ("location", "log")


@pytest.fixture(scope="module")
def flight(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("logs") / "flight.tlog"
    traffic.generate(path, 5_000, systems=2)
    return path


def converted(log: Path | str, out: Path, format: str = "mcap-json", **options: Any) -> Path:
    """The MCAP file of a log, whose row in the manifest says the same."""
    (row,) = convert([log], out, format=format, **options)
    assert row.error is None
    (name,) = row.files
    assert row.files == {f"{row.name}.mcap": row.rows}
    return out / name


def summary(path: Path) -> Any:
    with path.open("rb") as file:
        return make_reader(file).get_summary()


def expected(value: Any, text_column: bool = False) -> Any:
    """What JSON makes of a value of a column."""
    if isinstance(value, np.ndarray):
        return [expected(one) for one in value]
    if isinstance(value, np.floating):
        return float(value) if np.isfinite(value) else None
    if isinstance(value, bytes):
        return value.hex()
    return value.item() if isinstance(value, np.generic) else value


def same(found: Any, value: Any, dtype: Any) -> bool:
    """Whether a value of JSON is that of a column: the same number of its type."""
    if isinstance(found, list):
        return len(found) == len(value) and all(map(same, found, value, [dtype] * len(value)))
    if isinstance(found, float | int) and dtype.kind == "f":
        return bool(dtype.type(found) == value)
    return bool(found == expected(value))


def compare(path: Path, log: Path | str, **options: Any) -> int:
    """Assert that a file holds the columns of a telemetry log; how many messages that are."""
    found = {t: rows for t, rows in messages(path).items() if t.split("/")[-1] not in EXTRA}
    count = 0
    for name, table in mavwire.read(log, invalid="null", **options).items():
        senders = list(zip(table["sysid"].tolist(), table["compid"].tolist(), strict=True))
        order = np.argsort(table["timestamp"], kind="stable")
        iterators = {
            s: iter(sorted(found.pop("/{}/{}/{}".format(*s, name)), key=lambda one: one[0]))
            for s in set(senders)
        }
        for row in order.tolist():
            time, sequence, content = next(iterators[senders[row]])
            assert time == int(table["timestamp"][row].astype("int64")) * 1000
            assert sequence == table["seq"][row]
            for column in table.columns[4:]:
                value = table[column][row]
                if value is None or (isinstance(value, np.floating) and np.isnan(value)):
                    assert content.pop(column, None) is None
                    continue
                dtype = table[column].dtype
                assert same(content.pop(column), value, dtype), (name, column, row)
            assert not [key for key in content if not key.endswith("_raw")]
        assert all(next(one, None) is None for one in iterators.values())
        count += len(order)
    assert not found
    return count


@pytest.mark.parametrize("format", FORMATS)
def test_every_type_is_what_the_columns_say(tmp_path, format):
    log = tmp_path / "all.tlog"
    log_of_every_type(log, each=2)
    path = converted(log, tmp_path / "out", format)
    assert compare(path, log) == 2 * len(mavlink.mavlink_map)


@pytest.mark.parametrize("compression", ["zstd", "lz4", "none"])
@pytest.mark.parametrize("format", FORMATS)
def test_a_flight_of_two_vehicles(flight, tmp_path, format, compression):
    path = converted(flight, tmp_path, format, compression=compression)
    assert compare(path, flight) == 5_000
    found = summary(path)
    assert found.statistics.message_count >= 5_000
    assert found.statistics.chunk_count == len(found.chunk_indexes) > 0
    kinds = {index.compression for index in found.chunk_indexes}
    assert kinds == {"" if compression == "none" else compression}
    assert found.statistics.channel_count == len(found.channels)
    times = [table["timestamp"].astype("int64") for table in mavwire.read(flight).values()]
    span = found.statistics.message_start_time, found.statistics.message_end_time
    assert span == (min(map(min, times)) * 1000, max(map(max, times)) * 1000)


def test_types_systems_and_times_are_chosen(flight, tmp_path):
    times = mavwire.read(flight, "ATTITUDE")["ATTITUDE"]["timestamp"].astype("int64")
    chosen = {"types": ["ATTITUDE"], "systems": 2, "start": float(times.mean()) * 1e-6}
    path = converted(flight, tmp_path, **chosen)
    assert list(messages(path)) == ["/2/1/ATTITUDE"]
    assert 0 < compare(path, flight, **chosen) < 2_500


def test_a_log_of_many_blocks_is_sorted_within_them(flight, tmp_path):
    """Two blocks and a bit; also the message index, by which readers pick a topic and a time."""
    log = tmp_path / "large.tlog"
    piece = flight.read_bytes()
    log.write_bytes(piece * ((17 << 20) // len(piece)))
    types = ["HEARTBEAT", "SYS_STATUS"]
    path = converted(log, tmp_path / "out", types=types)
    assert compare(path, log, types=types) > 1_000
    with path.open("rb") as file:
        times = [one.log_time for *_, one in make_reader(file).iter_messages("/1/1/HEARTBEAT")]
    assert times == sorted(times)


@pytest.fixture
def no_descriptions(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder of stored definitions, which is not there; no others are either."""
    monkeypatch.setattr(_descriptions, "installed_folder", lambda: None)
    monkeypatch.delenv("MDEF", raising=False)
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    return tmp_path / "mavwire" / "definitions" / "1"


def test_schemas_have_stored_descriptions(flight, tmp_path, no_descriptions):
    no_descriptions.mkdir(parents=True)
    text = '<message id="30" name="ATTITUDE"><description>{}</description>{}</message>'
    field = '<field type="float" name="roll">How far it leans.</field>'
    message = text.format("Where it points.", field)
    (no_descriptions / "a.xml").write_text(f"<mavlink><messages>{message}</messages></mavlink>")
    found = summary(converted(flight, tmp_path / "out", types="ATTITUDE"))
    (schema,) = (json.loads(schema.data) for schema in found.schemas.values())
    assert schema["description"] == "Where it points."
    assert schema["properties"]["roll"]["description"] == "How far it leans. (rad)"
    assert schema["properties"]["pitch"]["description"] == "rad"


@pytest.mark.usefixtures("no_descriptions")
def test_schemas_name_types_units_and_enums(flight, tmp_path):
    found = summary(converted(flight, tmp_path))
    schemas = {schema.name: json.loads(schema.data) for schema in found.schemas.values()}
    position = schemas["GLOBAL_POSITION_INT"]["properties"]
    assert position["lat"] == {"type": "integer", "description": "degE7"}
    assert list(position)[:3] == ["time_boot_ms", "lat", "lon"], "in the order of the definition"
    battery = schemas["BATTERY_STATUS"]["properties"]
    assert battery["voltages"]["type"] == "array"
    assert battery["voltages"]["items"] == {"type": "integer"}
    assert schemas["HEARTBEAT"]["properties"]["type"]["description"] == "one of MAV_TYPE"
    assert schemas["ATTITUDE"]["properties"]["roll"] == {"type": "number", "description": "rad"}
    assert schemas["STATUSTEXT"]["properties"]["text"] == {"type": "string"}
    channels = {channel.topic: channel.metadata for channel in found.channels.values()}
    assert channels["/2/1/ATTITUDE"] == {"message": "ATTITUDE", "sysid": "2", "compid": "1"}


def test_protobuf_tells_what_is_invalid_from_0(tmp_path):
    log = tmp_path / "a.tlog"
    battery = mavlink.MAVLink_battery_status_message(0, 0, 0, 32767, [0, 65535] * 5, -1, -1, -1, -1)
    log.write_bytes(record(pack(battery)))
    path = converted(log, tmp_path / "out", "mcap")
    (schema,) = summary(path).schemas.values()
    with path.open("rb") as file:
        ((*_, one),) = make_reader(file).iter_messages()
    message = message_class(schema.name, schema.data).FromString(one.data)
    assert not message.HasField("temperature") and not message.HasField("current_battery")
    assert message.HasField("id") and message.id == 0
    assert str(list(message.voltages)) == str([0.0, math.nan] * 5)


def test_names_that_protobuf_does_not_take(tmp_path):
    log = Log().define("AB-C", "QIii", "TimeUS,1st,a b,a_b").add("AB-C", 1_000_000, 1, -2, 3)
    path = converted(log.write(tmp_path / "1.BIN"), tmp_path / "out", "mcap")
    assert [content for *_, content in messages(path)["/AB-C"]] == [
        {"TimeUS": 1_000_000, "_1st": 1, "a_b": -2, "a_b_": 3}
    ]


@pytest.mark.usefixtures("no_descriptions")
def test_comments_of_protobuf_have_units_and_enums(flight, tmp_path):
    found = summary(converted(flight, tmp_path, "mcap", types=["HEARTBEAT", "ATTITUDE"]))
    comments = {}
    for schema in found.schemas.values():
        (file,) = descriptor_pb2.FileDescriptorSet.FromString(schema.data).file
        (message,) = file.message_type
        for location in file.source_code_info.location:
            for at in location.path[3:]:
                comments[f"{message.name}.{message.field[at].name}"] = location.leading_comments
    assert comments["HEARTBEAT.type"] == "one of MAV_TYPE"
    assert comments["ATTITUDE.roll"] == "rad"


def test_numbers_that_json_does_not_have_are_null(tmp_path):
    log = tmp_path / "a.tlog"
    values = [math.nan, math.inf, -math.inf, 0.1, 5e-324, -0.0]
    log.write_bytes(record(pack(mavlink.MAVLink_attitude_message(7, *values))))
    ((_, _, content),) = messages(converted(log, tmp_path / "out"))["/1/1/ATTITUDE"]
    assert [content[name] for name in ("roll", "pitch", "yaw")] == [None, None, None]
    assert np.float32(content["rollspeed"]) == np.float32(0.1)
    assert content["time_boot_ms"] == 7


def fix(fix_type: int, lat: int, lon: int) -> bytes:
    message = mavlink.MAVLink_gps_raw_int_message(0, fix_type, lat, lon, 123_456, 0, 0, 0, 0, 9)
    return pack(message)


def test_positions_are_on_the_map(tmp_path):
    log = tmp_path / "a.tlog"
    frames = [fix(3, 473_977_418, 85_455_939), fix(1, 473_977_418, 85_455_939), fix(3, 0, 0)]
    frames.append(fix(3, 910_000_000, 1))
    log.write_bytes(b"".join(record(one, T0 + n * 1_000_001) for n, one in enumerate(frames)))
    found = messages(converted(log, tmp_path / "out"))
    assert len(found["/1/1/GPS_RAW_INT"]) == 4
    ((time, _, content),) = found["/1/1/GPS_RAW_INT/location"]
    assert time == T0 * 1000
    assert (content["latitude"], content["longitude"], content["altitude"]) == (
        47.3977418, 8.5455939, 123.456,
    )  # fmt: skip
    assert content["timestamp"] == {"sec": T0 // 10**6, "nsec": T0 % 10**6 * 1000}
    assert content["position_covariance_type"] == 0 and len(content["position_covariance"]) == 9
    names = {schema.name for schema in summary(tmp_path / "out" / "a.mcap").schemas.values()}
    assert names == {"GPS_RAW_INT", "foxglove.LocationFix"}


def test_texts_are_in_the_log_panel(tmp_path):
    log = tmp_path / "a.tlog"
    hostile = b'"\\\n\x1b[31m</script>'
    texts = [mavlink.MAVLink_statustext_message(level, b"level %d" % level) for level in range(8)]
    texts.append(mavlink.MAVLink_statustext_message(200, hostile))
    log.write_bytes(b"".join(record(pack(one)) for one in texts))
    found = messages(converted(log, tmp_path / "out"))["/1/1/STATUSTEXT/log"]
    assert [content["level"] for *_, content in found] == [5, 5, 5, 4, 3, 2, 2, 1, 0]
    assert found[4][2]["message"] == "level 4"
    assert (found[4][2]["name"], found[4][2]["line"]) == ("1/1", 0)
    assert found[8][2]["message"].encode() == hostile


@pytest.mark.parametrize("format", FORMATS)
def test_dataflash_logs(tmp_path, format):
    log = sample().write(tmp_path / "00000001.BIN")
    path = converted(log, tmp_path / "out", format)
    found = messages(path)
    for name, table in mavwire.read(log).items():
        rows = found[f"/{name}"]
        assert len(rows) == len(table)
        for row, (time, sequence, content) in enumerate(rows):
            assert (time, sequence) == (int(table["timestamp"][row].astype("int64")) * 1000, 0)
            for column in table.columns[1:]:
                value, dtype = table[column][row], table[column].dtype
                assert same(content[column], value, dtype), (name, column)
    (channel,) = [c for c in summary(path).channels.values() if c.topic == "/IMU"]
    assert channel.metadata == {"message": "IMU"}


def test_positions_of_dataflash_logs(tmp_path):
    log = Log().define("GPS", "QBIHLLe", "TimeUS,Status,GMS,GWk,Lat,Lng,Alt")
    for status in (1, 3):
        log.add("GPS", 1_000_000, status, 1000, 2200, 473_977_418, 85_455_939, 12_345)
    found = messages(converted(log.write(tmp_path / "1.BIN"), tmp_path / "out"))
    ((_, _, content),) = found["/GPS/location"]
    assert (content["latitude"], content["longitude"], content["altitude"]) == (
        47.3977418, 8.5455939, 123.45,
    )  # fmt: skip


def test_a_log_without_times_is_a_row_with_an_error(tmp_path):
    stream, old = tmp_path / "stream.raw", tmp_path / "old.BIN"
    stream.write_bytes(heartbeat() * 50)
    Log().define("ABC", "I", "X").add("ABC", 1).write(old)
    for log in (stream, old):
        (row,) = convert([log], tmp_path / "out", format="mcap")
        assert "MCAP needs a time" in str(row.error)
        assert not row.files
    assert not list((tmp_path / "out").rglob("*.mcap*"))


def test_times_that_no_clock_has_are_the_last_there_is(tmp_path):
    log = tmp_path / "a.tlog"
    log.write_bytes(record(heartbeat(), 2**62) + record(heartbeat(), 2**62 + 4))
    found = messages(converted(log, tmp_path / "out"))["/1/1/HEARTBEAT"]
    assert [time for time, *_ in found] == [2**64 - 1] * 2


def test_more_senders_than_there_is_room_for(tmp_path):
    log = tmp_path / "a.tlog"
    beat, text = mavlink.MAVLink_heartbeat_message(2, 3, 81, 0, 4, 3), []
    for system in range(256):
        for component in range(0, 256, 1):
            text.append(record(beat.pack(mavlink.MAVLink(None, system, component))))
    ping = mavlink.MAVLink_system_time_message(1, 1)
    text.append(record(ping.pack(mavlink.MAVLink(None, 1, 1))))
    log.write_bytes(b"".join(text))
    (row,) = convert([log], tmp_path / "out", format="mcap")
    assert "room for 65535" in str(row.error) and not row.files
    assert not list((tmp_path / "out").glob("*.mcap*"))
    path = converted(log, tmp_path / "one", systems=1)
    assert len(summary(path).channels) == 257


def test_damage_and_compression_of_the_log(flight, tmp_path):
    import gzip

    damaged = tmp_path / "damaged.tlog.gz"
    content = flight.read_bytes()
    content = content[:50_000] + b"\xfd\x09 damage \xfe" * 20 + content[50_000:]
    damaged.write_bytes(gzip.compress(content))
    path = converted(damaged, tmp_path / "out")
    assert path.name == "damaged.mcap"
    assert compare(path, damaged) >= 4_999


def test_nothing_wanted_makes_no_file(flight, tmp_path):
    (row,) = convert([flight], tmp_path / "out", format="mcap", types="AUTH_KEY")
    assert (row.error, row.files, row.rows) == (None, {}, 0)


def test_a_second_run_does_what_is_missing(flight, tmp_path):
    out = tmp_path / "out"
    first = converted(flight, out)
    (row,) = convert([flight], out, format="mcap-json")
    assert row.skipped
    content = first.read_bytes()
    first.unlink()
    assert converted(flight, out).read_bytes() == content
    twin = tmp_path / "flight.tlog"
    twin.write_bytes(record(heartbeat()))
    rows = convert([flight, twin], out, format="mcap-json")
    assert [(row.name, row.skipped) for row in rows] == [("flight", True), ("flight-2", False)]


@pytest.mark.parametrize("compression", ["gzip", "snappy"])
def test_other_compressions_are_refused(flight, tmp_path, compression):
    with pytest.raises(ValueError, match="zstd, lz4, none"):
        convert([flight], tmp_path / "out", format="mcap", compression=compression)


def test_the_command(flight, tmp_path, capsys):
    argv = ["convert", str(flight), "-o", str(tmp_path / "out"), "--format", "mcap"]
    assert cli.main([*argv, "--types", "ATTITUDE", "--compression", "lz4"]) == 0
    assert "in 1 files" in capsys.readouterr().out
    assert compare(tmp_path / "out" / "flight.mcap", flight, types="ATTITUDE") > 100
