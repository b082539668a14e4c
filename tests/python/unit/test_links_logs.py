"""Telemetry logs: cut, empty, growing, misnamed or foreign files give what can be read."""

from __future__ import annotations

import gc
import os
import struct
import weakref

import pytest
from mavwire import mavutil
from mavwire.dialects.v20 import all as mavlink
from unit.link_tools import T0, drain, heartbeat, pack, record, types

BATTERY = mavlink.MAVLink_battery_status_message(1, 0, 0, 0, [7] * 10, 0, 0, 0, 50)
ATTITUDE = mavlink.MAVLink_attitude_message(1000, 0.5, 0, 0, 0, 0, 0)
RECORDS = [
    record(heartbeat(0)),
    record(pack(ATTITUDE, 1), T0 + 4),
    record(pack(BATTERY, 2), T0 + 8),
    record(heartbeat(3, v1=True), T0 + 12),
    record(pack(ATTITUDE, 4), T0 + 16),
]
LOG = b"".join(RECORDS)
NAMES = ["HEARTBEAT", "ATTITUDE", "BATTERY_STATUS", "HEARTBEAT", "ATTITUDE"]


pytestmark = pytest.mark.usefixtures("mavlink20")


def whole_records(cut: int) -> int:
    """How many records the first `cut` bytes of LOG hold."""
    count = 0
    for rec in RECORDS:
        cut -= len(rec)
        count += cut >= 0
    return count


@pytest.mark.parametrize("options", [{}, {"append": True}], ids=["indexed", "stream"])
def test_every_cut_gives_every_whole_record(tmp_path, options):
    """R67."""
    path = tmp_path / "cut.tlog"
    for cut in range(len(LOG) + 1):
        path.write_bytes(LOG[:cut])
        with mavutil.mavlink_connection(str(path), **options) as log:
            expected = NAMES[: whole_records(cut)]
            assert types(drain(log)) == expected, cut
            if not options:
                log.rewind()
                assert types(drain(log, type="ATTITUDE")) == [
                    name for name in expected if name == "ATTITUDE"
                ], cut


def test_empty_log_has_an_empty_index(tmp_path):
    path = tmp_path / "empty.tlog"
    path.touch()
    log = mavutil.mavlink_connection(str(path))
    assert (log.counts, log.offsets, log._count, log.recv_match()) == ({}, {}, 0, None)
    assert (log.recv_match(type="ATTITUDE"), log.flightmode_list()) == (None, [])
    log.close()


@pytest.mark.parametrize("junk", [b"\x00", b"\xfd" * 7, b"\xfe\x01\x02", b"text " * 40, bytes(999)])
def test_foreign_bytes_raise_nothing(tmp_path, junk):
    """R67."""
    path = tmp_path / "foreign.tlog"
    path.write_bytes(junk)
    for options in ({}, {"append": True}, {"notimestamps": True}):
        log = mavutil.mavlink_connection(str(path), **options)
        assert set(types(drain(log))) <= {"BAD_DATA"}
        log.close()


@pytest.mark.parametrize("step", [1, 3, 11, 40])
def test_growing_log_is_followed_without_a_loss(tmp_path, step):
    path = tmp_path / "live.tlog"
    path.touch()
    log = mavutil.mavlink_connection(str(path), append=True)
    seen = []
    with open(path, "ab", buffering=0) as writer:
        for start in range(0, len(LOG), step):
            writer.write(LOG[start : start + step])
            seen += drain(log)
    assert types(seen) == NAMES
    assert [round(m._timestamp * 1e6) - T0 for m in seen] == pytest.approx([0, 4, 8, 12, 16], abs=1)
    log.close()


@pytest.mark.parametrize(
    "name", ["a.bin", "a.log", "a.LOG", "a.px4log", "a.txt", "a", "17:40.tlog"]
)
def test_tlog_is_recognised_by_content(tmp_path, name):
    path = tmp_path / name
    path.write_bytes(LOG)
    with mavutil.mavlink_connection(str(path)) as log:
        assert type(log) is mavutil.mavmmaplog
        assert types(drain(log)) == NAMES


def test_rewind_and_type_changes(tmp_path):
    path = tmp_path / "a.tlog"
    path.write_bytes(LOG)
    log = mavutil.mavlink_connection(str(path))
    assert log.recv_match(type={"ATTITUDE"}).get_seq() == 1
    assert log.recv_match(type="BATTERY_STATUS") is None  # the types stay until rewind
    log.rewind()
    assert log.recv_match(type=("BATTERY_STATUS",)).get_seq() == 2
    assert log.recv_match(blocking=True, type="BATTERY_STATUS", timeout=0.05) is None
    log.close()


def test_a_log_that_is_read_discards_what_is_sent(tmp_path):
    path = tmp_path / "a.tlog"
    path.write_bytes(LOG)
    for options in ({}, {"append": True}):
        log = mavutil.mavlink_connection(str(path), **options)
        log.mav.heartbeat_send(1, 2, 3, 4, 5)
        log.param_fetch_all()
        assert (log.discarded_writes, log.discarded_bytes > 20) == (2, True)
        log.close()
    assert path.read_bytes() == LOG


