"""Logs are checked ahead of being read: whatever happens in between must count from the very next
record on, as if there were no such thing."""

from __future__ import annotations

import weakref

import pytest
from mavwire import mavutil
from mavwire.dialects.v20 import all as mavlink
from unit.link_tools import KEY, T0, drain, heartbeat, pack, record, signed, types

COUNT = 600  # more than are ever checked at once
TEXT = "later"


pytestmark = pytest.mark.usefixtures("mavlink20")


def attitude(number: int) -> bytes:
    msg = mavlink.MAVLink_attitude_message(number, 0.5, 0, 0, 0, 0, 0)
    return record(pack(msg, number % 256), T0 + number)


@pytest.fixture
def path(tmp_path):
    path = tmp_path / "flight.tlog"
    path.write_bytes(record(heartbeat()) + b"".join(map(attitude, range(1, COUNT))))
    return str(path)


@pytest.fixture(params=[{}, {"append": True}], ids=["indexed", "stream"])
def log(request, path):
    with mavutil.mavlink_connection(path, **request.param) as log:
        yield log


def read(log, count: int) -> list[int]:
    """The numbers of the next messages."""
    return [getattr(log.recv_msg(), "time_boot_ms", 0) for _ in range(count)]


def test_every_message_comes_once(log):
    assert read(log, COUNT) == list(range(COUNT))
    assert log.recv_msg() is None
    assert log.last_seq == {(1, 1): (COUNT - 1) % 256}
    assert log.percent == pytest.approx(100, abs=1)


def test_a_jump_back(path):
    with mavutil.mavlink_connection(path) as log:
        read(log, 300)
        log.rewind()
        assert read(log, 20) == list(range(20))


def test_a_jump_forward_by_type(path):
    with mavutil.mavlink_connection(path) as log:
        read(log, 5)
        assert log.recv_match(type="ATTITUDE").time_boot_ms == 1
        assert read(log, 3) == [2, 3, 4]


def test_another_dialect(log):
    read(log, 10)
    mavutil.set_dialect("minimal")
    log.mav = mavutil.mavlink.MAVLink(log, srcSystem=255)
    log.mav.robust_parsing = True
    assert log.recv_msg().get_type() == "UNKNOWN_30"


def test_a_callback(log):
    read(log, 10)
    seen = []
    log.mav.set_callback(seen.append)
    read(log, 10)
    assert [msg.time_boot_ms for msg in seen] == list(range(10, 20))


def test_a_hook(log):
    read(log, 10)
    seen = []
    log.message_hooks.append(lambda _, msg: seen.append(msg.time_boot_ms))
    read(log, 10)
    assert seen == list(range(10, 20))


def test_a_key(log):
    read(log, 10)
    log.mav.signing.secret_key = KEY
    assert log.recv_msg().get_type() == "BAD_DATA"


def test_messages_without_time_stamps(log):
    read(log, 10)
    log.notimestamps = True
    assert log.recv_msg()._timestamp == pytest.approx(0.010)


def test_another_policy(log):
    read(log, 10)
    log.mav.resync = "rescan"
    assert read(log, 400) == list(range(10, 410))
    log.mav.resync = "skip"
    assert read(log, 100) == list(range(410, 510))


def test_bytes_given_to_the_parser(log):
    """They stand in front of the next record, whose frame completes what they began."""
    read(log, 10)
    log.mav.parse_char(heartbeat()[:10])
    assert log.recv_msg().get_type() == "BAD_DATA"
    assert read(log, 2) == [11, 12]


def test_reading_bytes_in_between(log):
    read(log, 10)
    frame = log.recv(40)
    assert frame[:1] == b"\xfd"


def test_a_closed_log(log):
    read(log, 10)
    log.close()
    assert log.recv_msg() is None


def test_damage_ends_the_stretch(tmp_path):
    damaged = bytearray(attitude(50))
    damaged[-1] ^= 1
    rows = [attitude(number) for number in range(1, 100)]
    rows[49] = bytes(damaged)
    path = tmp_path / "damaged.tlog"
    path.write_bytes(b"".join(rows))
    with mavutil.mavlink_connection(str(path)) as log:
        names = types(drain(log))
    assert names[:49] == ["ATTITUDE"] * 49
    assert names[49] == "BAD_DATA"
    assert names[50:] == ["ATTITUDE"] * 49


