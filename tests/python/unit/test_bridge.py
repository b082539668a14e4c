"""`Bridge` over real sockets: frames, links that come and go, recording, what it tells."""

from __future__ import annotations

import asyncio
import errno
import os
import socket
import sys
import threading
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from mavwire import Bridge, open_log
from mavwire.bridge import BridgeError, ConfigError, FrameBatches, Recording
from mavwire.dialects.v20 import all as mavlink
from mavwire.dialects.v20 import minimal
from unit.bridge_tools import (
    LIMIT,
    TCP,
    UDP,
    command,
    peers,
    port_of,
    read_exactly,
    receive,
    report,
    run_alone,
    udp_peer,
    wait_until,
)
from unit.link_tools import heartbeat, pack, signed

BEAT = mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3)


def collect(batches: FrameBatches, count: int) -> list[Any]:
    """The next messages, so many of them."""
    messages: list[Any] = []
    while len(messages) < count:
        batch = batches.next(LIMIT)
        assert batch, f"{len(messages)} of {count}"
        messages += batch
    return messages


def test_frames_go_where_they_are_meant_for() -> None:
    with Bridge() as bridge:
        bridge.add(UDP, name="vehicles")
        bridge.add(TCP, name="stations")
        address = ("127.0.0.1", port_of(bridge, "stations"))
        with (
            udp_peer(bridge, "vehicles") as first,
            udp_peer(bridge, "vehicles") as second,
            socket.create_connection(address, LIMIT) as station,
        ):
            wait_until("the station", lambda: peers(bridge, "stations"))
            first.send(heartbeat(sysid=1))
            assert read_exactly(station, 21) == heartbeat(sysid=1)
            second.send(heartbeat(sysid=2))
            assert read_exactly(station, 21) == heartbeat(sysid=2)
            assert receive(first) == heartbeat(sysid=2)
            station.sendall(command(1) + command(9) + heartbeat(sysid=255))
            assert [receive(first), receive(first)] == [command(1), heartbeat(sysid=255)]
            assert receive(second) == heartbeat(sysid=255)
            (peer,) = peers(bridge, "stations")
            assert (peer["received"], peer["unroutable"], peer["sent"]) == (3, 1, 2)


def test_frames_are_never_altered() -> None:
    """Signed, of version 1, unknown, untrimmed: the same bytes come out."""
    untrimmed = bytearray(
        mavlink.MAVLink_system_time_message(5, 0).pack(mavlink.MAVLink(None, 1, 1))
    )
    frames = [
        signed(BEAT),
        heartbeat(seq=1, v1=True),
        bytes(untrimmed),
        pack(mavlink.MAVLink_wind_cov_message(*[1] * 9), 3),
    ]
    with Bridge([UDP], dialect=minimal) as bridge, udp_peer() as station:
        bridge.add(f"udpout:127.0.0.1:{station.getsockname()[1]}")
        with udp_peer(bridge, UDP) as vehicle:
            for frame in frames:
                vehicle.send(frame)
            assert [receive(station) for _ in frames] == frames


def test_batches_have_frames_and_messages() -> None:
    with Bridge([UDP]) as bridge, udp_peer(bridge, UDP) as vehicle:
        every = bridge.frames(max_batch=2, max_latency=LIMIT)
        some = bridge.frames(["ATTITUDE", 4242], [3])
        attitude = mavlink.MAVLink_attitude_message(1, 0.5, 0, 0, 0, 0, 0)
        for frame in (heartbeat(sysid=3), pack(attitude, 1, 3), pack(attitude, 2, 4)):
            vehicle.send(frame)
        wait_until("them", lambda: bridge.latest("ATTITUDE", 4))
        bridge.send(BEAT)
        batch = every.next()
        assert batch is not None and len(batch) == 2
        assert batch.frames() == [heartbeat(sysid=3), pack(attitude, 1, 3)]
        assert batch.raw == b"".join(batch.frames())
        assert batch.ids == [(3, 1, 0), (3, 1, 30)] and batch.links == [UDP, UDP]
        first, second = batch
        assert (first.get_type(), second.roll) == ("HEARTBEAT", 0.5)
        assert [first._timestamp, second._timestamp] == batch.times
        assert batch.times == pytest.approx([first._timestamp] * 2, abs=LIMIT)
        last = every.next()
        assert last is not None and list(zip(last.links, last.ids, strict=True)) == [
            (UDP, (4, 1, 30)),
            ("program", (255, 190, 0)),
        ]
        assert [msg.get_type() for msg in collect(some, 1)] == ["ATTITUDE"]
        some.close()
        assert some.next() is None and some.dropped == 0
        stopper = threading.Timer(0.05, bridge.stop)
        stopper.start()
        assert list(every) == [], "it ends with the bridge"
        stopper.join()


