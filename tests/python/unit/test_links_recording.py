"""Recorded telemetry logs: no secrets in them, and no harm from them."""

from __future__ import annotations

import os
import socket

import pytest
from mavwire import aio, cli, mavutil
from mavwire._native import recordable
from mavwire.dialects.v20 import all as mavlink
from mavwire.dialects.v20 import minimal
from unit.aio_tools import eventually, run
from unit.link_tools import KEY, Capture, drain, heartbeat, pack, signed, types

LONG = mavlink.MAVLink_statustext_message(6, b"x" * 50)
SETUP = mavlink.MAVLink_setup_signing_message(1, 1, KEY[::-1], 99)


pytestmark = pytest.mark.usefixtures("mavlink20")


def decoded(frame: bytes):
    return mavlink.MAVLink(None).decode(bytearray(frame))


@pytest.mark.parametrize("msg", [mavlink.MAVLink_heartbeat_message(2, 3, 81, 4, 4, 3), LONG])
def test_a_signed_frame_is_recorded_as_its_unsigned_twin(msg):
    assert bytes(recordable(signed(msg))) == pack(msg)


def test_a_signed_frame_of_an_unknown_message_keeps_a_good_checksum():
    """Its crc_extra is not known, and not needed."""
    wheel = mavlink.MAVLink_wheel_distance_message(1, 2, [1.0] * 16)
    assert bytes(recordable(signed(wheel))) == pack(wheel)


def test_unsigned_and_v1_frames_are_recorded_as_they_are():
    for frame in (heartbeat(), heartbeat(v1=True), b"", b"\xfd"):
        assert recordable(frame) is frame


@pytest.mark.parametrize("make", [pack, signed])
def test_no_key_of_setup_signing_is_recorded(make):
    frame = bytes(recordable(make(SETUP)))
    msg = decoded(frame)
    assert (msg.get_type(), msg.initial_timestamp, msg.target_system) == ("SETUP_SIGNING", 99, 1)
    assert bytes(bytearray(msg.secret_key)) == b"\xff" * 32


def test_a_trimmed_key_is_not_recorded_either():
    frame = bytes(recordable(pack(mavlink.MAVLink_setup_signing_message(1, 1, [5] + [0] * 31, 0))))
    assert bytes(bytearray(decoded(frame).secret_key)) == b"\xff" * 32


def test_setup_logfile_keeps_secrets_out(tmp_path):
    """R53, R54."""
    link = Capture()
    link.setup_logfile(str(tmp_path / "a.tlog"))
    link.rx += signed(mavlink.MAVLink_heartbeat_message(2, 3, 81, 4, 4, 3)) + pack(SETUP)
    drain(link)
    link.logfile.close()
    raw = (tmp_path / "a.tlog").read_bytes()
    assert KEY[::-1] not in raw
    with mavutil.mavlink_connection(str(tmp_path / "a.tlog")) as log:
        assert types(drain(log)) == ["HEARTBEAT", "SETUP_SIGNING"]


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="no /dev/full on this platform")
def test_a_full_disk_does_not_stop_reception():
    """R66."""
    link = Capture()
    link.setup_logfile("/dev/full")
    link.setup_logfile_raw("/dev/full")
    for seq in range(500):
        link.rx += heartbeat(seq % 256)
    assert len(drain(link)) == 500
    assert link.mav_loss == 0
    assert link.logfile_errors > 0


def test_a_closed_log_does_not_stop_reception(tmp_path):
    """R66."""
    link = Capture()
    link.setup_logfile(str(tmp_path / "a.tlog"))
    link.logfile.close()
    link.rx += heartbeat()
    assert types(drain(link)) == ["HEARTBEAT"]
    assert link.logfile_errors == 1


def test_a_log_that_is_open_for_reading_does_not_stop_reception(tmp_path):
    link = Capture()
    path = tmp_path / "a.tlog"
    path.touch()
    with path.open("rb") as link.logfile:
        link.rx += heartbeat()
        assert types(drain(link)) == ["HEARTBEAT"]
        assert link.logfile_errors == 1


def test_records_reach_the_file_at_once(tmp_path):
    link = Capture()
    link.setup_logfile(str(tmp_path / "a.tlog"))
    link.setup_logfile_raw(str(tmp_path / "a.raw"))
    for seq in range(3):
        link.rx += heartbeat(seq)
        link.recv_msg()
        assert (tmp_path / "a.tlog").stat().st_size == (seq + 1) * 29
        assert (tmp_path / "a.raw").stat().st_size == (seq + 1) * 21
    link.logfile.close()
    link.logfile_raw.close()