def test_signed_frames_without_a_key(tmp_path):
    path = tmp_path / "signed.tlog"
    msg = mavlink.MAVLink_attitude_message(1, 0.5, 0, 0, 0, 0, 0)
    path.write_bytes(b"".join(record(signed(msg, number)) for number in range(50)))
    with mavutil.mavlink_connection(str(path)) as log:
        messages = drain(log)
        assert len(messages) == 50
        assert not any(msg.get_signed() for msg in messages)
        assert log.mav.signing.sig_count == 50 + 1  # the index reads the first record of each type


def test_a_log_that_grows_at_its_end(tmp_path):
    path = tmp_path / "growing.tlog"
    path.write_bytes(b"")
    log = mavutil.mavlink_connection(str(path), append=True)
    with open(path, "ab") as file:
        for number in range(1, 40):
            file.write(attitude(number))
            file.flush()
            assert read(log, 1) == [number]
            assert log.recv_msg() is None
    log.close()


class TestInstances:
    """The newest message of each instance."""

    @pytest.fixture
    def path(self, tmp_path):
        path = tmp_path / "batteries.tlog"
        path.write_bytes(record(heartbeat()) + b"".join(map(self.battery, range(1, 41))))
        return str(path)

    @staticmethod
    def battery(number: int) -> bytes:
        msg = mavlink.MAVLink_battery_status_message(
            number % 2, 0, 0, number, [7] * 10, 0, 0, 0, 50
        )
        return record(pack(msg, number), T0 + number)

    @pytest.fixture
    def log(self, path):
        with mavutil.mavlink_connection(path, append=True) as log:
            for _ in range(11):
                log.recv_msg()
            yield log

    def test_the_table_shows_the_newest(self, log):
        assert log.messages["BATTERY_STATUS"].temperature == 10
        assert log.messages["BATTERY_STATUS[0]"].temperature == 10
        assert log.messages["BATTERY_STATUS[1]"].temperature == 9
        newest = log.messages["BATTERY_STATUS"]
        assert (newest[0].temperature, newest[1].temperature) == (10, 9)
        assert log.messages["BATTERY_STATUS"]._timestamp == pytest.approx(1_600_000_000.000010)

    @pytest.mark.parametrize("key", ["BATTERY_STATUS", "BATTERY_STATUS[0]"])
    def test_what_somebody_keeps_stays(self, log, key):
        kept = log.messages[key]
        text = str(kept)
        for _ in range(10):
            log.recv_msg()
        assert str(kept) == text
        assert log.messages[key].temperature == 20

    @pytest.mark.parametrize("key", ["BATTERY_STATUS", "BATTERY_STATUS[0]"])
    def test_what_somebody_watches_dies(self, log, key):
        watched = weakref.ref(log.messages[key])
        for _ in range(2):
            log.recv_msg()
        assert log.messages[key] is not watched()
        assert watched() is None

    @pytest.mark.parametrize("key", ["BATTERY_STATUS", "BATTERY_STATUS[0]"])
    def test_what_somebody_writes_is_gone_with_the_message(self, log, key):
        log.messages[key].note = TEXT
        log.messages[key].temperature = -1
        vars(log.messages[key])["other"] = TEXT
        self.forgets(log, key, "note", "other")

    @pytest.mark.parametrize("key", ["BATTERY_STATUS", "BATTERY_STATUS[0]"])
    def test_what_somebody_marks_is_gone_with_the_message(self, log, key):
        log.messages[key]._link = TEXT
        self.forgets(log, key)
        assert log.messages[key]._link != TEXT

    @staticmethod
    def forgets(log, key, *names):
        for _ in range(2):
            log.recv_msg()
        for name in names:
            assert not hasattr(log.messages[key], name)
        assert log.messages[key].temperature == 12

    def test_another_dialect_has_another_class(self, log):
        mavutil.set_dialect("common")
        log.mav = mavutil.mavlink.MAVLink(log, srcSystem=255)
        for _ in range(2):
            log.recv_msg()
        for key in ("BATTERY_STATUS", "BATTERY_STATUS[0]"):
            assert isinstance(log.messages[key], mavutil.mavlink.MAVLink_battery_status_message)
