"""Clocks of telemetry logs that step back, wrap, or are several."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import mavwire
import pytest
from mavwire import cli
from mavwire.dialects.v20 import all as mavlink
from unit.link_tools import record

T0 = 1_700_000_000_000_000
TRACKER, COPTER, WINCH = 5, 2, 42


def pack(message: Any, sysid: int = 1, compid: int = 1, seq: int = 0) -> bytes:
    sender = mavlink.MAVLink(None, sysid, compid)
    sender.seq = seq % 256
    frame: bytes = message.pack(sender)
    return frame


def attitude(boot_ms: int, sysid: int = 1, seq: int = 0) -> bytes:
    return pack(mavlink.MAVLink_attitude_message(boot_ms % 2**32, 0, 0, 0, 0, 0, 0), sysid, seq=seq)


def position(boot_ms: int, lat: int, sysid: int) -> bytes:
    message = mavlink.MAVLink_global_position_int_message(boot_ms, lat, 10, 0, 0, 0, 0, 0, 0)
    return pack(message, sysid)


def heartbeat(kind: int, sysid: int) -> bytes:
    return pack(mavlink.MAVLink_heartbeat_message(kind, 3, 81, 0, 4, 3), sysid)


def written(path: Path, records: list[tuple[int, bytes]]) -> Path:
    """A log of frames with milliseconds behind T0."""
    path.write_bytes(b"".join(record(frame, T0 + 1000 * time) for time, frame in records))
    return path


def test_a_clock_that_is_set_back_takes_no_time(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Two stretches of 5 s, the second one an hour before the first by the clock."""
    times = [100 * n for n in range(51)] + [100 * n - 3_600_000 for n in range(52, 103)]
    log = written(
        tmp_path / "a.tlog", [(t, attitude(100 * n + 1, seq=n)) for n, t in enumerate(times)]
    )
    info = mavwire.open_log(log).info()
    assert info.count.seconds == pytest.approx(10.0)
    assert info.set_back == pytest.approx(3599.8)
    assert info.types["ATTITUDE"].rate == pytest.approx(101 / 10.0)
    assert info.senders[1, 1].count.rate == pytest.approx(101 / 10.0)
    assert (info.times_back, info.lost, info.gap_count) == (1, 0, 0)
    assert cli.main(["info", str(log)]) == 0
    said = capsys.readouterr().out
    assert "UTC, 10.0 s" in said and "went back 1 times, by 3,599.8 s" in said
    assert "10.20" in said and " -3" not in said
    assert cli.main(["info", "--json", str(log)]) == 0
    assert json.loads(capsys.readouterr().out)["span"] == pytest.approx(10.0)


def told(log: Path, capsys: pytest.CaptureFixture[str]) -> str:
    """What `mavwire info` prints."""
    assert cli.main(["info", str(log)]) == 0
    return capsys.readouterr().out


