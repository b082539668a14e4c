"""Several types on one clock, and what is in a log."""

from __future__ import annotations

import json
from datetime import timedelta
from typing import Any

import mavwire
import numpy as np
import pytest
from mavwire import traffic
from mavwire.dialects.v20 import all as mavlink
from mavwire.logs.align import align
from mavwire.logs.rewriting import merge
from unit.link_tools import T0, heartbeat, pack, record

STEP = 100_000


def attitude(seq: int, roll: float) -> bytes:
    return pack(mavlink.MAVLink_attitude_message(seq, roll, 0, 0, 0, 0, 0), seq)


@pytest.fixture
def log(tmp_path):
    """ATTITUDE every 100 ms with roll = n, and HEARTBEAT every 250 ms, custom_mode unset."""
    records = [(T0 + STEP * n, attitude(n, float(n))) for n in range(10)]
    records += [(T0 + 250_000 * n, heartbeat(n)) for n in range(4)]
    path = tmp_path / "small.tlog"
    path.write_bytes(b"".join(record(frame, time) for time, frame in sorted(records)))
    return mavwire.open_log(path)


def test_nothing_lies_between_two_modes(tmp_path):
    path = tmp_path / "modes.tlog"
    beats = [mavlink.MAVLink_heartbeat_message(2, 3, mode, mode // 8, 4, 3) for mode in (81, 209)]
    frames = [pack(beats[0]), attitude(1, 0.0), pack(beats[1]), attitude(2, 1.0)]
    path.write_bytes(b"".join(record(one, T0 + STEP * n) for n, one in enumerate(frames)))
    log = mavwire.open_log(path)
    table = log.align(["HEARTBEAT", "ATTITUDE"], rate="25ms", method="linear")
    for name in ("base_mode", "custom_mode", "system_status"):
        column = table[f"HEARTBEAT.{name}"]
        assert set(column) == set(log["HEARTBEAT"][name]), name
        assert column.dtype == log["HEARTBEAT"][name].dtype, name
    assert 0.5 in table["ATTITUDE.roll"]


def test_on_the_clock_of_a_type(log):
    table = log.align(["ATTITUDE", "HEARTBEAT"], on="HEARTBEAT")
    assert table.columns[:2] == ["timestamp", "ATTITUDE.time_boot_ms"]
    assert not [c for c in table.columns if c.endswith((".seq", ".sysid", ".timestamp"))]
    assert table["ATTITUDE.roll"].tolist() == [0, 2, 5, 7]
    nearest = log.align(["ATTITUDE"], on="HEARTBEAT", method="nearest")
    assert nearest["ATTITUDE.roll"].tolist() == [0, 2, 5, 7], "the earlier of two as close"
    linear = log.align(["ATTITUDE"], on="HEARTBEAT", method="linear")
    assert linear["ATTITUDE.roll"].tolist() == [0, 2.5, 5, 7.5]
    assert linear["ATTITUDE.roll"].dtype == np.float64


def test_at_a_rate_and_with_a_tolerance(log):
    table = log.align(["HEARTBEAT"], rate="50ms", tolerance="100ms")
    times = (table["timestamp"].astype("int64") - T0).tolist()
    assert times == list(range(0, 750_001, 50_000))
    valid = ~np.isnan(table["HEARTBEAT.type"])
    assert [t for t, ok in zip(times, valid, strict=True) if not ok] == [
        150_000, 200_000, 400_000, 450_000, 650_000, 700_000,
    ]  # fmt: skip
    assert len(log.align(["HEARTBEAT"], rate=0.05)) == 16


@pytest.mark.parametrize(
    ("how", "said"),
    [
        ({}, "either"),
        ({"on": "ATTITUDE", "rate": "1s"}, "either"),
        ({"rate": "soon"}, "rate"),
        ({"rate": "0s"}, "rate"),
        ({"rate": "-1s"}, "rate"),
        ({"on": "ATTITUDE", "method": "guess"}, "method"),
        ({"on": "ATTITUDE", "tolerance": "x"}, "tolerance"),
        ({"on": "NOPE"}, "NOPE"),
    ],
)
def test_senseless_arguments_are_named(log, how, said):
    with pytest.raises(ValueError, match=said):
        log.align(["ATTITUDE"], **how)


def test_rows_of_one_time_are_one_tick(tmp_path):
    path = tmp_path / "twice.tlog"
    path.write_bytes(
        b"".join(record(attitude(n, n), T0 + STEP * time) for n, time in enumerate([0, 1, 1, 2]))
    )
    table = mavwire.open_log(path).align(["ATTITUDE"], on="ATTITUDE")
    assert table["ATTITUDE.roll"].tolist() == [0, 2, 3], "the last of those at one time"


def test_a_clock_that_would_fill_the_memory_is_refused(tmp_path):
    path = tmp_path / "long.tlog"
    path.write_bytes(record(heartbeat(0), T0) + record(heartbeat(1), T0 + 10**15))
    with pytest.raises(ValueError, match="ticks"):
        mavwire.open_log(path).align(["HEARTBEAT"], rate="1us")


def test_a_table_that_would_fill_the_memory_is_refused(tmp_path):
    path = tmp_path / "wide.tlog"
    battery = mavlink.MAVLink_battery_status_message(0, 0, 0, 0, [0] * 10, 0, 0, 0, 0)
    path.write_bytes(record(pack(battery, 0), T0) + record(pack(battery, 1), T0 + 100_000_000))
    log = mavwire.open_log(path)
    with pytest.raises(ValueError, match="^a clock of 100000001 ticks with 27 values"):
        log.align(["BATTERY_STATUS"], rate="1us")
    assert len(log.align(["BATTERY_STATUS"], rate="100us")) == 1_000_001


def test_wide_takes_rows_of_one_component(tmp_path):
    """Batteries of the autopilot and of a companion may have one number."""
    path = tmp_path / "two.tlog"
    records = []
    for n in range(6):
        compid = (1, 180)[n % 2]
        mav = mavlink.MAVLink(None, 1, compid)
        voltages = [11_000] * 10
        msg = mavlink.MAVLink_battery_status_message(0, 0, 0, 0, voltages, compid, 0, 0, 50)
        records.append(record(msg.pack(mav), T0 + 1000 * n))
    path.write_bytes(b"".join(records))
    table = mavwire.open_log(path)["BATTERY_STATUS"]
    for several in (table.wide, lambda: mavwire.read(path, systems=1, wide=True)):
        with pytest.raises(ValueError, match=r"1/1, 1/180.*table\.sender\(1, 1\)\.wide\(\)"):
            several()
    wide = table.sender(1, 180).wide()
    assert wide["BATTERY_STATUS[0].current_battery"].tolist() == [180] * 3
    assert len(table.select(["timestamp", "id", "current_battery"]).wide()) == 6, "nobody can tell"


@pytest.mark.parametrize("suffix", ["csv", "jsonl"])
def test_times_in_texts_have_as_many_digits(tmp_path, suffix):
    pd = pytest.importorskip("pandas")
    path, out = tmp_path / "flight.tlog", tmp_path / f"out.{suffix}"
    times = [T0 - T0 % 1_000_000 + after for after in (0, 62_500, 500_000)]
    path.write_bytes(b"".join(record(heartbeat(n), time) for n, time in enumerate(times)))
    table = mavwire.open_log(path)["HEARTBEAT"]
    table.write(out)
    found = pd.read_csv(out) if suffix == "csv" else pd.DataFrame(map(json.loads, out.open()))
    assert {len(text) for text in found["timestamp"]} == {len("2024-01-31T12:00:00.000000Z")}
    read = pd.to_datetime(found["timestamp"], utc=True)
    np.testing.assert_array_equal(
        read.dt.tz_localize(None).to_numpy().astype("datetime64[us]"), table["timestamp"]
    )


def test_info_counts_what_the_messages_say(tmp_path):
    path = tmp_path / "flight.tlog"
    traffic.generate(path, 5_000, systems=2, loss=0.02, corruption=0.01)
    log = mavwire.open_log(path)
    info = log.info()
    messages = list(log)
    assert info.messages == len(messages) == sum(c.messages for c in info.types.values())
    kinds = [msg.get_type() for msg in messages]
    assert {n: c.messages for n, c in info.types.items()} == {k: kinds.count(k) for k in {*kinds}}
    senders = [(msg.get_srcSystem(), msg.get_srcComponent()) for msg in messages]
    assert {ids: s.count.messages for ids, s in info.senders.items()} == {
        ids: senders.count(ids) for ids in {*senders}
    }
    assert info.lost > 50
    assert info.bad_bytes == info.bytes - sum(8 + len(msg.get_msgbuf()) for msg in messages) > 0
    assert sum(length for _, length in info.bad) == info.bad_bytes
    content = path.read_bytes()
    assert info.bytes == len(content)
    assert (info.count.first, info.count.last) == (messages[0]._timestamp, messages[-1]._timestamp)
    assert info.version2 == info.messages and info.signed_share == 0


def test_info_finds_gaps_reboots_and_versions(tmp_path):
    frames = [attitude(0, 0), attitude(1, 0), heartbeat(2, v1=True)]
    boot = [60_000, 61_000, 500]
    frames += [pack(mavlink.MAVLink_system_time_message(0, ms), 3 + n) for n, ms in enumerate(boot)]
    times = [0, 1, 2, 30, 31, 20]
    path = tmp_path / "odd.tlog"
    path.write_bytes(
        b"".join(record(f, T0 + 1_000_000 * t) for f, t in zip(frames, times, strict=True))
    )
    info = mavwire.open_log(path).info()
    assert info.gap_count == 1 and info.gaps[0][1] - info.gaps[0][0] == pytest.approx(28)
    assert info.times_back == 1
    assert info.senders[1, 1].reboots == 1
    assert (info.version1, info.version2) == (1, 5)


@pytest.mark.parametrize(("back", "reboots"), [(4_999, 0), (5_000, 0), (5_001, 1)])
def test_messages_that_overtake_each_other_are_no_reboot(tmp_path, back, reboots):
    path = tmp_path / "odd.tlog"
    clock = (10_000, 10_000 - back, 11_000)
    frames = [pack(mavlink.MAVLink_system_time_message(0, ms), seq) for seq, ms in enumerate(clock)]
    path.write_bytes(b"".join(map(record, frames)))
    assert mavwire.open_log(path).info().senders[1, 1].reboots == reboots


def test_a_clock_that_some_messages_leave_empty_is_no_reboot(tmp_path):
    path = tmp_path / "odd.tlog"
    empty = mavlink.MAVLink_attitude_message(0, 0, 0, 0, 0, 0, 0)
    frames = [
        pack(one, 0)
        for ms in (10_000, 20_000, 30_000, 500)
        for one in (mavlink.MAVLink_system_time_message(0, ms), empty)
    ]
    path.write_bytes(b"".join(map(record, frames)))
    assert mavwire.open_log(path).info().senders[1, 1].reboots == 1


def test_a_span_of_time_and_names_of_enums(tmp_path):
    path = tmp_path / "flight.tlog"
    traffic.generate(path, 2000)
    log = mavwire.open_log(path)
    whole = log.align(["HEARTBEAT", "ATTITUDE"], on="ATTITUDE", systems=1)
    first, last = whole["timestamp"][20], whole["timestamp"][40]
    some = log.align(["ATTITUDE"], on="ATTITUDE", start=first, end=last)
    assert some["ATTITUDE.roll"].tolist() == whole["ATTITUDE.roll"][20:40].tolist()
    named = log.align(["HEARTBEAT"], on="HEARTBEAT", enums="names", systems=1)
    assert str(named["HEARTBEAT.autopilot"][0]).startswith("MAV_AUTOPILOT_")


def test_an_aligned_table_has_no_instances_of_its_own(tmp_path):
    path = tmp_path / "flight.tlog"
    traffic.generate(path, 2000)
    log = mavwire.open_log(path)
    table = log.align(["BATTERY_STATUS"], rate="1s")
    assert log["BATTERY_STATUS"].instance_field == "id"
    assert table.instance_field is None and table.wide() is table


def gps(lat: int) -> Any:
    return mavlink.MAVLink_gps_raw_int_message(0, 3, lat, 0, 0, 0, 0, 0, 0, 9)


def test_senders_are_not_mixed(tmp_path):
    path = tmp_path / "two.tlog"
    path.write_bytes(
        b"".join(
            record(
                pack(gps((10 if sysid == 1 else -50) * 10_000_000), n, sysid, compid),
                T0 + STEP * at,
            )
            for at, (n, sysid, compid) in enumerate(
                [(0, 1, 1), (0, 2, 1), (1, 1, 1), (1, 2, 1), (0, 2, 7)]
            )
        )
    )
    log = mavwire.open_log(path)
    for how in ({"on": "GPS_RAW_INT"}, {"rate": "50ms"}, {"rate": "50ms", "systems": 2}):
        with pytest.raises(ValueError, match=r"several senders .*2/7.*systems="):
            log.align(["GPS_RAW_INT"], **how)
    one = log.align(["GPS_RAW_INT"], rate="50ms", method="linear", systems=1)
    assert set(one["GPS_RAW_INT.lat"]) == {100_000_000}
    table = log["GPS_RAW_INT"]
    assert [len(table.sender(*who)) for who in ((1,), (2,), (2, 7), (9,))] == [2, 3, 1, 0]
    tables = {"GPS_RAW_INT": table.sender(2, 1)}
    assert set(align(tables, rate="50ms")["GPS_RAW_INT.lat"]) == {-500_000_000}


def test_the_clock_is_of_one_sender(tmp_path):
    path = tmp_path / "clock.tlog"
    frames = [heartbeat(0), heartbeat(0, sysid=255), pack(gps(1), 1)]
    path.write_bytes(b"".join(record(one, T0 + STEP * n) for n, one in enumerate(frames)))
    with pytest.raises(ValueError, match="HEARTBEAT comes from several senders"):
        mavwire.open_log(path).align(["GPS_RAW_INT"], on="HEARTBEAT")


def test_instances_are_aligned_each_by_itself(tmp_path):
    path = tmp_path / "batteries.tlog"

    def battery(number: int, current: int) -> Any:
        return mavlink.MAVLink_battery_status_message(number, 0, 0, 0, [0] * 10, current, 0, 0, 0)

    messages = [battery(0, 100), battery(1, 900), battery(0, 300), battery(1, 1100)]
    path.write_bytes(b"".join(record(pack(m, n), T0 + STEP * n) for n, m in enumerate(messages)))
    table = mavwire.open_log(path).align(["BATTERY_STATUS"], rate="100ms", method="linear")
    first, second = (table[f"BATTERY_STATUS[{n}].current_battery"] for n in (0, 1))
    assert first[:3].tolist() == [100, 200, 300] and np.isnan(first[3])
    assert np.isnan(second[0]) and second[1:].tolist() == [900, 1000, 1100]
    assert not [name for name in table.columns if name.endswith(".id")]


def test_instances_are_told_apart_whatever_fields_are_wanted(tmp_path):
    path = tmp_path / "batteries.tlog"

    def battery(number: int, current: int) -> bytes:
        values = (number, 0, 0, 0, [0] * 10, current, 0, 0, 0)
        return pack(mavlink.MAVLink_battery_status_message(*values), number)

    frames = [battery(number, 100 * (number + 1) + n) for n in range(3) for number in (0, 1)]
    times = [T0 + STEP * (n // 2) for n in range(len(frames))]
    path.write_bytes(b"".join(map(record, frames, times)))
    log, field = mavwire.open_log(path), "current_battery"
    columns = ["timestamp", *(f"BATTERY_STATUS[{n}].{field}" for n in (0, 1))]
    for table in (
        log.align("BATTERY_STATUS", rate="100ms", fields=field),
        log.read("BATTERY_STATUS", fields=field, wide=True)["BATTERY_STATUS"],
        mavwire.read(path, fields=iter([field]), wide=True)["BATTERY_STATUS"],
    ):
        assert table.columns == columns
        assert [table[name].tolist() for name in columns[1:]] == [[100, 101, 102], [200, 201, 202]]
    asked = log.align("BATTERY_STATUS", rate="100ms", fields=iter(["id", field]))
    assert asked.columns == columns
    for refused in (log.align, log.read):
        how: dict[str, Any] = {"rate": "1s"} if refused == log.align else {"wide": True}
        with pytest.raises(ValueError, match="no wanted .* has a field 'curent'"):
            refused("BATTERY_STATUS", fields="curent", **how)
    path.write_bytes(b"".join(record(battery(0, n), T0 + STEP * n) for n in range(3)))
    alone = mavwire.open_log(path)
    assert alone.align("BATTERY_STATUS", rate="100ms", fields=field).columns == [
        "timestamp", f"BATTERY_STATUS.{field}",
    ]  # fmt: skip


def test_rows_without_times_are_refused(log, tmp_path):
    """As of a raw stream in which nothing tells a time."""
    path = tmp_path / "flight.raw"
    frames = [(msg.get_type(), bytes(msg.get_msgbuf())) for msg in log]
    path.write_bytes(b"".join(frame for kind, frame in frames if kind == "HEARTBEAT"))
    for how in ({"on": "HEARTBEAT"}, {"rate": "50ms"}):
        with pytest.raises(ValueError, match="^the rows of .* have no times"):
            mavwire.open_log(path).align(["HEARTBEAT"], **how)
    path.write_bytes(b"".join(frame for _, frame in frames))
    assert len(mavwire.open_log(path).align(["ATTITUDE"], on="HEARTBEAT"))


def test_what_two_links_heard_is_no_loss(tmp_path):
    path, twice = tmp_path / "flight.tlog", tmp_path / "twice.tlog"
    traffic.generate(path, 5_000, systems=2, loss=0.02)
    merge([path, path], twice)
    once, info = mavwire.open_log(path).info(), mavwire.open_log(twice).info()
    assert once.lost > 50 and once.repeated == 0
    assert (info.lost, info.repeated, info.messages) == (once.lost, 5_000, 10_000)
    assert {ids: one.loss for ids, one in info.senders.items()} == {
        ids: one.loss for ids, one in once.senders.items()
    }


def test_a_swapped_pair_is_no_loss(tmp_path):
    path = tmp_path / "swapped.tlog"
    numbers = [0, 1, 3, 2, 4, 6, 7]
    path.write_bytes(b"".join(record(heartbeat(n), T0 + at) for at, n in enumerate(numbers)))
    info = mavwire.open_log(path).info()
    assert (info.lost, info.repeated) == (1, 0)


def test_spans_of_time_in_other_words(log):
    expected = log.align(["ATTITUDE"], rate="50ms", tolerance=0.02)
    for span in (timedelta, lambda milliseconds: np.timedelta64(milliseconds, "ms")):
        rate, tolerance = span(milliseconds=50), span(milliseconds=20)
        found = log.align(["ATTITUDE"], rate=rate, tolerance=tolerance)
        assert found.to_arrow().equals(expected.to_arrow())
    for wrong in (timedelta(seconds=-1), np.timedelta64("NaT"), "soon"):
        with pytest.raises(ValueError, match="a span of time"):
            log.align(["ATTITUDE"], rate=wrong)


@pytest.mark.parametrize(("method", "expected"), [("nearest", 2.0), ("linear", 1.0)])
def test_of_later_rows_of_one_time_the_last_counts(tmp_path, method, expected):
    path = tmp_path / "twice.tlog"
    rolls = [(8, 0.0), (12, 1.0), (12, 2.0)]
    records = [record(heartbeat(), T0 + 10 + (method == "nearest"))]
    records += [record(attitude(n, roll), T0 + at) for n, (at, roll) in enumerate(rolls)]
    path.write_bytes(b"".join(records))
    table = mavwire.open_log(path).align(["ATTITUDE"], on="HEARTBEAT", method=method)
    assert table["ATTITUDE.roll"].tolist() == [expected]
