"""Hooks of real programs, in both packages: the calls they see, and their effects.

A test clock, a bound on the memory for newest messages, readers and messages of a program's own.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from differential import workload
from unit.link_tools import drain

Scenario = Callable[[workload.Package, pytest.MonkeyPatch], Any]


@pytest.fixture
def agree(
    subject: str, oracle: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Callable[[Scenario], Any]:
    """Runs a scenario in both packages and gives what both answer."""
    monkeypatch.setenv("MAVLINK20", "1")

    def run(scenario: Scenario) -> Any:
        answers = []
        for name in (subject, oracle):
            package = workload.Package(name, tmp_path)
            package.mavutil.set_dialect("all")
            with pytest.MonkeyPatch.context() as patch:
                answers.append(scenario(package, patch))
        assert answers[0] == answers[1]
        return answers[0]

    return run


def receive(package: workload.Package, frames: list[bytes]) -> Any:
    """A UDP link that has received some frames."""
    link = package.mavutil.mavudp("127.0.0.1:0")
    with workload.socket.socket(workload.socket.AF_INET, workload.socket.SOCK_DGRAM) as vehicle:
        vehicle.connect(link.port.getsockname())
        for frame in frames:
            vehicle.send(frame)
        drain(link, blocking=True, timeout=0.05)
    return link


def test_a_clock_of_the_program(agree: Callable[[Scenario], Any]) -> None:
    """In place of the module, as mavutil has it, and in place of its function for everybody."""

    def in_mavutil(package: workload.Package, patch: pytest.MonkeyPatch) -> Any:
        clock = SimpleNamespace(time=lambda: 1000.5, sleep=lambda seconds: None)
        patch.setattr(package.mavutil, "time", clock)
        return stamps(package)

    def for_everybody(package: workload.Package, patch: pytest.MonkeyPatch) -> Any:
        now = iter(range(10**9))
        patch.setattr(time, "time", lambda: 1000.5 + 0 * next(now))
        found = stamps(package)
        patch.undo()
        return found

    def stamps(package: workload.Package) -> Any:
        frames = package.frames[:24]
        link = package.mavutil.mavudp("127.0.0.1:0")
        with workload.socket.socket(workload.socket.AF_INET, workload.socket.SOCK_DGRAM) as vehicle:
            vehicle.connect(link.port.getsockname())
            for frame in frames:
                vehicle.send(frame)
            found = [link.recv_match(blocking=True)._timestamp for _ in frames]
        answer = found, link.start_time, link.timestamp, link.time_since("HEARTBEAT")
        event = package.mavutil.periodic_event(1)
        link.close()
        return *answer, event.last_time

    for scenario in (in_mavutil, for_everybody):
        found, start, newest, since, _ = agree(scenario)
        assert set(found) == {1000.5} and (start, newest, since) == (1000.5, 1000.5, 0)


def test_newest_messages_are_kept_by_the_program(agree: Callable[[Scenario], Any]) -> None:
    """A program that bounds memory keeps what it wants, of logs and of links."""

    def scenario(package: workload.Package, patch: pytest.MonkeyPatch) -> Any:
        asked: list[Any] = []

        def add_message(messages: Any, kind: str, msg: Any) -> None:
            asked.append((kind, msg.get_type()))
            if kind == "HEARTBEAT":
                messages[kind] = msg

        patch.setattr(package.mavutil, "add_message", add_message)
        answers: list[Any] = []
        for log in (
            package.mavutil.mavlogfile(package.file("flight.tlog")),
            package.mavutil.mavlink_connection(package.file("flight.tlog")),
            receive(package, package.frames[:40]),
        ):
            opened = len(asked)
            drain(log)
            answers.append((sorted(log.messages), len(asked) - opened, log.mav_count))
            log.close()
        patch.undo()
        log = package.mavutil.mavlogfile(package.file("flight.tlog"))
        drain(log)
        return answers, sorted(log.messages)

    answers, _ = agree(scenario)
    assert all("HEARTBEAT" in kept and "ATTITUDE" not in kept for kept, _, _ in answers)


def test_a_reader_of_the_program(agree: Callable[[Scenario], Any]) -> None:
    """Times, filters and messages are those that the methods of the derived reader make of them."""

    def scenario(package: workload.Package, patch: pytest.MonkeyPatch) -> Any:
        answers = []
        readers = package.module("DFReader")
        for cls, name in (
            (readers.DFReader_binary, "flight.bin"), (readers.DFReader_text, "flight.log"),
        ):  # fmt: skip
            base: Any = cls

            class Reader(base):
                def _set_time(self, m: Any) -> None:
                    super()._set_time(m)
                    m._timestamp += 1000

                def _add_msg(self, m: Any) -> None:
                    super()._add_msg(m)
                    if m.get_type() == "IMU":
                        self.count = getattr(self, "count", 0) + 1

                def _parse_next(self) -> Any:
                    m = super()._parse_next()
                    while m is not None and m.get_type() == "EV":
                        m = super()._parse_next()
                    return m

            log = Reader(package.file(name))
            log.count = 0
            found = [(m.get_type(), m._timestamp) for m in iter(log.recv_msg, None)]
            log.rewind()
            while (m := log.recv_match(type={"IMU", "EV", "MODE"})) is not None:
                found.append((m.get_type(), m._timestamp))
            answers.append((found, log.count, log.flightmode, sorted(log.messages)))
            log.close()
        return answers

    (found, count, _, _), _ = agree(scenario)
    assert count and "EV" not in {kind for kind, _ in found}


def test_methods_of_a_reader_that_is_open(agree: Callable[[Scenario], Any]) -> None:
    def scenario(package: workload.Package, patch: pytest.MonkeyPatch) -> Any:
        log = package.module("DFReader").DFReader_binary(package.file("flight.bin"))
        log.rewind()
        log._set_time = lambda m: setattr(m, "_timestamp", 7.0)
        found = [(m.get_type(), m._timestamp) for m in iter(log.recv_msg, None)]
        log.close()
        return found

    assert {seconds for _, seconds in agree(scenario)} == {7.0}


def test_a_message_class_of_the_program(agree: Callable[[Scenario], Any]) -> None:
    """`mavlink_map` says what is made of an id, also for links that open later, and what is not."""

    def scenario(package: workload.Package, patch: pytest.MonkeyPatch) -> Any:
        mavlink = package.mavutil.mavlink

        base: Any = mavlink.MAVLink_heartbeat_message

        class Beat(base):
            def __init__(self, *args: Any, **kwargs: Any) -> None:
                super().__init__(*args, **kwargs)
                self.mine = self.custom_mode + 1

        beat, parameter = mavlink.MAVLINK_MSG_ID_HEARTBEAT, mavlink.MAVLINK_MSG_ID_PARAM_VALUE
        patch.setitem(mavlink.mavlink_map, beat, Beat)
        patch.delitem(mavlink.mavlink_map, mavlink.MAVLINK_MSG_ID_ATTITUDE)
        frames = package.frames[:24]
        found = []
        for msg in mavlink.MAVLink(None).parse_buffer(b"".join(frames)):
            shown = (msg.get_type(), str(msg), getattr(msg, "mine", None), msg.get_seq())
            found.append((*shown, bytes(msg.get_msgbuf()), msg.get_srcSystem()))
        log = package.mavutil.mavlogfile(package.file("flight.tlog"))
        of_log = [(m.get_type(), getattr(m, "mine", None)) for m in iter(log.recv_msg, None)]
        newest = getattr(log.messages["HEARTBEAT"], "mine", None)
        patch.undo()
        plain = mavlink.MAVLink(None).parse_char(frames[0])
        if package.name == "mavwire":
            assert "decode" not in vars(mavlink.MAVLink._mavlink_base)  # native again
        return found, of_log, newest, type(plain).__name__, parameter in mavlink.mavlink_map

    found, of_log, newest, plain, _ = agree(scenario)
    assert found[0][2] == 1 and newest is not None and plain == "MAVLink_heartbeat_message"
    assert "UNKNOWN_30" in {kind for kind, _ in of_log}


def test_classes_of_a_dialect_module(agree: Callable[[Scenario], Any]) -> None:
    """Sent, bad and unknown messages are made of the classes that are now in the module."""

    def scenario(package: workload.Package, patch: pytest.MonkeyPatch) -> Any:
        mavlink = package.mavutil.mavlink
        made: list[str] = []

        def own(name: str) -> None:
            base: Any = getattr(mavlink, name)

            class Own(base):
                def __init__(self, *args: Any, **kwargs: Any) -> None:
                    made.append(name)
                    super().__init__(*args, **kwargs)

            patch.setattr(mavlink, name, Own)

        for name in (
            "MAVLink_heartbeat_message",
            "MAVLink_bad_data",
            "MAVLink_unknown",
            "MAVLinkSigning",
        ):
            own(name)
        mav = mavlink.MAVLink(workload.io.BytesIO(), 1, 1)
        mav.robust_parsing = True
        mav.heartbeat_send(1, 2, 3, 4, 5)
        mav.heartbeat_encode(1, 2, 3, 4, 5)
        unknown = bytes([0xFD, 0, 0, 0, 0, 1, 1, 0xFF, 0xFF, 0x7F, 0, 0])
        texts = [str(mav.parse_char(data)) for data in (b"xxxxxxxx", unknown)]
        patch.undo()
        mav.heartbeat_send(1, 2, 3, 4, 5)
        return made, texts, mav.file.getvalue()

    made, _, _ = agree(scenario)
    assert sorted(made) == [
        "MAVLinkSigning", "MAVLink_bad_data", "MAVLink_heartbeat_message", "MAVLink_heartbeat_message",
        "MAVLink_unknown",
    ]  # fmt: skip


def test_a_signature_check_of_the_program(agree: Callable[[Scenario], Any]) -> None:
    def scenario(package: workload.Package, patch: pytest.MonkeyPatch) -> Any:
        mavlink = package.mavutil.mavlink
        asked = []

        base: Any = mavlink.MAVLink

        class Own(base):
            def check_signature(self, msgbuf: Any, system: int, component: int) -> Any:
                asked.append((len(msgbuf), system, component))
                return super().check_signature(msgbuf, system, component) and len(asked) != 2

        sender, receiver = mavlink.MAVLink(None, 1, 1), Own(None, 2, 2)
        receiver.robust_parsing = True
        for mav in (sender, receiver):
            mav.signing.secret_key = bytes(32)
        sender.signing.sign_outgoing = True
        sender.signing.timestamp = receiver.signing.timestamp = 1
        found = []
        for _ in range(3):
            frame = mavlink.MAVLink_heartbeat_message(2, 3, 81, 4, 4, 3).pack(sender)
            sender.seq += 1
            msg = receiver.parse_char(frame)
            found.append((msg.get_type(), msg.get_signed()))
        return asked, found, receiver.signing.sig_count, receiver.signing.badsig_count

    _, found, _, _ = agree(scenario)
    assert [kind for kind, _ in found] == ["HEARTBEAT", "BAD_DATA", "HEARTBEAT"]


def test_functions_of_expressions(agree: Callable[[Scenario], Any]) -> None:
    def scenario(package: workload.Package, patch: pytest.MonkeyPatch) -> Any:
        module = package.module("mavexpression")
        patch.setattr(module, "kmh", lambda value: value * 2)
        patch.setattr(module, "own", lambda value: value + 1, raising=False)
        return [
            package.mavutil.evaluate_expression(text, {"A": SimpleNamespace(x=3)})
            for text in ("kmh(A.x)", "own(A.x)")
        ]

    assert agree(scenario) == [6, 4]
