"""Shadow mode raises no false alarm: deliberate differences, callbacks, subclasses, threads, logs."""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys
import textwrap
import threading
from collections.abc import Callable
from pathlib import Path
from random import Random
from types import ModuleType
from typing import Any

import pytest
from differential import frames, streams

from .shadow_tools import KEY, Log, shadowed  # noqa: F401

Loader = Callable[[str], ModuleType]
NAN_FRAME_FIELD = b"\x01\x00\xa0\x7f"  # a signalling NaN
RECEIVERS = {
    "robust": streams.Receiver(),
    "strict": streams.Receiver(robust=False),
    "keyed": streams.Receiver(keyed=True),
    "keyed-accepting": streams.Receiver(keyed=True, accept_unsigned=True),
    "keyed-refusing": streams.Receiver(robust=False, keyed=True, accept_unsigned=False),
}


@pytest.fixture
def module(shadowed: Loader) -> ModuleType:  # noqa: F811
    return shadowed("v20.common")


def feed(mav: Any, module: ModuleType, data: bytes, size: int) -> int:
    """Feeds a stream; the number of messages."""
    count = 0
    for index, chunk in enumerate(streams.chunks(data, size)):
        try:
            found = mav.parse_buffer(chunk) if index % 2 else [mav.parse_char(chunk)]
        except module.MAVError:
            continue
        count += sum(one is not None for one in found or [])
    return count


@pytest.mark.parametrize("receiver", RECEIVERS.values(), ids=RECEIVERS)
@pytest.mark.parametrize("name", ["v20.common", "v10.ardupilotmega"])
def test_damaged_streams(shadowed: Loader, receiver: streams.Receiver, name: str) -> None:  # noqa: F811
    module = shadowed(name)
    every = frames.layouts(module)
    count = 0
    for seed in range(12):
        data = streams.stream(seed, every, 30, receiver.keyed or seed % 5 == 0)
        count += feed(receiver.make(module), module, data, streams.CHUNKS[seed])
    assert count > 50


def sign(frame: bytes, timestamp: int, key: bytes = KEY, link_id: int = 1) -> bytes:
    """A MAVLink 2 frame, signed; its checksum is that of the signed frame."""
    body = frame[1:2] + b"\1" + frame[3:-2]
    extra = bytes([50])  # HEARTBEAT's
    frame = b"\xfd" + body + frames.x25(body + extra).to_bytes(2, "little")
    frame += bytes([link_id]) + timestamp.to_bytes(6, "little")
    return frame + hashlib.sha256(key + frame).digest()[:6]


def test_differences_of_signing_are_no_alarm(module: ModuleType) -> None:
    """A forged frame moves no timestamp, and unknown ids are under the policy."""
    plain = module.MAVLink_heartbeat_message(2, 3, 81, 4, 4, 3).pack(module.MAVLink(None, 1, 1))
    mav = module.MAVLink(None)
    mav.robust_parsing = True
    mav.signing.secret_key = KEY
    unknown = bytearray(plain)
    unknown[7:10] = b"\xff\xff\x01"
    forged = sign(plain, 5000, key=bytes(32))
    answers = [
        mav.parse_char(one)
        for one in (sign(plain, 1000), forged, sign(plain, 1001), bytes(unknown), sign(plain, 1001))
    ]
    assert [one.get_type() for one in answers] == [
        *("HEARTBEAT", "BAD_DATA", "HEARTBEAT", "BAD_DATA", "BAD_DATA")
    ]
    assert mav.signing.stream_timestamps == {(1, 1, 1): 1001}


def test_policy_is_asked_once_for_each_frame(module: ModuleType) -> None:
    asked = []
    mav = module.MAVLink(None)
    mav.signing.secret_key = KEY

    def allow(link: Any, msgid: int) -> bool:
        asked.append((link is mav, msgid))
        return len(asked) != 2

    mav.signing.allow_unsigned_callback = allow
    mav.robust_parsing = True
    frame = module.MAVLink_heartbeat_message(2, 3, 81, 4, 4, 3).pack(module.MAVLink(None))
    found = mav.parse_buffer(frame * 3)
    assert [one.get_type() for one in found] == ["HEARTBEAT", "BAD_DATA", "HEARTBEAT"]
    assert asked == [(True, 0)] * 3
    assert mav.signing.allow_unsigned_callback == allow