def opened(kind, folder):
    """A link of a kind, and what has to be kept for it."""
    if kind == "tcp":
        server = socket.create_server(("127.0.0.1", 0))
        return mavutil.mavlink_connection(f"tcp:127.0.0.1:{server.getsockname()[1]}"), server
    if kind == "serial":
        pytest.importorskip("serial")
        ends = os.openpty()
        return mavutil.mavlink_connection(os.ttyname(ends[1])), ends
    if kind == "exec":
        program = folder / "program"
        program.write_text("#!/bin/sh\nexec cat\n")
        program.chmod(0o700)
        return mavutil.mavlink_connection(f"exec:{program}"), None
    if kind == "log":
        (folder / "log.tlog").write_bytes(bytes(8) + heartbeat())
        return mavutil.mavlink_connection(str(folder / "log.tlog")), None
    if kind.startswith("ws"):
        pytest.importorskip("wsproto")
    if kind == "ws":
        return mavutil.mavlink_connection("ws:127.0.0.1:9"), None  # and nobody is there
    return mavutil.mavlink_connection("mcast:" if kind == "mcast" else f"{kind}:127.0.0.1:0"), None


@pytest.mark.parametrize(
    "kind", ["udpin", "mcast", "tcpin", "tcp", "ws", "wsserver", "serial", "exec", "log"]
)
def test_records_reach_the_file_when_the_link_is_closed(kind, tmp_path):
    path, raw = tmp_path / "a.tlog", tmp_path / "a.raw"
    link, kept = opened(kind, tmp_path)
    link.setup_logfile(str(path))
    link.setup_logfile_raw(str(raw))
    for seq in range(5):
        link._arrived(heartbeat(seq))
        link._record(decoded(heartbeat(seq)))
    link.close()
    assert (path.stat().st_size, raw.stat().st_size) == (5 * 29, 5 * 21)
    link.logfile.close()
    link.logfile_raw.close()
    del kept


def test_records_reach_the_file_in_a_loop(tmp_path):
    path = tmp_path / "a.tlog"

    async def main():
        async with aio.connect("udpin:127.0.0.1:0") as link:
            link.sync.setup_logfile(str(path))
            send(link.sync.port.getsockname()[1], 10)
            await eventually(lambda: path.stat().st_size == 10 * 29)
            link.sync.logfile.close()

    run(main())


def send(port: int, count: int) -> None:
    """HEARTBEATs to a UDP link."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as peer:
        for seq in range(count):
            peer.sendto(heartbeat(seq), ("127.0.0.1", port))


KEY_TEXTS = [
    ", ".join(map(str, KEY[::-1][:8])),
    ", ".join(f"'{byte:x}'" for byte in KEY[::-1][:8]),
    ",".join(map(str, KEY[::-1][:8])),
]


@pytest.mark.parametrize(
    "words",
    ["", "--format json", "--verbose", "--condition True", "--condition True --format json"],
)
@pytest.mark.parametrize("dialect", ["all", "minimal"])
def test_no_dump_shows_a_key(tmp_path, capsys, words, dialect):
    """R53: also where the dialect lacks the message."""
    path = tmp_path / "keyed.tlog"
    path.write_bytes(bytes(8) + heartbeat() + bytes(8) + pack(SETUP))
    assert cli.main(["dump", "--dialect", dialect, *words.split(), str(path)]) == 0
    shown = capsys.readouterr().out
    assert ("SETUP_SIGNING" if dialect == "all" else "UNKNOWN_256") in shown
    assert not [text for text in KEY_TEXTS if text in shown]


def test_the_text_of_an_unknown_message_shows_no_key_and_its_data_are_exact():
    """R53."""
    frame = pack(SETUP)
    (msg,) = minimal.MAVLink(None).parse_buffer(frame)
    assert msg.get_type() == "UNKNOWN_256"
    assert not [text for text in KEY_TEXTS if text in str(msg)]
    assert bytes(msg.data) == bytes(msg.get_msgbuf()) == frame


def test_a_script_of_a_log_shows_no_key(tmp_path):
    """R53."""
    path = tmp_path / "keyed.tlog"
    path.write_bytes(bytes(8) + pack(SETUP))
    assert cli.main(["tomfile", str(path)]) == 0
    script = (tmp_path / "keyed.m").read_text()
    assert "SETUP_SIGNING.data(1,:)" in script
    assert script.count(",255") == 32
