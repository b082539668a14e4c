"""What the tools do differently from pymavlink's scripts, and how they refuse what they cannot do."""

from __future__ import annotations

import os
import subprocess
import sys
from datetime import timedelta
from pathlib import Path

import pytest
from mavwire import cli, mavutil, traffic
from mavwire.cli._errors import CommandError
from mavwire.cli._reading import definitions
from mavwire.cli.logs.flightmodes import _duration
from mavwire.cli.logs.loss import Losses
from mavwire.dialects.v20 import ardupilotmega as mavlink
from mavwire.links import state
from tool_runs import Log, attitude, flight_log, heartbeat, random_log

READERS = (
    "parms", "flightmodes", "flighttime", "loss", "summarize", "mission", "togpx", "search",
    "extract", "msgstats", "tomfile",
)  # fmt: skip


def run(capsys: pytest.CaptureFixture[str], *arguments: str | Path) -> str:
    """Standard output of a subcommand that succeeds."""
    assert cli.main([str(one) for one in arguments]) == 0
    return capsys.readouterr().out


def fails(capsys: pytest.CaptureFixture[str], *arguments: str | Path) -> str:
    """What a subcommand says that fails: one line."""
    assert cli.main([str(one) for one in arguments]) == 1
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    return error


def messages(path: Path) -> list[tuple[float, str]]:
    """Time and text of each message of a log."""
    log = mavutil.mavlogfile(str(path))
    return [(msg._timestamp, str(msg)) for msg in iter(log.recv_msg, None)]


