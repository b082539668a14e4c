"""What a log shows of itself beside pymavlink's: attributes, progress, and damage that is let pass."""

from __future__ import annotations

import importlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from unit.link_tools import T0, heartbeat, record

KINDS = ("mavlogfile", "mavmmaplog")


@pytest.fixture
def both(monkeypatch: pytest.MonkeyPatch, subject: str, oracle: str) -> Iterator[list[Any]]:
    """mavutil of both packages, with MAVLink 2."""
    monkeypatch.setenv("MAVLINK20", "1")
    packages = [importlib.import_module(f"{name}.mavutil") for name in (subject, oracle)]
    for package in packages:
        package.set_dialect("common")
    yield packages
    monkeypatch.delenv("MAVLINK20")
    for package in packages:
        package.set_dialect("all")


def ten_records(folder: Path, damaged: tuple[int, ...] = ()) -> Path:
    """A log of ten heartbeats; the `damaged` ones have another custom mode than was summed up."""
    records = []
    for seq in range(10):
        frame = bytearray(heartbeat(seq))
        frame[10] ^= seq in damaged
        records.append(record(bytes(frame), T0 + seq))
    path = folder / "ten.tlog"
    path.write_bytes(b"".join(records))
    return path


def seen(msg: Any) -> Any:
    if msg is None or msg.get_type() == "BAD_DATA":
        return msg and "BAD_DATA"
    return msg.get_type(), msg.custom_mode, msg.get_seq()


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("ignore", [0, "1"])
@pytest.mark.parametrize("wanted", [None, "HEARTBEAT"])
def test_checksums_that_are_to_be_ignored(
    both: list[Any], kind: str, ignore: object, wanted: str | None, tmp_path: Path
) -> None:
    """The module's flag may change at any time; it counts from the next call on."""
    path = ten_records(tmp_path, damaged=(3, 6))
    outcomes = []
    for mavutil in both:
        log = getattr(mavutil, kind)(str(path))
        mavutil.mavlink.MAVLINK_IGNORE_CRC = ignore
        try:
            found = [seen(log.recv_msg())] + [seen(log.recv_match(type=wanted)) for _ in range(4)]
            mavutil.mavlink.MAVLINK_IGNORE_CRC = 0
            found += [seen(log.recv_match(type=wanted)) for _ in range(6)]
        finally:
            mavutil.mavlink.MAVLINK_IGNORE_CRC = 0
        outcomes.append((found, log.mav_count))
        log.close()
    assert outcomes[0] == outcomes[1]
    assert (("HEARTBEAT", 5, 3) in outcomes[0][0]) == bool(ignore)


@pytest.mark.parametrize("kind", KINDS)
def test_progress_after_each_message(both: list[Any], kind: str, tmp_path: Path) -> None:
    path = ten_records(tmp_path)
    outcomes = []
    for mavutil in both:
        with getattr(mavutil, kind)(str(path)) as log:
            outcomes.append([(log.recv_msg() is None, log.percent) for _ in range(11)])
    assert outcomes[0] == outcomes[1]
    assert outcomes[0][0] == (False, 0.0)


@pytest.mark.parametrize("kind", KINDS)
def test_attributes_of_a_log(both: list[Any], kind: str, tmp_path: Path) -> None:
    path = ten_records(tmp_path)
    shown = []
    for mavutil in both:
        with getattr(mavutil, kind)(str(path)) as log:
            log.recv_msg()
            log.mine = 7
            shown.append(vars(log))
            assert all(shown[-1][name] is not None for name in ("f", "mav", "_last_message"))
    ours, theirs = shown
    # A constant for computing with.
    assert ours.keys() == theirs.keys() - {"_two64"}
    plain = [name for name, value in theirs.items() if type(value) in (int, float, str, bool, dict)]
    for name in {*plain} - {"_two64", "start_time", "sysid_state", "param_state"}:
        assert ours[name] == theirs[name], name


def test_attributes_of_a_live_link(both: list[Any]) -> None:
    shown = []
    for mavutil in both:
        link = mavutil.mavudp("127.0.0.1:0")
        shown.append(vars(link))
        link.close()
    assert shown[0].keys() - {"_useful_clients"} == shown[1].keys()