def test_a_policy_that_raises_ends_the_call_and_costs_one_frame(module: ModuleType) -> None:
    def refuse(link: Any, msgid: int) -> bool:
        if link.signing.reject_count == 1:
            raise RuntimeError("mine")
        return False

    mav = module.MAVLink(None)
    mav.signing.secret_key = KEY
    mav.signing.allow_unsigned_callback = refuse
    mav.robust_parsing = True
    frame = module.MAVLink_heartbeat_message(2, 3, 81, 4, 4, 3).pack(module.MAVLink(None))
    with pytest.raises(RuntimeError, match="mine"):
        mav.parse_buffer(frame * 4)
    assert mav.buf_len() == 2 * len(frame)
    mav.signing.allow_unsigned_callback = None
    found = mav.parse_buffer(b"")
    assert [one.get_type() for one in found] == ["BAD_DATA"] * 2


def test_callback_may_change_messages_and_counters(module: ModuleType) -> None:
    seen = []

    def change(msg: Any) -> None:
        seen.append(msg.custom_mode)
        msg.custom_mode = 77
        mav.total_packets_received = 0

    mav = module.MAVLink(None)
    mav.set_callback(change)
    frame = module.MAVLink_heartbeat_message(2, 3, 81, 4, 4, 3).pack(module.MAVLink(None))
    assert [one.custom_mode for one in mav.parse_buffer(frame * 2)] == [77, 77]
    assert mav.callback == change and seen == [4, 4]


def test_failing_callback_fails_and_the_stream_goes_on(module: ModuleType) -> None:
    def fail(msg: Any) -> None:
        raise RuntimeError("mine")

    mav = module.MAVLink(None)
    mav.set_callback(fail)
    frame = module.MAVLink_heartbeat_message(2, 3, 81, 4, 4, 3).pack(module.MAVLink(None))
    with pytest.raises(RuntimeError, match="mine"):
        mav.parse_buffer(frame * 3)
    mav.set_callback(None)
    assert len(mav.parse_buffer(b"")) == 2


def test_subclass_decides_itself_and_its_decoding_is_compared(module: ModuleType) -> None:
    class Choosy(module.MAVLink):  # type: ignore[name-defined,misc]
        def decode(self, msgbuf: bytearray) -> Any:
            msg = super().decode(msgbuf)
            if msg.get_type() == "HEARTBEAT":
                raise module.MAVError("no heartbeats")
            return msg

    mav = Choosy(None)
    mav.robust_parsing = True
    frame = module.MAVLink_heartbeat_message(2, 3, 81, 4, 4, 3).pack(module.MAVLink(None))
    assert [one.get_type() for one in mav.parse_buffer(frame)] == ["BAD_DATA"]


def test_rescan_is_left_alone(module: ModuleType) -> None:
    mav = module.MAVLink(None)
    mav.robust_parsing = True
    mav.resync = "rescan"
    frame = module.MAVLink_heartbeat_message(2, 3, 81, 4, 4, 3).pack(module.MAVLink(None))
    damaged = b"\xfd\x20" + frame + b"\0" * 40 + frame
    kinds = [one.get_type() for one in mav.parse_buffer(damaged)]
    assert kinds.count("HEARTBEAT") == 2
    mav.resync = "skip"
    assert mav.parse_buffer(frame * 2)


def test_buffer_that_the_program_replaces(module: ModuleType) -> None:
    mav = module.MAVLink(None)
    frame = module.MAVLink_heartbeat_message(2, 3, 81, 4, 4, 3).pack(module.MAVLink(None))
    assert mav.parse_char(frame[:10]) is None
    mav.buf = bytearray()
    mav.total_bytes_received = 0
    assert [one.get_type() for one in mav.parse_buffer(frame)] == ["HEARTBEAT"]


def test_deliberate_differences_of_sending(module: ModuleType) -> None:
    """Extensions and signatures in MAVLink 1, and the bits of a NaN."""
    file = Log()
    mav = module.MAVLink(file, 1, 1)
    mav.statustext_send(6, b"hello", id=7, chunk_seq=1, force_mavlink1=True)
    mav.attitude_send(1, 2, 3, 4, 5, 6, 7)
    frame = bytearray(file[-1])
    frame[14:18] = NAN_FRAME_FIELD
    body = bytes(frame[1:-2])
    extra = bytes([module.MAVLink_attitude_message.crc_extra])
    frame[-2:] = frames.x25(body + extra).to_bytes(2, "little")
    msg = mav.decode(frame)
    mav.send(msg)
    assert file[-1][14:18] == NAN_FRAME_FIELD
    mav.signing.secret_key, mav.signing.sign_outgoing = KEY, True
    mav.heartbeat_send(2, 3, 81, 4, 4, force_mavlink1=True)
    assert len(file) == 4


