"""A raw stream, frames without time stamps, is one log for all that reads it."""

from __future__ import annotations

import json
import shutil
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import mavwire
import pytest
from mavwire import cli, mavutil, traffic
from mavwire._native import LogKind
from mavwire.dialects.v20 import all as mavlink
from mavwire.fleet.cuts import find_cuts
from mavwire.links.recognise import log_kind
from mavwire.plots.expressions import parse
from mavwire.plots.series import read_series
from unit.link_tools import heartbeat, record

COUNT = 400


@pytest.fixture(params=["flight.raw", "flight.tlog", "flight.BIN", "flight"])
def raw(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    stamped, path = tmp_path / "stamped.tlog", tmp_path / request.param
    traffic.generate(stamped, COUNT)
    path.write_bytes(b"".join(bytes(msg.get_msgbuf()) for msg in mavwire.open_log(stamped)))
    return path


def types_of(path: Path) -> Counter[str]:
    """What the log holds, by the twin with time stamps."""
    return Counter(msg.get_type() for msg in mavwire.open_log(path.with_name("stamped.tlog")))


def by_mavutil(path: Path, **options: Any) -> list[Any]:
    with mavutil.mavlink_connection(str(path), **options) as log:
        return list(iter(log.recv_msg, None))


def test_every_reader_finds_the_same_messages(raw: Path) -> None:
    expected = types_of(raw)
    found = [
        Counter(msg.get_type() for msg in by_mavutil(raw)),
        Counter(msg.get_type() for msg in mavwire.open_log(raw)),
        Counter({name: len(table) for name, table in mavwire.read(raw).items()}),
        Counter({name: one.messages for name, one in mavwire.open_log(raw).info().types.items()}),
    ]
    if raw.suffix != ".BIN":  # which is a dataflash log to who says how it is to be read
        found.append(Counter(msg.get_type() for msg in by_mavutil(raw, append=True)))
    assert found == [expected] * len(found)


def test_every_reader_finds_the_same_times(raw: Path) -> None:
    """Of one system those of pymavlink with `notimestamps=True`; a first message tells 0, which is no time."""
    stamps = [msg._timestamp for msg in by_mavutil(raw)]
    assert [msg._timestamp for msg in mavwire.open_log(raw)] == stamps
    if raw.suffix != ".BIN":
        theirs = [msg._timestamp for msg in by_mavutil(raw, notimestamps=True)]
        assert stamps == pytest.approx(theirs)
    own = [msg.time_boot_ms / 1e3 for msg in mavwire.open_log(raw).messages(["ATTITUDE"])]
    times = mavwire.read(raw, "ATTITUDE")["ATTITUDE"]["timestamp"][1:]
    assert (times.astype("int64") / 1e6).tolist() == pytest.approx(own[1:])
    info = mavwire.open_log(raw).info()
    assert (info.count.first, info.count.last) == pytest.approx((0.1, stamps[-1]))


@pytest.mark.parametrize("command", [
    "dump", "loss", "msgstats", "summarize", "search", "sigloss", "flightmodes", "flighttime",
    "gpslock", "parms", "magfit", "extract", "togpx", "tomfile", "sensor_status_change",
])  # fmt: skip
def test_commands_answer_as_for_the_log_with_time_stamps(
    command: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: Any
) -> None:
    """Where no absolute time is part of the answer."""
    monkeypatch.chdir(tmp_path)
    stamped = tmp_path / "stamped.tlog"
    traffic.generate(stamped, COUNT)
    frames = b"".join(bytes(msg.get_msgbuf()) for msg in mavwire.open_log(stamped))
    said = []
    for content in (stamped.read_bytes(), frames):
        path = tmp_path / "same.tlog"
        path.write_bytes(content)
        code = cli.main([command, str(path)])
        printed = capsys.readouterr()
        said.append((code, printed.out.count("\n"), printed.err))
    assert said[0] == said[1]


def test_dump_loss_and_info_count_the_same(raw: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["dump", str(raw)]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == COUNT and all(line.startswith("1970-01-01 ") for line in lines)
    assert cli.main(["loss", str(raw)]) == 0
    assert f"Total: {COUNT} packets, 0 lost" in capsys.readouterr().out
    assert cli.main(["info", "--json", str(raw)]) == 0
    told = json.loads(capsys.readouterr().out)
    assert (told["messages"], told["lost"], told["stamped"]) == (COUNT, 0, False)
    assert (told["first"], told["span"]) == pytest.approx((0.1, 3.6))


def attitude(system: int, millis: int, roll: float) -> bytes:
    message = mavlink.MAVLink_attitude_message(millis, roll, 0.0, 0.0, 0.0, 0.0, 0.0)
    frame: bytes = message.pack(mavlink.MAVLink(None, system, 1))
    return frame


@pytest.mark.parametrize("options", [{}, {"resync": "rescan"}, {"append": True}])
def test_the_first_clock_gives_the_times_of_all_systems(
    options: dict[str, Any], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """And its wrap after 49.7 days goes on."""
    path, wrap = tmp_path / "two.raw", 1 << 32
    path.write_bytes(
        heartbeat()
        + b"".join(
            attitude(1, (wrap - 1000 + 500 * n) % wrap + 1, n) + attitude(2, 500_000 + n, 10 + n)
            for n in range(5)
        )
    )
    clock = [(wrap - 999 + 500 * n) / 1e3 for n in range(5)]
    expected = [0.0] + [time for one in clock for time in (one, one)]
    with mavutil.mavlink_connection(str(path), **options) as log:
        slowly = list(iter(log._recv_by_methods, None))
    for messages in (mavwire.open_log(path), by_mavutil(path, **options), slowly):
        assert [msg._timestamp for msg in messages] == pytest.approx(expected)
    table = mavwire.read(path, "ATTITUDE")["ATTITUDE"]["timestamp"].astype("int64") / 1e6
    assert table.tolist() == pytest.approx(expected[1:])
    for more in ([], ["--verbose"]):
        assert cli.main(["dump", "--types", "ATTITUDE", *more, str(path)]) == 0
        lines = [line for line in capsys.readouterr().out.splitlines() if "ATTITUDE" in line]
        assert len(lines) == 10 and all(line.startswith("1970-02-19 17:02:4") for line in lines)
    texts = ["ATTITUDE.roll", "ATTITUDE.roll**2"]  # by columns, and by messages
    for series in read_series(str(path), [parse(text) for text in texts], system=2).series:
        assert series.times.tolist() == pytest.approx(clock)


def test_plots_and_maps(raw: Path, tmp_path: Path) -> None:
    pytest.importorskip("numpy")
    from mavwire.plots.expressions import parse
    from mavwire.plots.series import read_series
    from mavwire.plots.track import read_track

    if raw.suffix == ".BIN":
        pytest.skip("one name is enough")
    stamped = raw.with_name("stamped.tlog")
    (line,), (with_stamps,) = (
        read_series(str(path), [parse("ATTITUDE.roll")]).series for path in (raw, stamped)
    )
    # The first one has no time: its clock shows 0.
    assert line.values.tolist() == with_stamps.values.tolist()[1:] and line.left_out == 1
    ours, theirs = read_track(str(raw)), read_track(str(stamped))
    assert ours.lat.tolist() == theirs.lat.tolist() and len(ours.modes) == len(theirs.modes)


@pytest.mark.parametrize("refused", [
    lambda path, out: cli.main(["cut", "--start", "1", "-o", str(out), str(path)]),
    lambda path, out: cli.main(["merge", "--exact", "-o", str(out), str(path), str(path)]),
    lambda path, out: cli.main(["convert", "--format", "mcap", "-o", str(out), str(path)]),
    lambda path, out: cli.main(["convert", "--start", "1", "-o", str(out), str(path)]),
])  # fmt: skip
def test_what_needs_time_stamps_is_refused(
    refused: Callable[[Path, Path], int], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "a.raw"
    path.write_bytes(heartbeat() * 9)
    assert refused(path, tmp_path / "out") == 1
    assert "no time stamps" in (said := capsys.readouterr().err) or "needs a time stamp" in said


def test_a_raw_stream_is_not_cut_into_parts(tmp_path: Path) -> None:
    """The times of its frames depend on all frames before."""
    log, raw = tmp_path / "long.tlog", tmp_path / "long.raw"
    log.write_bytes(b"".join(record(heartbeat(n % 256), 4 * n) for n in range(200_000)))
    raw.write_bytes(b"".join(heartbeat(n % 256) for n in range(300_000)))
    assert len(find_cuts(str(log), 1 << 20)) > 1
    assert find_cuts(str(raw), 1 << 20) == []


def test_what_is_written_is_not_recognised(tmp_path: Path) -> None:
    """A log that is opened to be written gets records with time stamps, whatever it held."""
    path = tmp_path / "a.tlog"
    path.write_bytes(heartbeat() * 3)
    with mavutil.mavlink_connection(str(path), write=True, append=True) as log:
        assert not log.notimestamps
    shutil.copy(path, tmp_path / "b.tlog")
    assert [log_kind(str(tmp_path / name), True) for name in ("a.tlog", "b.tlog")] == [
        LogKind.RAW
    ] * 2
    path.write_bytes(b"no log " * 3000)
    assert log_kind(str(path), True) is LogKind.TLOG


def test_a_plot_of_a_stream_whose_clock_begins_later(tmp_path: Path) -> None:
    sender = mavlink.MAVLink(None, 1, 1)
    messages = [mavlink.MAVLink_heartbeat_message(2, 3, 81, 0, 4, 3)]
    messages += [
        mavlink.MAVLink_attitude_message(1000 + n, n, 0.0, 0.0, 0.0, 0.0, 0.0) for n in range(5)
    ]
    path = tmp_path / "x.raw"
    path.write_bytes(b"".join(message.pack(sender) for message in messages))
    found = read_series(str(path), [parse("ATTITUDE.roll")])
    assert found.series[0].values.tolist() == [0, 1, 2, 3, 4]
    assert found.modes == []