@pytest.mark.parametrize("verb", READERS)
def test_a_log_that_is_not_there(verb: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert fails(capsys, verb, "none.tlog") == f"mavwire {verb}: error: no such log: none.tlog\n"


@pytest.mark.parametrize("verb", READERS)
def test_a_log_is_read_without_what_tables_need(verb: str, tmp_path: Path) -> None:
    """Which would take as long as the start of all else."""
    path = tmp_path / "a.tlog"
    flight_log(path)
    listing = (
        "import sys; from mavwire import cli; status = cli.main(sys.argv[1:]);"
        " print(*sorted(sys.modules), file=sys.stderr); sys.exit(status)"
    )
    command = [sys.executable, "-c", listing, verb, path]
    done = subprocess.run(command, capture_output=True, text=True, check=True, cwd=tmp_path)
    loaded = set(done.stderr.split())
    assert "mavwire.mavutil" in loaded
    assert not {"mavwire.logs", "dataclasses", "inspect", "tempfile"} & loaded


@pytest.mark.parametrize("verb", READERS)
def test_a_file_that_is_no_log(
    verb: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "archive.tlog"
    path.write_bytes(b"PK\x03\x04" + bytes(500))
    assert cli.main([verb, str(path)]) == 0
    assert "a ZIP archive, not a telemetry log" in capsys.readouterr().err
    path.write_bytes(b"\x1f\x8b\x08" + bytes(500))
    assert cli.main([verb, str(path)]) == 1
    assert "a gzip file, not a telemetry log" in capsys.readouterr().err


@pytest.mark.parametrize("verb", ["loss", "bitmask_change"])
def test_what_only_telemetry_has(
    verb: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    class Dataflash:
        """A log without senders and frames."""

        def close(self) -> None:
            """Nothing is open."""

    path = tmp_path / "flight.bin"
    path.write_bytes(b"\xa3\x95\x80" + bytes(86))
    monkeypatch.setattr(mavutil, "mavlink_connection", lambda *_, **__: Dataflash())
    more = ["HEARTBEAT.type"] if verb == "bitmask_change" else []
    assert "is a dataflash log; this is for telemetry only" in fails(capsys, verb, path, *more)


def test_a_condition_that_is_wrong(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = flight_log(tmp_path / "flight.tlog")
    for verb in ("flighttime", "summarize", "togpx", "search", "tomfile"):
        assert "--condition 'import os'" in fails(capsys, verb, path, "--condition", "import os")


@pytest.mark.parametrize("condition", ["(", "", "GPS_RAW_INT.nope>1", "__import__('os')"])
@pytest.mark.parametrize("verb", ["extract", "loss"])
def test_a_wrong_condition_that_no_message_asks_for(
    verb: str, condition: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """No stretch of the log is in that mode, and `loss` counts all messages."""
    path = flight_log(tmp_path / "flight.tlog")
    options = ["--mode", "no_such_mode"] if verb == "extract" else []
    said = fails(capsys, verb, path, *options, "--condition", condition)
    assert said.startswith(f"mavwire {verb}: error: --condition {condition!r}: ")


def test_gaps_that_were_not_counted_by_type() -> None:
    """ValueError also where there is no gap."""
    with pytest.raises(ValueError, match="not counted by type"):
        Losses().types_table()


def test_a_dialect_that_is_not_there(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = random_log(tmp_path / "random.tlog", 3)
    for verb in ("loss", "summarize", "tomfile"):
        assert "no dialect 'nope'" in fails(capsys, verb, path, "--dialect", "nope")
        assert "no dialect ''; name a built-in one" in fails(capsys, verb, path, "--dialect", "")


def test_the_dialect_of_the_process_is_back_afterwards(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = mavutil.mavlink
    run(capsys, "loss", random_log(tmp_path / "random.tlog", 3), "--dialect", "common")
    assert mavutil.mavlink is before


def test_modes_that_took_no_time(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """mavflightmodes.py divides by zero."""
    log = Log(tmp_path / "short.tlog")
    for mode in (0, 4, 5):
        log.add(0, heartbeat(mode))
    text = run(capsys, "flightmodes", log.done())
    assert text.splitlines()[-3:] == [
        "STABILIZE    0:00:00 0.00%",
        "GUIDED       0:00:00 0.00%",
        "LOITER       0:00:00 0.00%",
    ]


def test_merge_is_in_the_order_of_time(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """mavmerge.py stops after the first change of logs and writes nothing."""
    logs = []
    for name, step in (("one", 2), ("other", 3)):
        log = Log(tmp_path / f"{name}.tlog")
        for number in range(40):
            log.add(number * step + len(name) / 10, heartbeat(number), link=step)
        logs.append(log.done())
    merged = tmp_path / "merged.tlog"
    text = run(capsys, "merge", *logs, "-o", merged)
    expected = sorted((one for log in logs for one in messages(log)), key=lambda one: one[0])
    assert text.splitlines() == [line for _, line in expected]
    assert [line for _, line in messages(merged)] == [line for _, line in expected]
    times = [time for time, _ in messages(merged)]
    assert times == pytest.approx([time for time, _ in expected], abs=4e-6)
    assert run(capsys, "merge", "--quiet", *logs) == ""


def test_merge_does_not_write_over_a_log(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    logs = [random_log(tmp_path / f"{seed}.tlog", seed) for seed in (1, 2)]
    before = logs[1].read_bytes()
    assert "is the log itself" in fails(capsys, "merge", *logs, "-o", logs[1])
    assert logs[1].read_bytes() == before


def test_extract_does_not_write_over_a_log(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log, other = Log(tmp_path / "a.tlog"), Log(tmp_path / "GUIDED1.tlog")
    log.add(0, heartbeat(4))
    other.add(0, heartbeat(4))
    paths = [log.done(), other.done()]
    before = paths[1].read_bytes()
    assert "GUIDED2.tlog" in run(capsys, "extract", "--mode", "guided", *paths)
    assert paths[1].read_bytes() == before
    assert sorted(path.name for path in tmp_path.glob("GUIDED*")) == [
        f"GUIDED{number}.tlog" for number in (1, 2, 3)
    ]


def test_definitions_are_the_old_ones_after_a_dialect_that_is_none() -> None:
    before = state.wire_protocol, state.mavlink, state.current_dialect
    for dialect in ("no such dialect", "nosuch"):
        with pytest.raises(CommandError), definitions(dialect, "1.0"):
            pytest.fail("there is no such dialect")
        assert (state.wire_protocol, state.mavlink, state.current_dialect) == before


def test_sizes_are_those_of_every_message(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """mavmsgstats.py takes the first message of a type for all of them, and one for a group."""
    log = Log(tmp_path / "sizes.tlog")
    log.add(0, mavlink.MAVLink_gps_rtcm_data_message(0, 1, [1] + [0] * 179))
    log.add(1, mavlink.MAVLink_gps_rtcm_data_message(0, 180, [1] * 180))
    log.add(2, mavlink.MAVLink_attitude_message(0, 0, 0, 0, 0, 0, 0))
    log.add(3, attitude(1))
    lines = run(capsys, "msgstats", log.done()).splitlines()
    rtcm, attitudes = 3 + 182, 1 + 28
    total = rtcm + attitudes
    assert lines[1:] == [
        f"Total size: {total}",
        f"ATTITUDE {attitudes / total:.2%}",
        f"GPS_RTCM_DATA {rtcm / total:.2%}",
        "",
        f"@SENSORS {rtcm / total:.2%}",
        f"@OTHER {attitudes / total:.2%}",
    ]


def test_tomfile_writes_where_it_is_told(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """mavtomfile.py has the option and does not use it; messages of unknown types end it."""
    log = Log(tmp_path / "flight.tlog")
    log.add(0, heartbeat())
    log.add_bytes(1, bytes((0xFD, 3, 0, 0, 7, 9, 9, 0x11, 0x99, 1, 1, 2, 3, 4, 5)))
    log.add(2, attitude(2))
    path = log.done()
    output = tmp_path / "table.m"
    run(capsys, "tomfile", path, "-o", output)
    assert [line.split(".")[0] for line in output.read_text().splitlines()] == (
        ["HEARTBEAT"] * 2 + ["ATTITUDE"] * 2
    )
    assert not (tmp_path / "flight.m").exists()
    assert "takes one log" in fails(capsys, "tomfile", path, path, "-o", output)


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (("bitmask_decoder", "NOPE", "x", "1"), "NOPE.x: "),
        (("bitmask_decoder", "HEARTBEAT", "nope", "1"), "HEARTBEAT.nope: "),
        (("bitmask_change", "LOG", "SYS_STATUS"), "invalid MSG.Field specifier 'SYS_STATUS'"),
        (("bitmask_change", "LOG", "NOPE.x"), "unknown MAVLink message type 'NOPE'"),
        (("bitmask_change", "LOG", "ATTITUDE.roll"), "field 'ATTITUDE.roll' has no bitmask enum"),
    ],
)
def test_fields_without_bits(
    arguments: tuple[str, ...], reason: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log = str(random_log(tmp_path / "random.tlog", 3))
    assert reason in fails(capsys, *(log if one == "LOG" else one for one in arguments))


def test_a_parameter_file_with_a_mistake(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "wrong.parm"
    path.write_text("A 1\nB one\n")
    assert f"{path}:2" in fails(capsys, "parmdiff", path, path)


@pytest.mark.parametrize("verb", ["parmdiff", "extract_parms"])
def test_a_parameter_file_that_cannot_be_read(
    verb: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Compared with nothing, each parameter would look like one that is new."""
    path = tmp_path / "some.parm"
    path.write_text("A 1\n")
    wrongs = [(tmp_path / "none.parm", "No such file"), (tmp_path, "directory")]
    if Path("/proc/self/mem").exists():
        wrongs.append((Path("/proc/self/mem"), "Input/output error"))
    for wrong, reason in wrongs:
        for names in ((path, wrong), (wrong, path)):
            assert cli.main([verb, *map(str, names)]) == 1
            printed = capsys.readouterr()
            assert printed.out == ""
            assert str(wrong) in printed.err
            assert reason in printed.err
            assert printed.err.count("\n") == 1


@pytest.mark.skipif(not os.path.exists("/dev/fd"), reason="descriptors have no names")
def test_a_parameter_file_may_be_what_another_program_prints(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """`mavwire parmdiff <(ssh vehicle cat now.parm) before.parm`."""
    before = tmp_path / "before.parm"
    before.write_text("A 1\nB 2\n")
    now, end = os.pipe()
    try:
        os.write(end, b"A 1\nB 3\n")
        os.close(end)
        printed = run(capsys, "parmdiff", f"/dev/fd/{now}", before)
    finally:
        os.close(now)
    assert "B                      3.0000       2.0000" in printed


def test_control_characters_of_a_parameter_file_do_not_reach_the_terminal(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "garbage.parm"
    path.write_bytes(b"\x1b[2J 1 2\nA 1\nB \x07\xff\n")
    assert cli.main(["parmdiff", str(path), str(path)]) == 1
    printed = capsys.readouterr()
    assert "Invalid line: \\x1b[2J 1 2\n" in printed.out
    assert "\\x07" in printed.err
    assert not {"\x1b", "\x07"} & set(printed.out + printed.err)


def test_tools_start_without_heavy_modules(tmp_path: Path) -> None:
    log = tmp_path / "flight.tlog"
    traffic.generate(log, 200)
    heavy = "numpy matplotlib rich asyncio mavwire.mavextra mavwire.generator".split()
    for verb in ("parms", "flightmodes", "loss", "msgstats"):
        code = (
            f"import sys; from mavwire import cli; cli.main([{verb!r}, {str(log)!r}]);"
            f"sys.exit(repr(sorted(set({heavy!r}) & set(sys.modules)) or ''))"
        )
        result = subprocess.run(
            [sys.executable, "-c", code],
            capture_output=True, text=True, env=dict(os.environ), timeout=120, check=False,
        )  # fmt: skip
        assert result.stderr == "''\n", verb


@pytest.mark.parametrize(
    "seconds", [0, 59, 60, 3600, 86399, 86400, 2 * 86400 + 1, -1, -86400, -90000]
)
def test_durations_of_flightmodes_are_those_of_timedelta(seconds: int) -> None:
    assert _duration(seconds) == str(timedelta(seconds=seconds))