def test_failing_file_is_no_alarm(module: ModuleType) -> None:
    class Closed:
        def write(self, buf: bytes) -> None:
            raise OSError("closed")

    mav = module.MAVLink(Closed(), 1, 1)
    with pytest.raises(OSError, match="closed"):
        mav.heartbeat_send(2, 3, 81, 4, 4)
    assert mav.seq == 0
    mav.file = None
    with pytest.raises(AttributeError, match="write"):
        mav.heartbeat_send(2, 3, 81, 4, 4)
    mav.file = file = Log()
    assert mav.file is file
    mav.heartbeat_send(2, 3, 81, 4, 4)
    assert len(file) == 1


def test_wrong_arguments_raise_what_they_raise(module: ModuleType) -> None:
    mav = module.MAVLink(Log(), 1, 1)
    with pytest.raises(Exception, match="ubyte format requires"):
        mav.heartbeat_send(2, 3, 81, 4, 999)
    with pytest.raises(TypeError, match="heartbeat_send"):
        mav.heartbeat_send(2)
    with pytest.raises(TypeError):
        mav.parse_char("text")
    for wrong in (b"bytes", [1, 2], None):
        with pytest.raises(AttributeError, match="append"):
            mav.decode(wrong)
    assert mav.heartbeat_send.__name__ == "heartbeat_send"


def test_messages_edited_and_passed_on(module: ModuleType) -> None:
    file = Log()
    mav = module.MAVLink(file, 7, 8)
    received = module.MAVLink(None)
    source = module.MAVLink(None, 1, 1)
    for values in ((b"ABC", 1.5, 9, 10, 1), (b"\xff\x00x", -0.0, 9, 10, 1)):
        msg = received.decode(bytearray(module.MAVLink_param_value_message(*values).pack(source)))
        mav.send(msg)
        msg.param_value = 3.5
        msg.param_id = "text that packing ignores"
        mav.send(msg)
    assert len(file) == 4 and mav.seq == 4


def test_send_callback_may_send(module: ModuleType) -> None:
    file = Log()
    mav = module.MAVLink(file, 1, 1)

    def echo(msg: Any) -> None:
        if msg.get_type() == "HEARTBEAT":
            mav.system_time_send(1, 2)

    mav.set_send_callback(echo)
    mav.heartbeat_send(2, 3, 81, 4, 4)
    assert [frame[7] for frame in file] == [0, 2]


def test_threads_send_signed_while_another_receives(module: ModuleType) -> None:
    file = Log()
    mav = module.MAVLink(file, 1, 1)
    mav.signing.secret_key, mav.signing.sign_outgoing = KEY, True
    plain = module.MAVLink_heartbeat_message(2, 3, 81, 4, 4, 3).pack(module.MAVLink(None, 1, 1))
    failures: list[Exception] = []

    def run(act: Callable[[int], Any]) -> None:
        try:
            for index in range(150):
                act(index)
        except Exception as error:
            failures.append(error)

    def receive(index: int) -> None:
        # Ahead of what is sent, so that receiving moves the timestamp.
        assert mav.parse_char(sign(plain, 10_000 + 1000 * index)).get_signed()

    actions = [lambda _: mav.heartbeat_send(2, 3, 81, 4, 4)] * 3 + [receive]
    threads = [threading.Thread(target=run, args=(act,)) for act in actions]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not failures
    assert len(file) == 450 and {frame[4] for frame in file} == set(range(256))
    assert len({frame[-12:-6] for frame in file}) == 450