def test_missing_logs(tmp_path):
    missing = str(tmp_path / "no.tlog")
    with pytest.raises(FileNotFoundError) as error:
        mavutil.mavlink_connection(missing)
    assert error.value.filename == missing
    with pytest.raises(IsADirectoryError):
        mavutil.mavlink_connection(str(tmp_path))
    with mavutil.mavlink_connection(missing, write=True) as log:
        log.write(RECORDS[0])
    with mavutil.mavlink_connection(missing) as log:
        assert types(drain(log)) == ["HEARTBEAT"]


def test_what_is_no_log_and_no_port(tmp_path):
    with pytest.raises(ValueError, match="name is empty"):
        mavutil.mavlink_connection("")
    pipe = tmp_path / "pipe.tlog"
    os.mkfifo(pipe)
    with pytest.raises(ValueError, match=r"a pipe or a socket.*pipe\.tlog"):
        mavutil.mavlink_connection(str(pipe))


def test_damage_costs_no_more_than_the_damaged_record(tmp_path):
    path = tmp_path / "damaged.tlog"
    damaged = bytearray(LOG)
    damaged[len(RECORDS[0]) + 8 + 12] ^= 0xFF  # in the first ATTITUDE's payload
    path.write_bytes(damaged)
    with mavutil.mavlink_connection(str(path)) as log:
        assert types(drain(log)) == ["HEARTBEAT", "BAD_DATA", *NAMES[2:]]
        log.rewind()
        assert [m.get_seq() for m in drain(log, type="ATTITUDE")] == [4]


def test_indexing_drops_the_rest_of_a_cut_frame(tmp_path):
    """A frame whose end is missing must not eat the records that the index leads to."""
    path = tmp_path / "cut_inside.tlog"
    path.write_bytes(RECORDS[0] + LOG[len(RECORDS[0]) :][:-10])
    log = mavutil.mavlink_connection(str(path))
    first = drain(log)
    log.rewind()
    assert [m.get_seq() for m in drain(log)] == [m.get_seq() for m in first]
    log.close()


def test_resync_argument(tmp_path):
    path = tmp_path / "a.tlog"
    path.write_bytes(LOG)
    log = mavutil.mavlink_connection(str(path), resync="rescan")
    assert log.mav.resync == "rescan"
    log.close()
    with pytest.raises(ValueError, match="resync must be"):
        mavutil.mavlink_connection(str(path), resync="both")


def test_v2_log_from_its_first_record_on(tmp_path):
    """A v2-only message that comes first is indexed although the process began with v1."""
    mavutil.set_wire_protocol("1.0")
    mavutil.set_dialect("all")
    wheel = mavlink.MAVLink_wheel_distance_message(1, 2, [1.0] * 16)
    path = tmp_path / "v2.tlog"
    path.write_bytes(record(pack(wheel)) + record(heartbeat(1)))
    log = mavutil.mavlink_connection(str(path))
    assert log.counts == {9000: 1, 0: 1}
    assert types(drain(log)) == ["WHEEL_DISTANCE", "HEARTBEAT"]
    log.close()


def test_truncated_timestamp_then_rest(tmp_path):
    path = tmp_path / "slow.tlog"
    path.write_bytes(struct.pack(">Q", T0)[:3])
    log = mavutil.mavlink_connection(str(path), append=True)
    assert log.recv_msg() is None
    with open(path, "ab") as writer:
        writer.write(RECORDS[0][3:])
    assert log.recv_msg().get_type() == "HEARTBEAT"
    log.close()


@pytest.mark.parametrize("options", [{}, {"append": True}, {"resync": "rescan"}])
def test_a_log_that_is_truncated_while_it_is_read(tmp_path, options):
    path = tmp_path / "shrinking.tlog"
    beats = [record(heartbeat(n % 256), T0 + 1000 * n) for n in range(30_000)]
    path.write_bytes(b"".join(beats))
    left = 12_345
    for kind in (None, "HEARTBEAT"):
        path.write_bytes(b"".join(beats))
        log = mavutil.mavlink_connection(str(path), **options)
        for _ in range(10):
            log.recv_match(type=kind)
        os.truncate(path, left * len(beats[0]) + 9)
        count = 10 + len(drain(log, type=kind))
        # What was read ahead before the cut may still come.
        assert left <= count < left + 10_000
        assert log.recv_match(type=kind) is None
        if not options.get("append"):
            log.rewind()
            assert len(log.flightmode_list()) == 1
        log.close()


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() == 0, reason="root may read all")
def test_a_log_that_may_not_be_read(tmp_path):
    path = tmp_path / "secret.tlog"
    path.write_bytes(LOG)
    path.chmod(0)
    with pytest.raises(PermissionError) as error:
        mavutil.mavlink_connection(str(path))
    assert error.value.filename == str(path)


def test_a_closed_log_is_at_its_end(tmp_path):
    path = tmp_path / "a.tlog"
    path.write_bytes(LOG)
    for options in ({}, {"append": True}, {"resync": "rescan"}):
        log = mavutil.mavlink_connection(str(path), **options)
        log.recv_msg()
        log.close()
        assert (log.recv_msg(), log.recv_match(type="ATTITUDE")) == (None, None)