def test_a_clock_that_starts_in_1970_takes_no_time(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """600 records of a minute before the clock is set, and 400 behind it."""
    times = [(100_000 if n < 600 else T0) + 100_000 * n for n in range(1000)]
    log = tmp_path / "a.tlog"
    frames = [attitude(100 * n + 1, seq=n) for n in range(1000)]
    log.write_bytes(b"".join(map(record, frames, times)))
    info = mavwire.open_log(log).info()
    assert info.count.seconds == pytest.approx(99.8)
    assert info.types["ATTITUDE"].rate == pytest.approx(999 / 99.8)
    assert (info.times_forward, info.times_back, info.lost, info.gap_count) == (1, 0, 0, 0)
    assert info.set_forward == pytest.approx(1_700_000_000)
    said = told(log, capsys)
    assert (
        "first 1970-01-01 00:00:00, last 2023-11-14 22:14:59 UTC,"
        " 99.8 s without the steps of the clock\n" in said
    )
    assert "clock    went forward 1 times, by 53.9 years\n" in said and "gaps" not in said
    assert re.search(r"^  ATTITUDE +1,000 +10.02$", said, re.MULTILINE)


@pytest.mark.parametrize("place", [0, 500, 501, 999])
def test_a_damaged_time_takes_no_time_and_loses_nothing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], place: int
) -> None:
    """Two links heard each message, the second one a little later."""
    frames = [attitude(100 * (n // 2) + 1, seq=n // 2) for n in range(1000)]
    records = [record(frame, T0 + 100_000 * (n // 2)) for n, frame in enumerate(frames)]
    records[place] = b"\xff" + records[place][1:]
    log = tmp_path / "a.tlog"
    log.write_bytes(b"".join(records))
    info = mavwire.open_log(log).info()
    assert info.count.seconds == pytest.approx(49.9, abs=0.11)
    assert (info.lost, info.repeated, info.gap_count) == (0, 500, 0)
    assert (info.times_forward, info.times_back) == (int(place > 0), int(place < 999))
    said = told(log, capsys)
    if 0 < place < 999:
        assert "first 2023-11-14 22:13:20, last 2023-11-14 22:14:09 UTC" in said
        far = r"by 582,27\d\.\d years"
        assert re.search(f"went back 1 times, {far}; went forward 1 times, {far}\n", said)
    else:
        assert f"{'last' if place else 'first'} year 584" in said


def test_steps_of_some_microseconds_are_no_steps(tmp_path: Path) -> None:
    times = [100_000 * n - (100_030 if n % 2 else 0) for n in range(100)]
    log = tmp_path / "a.tlog"
    log.write_bytes(
        b"".join(record(attitude(n + 1, seq=n), T0 + time) for n, time in enumerate(times))
    )
    info = mavwire.open_log(log).info()
    assert (info.times_back, info.set_back, info.lost) == (0, 0, 0)
    assert info.count.seconds == pytest.approx(9.79997)


@pytest.mark.parametrize(("boots", "reboots"), [
    ([2**32 - 1000 + 100 * n for n in range(1, 100)], 0),  # 49.7 days after the start
    ([4_000_000_000 + 100 * n for n in range(50)] + [100 * n for n in range(1, 50)], 1),
])  # fmt: skip
def test_a_clock_that_wraps_is_no_reboot(tmp_path: Path, boots: list[int], reboots: int) -> None:
    records = [(100 * n, attitude(boot, seq=n)) for n, boot in enumerate(boots)]
    sender = mavwire.open_log(written(tmp_path / "a.tlog", records)).info().senders[1, 1]
    assert (sender.reboots, sender.shared) == (reboots, False)


def test_two_vehicles_with_one_id_are_called_so(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    records = [(50 * n, attitude(50 * n + 10_000 * (n % 2 + 1), seq=n)) for n in range(200)]
    log = written(tmp_path / "a.tlog", records)
    sender = mavwire.open_log(log).info().senders[1, 1]
    assert (sender.reboots, sender.shared) == (0, True)
    assert cli.main(["info", str(log)]) == 0
    said = capsys.readouterr().out
    assert "shared   1/1: several vehicles use this id" in said and "reboots" not in said
    assert cli.main(["info", "--json", str(log)]) == 0
    assert json.loads(capsys.readouterr().out)["shared"] == ["1/1"]


@pytest.mark.parametrize("equipment", [TRACKER, WINCH])
def test_an_antenna_tracker_is_not_the_vehicle(tmp_path: Path, equipment: int) -> None:
    """It was heard first, and more often, and says where it is."""
    pytest.importorskip("numpy")
    from mavwire.plots.expressions import parse
    from mavwire.plots.series import read_series
    from mavwire.plots.track import read_track

    records = [(0, heartbeat(equipment, 2)), (1, heartbeat(COPTER, 1))]
    for n in range(1, 20):
        records += [(100 * n, position(100 * n, 20 + k, 2)) for k in range(3)]
        records += [(100 * n + 50, position(100 * n, 500_000_000 + n, 1))]
    log = written(tmp_path / "a.tlog", records)
    track = read_track(str(log))
    assert track.lat.tolist() == [50.0 + n / 1e7 for n in range(1, 20)]
    (line,) = read_series(str(log), [parse("GLOBAL_POSITION_INT.lat")]).series
    assert line.values.min() > 499_999_999 and len(line.values) == 19
    # Where there is nothing else it is drawn.
    alone = [(time, frame) for time, frame in records if frame[5] == 2]
    assert len(read_track(str(written(tmp_path / "b.tlog", alone))).lat) == 57
    # A vehicle that says where it is comes before one that does not.
    silent = [(0, heartbeat(COPTER, 7)), *records]
    assert read_track(str(written(tmp_path / "c.tlog", silent))).lat.min() > 49


JUMP = (
    "times jump from 2023-11-14 22:13:22 to 4191-05-01 07:09:01"
    " (`mavwire repair` replaces damaged times of telemetry logs)"
)


def with_a_damaged_time(path: Path) -> Path:
    """30 records of three seconds, the 12th of them in another millennium."""
    records = [record(attitude(100 * n + 1, seq=n), T0 + 100_000 * n) for n in range(30)]
    records[11] = b"\x00\xf9" + records[11][2:]
    path.write_bytes(b"".join(records))
    return path


def test_a_clock_of_too_many_ticks_names_the_jump(tmp_path: Path) -> None:
    log = mavwire.open_log(with_a_damaged_time(tmp_path / "a.tlog"))
    with pytest.raises(ValueError, match=re.escape(JUMP)):
        log.align(["ATTITUDE"], rate="50ms")


def test_a_plot_names_the_jump(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("numpy")
    log = with_a_damaged_time(tmp_path / "a.tlog")
    drawing = ["plot", str(log), "ATTITUDE.roll", "-o", str(tmp_path / "a.html")]
    assert cli.main(drawing) == 0
    assert capsys.readouterr().err == f"mavwire plot: {log}: {JUMP}\n"
    assert cli.main([*drawing, "--xaxis", "ATTITUDE.time_boot_ms"]) == 0
    assert capsys.readouterr().err == ""