def run_script(code: str, *args: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-W", "error", "-c", textwrap.dedent(code), *args],
        env=os.environ | {"MAVWIRE_SHADOW": "pymavlink"},
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.fixture
def log(tmp_path: Path, oracle: str) -> Path:
    """A telemetry log with damage."""
    from mavwire.dialects.v20 import common

    every = frames.layouts(common)
    maker = frames.FrameMaker(3)
    random = Random(4)
    path = tmp_path / "flight.tlog"
    with path.open("wb") as file:
        for index, frame in enumerate(maker.frames(every, 400)):
            if random.random() < 0.05:
                frame = frame[:-1] + bytes([frame[-1] ^ 1])  # noqa: PLW2901
            stamp = (1_600_000_000_000_000 + index * 10_000) & ~3
            file.write(stamp.to_bytes(8, "big") + frame)
    return path


READ = """
    import sys
    import mavwire
    mavwire.install_as_pymavlink()
    from pymavlink import mavutil
    import mavwire.mavutil
    assert mavutil is mavwire.mavutil
    log = mavutil.mavlink_connection(sys.argv[1])
    inner = type(log.mav).__mro__[1]
    {breakage}
    log.rewind()
    count = 0
    while log.recv_match() is not None:
        count += 1
    import pymavlink.dialects.v20.common as common
    assert common.__name__ == "mavwire.dialects.v20.common"
    log.close()
    print(count)
"""
BREAKAGE = """def wrong(self, data, original=inner.parse_char):
        msg = original(self, data)
        if msg is not None and msg.get_type() == "ATTITUDE":
            msg.roll = 1000.0
        return msg
    inner.parse_char = wrong"""


def test_log_through_the_alias(log: Path) -> None:
    run = run_script(READ.format(breakage=""), str(log))
    assert (run.stdout, run.stderr, run.returncode) == ("400\n", "", 0)


def test_broken_log_reading_through_the_alias(log: Path) -> None:
    run = run_script(READ.format(breakage=BREAKAGE), str(log))
    assert run.returncode == 1 and "ShadowMismatch: " in run.stderr
    assert "parse_char at byte" in run.stderr and "roll : 1000.0" in run.stderr


def test_dump_is_the_same(log: Path) -> None:
    command = [sys.executable, "-m", "mavwire", "dump", str(log)]
    plain, shadow = (
        subprocess.run(
            command, env=os.environ | {"MAVWIRE_SHADOW": chosen}, capture_output=True, check=False
        )
        for chosen in ("", "pymavlink")
    )
    assert (shadow.stdout, shadow.stderr, shadow.returncode) == (plain.stdout, b"", 0)
    assert plain.stdout.count(b"2020-09-13 ") == 400


def test_pymavlink_that_the_program_imports_is_another(oracle: str) -> None:
    run = run_script(
        """
        from mavwire.dialects.v20 import common
        mav = common.MAVLink(None)
        assert "pymavlink" not in __import__("sys").modules
        from pymavlink.dialects.v20 import common as theirs
        assert theirs.__name__ == "pymavlink.dialects.v20.common"
        common.WIRE_PROTOCOL_VERSION = "1.0"
        mav.parse_char(b"")
        assert theirs.WIRE_PROTOCOL_VERSION == "2.0"
        """
    )
    assert (run.stderr, run.returncode) == ("", 0)


def test_dialects_without_counterpart_are_told_once(oracle: str) -> None:
    run = run_script(
        """
        from mavwire import dialects
        xml = '<mavlink><messages><message id="1" name="A"><field type="uint8_t" name="b"/>'
        custom = dialects.load(xml + "</message></messages></mavlink>", name="mine")
        again = dialects.load(xml + "</message></messages></mavlink>", name="mine")
        from mavwire.dialects.v20 import upstream
        for module in (custom, again, upstream, upstream):
            link = module.MAVLink(None)
            link.robust_parsing = True
            assert link.parse_buffer(b"xyz")[0].get_type() == "BAD_DATA"
        """
    )
    assert run.returncode == 0, run.stderr
    lines = run.stderr.splitlines()
    assert [line.split()[1] for line in lines] == [
        "mavwire.dialects.loaded.mine",
        "mavwire.dialects.v20.upstream",
    ]
    assert all("no counterpart in pymavlink, not compared" in line for line in lines)


def test_missing_pymavlink_is_said_clearly() -> None:
    run = run_script(
        """
        import sys
        class Nothing:
            def find_spec(self, name, path=None, target=None):
                if name.partition(".")[0] == "pymavlink":
                    raise ModuleNotFoundError(f"No module named {name!r}", name=name)
        sys.meta_path.insert(0, Nothing())
        from mavwire.dialects.v20 import common
        common.MAVLink(None)
        """
    )
    assert run.returncode == 1
    assert "ImportError: MAVWIRE_SHADOW=pymavlink is set, but pymavlink cannot be imp" in run.stderr


def test_other_references_are_refused() -> None:
    run = subprocess.run(
        [sys.executable, "-c", "import mavwire.dialects.v20.common"],
        env=os.environ | {"MAVWIRE_SHADOW": "mavsdk"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert "ValueError: MAVWIRE_SHADOW must be 'pymavlink' or unset, not 'mavsdk'" in run.stderr


def test_nothing_of_it_without_the_variable() -> None:
    code = """
        import sys
        from mavwire import mavutil
        from mavwire.dialects.v20 import common
        common.MAVLink(None).parse_char(b"")
        assert not [name for name in sys.modules if "shadow" in name or "pymavlink" in name]
        assert common.MAVLink.__mro__[1].__module__ == "mavwire._native"
    """
    subprocess.run(
        [sys.executable, "-c", textwrap.dedent(code)],
        env={name: value for name, value in os.environ.items() if name != "MAVWIRE_SHADOW"},
        check=True,
    )