def test_batches_as_tables() -> None:
    def attitude(seq: int) -> bytes:
        message = mavlink.MAVLink_attitude_message(seq, seq / 4, 0, 0, 0, 0, 0)
        return bytes(pack(message, seq, 3))

    with Bridge([UDP]) as bridge, udp_peer(bridge, UDP) as vehicle:
        batches = bridge.frames(max_batch=3, max_latency=LIMIT)
        for frame in (attitude(1), heartbeat(sysid=7), attitude(2)):
            vehicle.send(frame)
        batch = batches.next()
        assert batch is not None and len(batch) == 3
        tables = batch.tables()
        assert list(tables) == ["ATTITUDE", "HEARTBEAT"]
        rows = tables["ATTITUDE"].to_numpy()
        assert list(rows)[:5] == ["timestamp", "sysid", "compid", "seq", "time_boot_ms"]
        assert [list(rows[name]) for name in ("sysid", "seq", "roll")] == [
            [3, 3], [1, 2], [0.25, 0.5],
        ]  # fmt: skip
        assert [time / 1e6 for time in rows["timestamp"].astype(int)] == [
            batch.times[0], batch.times[2],
        ]  # fmt: skip
        named = batch.tables(enums="names")["HEARTBEAT"].to_numpy()["autopilot"]
        assert list(named) == ["MAV_AUTOPILOT_ARDUPILOTMEGA"]
        with pytest.raises(ValueError, match="units must be None or 'si'"):
            batch.tables(units="feet")
        nothing = batches.next(0.0)
        assert nothing is not None and nothing.tables() == {}


def test_tables_lack_what_the_dialect_lacks() -> None:
    with Bridge(dialect=minimal) as bridge, bridge.frames(max_batch=2, max_latency=LIMIT) as some:
        bridge.send(heartbeat() + pack(mavlink.MAVLink_wind_cov_message(*[1] * 9), 3))
        batch = some.next()
        assert batch is not None and len(batch) == 2
        assert list(batch.tables()) == ["HEARTBEAT"]


def test_batches_in_asyncio() -> None:
    async def main() -> list[Any]:
        with Bridge() as bridge, bridge.frames(["HEARTBEAT"]) as batches:
            asyncio.get_running_loop().call_later(0.05, bridge.send, BEAT)
            async for batch in batches:
                asyncio.get_running_loop().call_later(0.05, bridge.stop)
                messages = list(batch)
            return messages

    assert [msg.get_type() for msg in asyncio.run(asyncio.wait_for(main(), LIMIT))] == ["HEARTBEAT"]


def test_a_cancelled_wait_loses_no_batch() -> None:
    class Tap:
        def __init__(self) -> None:
            self.go, self.left = threading.Event(), [["first"], ["second"], None]

        def next(self, *limits: object) -> Any:
            assert self.go.wait(LIMIT)
            return self.left.pop(0)

        def close(self) -> None: ...

    async def main() -> None:
        tap: Any = Tap()
        batches = FrameBatches(tap, 1, 0.0)
        with pytest.raises(TimeoutError):
            await asyncio.wait_for(anext(batches), 0.001)
        tap.go.set()
        assert [batch async for batch in batches] == [["first"], ["second"]]

    asyncio.run(main())