def test_last_message_and_time(tmp_path):
    path = tmp_path / "a.tlog"
    path.write_bytes(LOG[:-30] + b"junk" + LOG[-30:])
    log = mavutil.mavlink_connection(str(path), append=True)
    assert (log._last_message, log._last_timestamp, log._link) == (None, None, 0)
    while (msg := log.recv_msg()) is not None:
        assert str(log._last_message) == str(msg)
        assert (log._last_message is msg) == (msg.get_type() != "BATTERY_STATUS")
        assert log._last_timestamp == msg._timestamp or msg.get_type() == "BAD_DATA"
    log.close()


def test_scan_timestamp(tmp_path):
    path = tmp_path / "a.tlog"
    path.write_bytes(RECORDS[0] + b"\xff" * 5 + RECORDS[1])
    log = mavutil.mavlink_connection(str(path), append=True)
    log.recv_msg()
    stamp = log.f.read(8)
    assert round(log.scan_timestamp(stamp) * 1e6) == pytest.approx(T0 + 4, abs=1)
    assert log.f.tell() == len(RECORDS[0]) + 13
    with pytest.raises(ValueError, match="8 bytes"):
        log.scan_timestamp(b"\x00" * 7)
    log.close()


@pytest.mark.parametrize("options", [{}, {"append": True}], ids=["indexed", "stream"])
def test_asking_for_more_than_there_is(tmp_path, options):
    path = tmp_path / "flight.tlog"
    path.write_bytes(LOG)
    with mavutil.mavlink_connection(str(path), **options) as log:
        frames = list(iter(lambda: log.recv(1 << 62), b""))
        assert frames == [rec[8:] for rec in RECORDS]
        log.mav.expected_length = (1 << 62) + 1
        assert log.recv_msg() is None


def test_counters_that_were_set_back_do_not_wrap(tmp_path):
    path = tmp_path / "cut.tlog"
    path.write_bytes(LOG[:-1])
    with mavutil.mavlink_connection(str(path)) as log:
        drain(log)
        log.mav.total_bytes_received = 0
        log.rewind()
        assert log.mav.total_bytes_received == 0


def test_a_log_and_its_last_message_are_collected(tmp_path):
    path = tmp_path / "damaged.tlog"
    path.write_bytes(record(heartbeat()[:-1] + b"\0"))
    log = mavutil.mavlink_connection(str(path))
    message = log.recv_msg()
    assert message.get_type() == "BAD_DATA"
    message.log = log
    reference = weakref.ref(message)
    mavutil.mavfile_global = None
    del log, message
    gc.collect()
    assert reference() is None


def log_of(path, *messages):
    """A log with these messages, a second apart."""
    records = (record(pack(msg, n), T0 + 1_000_000 * n) for n, msg in enumerate(messages))
    path.write_bytes(b"".join(records))
    return mavutil.mavlink_connection(str(path))


def test_a_target_that_was_let_go_is_locked_again_by_an_equal_heartbeat(tmp_path):
    beat = mavlink.MAVLink_heartbeat_message(2, 3, 81, 4, 4, 3)
    log = log_of(tmp_path / "flight.tlog", *[beat] * 6)
    for attribute in ("sysid", "target_system"):
        log.recv_msg()
        log.recv_msg()
        assert log.sysid == 1
        setattr(log, attribute, 0)
        log.recv_msg()
        assert (log.sysid, log.target_system) == (1, 1)


def test_parameters_that_were_removed_come_back_with_an_equal_message(tmp_path):
    beat = mavlink.MAVLink_heartbeat_message(2, 3, 81, 4, 4, 3)
    value = mavlink.MAVLink_param_value_message(b"GAIN", 1.5, 9, 1, 0)
    log = log_of(tmp_path / "flight.tlog", beat, *[value] * 4)
    for _ in range(4):
        log.recv_msg()
    assert log.params == {"GAIN": 1.5}
    log.params.clear()
    log.recv_msg()
    assert log.params == {"GAIN": 1.5}


def test_home_is_the_newest_position_until_there_is_a_fix(tmp_path):
    lost, fixed = (
        mavlink.MAVLink_gps_raw_int_message(0, fix, 0, 0, 0, 0, 0, 0, 0, 0) for fix in (1, 3)
    )
    log = log_of(tmp_path / "flight.tlog", *[lost] * 3, *[fixed] * 3)
    homes = []
    while log.recv_msg() is not None:
        homes.append(log.sysid_state[1].messages["HOME"]._timestamp - T0 / 1e6)
    assert homes == [0, 1, 2, 3, 3, 3]


def test_states_take_attributes_that_cannot_be_compared(tmp_path):
    class Array:
        def __ne__(self, other: object) -> bool:
            raise ValueError("the truth value is ambiguous")

    log = log_of(tmp_path / "flight.tlog", mavlink.MAVLink_heartbeat_message(2, 3, 81, 4, 4, 3))
    log.recv_msg()
    log.sysid_state[1].trace = Array()
    log.sysid_state[1].trace = newest = Array()
    assert log.sysid_state[1].trace is newest