def test_the_newest_message_of_each_kind() -> None:
    with Bridge([UDP], source_system=250, source_component=7) as bridge:
        assert bridge.latest("HEARTBEAT") is None
        with udp_peer(bridge, UDP) as vehicle:
            vehicle.send(heartbeat(seq=5, sysid=1))
            vehicle.send(heartbeat(seq=6, sysid=2))
            wait_until("both", lambda: bridge.latest("HEARTBEAT", 2))
        assert bridge.latest("HEARTBEAT", 1, 1).get_seq() == 5
        assert bridge.latest(0, component=1).get_seq() == 6
        assert bridge.latest("HEARTBEAT", 3) is None and bridge.latest("ATTITUDE") is None
        for seq in range(3):
            bridge.send(BEAT)
            own = wait_until("it", lambda: bridge.latest("HEARTBEAT", 250, 7))
            wait_until("the next", lambda: bridge.latest("HEARTBEAT", 250).get_seq() == seq)  # noqa: B023
        assert own.autopilot == 8
        with pytest.raises(ValueError, match="the dialect has no message 'NOPE'"):
            bridge.latest("NOPE")


def test_links_come_and_go() -> None:
    bridge = Bridge()
    bridge.add(UDP, name="early")
    with bridge:
        assert bridge.add(TCP, name="late", group="g", private=True) == "late"
        with pytest.raises(BridgeError, match='a link called "late"'):
            bridge.add(UDP, name="late")
        with pytest.raises(BridgeError, match='no link called "nope"'):
            bridge.remove("nope")
        bridge.remove("early")
        names = [one["name"] for one in bridge.stats()["links"]]
        assert names == ["late", "program"]
    assert not bridge.running
    bridge.stop()
    with pytest.raises(BridgeError, match="not running"):
        bridge.stats()
    with bridge:  # again, with the links that it has by now
        assert [one["name"] for one in bridge.stats()["links"]] == ["late", "program"]
        with pytest.raises(BridgeError, match="running already"):
            bridge.start()


def test_what_cannot_be_opened_is_an_os_error_that_names_it(tmp_path: Path) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as taken:
        taken.bind(("127.0.0.1", 0))
        busy = f"udpin:127.0.0.1:{taken.getsockname()[1]}"
        bridge = Bridge([UDP, busy])
        with pytest.raises(OSError) as raised:
            bridge.start()
        assert (raised.value.errno, raised.value.filename) == (errno.EADDRINUSE, busy)
        assert not bridge.running
    bridge.start().stop()
    with pytest.raises(FileNotFoundError, match="no-such-device"):
        Bridge(["serial:/dev/no-such-device:57600"]).start()
    with pytest.raises(OSError, match="this is no serial port: 'serial:/dev/null:57600'"):
        Bridge(["serial:/dev/null:57600"]).start()
    (tmp_path / "file").write_text("")
    with pytest.raises(OSError, match="file"):
        Bridge(record=tmp_path / "file").start()


def test_frames_that_wait_may_share_a_datagram() -> None:
    with Bridge() as bridge, udp_peer() as station:
        out = f"udpout:127.0.0.1:{station.getsockname()[1]}"
        bridge.add(out, name="station", datagram_bytes=50)
        frames = [heartbeat(seq=seq) for seq in range(5)]
        bridge.send(b"".join(frames))
        pairs = [frames[0] + frames[1], frames[2] + frames[3], frames[4]]
        assert [station.recv(65536) for _ in pairs] == pairs
        wait_until("the count", lambda: report(bridge, "station")["sent"] == 5)


def test_frames_of_one_datagram_fit_where_the_longest_frame_does() -> None:
    with Bridge() as bridge, udp_peer() as station:
        bridge.add(f"udpout:127.0.0.1:{station.getsockname()[1]}")
        sent = b"".join(heartbeat(seq=seq) for seq in range(200))
        bridge.send(sent)
        came = b""
        while len(came) < len(sent):
            datagram = station.recv(65536)
            assert len(datagram) <= 280 and len(datagram) % len(heartbeat()) == 0
            came += datagram
        assert came == sent


def test_a_datagram_for_each_frame_if_that_is_wanted() -> None:
    with Bridge() as bridge, udp_peer() as station:
        bridge.add(f"udpout:127.0.0.1:{station.getsockname()[1]}", datagram_bytes=0)
        frames = [heartbeat(seq=seq) for seq in range(200)]
        frames[7] = pack(mavlink.MAVLink_attitude_message(1, 0, 0, 0, 0, 0, 0), 7)
        bridge.send(b"".join(frames))
        assert [receive(station) for _ in frames] == frames


def test_bytes_that_are_no_whole_frames_are_refused() -> None:
    beat = heartbeat()
    damaged = beat[:-1] + bytes([beat[-1] ^ 1])
    many = 10_000
    cases = [
        (b"xx", 0), (beat + beat[:9], len(beat)), (beat + b"x", len(beat)), (damaged, 0), (beat + damaged + beat, len(beat)),
        (heartbeat(v1=True) + damaged, len(heartbeat(v1=True))), (signed(BEAT)[:-1], 0),
        (beat * many + damaged + beat, many * len(beat)),
    ]  # fmt: skip
    with Bridge() as bridge, udp_peer() as station:
        bridge.add(f"udpout:127.0.0.1:{station.getsockname()[1]}")
        for junk, at in cases:
            place = f"no (whole|good) frame at byte {at} of {len(junk)}: "
            with pytest.raises(ValueError, match=place):
                bridge.send(junk)
        assert report(bridge, "program")["damaged"] == 0, "none was routed"
        bridge.send(b"")
        bridge.send(heartbeat(seq=7))
        assert station.recv(65536) == heartbeat(seq=7), "and nothing before it"


def test_filters_limits_and_duplicates() -> None:
    with Bridge(dedup=LIMIT) as bridge, udp_peer() as station:
        station.settimeout(LIMIT)
        bridge.add(UDP, name="a", block_messages_in=["HEARTBEAT"])
        bridge.add(UDP, name="b")
        bridge.add(
            f"udpout:127.0.0.1:{station.getsockname()[1]}", name="station",
            rates={"ATTITUDE": 0.01}, block_systems_out=[9],
        )  # fmt: skip
        attitudes = [
            pack(mavlink.MAVLink_attitude_message(n, 0, 0, 0, 0, 0, 0), n) for n in range(3)
        ]
        with udp_peer(bridge, "a") as first, udp_peer(bridge, "b") as second:
            for frame in (heartbeat(), heartbeat(sysid=9), *attitudes):
                first.send(frame)
            assert receive(station) == attitudes[0]
            wait_until(
                "them", lambda: peers(bridge, "a") and peers(bridge, "a")[0]["received"] == 5
            )
            for frame in (attitudes[0], heartbeat(sysid=9), heartbeat()):
                second.send(frame)
            assert receive(station) == heartbeat()
            stats = {name: report(bridge, name) for name in ("station",)}
            assert peers(bridge, "a")[0]["filtered_in"] == 2
            assert peers(bridge, "b")[0]["duplicates"] == 1
            assert (stats["station"]["filtered_out"], stats["station"]["limited"]) == (1, 2)


def test_a_server_that_is_not_there_yet_is_tried_again() -> None:
    with socket.socket() as server, Bridge(["tcp:localhost:1"], dedup=0) as bridge:
        server.bind(("127.0.0.1", 0))  # nobody else gets the port, and nobody listens
        server.settimeout(LIMIT)
        bridge.add(f"tcp:127.0.0.1:{server.getsockname()[1]}", name="server", retry=0.05)
        told = wait_until("a refusal", lambda: report(bridge, "server")["error"])
        assert told == os.strerror(errno.ECONNREFUSED), "without Rust's number"
        assert report(bridge, "server")["state"] == "connecting"
        bridge.send(heartbeat())
        wait_until("it", lambda: report(bridge, "server")["dropped"] == 1)
        server.listen()
        with server.accept()[0] as connection:
            connection.settimeout(LIMIT)
            wait_until("it", lambda: report(bridge, "server")["state"] == "up")
            bridge.send(heartbeat(seq=1))
            assert read_exactly(connection, 21) == heartbeat(seq=1), "and nothing old"
            assert report(bridge, "server")["error"] is None


@pytest.mark.skipif(sys.platform != "linux", reason="loopback has a broadcast address on Linux")
def test_broadcast() -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as station:
        station.bind(("", 0))
        station.settimeout(LIMIT)
        port = station.getsockname()[1]
        with Bridge([f"udpbcast:127.255.255.255:{port}"]) as bridge:
            bridge.send(heartbeat())
            frame, sender = station.recvfrom(300)
            assert frame == heartbeat()
            station.sendto(heartbeat(sysid=9), sender)
            assert wait_until("the answer", lambda: bridge.latest("HEARTBEAT", 9))


def test_serial_ports() -> None:
    controller, device = os.openpty()
    try:
        with (
            Bridge([f"serial:{os.ttyname(device)}:57600", UDP]) as bridge,
            udp_peer(bridge, UDP) as station,
        ):
            station.send(heartbeat(sysid=255))
            assert os.read(controller, 300) == heartbeat(sysid=255), "as it is, raw"
            half = heartbeat(sysid=1)
            os.write(controller, half[:7])
            os.write(controller, half[7:])
            assert receive(station) == half
    finally:
        os.close(controller)
        os.close(device)


def test_recording(tmp_path: Path) -> None:
    recording = Recording(tmp_path / "logs", max_bytes=1, flush_interval=0.001)
    key = pack(mavlink.MAVLink_setup_signing_message(1, 1, list(range(32)), 1), 0, 255)
    with Bridge(record=recording) as bridge:
        for n, frame in enumerate((heartbeat(seq=1), key, signed(BEAT)), 1):
            bridge.send(frame)
            written = n - (n > 1)  # the key is not
            wait_until("it", lambda: bridge.stats()["recording"]["records"] >= written)  # noqa: B023
        told = bridge.stats()["recording"]
    assert (told["files"], told["records"], told["dropped"], told["error"]) == (2, 2, 0, None)
    logs = sorted((tmp_path / "logs").iterdir())
    assert Path(told["path"]) in logs and len(logs) == 2
    messages = sorted((msg for log in logs for msg in open_log(log)), key=lambda msg: msg.autopilot)
    assert [msg.get_type() for msg in messages] == ["HEARTBEAT"] * 2
    assert not any(msg.get_signed() for msg in messages)
    assert messages[1].get_msgbuf()[2] == 0, "the signature is off"


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="there is no /dev/full here")
def test_a_full_disk_costs_records_and_nothing_else(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A file size limit stands for the full disk; it is a process of its own that has it."""
    program = f"""
import resource, signal
from mavwire import Bridge, open_log
from mavwire.bridge import Recording
from unit.bridge_tools import wait_until
from unit.link_tools import heartbeat
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (100, resource.RLIM_INFINITY))
with Bridge(record=Recording({str(tmp_path)!r}, flush_interval=0.001)) as bridge:
    bridge.send(b"".join(heartbeat(seq=seq) for seq in range(10)))
    wait_until("the error", lambda: bridge.stats()["recording"]["error"])
    resource.setrlimit(resource.RLIMIT_FSIZE, (resource.RLIM_INFINITY,) * 2)
    bridge.send(heartbeat(seq=99))
    wait_until("room", lambda: bridge.stats()["recording"]["error"] is None)
    told = bridge.stats()["recording"]
assert (told["records"], told["bytes"], told["dropped"]) == (4, 4 * 29, 7), told
assert [msg.get_seq() for msg in open_log(told["path"])] == [0, 1, 2, 99]
"""
    run_alone(program)


def test_a_bridge_that_is_forgotten_ends() -> None:
    bridge = Bridge([UDP]).start()
    port = port_of(bridge, UDP)
    del bridge
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as again:
        again.bind(("127.0.0.1", port))


def test_wrong_arguments() -> None:
    with pytest.raises(ConfigError, match="a link must be a text, not 3"):
        Bridge([3])  # type: ignore[list-item]
    with Bridge() as bridge:
        with pytest.raises(ConfigError, match="max_batch must be a number from 1"):
            bridge.frames(max_batch=0)
        with pytest.raises(ConfigError, match="max_latency must be 0 seconds or more"):
            bridge.frames(max_latency=-1.0)
        with pytest.raises(ConfigError, match="system must be a number from 0 to 255, not 999"):
            bridge.latest("ATTITUDE", 999)
        with pytest.raises(TypeError, match="a message or the bytes of frames can be sent, not 3"):
            bridge.send(3)


@pytest.mark.parametrize("arguments", [(0, 0.0, -1.0), (1, float("nan"), 1.0), (1, -1.0, 1.0)])
def test_wrong_waits(arguments: tuple[int, float, float]) -> None:
    with Bridge() as bridge, pytest.raises(ValueError, match="number of seconds"):
        bridge._running().tap(None, None).next(*arguments)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="there is no fork here")
def test_a_fork_leaves_the_bridge_to_its_parent() -> None:
    program = """
import os, warnings
from mavwire import Bridge
warnings.simplefilter("ignore")
bridge = Bridge(["udpin:127.0.0.1:0"]).start()
batches = bridge.frames()
child = os.fork()
if child == 0:
    for ask in (
        bridge.stats, lambda: bridge.add("udpin:127.0.0.1:0", name="b"), lambda: bridge.send(b""),
        lambda: bridge.latest("HEARTBEAT"), bridge.frames, bridge.kinds,
    ):
        try:
            ask()
        except RuntimeError as error:
            assert "stopped" in str(error)
        else:
            os._exit(1)
    assert batches.next() is None and batches.dropped == 0
    batches.close()
    bridge.stop()
    os._exit(0)
assert os.waitpid(child, 0)[1] == 0
assert bridge.stats()["links"][0]["state"] == "listening"
bridge.stop()
"""
    run_alone(program)


def test_a_fork_waits_for_no_lock_that_the_bridge_holds() -> None:
    """The bridge is busy with its locks while the process forks."""
    program = """
import os, threading, warnings
from mavwire import Bridge
from unit.link_tools import heartbeat
warnings.simplefilter("ignore")
with Bridge() as bridge:
    frames, batches, done = heartbeat() * 500, bridge.frames(), threading.Event()
    def flood():
        while not done.is_set():
            bridge.send(frames)
    sender = threading.Thread(target=flood)
    sender.start()
    for _ in range(20):
        child = os.fork()
        if child == 0:
            assert batches.next() is None
            try:
                bridge.latest("HEARTBEAT")
            except RuntimeError:
                os._exit(0)
            os._exit(1)
        assert os.waitpid(child, 0)[1] == 0
    done.set()
    sender.join()
"""
    run_alone(program)


def test_two_threads_share_the_frames() -> None:
    """One of them may be too late for a frame, and waits for the next; an empty batch means a time-out."""
    count = 300
    with Bridge() as bridge:
        batches = bridge.frames(max_batch=1, max_latency=0)
        got: list[int] = []

        def fetch() -> None:
            while (batch := batches.next()) is not None:
                got.append(len(batch))

        threads = [threading.Thread(target=fetch, daemon=True) for _ in range(3)]
        for thread in threads:
            thread.start()
        for seq in range(count):
            bridge.send(heartbeat(seq=seq % 256))
        wait_until("all", lambda: sum(got) == count)
        bridge.stop()
        for thread in threads:
            thread.join(LIMIT)
        assert got == [1] * count


def test_closing_ends_the_wait_of_another_thread() -> None:
    with Bridge() as bridge:
        batches = bridge.frames()
        ended: list[object] = []
        waiting = threading.Thread(target=lambda: ended.append(batches.next()), daemon=True)
        waiting.start()
        batches.close()
        waiting.join(LIMIT)
        assert ended == [None]
        assert batches.next() is None and batches.dropped == 0


def test_a_broken_installation_is_not_taken_for_a_foreign_system(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    import mavwire._native

    with monkeypatch.context() as patch:
        patch.delattr(mavwire._native, "BridgeCore")
        with pytest.raises(ImportError, match="BridgeCore"):
            Bridge().start()
    monkeypatch.setattr("mavwire.bridge.bridge.os", SimpleNamespace(name="nt"))
    with pytest.raises(OSError, match="POSIX"):
        Bridge().start()


def test_waiting_for_a_batch_ends_with_a_signal(request: pytest.FixtureRequest) -> None:
    """Ctrl-C ends a wait for the first frame, and one for the batch to fill (R65)."""
    import signal

    main_thread = threading.get_ident()
    # A shell starts what runs in the background without it.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    request.addfinalizer(lambda: signal.signal(signal.SIGINT, before))
    with Bridge() as bridge, bridge.frames(max_batch=100, max_latency=10 * LIMIT) as batches:
        for frames in (b"", heartbeat()):
            bridge.send(frames)
            timer = threading.Timer(0.3, signal.pthread_kill, (main_thread, signal.SIGINT))
            with pytest.raises(KeyboardInterrupt):
                timer.start()
                batches.next()
            timer.join()
        bridge.stop()
        batch = batches.next()
        assert batch is not None and batch.frames() == [heartbeat()], "nothing is lost by it"
