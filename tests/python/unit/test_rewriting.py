"""cut, repair, anonymize and merge write logs that say what they should and nothing else."""

from __future__ import annotations

import gzip
import os
import signal
import subprocess
import sys
from datetime import UTC, datetime
from pathlib import Path
from random import Random
from typing import Any

import mavwire
import numpy as np
import pytest
from dataflash_writer import sample
from mavwire import cli, traffic
from mavwire.cli import main
from mavwire.cli._progress import Progress
from mavwire.dialects.v20 import all as mavlink
from mavwire.logs.rewriting import anonymize, cut, merge, repair
from unit.column_tools import log_of_every_type
from unit.link_tools import T0, heartbeat, record


@pytest.fixture(scope="module")
def flight(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("logs") / "flight.tlog"
    traffic.generate(path, 5000, systems=2)
    return path


def rows(path: Path | str, **selection: Any) -> list[tuple[float, bytes]]:
    """Time and frame of each message."""
    log = mavwire.open_log(path)
    return [(msg._timestamp, bytes(msg.get_msgbuf())) for msg in log.messages(**selection)]


@pytest.mark.parametrize(
    "selection",
    [
        {},
        {"types": ["ATTITUDE", "GPS_RAW_INT"]},
        {"systems": 2},
        {"types": "ATTITUDE", "systems": 1},
    ],
)
def test_cut(flight, tmp_path, selection):
    out = tmp_path / "out.tlog"
    done = cut(flight, out, **selection)
    expected = rows(flight, **selection)
    assert rows(out) == expected
    assert (done.records, done.written, done.bad_bytes) == (5000, len(expected), 0)
    assert os.listdir(tmp_path) == ["out.tlog"]


@pytest.mark.parametrize(
    "types", ["UNKNOWN", ["UNKNOWN", "HEARTBEAT"], "UNKNOWN_30", ["HEARTBEAT", "UNKNOWN_30"], None]
)
def test_ids_that_the_dialect_lacks_are_cut_as_they_are_read(flight, tmp_path, types):
    out = tmp_path / "out.tlog"
    cut(flight, out, types, dialect="minimal")
    log = mavwire.open_log(flight, dialect="minimal")
    expected = [bytes(msg.get_msgbuf()) for msg in log.messages(types=types)]
    assert [frame for _, frame in rows(out)] == expected
    assert 0 < len(expected) <= 5000


def test_a_dataflash_log_is_called_one_whatever_types_are_wanted(tmp_path, capsys):
    path = tmp_path / "onboard.BIN"
    sample().write(path)
    for types in ("IMU", "ATTITUDE,NOSUCHTYPE"):
        argv = ["cut", str(path), "-o", str(tmp_path / "out.tlog"), "--types", types]
        assert cli.main(argv) == 1
        assert "a dataflash log, not a telemetry log" in capsys.readouterr().err


@pytest.mark.parametrize("command", ["cut", "repair", "anonymize"])
def test_standard_output_is_no_place_for_a_log(flight, tmp_path, monkeypatch, capsys, command):
    monkeypatch.chdir(tmp_path)
    assert cli.main([command, str(flight), "-o", "-"]) == 1
    assert "--out is a file, not standard output" in capsys.readouterr().err
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize("option", ["--start", "--end"])
def test_a_year_alone_is_no_time(flight, tmp_path, capsys, option):
    assert main(["cut", str(flight), "-o", str(tmp_path / "x.tlog"), option, "2020"]) == 1
    assert "write 2020-01-01 or 2020.0" in capsys.readouterr().err
    assert not (tmp_path / "x.tlog").exists()


def test_cut_by_time(flight, tmp_path):
    times = [time for time, _ in rows(flight)]
    start, end = times[1000], times[3000]
    out = tmp_path / "out.tlog"
    cut(flight, out, start=start, end=end)
    assert rows(out) == rows(flight, start=start, end=end)
    start_text = datetime.fromtimestamp(start, UTC).isoformat()
    assert main(["cut", str(flight), "-o", str(out), "--start", start_text, "--quiet"]) == 0
    assert rows(out) == rows(flight, start=datetime.fromisoformat(start_text))


def test_cut_of_a_raw_stream(flight, tmp_path):
    raw, out = tmp_path / "flight.raw", tmp_path / "out.raw"
    frames = [frame for _, frame in rows(flight)]
    raw.write_bytes(b"".join(frames))
    cut(raw, out, systems=1)
    assert out.read_bytes() == b"".join(frame for frame in frames if frame[5] == 1)
    with pytest.raises(ValueError, match="no time stamps"):
        cut(raw, out, start=1.0)


def test_compressed(flight, tmp_path):
    packed, out = tmp_path / "flight.tlog.gz", tmp_path / "out.tlog"
    packed.write_bytes(gzip.compress(flight.read_bytes()))
    assert repair(packed, out).damage is None
    assert out.read_bytes() == flight.read_bytes()
    packed.write_bytes(packed.read_bytes()[:-30_000])
    assert repair(packed, out).damage is not None
    assert flight.read_bytes().startswith(out.read_bytes()[:1000])


COMMANDS = [["cut"], ["repair"], ["anonymize"], ["merge", "-q"], ["merge", "--exact", "-q"]]


@pytest.mark.parametrize("command", COMMANDS, ids=" ".join)
@pytest.mark.parametrize("cut_at", [4, 7, 10, 11])
def test_a_gzip_file_cut_off_in_its_head_is_an_error(flight, tmp_path, command, cut_at, capsys):
    packed, out = tmp_path / "a.tlog.gz", tmp_path / "out.tlog"
    packed.write_bytes(gzip.compress(flight.read_bytes())[:cut_at])
    assert main([*command, str(packed), "-o", str(out)]) == 1
    assert "a gzip file, not a telemetry log, as far as it can be read" in capsys.readouterr().err
    assert not out.exists()


@pytest.mark.parametrize("command", COMMANDS, ids=" ".join)
def test_junk_behind_a_gzip_file_is_told_of(flight, tmp_path, command, capsys):
    packed, out = tmp_path / "a.tlog.gz", tmp_path / "out.tlog"
    packed.write_bytes(gzip.compress(flight.read_bytes()) + b"junk" * 3)
    command = [one for one in command if one != "-q"]
    assert main([*command, str(packed), "-o", str(out)]) == 0
    said = capsys.readouterr()
    assert "invalid gzip header" in said.out + said.err
    assert len(mavwire.read(out)["ATTITUDE"]) == len(mavwire.read(flight)["ATTITUDE"])


@pytest.mark.parametrize(
    "junk",
    [
        b"\x7fELF" + bytes(range(3, 250)) * 20,
        gzip.compress(b"x" * 999, mtime=0),
        b"k",
        b"keep\n",
        b"12345678",
    ],
)
def test_an_exact_merge_takes_no_file_without_a_record(flight, tmp_path, junk, capsys):
    other, out = tmp_path / "other.tlog", tmp_path / "out.tlog"
    other.write_bytes(junk)
    for logs in ([flight, other], [other, flight], [other]):
        with pytest.raises(
            mavwire.logs.LogFormatError,
            match="(not a telemetry log|no telemetry record).*other.tlog",
        ):
            merge(logs, out)
    assert main(["merge", "--exact", str(flight), str(other), "-o", str(out)]) == 1
    assert "other.tlog" in capsys.readouterr().err
    assert not out.exists()


@pytest.mark.parametrize("size", [0, 1, 5, 8, 9, 20])
def test_an_exact_merge_takes_a_log_that_is_cut_off_in_its_first_record(flight, tmp_path, size):
    other, out = tmp_path / "other.tlog", tmp_path / "out.tlog"
    other.write_bytes(flight.read_bytes()[:size])
    assert merge([flight, other], out).written == 5000


def test_a_merge_tells_of_each_log_its_own_damage(flight, tmp_path):
    damaged, whole, cut_off = (tmp_path / f"{name}.tlog.gz" for name in ("a", "b", "c"))
    damaged.write_bytes(gzip.compress(flight.read_bytes())[:-30_000])
    whole.write_bytes(gzip.compress(b"x" * 999))
    cut_off.write_bytes(gzip.compress(flight.read_bytes())[:11])
    for logs, said in (([damaged, whole], f"no telemetry record found; .*: '{whole}'"),
                       ([flight, cut_off], r"as far as it can be read \(.*\); .*c.tlog.gz")):  # fmt: skip
        with pytest.raises(mavwire.logs.LogFormatError, match=said):
            merge(logs, tmp_path / "out.tlog")


def test_a_merge_names_all_logs_that_are_cut_off(flight, tmp_path, capsys):
    cut_off, whole, junk = (tmp_path / f"{name}.tlog.gz" for name in ("cut", "whole", "junk"))
    packed, out = gzip.compress(flight.read_bytes()), tmp_path / "out.tlog"
    cut_off.write_bytes(packed[:-30_000])
    whole.write_bytes(packed)
    junk.write_bytes(packed + b"junk" * 3)
    argv = ["merge", "--exact", *map(str, (cut_off, whole, junk)), "-o", str(out)]
    assert main(argv) == 0
    said = capsys.readouterr().out
    assert f"'{cut_off}': incomplete deflate stream; '{junk}': invalid gzip header" in said
    assert "whole.tlog" not in said


@pytest.mark.skipif(os.name == "nt", reason="an open file cannot be removed there")
def test_a_merge_reads_each_log_once(flight, tmp_path):
    """Of what happens to one meanwhile nothing is told, and one given twice is named twice."""
    gone, replaced = tmp_path / "gone.tlog.gz", tmp_path / "replaced.tlog.gz"
    for path in (gone, replaced):
        path.write_bytes(gzip.compress(flight.read_bytes())[:-30_000])

    def change(_read: int) -> None:
        gone.unlink(missing_ok=True)
        (tmp_path / "new").write_bytes(b"no log")
        (tmp_path / "new").replace(replaced)

    done = merge([gone, replaced, flight, gone], tmp_path / "out.tlog", progress=change)
    said = "{!r}: incomplete deflate stream"
    assert done.damage == "; ".join(said.format(str(path)) for path in (gone, replaced, gone))


@pytest.mark.parametrize("pack", [bytes, gzip.compress])
def test_an_empty_log_is_one_compressed_too(tmp_path, pack):
    path, out = tmp_path / "empty.tlog", tmp_path / "out.tlog"
    path.write_bytes(pack(b""))
    with mavwire.open_log(path) as log:
        assert log.read() == {} and log.info().messages == 0
    assert list(mavwire.scan(path)) == [] and repair(path, out).records == 0
    assert main(["info", str(path)]) == 0


def zstd(content: bytes) -> bytes:
    return bytes(pytest.importorskip("zstandard").compress(content))


PACKED = [("gz", gzip.compress), ("zst", zstd)]


@pytest.mark.parametrize(("suffix", "pack"), PACKED)
def test_a_log_that_is_cut_off_in_its_first_record_is_one_compressed_too(
    flight, tmp_path, suffix, pack
):
    start, out = tmp_path / f"start.tlog.{suffix}", tmp_path / "out.tlog"
    start.write_bytes(pack(flight.read_bytes()[:20]))
    assert merge([flight, start], out).written == 5000
    with mavwire.open_log(start) as log:
        assert mavwire.read(start) == {} and log.info().bad_bytes == 20
    assert merge([start], out).bad_bytes == 20 and out.read_bytes() == b""


def skipped(nibble: int, content: bytes = b"anything") -> bytes:
    """A frame that readers of zstd pass over."""
    return bytes((0x50 + nibble,)) + b"\x2a\x4d\x18" + len(content).to_bytes(4, "little") + content


def test_zstd_frames_are_read_as_its_own_tool_does(flight, tmp_path):
    path, out, content = tmp_path / "flight.tlog.zst", tmp_path / "out.tlog", flight.read_bytes()
    front, rest = content[:60_000], content[60_000:]
    for parts in ([zstd(front), zstd(rest)], [skipped(0), zstd(content)],
                  [skipped(15, b""), skipped(3), zstd(front), skipped(0), zstd(rest), skipped(7)],
                  [zstd(b""), zstd(content)]):  # fmt: skip
        path.write_bytes(b"".join(parts))
        with mavwire.open_log(path) as log:
            assert log.compressed and log.info().damage is None
        repair(path, out)
        assert out.read_bytes() == content
    path.write_bytes(skipped(0))
    assert mavwire.read(path) == {}


@pytest.mark.parametrize(("suffix", "pack"), PACKED)
@pytest.mark.parametrize(
    "command",
    [["cut", "--types", "ATTITUDE"], ["repair"], ["anonymize", "--shift", "1,2"],
     ["merge", "-q"], ["merge", "--exact", "-q"]],
    ids=" ".join,
)  # fmt: skip
def test_the_commands_take_compressed_logs(flight, tmp_path, command, suffix, pack):
    packed = tmp_path / f"flight.tlog.{suffix}"
    packed.write_bytes(pack(flight.read_bytes()))
    found, same = tmp_path / "found.tlog", tmp_path / "same.tlog"
    for log, out in ((packed, found), (flight, same)):
        assert main([*command, str(log), "-o", str(out)]) == 0
    assert found.read_bytes() == same.read_bytes() != b""


@pytest.mark.parametrize("seed", range(5))
def test_repair(flight, tmp_path, seed):
    random, data = Random(seed), bytearray(flight.read_bytes())
    for _ in range(40):
        at = random.randrange(len(data))
        data[at : at + random.randrange(3)] = random.randbytes(random.randrange(30))
    damaged, out = tmp_path / "damaged.tlog", tmp_path / "out.tlog"
    damaged.write_bytes(data)
    done = repair(damaged, out)
    assert rows(out) == rows(damaged)
    assert done.bytes == len(data)
    assert done.bad_bytes == len(data) - out.stat().st_size > 0
    again = repair(out, tmp_path / "again.tlog")
    assert (again.bad_bytes, again.records) == (0, done.written)


def test_merge(flight, tmp_path):
    parts = [tmp_path / f"{n}.tlog" for n in (1, 2)]
    cut(flight, parts[0], systems=1)
    cut(flight, parts[1], systems=[n for n in range(256) if n != 1])
    out = tmp_path / "out.tlog"
    assert merge(parts, out).written == 5000
    assert sorted(rows(out)) == sorted(rows(flight))
    assert [time for time, _ in rows(out)] == sorted(time for time, _ in rows(flight))
    merge([flight, flight], out)
    assert sorted(rows(out)) == sorted(rows(flight) * 2)
    assert main(["merge", *map(str, parts), "--exact", "-o", str(out), "-q"]) == 0
    assert len(rows(out)) == 5000


def test_identifiers_of_every_spelling_are_emptied(tmp_path):
    path, out = tmp_path / "one.tlog", tmp_path / "public.tlog"
    seen = mavlink.MAVLink_adsb_vehicle_message(1, 0, 0, 0, 0, 0, 0, 0, b"", 0, 0, 0, 7)
    flown = mavlink.MAVLink_flight_information_message(1, 1, 1, 0x1234567890ABCDEF)
    frames = [msg.pack(mavlink.MAVLink(None, 1, 1)) for msg in (seen, flown)]
    path.write_bytes(b"".join(record(frame, T0) for frame in frames))
    anonymize(path, out)
    seen, flown = mavwire.open_log(out)
    assert (seen.squawk, flown.flight_uuid) == (0, 0)


def test_anonymize(flight, tmp_path):
    out = tmp_path / "out.tlog"
    done = anonymize(flight, out, shift=(2.5, -40.0))
    before, after = mavwire.read(flight), mavwire.read(out)
    assert done.written == sum(map(len, after.values()))
    for name in ("GPS_RAW_INT", "GLOBAL_POSITION_INT"):
        one, other = before[name], after[name]
        assert (other["lat"] - one["lat"] == 25_000_000).all()
        assert (other["lon"].astype("int64") - one["lon"] == -400_000_000).all()
        same = set(one.columns) - {"lat", "lon"}
        assert all((one[column] == other[column]).all() for column in same)
    assert (before["ATTITUDE"]["roll"] == after["ATTITUDE"]["roll"]).all()
    made_up = tmp_path / "made_up.tlog"
    anonymize(flight, made_up)
    moved = mavwire.read(made_up, "GPS_RAW_INT")["GPS_RAW_INT"]["lat"]
    assert len(np.unique(moved - before["GPS_RAW_INT"]["lat"])) == 1


def test_anonymize_every_type(tmp_path):
    path, out = tmp_path / "all.tlog", tmp_path / "out.tlog"
    log_of_every_type(path)
    before = mavwire.read(path)
    done = anonymize(path, out, shift=(3.0, 5.0))
    after = mavwire.read(out)
    assert done.bad_bytes == 0 and mavwire.open_log(out).info().bad_bytes == 0
    left_out = set(before) - set(after)
    assert {"SETUP_SIGNING", "TUNNEL", "OPEN_DRONE_ID_LOCATION"} <= left_out
    assert len(left_out) < 45
    changed = {
        f"{name}.{column}"
        for name, table in after.items()
        for column in table.columns
        if str(table[column].tolist()) != str(before[name][column].tolist())
    }
    assert {"GPS_RAW_INT.lat", "HIGH_LATENCY2.longitude", "AUTOPILOT_VERSION.uid"} <= changed
    assert {"ADSB_VEHICLE.ICAO_address", "ADSB_VEHICLE.callsign"} <= changed
    assert {"UTM_GLOBAL_POSITION.uas_id", "AIRLINK_AUTH.login"} <= changed
    assert {"VIDEO_STREAM_INFORMATION.uri", "GIMBAL_DEVICE_INFORMATION.custom_name"} <= changed
    words = ("lat", "lon", "lng", "uid", "ICAO", "callsign", "serial", "password", "ssid", "MMSI",
             "passkey", "pin", "puk", "apn", "id", ".x", ".y", ".text", "param", "registration",
             "Lat", "Lon", "login", "uri", "file_url", "custom_name", "AIS_VESSEL.name",
             "VIDEO_STREAM_INFORMATION.name", "NAMED_VALUE_STRING.value", "squawk")  # fmt: skip
    assert not [one for one in changed if not any(word in one for word in words)], changed


def test_signatures_go(tmp_path):
    path, out = tmp_path / "signed.tlog", tmp_path / "out.tlog"
    mav = mavlink.MAVLink(None, 1, 1)
    mav.signing.secret_key, mav.signing.sign_outgoing = bytes(32), True
    frame = mavlink.MAVLink_heartbeat_message(1, 2, 3, 4, 5, 3).pack(mav)
    path.write_bytes(record(frame, T0))
    assert mavwire.open_log(path).info().signed == 1
    anonymize(path, out)
    info = mavwire.open_log(out).info()
    assert (info.messages, info.signed, info.bad_bytes) == (1, 0, 0)


def test_what_is_refused(flight, tmp_path):
    copy = tmp_path / "copy.tlog"
    copy.write_bytes(flight.read_bytes())
    link = tmp_path / "link.tlog"
    link.symlink_to(copy)
    for out in (copy, link):
        with pytest.raises(ValueError, match="the log itself"):
            repair(copy, out)
        assert main(["repair", str(copy), "-o", str(out)]) != 0
    with pytest.raises(ValueError, match="folder"):
        repair(copy, tmp_path)
    with pytest.raises(ValueError, match="the log itself"):
        merge([flight, copy], copy)
    with pytest.raises(FileNotFoundError):
        repair(tmp_path / "none.tlog", tmp_path / "out.tlog")
    with pytest.raises(ValueError, match="no message"):
        cut(copy, tmp_path / "out.tlog", types="NOPE")
    wrong: Any
    for wrong in ((float("nan"), 0), 5, (1,), (1, 2, 3), "12", (91, 0)):
        with pytest.raises(ValueError, match="a shift is degrees"):
            anonymize(copy, tmp_path / "out.tlog", shift=wrong)
    noise = tmp_path / "noise.tlog"
    noise.write_bytes(b"nothing of all this is a log " * 50)
    with pytest.raises(mavwire.LogFormatError, match="no telemetry record"):
        repair(noise, tmp_path / "out.tlog")
    assert sorted(os.listdir(tmp_path)) == ["copy.tlog", "link.tlog", "noise.tlog"]


def test_the_commands_say_what_they_did(tmp_path, capsys):
    path, out = tmp_path / "flight.tlog", tmp_path / "out.tlog"
    frames = [record(heartbeat(seq=n), T0 + 1000 * n) for n in range(10)]
    path.write_bytes(b"".join(frames[:5]) + b"junk" + b"".join(frames[5:]))
    assert main(["repair", str(path), "-o", str(out)]) == 0
    assert capsys.readouterr().out == (
        f"{out}: 10 of 10 records\n  left out 4 bytes in 1 places: no record\n"
    )
    assert out.read_bytes() == b"".join(frames)
    assert main(["cut", str(path), "-o", str(out), "--systems", "x"]) != 0
    assert "--systems" in capsys.readouterr().err
    assert main(["anonymize", str(path), "-o", str(out), "--shift", "1"]) != 0
    assert "NORTH,EAST" in capsys.readouterr().err
    assert main(["anonymize", str(path), "-o", str(out), "--quiet"]) == 0
    assert capsys.readouterr().out == ""


def test_a_damaged_time_of_an_intact_frame_is_replaced(tmp_path, capsys):
    path, out = tmp_path / "flight.tlog", tmp_path / "out.tlog"
    frames = [heartbeat(seq=n) for n in range(10)]
    records = [record(frame, T0 + 1000 * n) for n, frame in enumerate(frames)]
    damaged = [*records[:5], b"\xff" + records[5][1:], *records[6:]]
    path.write_bytes(b"".join(damaged))
    assert main(["repair", str(path), "-o", str(out)]) == 0
    assert capsys.readouterr().out == (
        f"{out}: 10 of 10 records\n  replaced 1 times that damage made implausible\n"
    )
    records[5] = record(frames[5], T0 + 4000)
    assert out.read_bytes() == b"".join(records)


MERGE_MANY = """
import glob, resource, sys
from mavwire.logs.rewriting import merge
resource.setrlimit(resource.RLIMIT_NOFILE, (40, 40))
try:
    merge(sorted(glob.glob(sys.argv[1] + "/*.tlog")), sys.argv[1] + "/all.out")
except OSError as error:
    print(error.filename, error)
"""


@pytest.mark.parametrize("shift", [["--shift", "-1,2"], ["--shift=-1,2"], ["--shift", "-1e0,+2.0"]])
def test_a_shift_may_begin_with_a_minus(flight, tmp_path, shift):
    out, expected = tmp_path / "out.tlog", tmp_path / "expected.tlog"
    assert cli.main(["anonymize", str(flight), "-o", str(out), "--quiet", *shift]) == 0
    anonymize(flight, expected, shift=(-1, 2))
    assert out.read_bytes() == expected.read_bytes()


@pytest.mark.skipif(not hasattr(signal, "SIGHUP"), reason="needs SIGHUP")
@pytest.mark.parametrize("number", [getattr(signal, "SIGHUP", 0), signal.SIGTERM])
@pytest.mark.parametrize("command", ["cut", "repair", "anonymize", "merge --exact"])
def test_a_run_that_is_told_to_end_leaves_nothing(flight, tmp_path, monkeypatch, command, number):
    def told(self: Progress, percents: float) -> None:
        assert [path.suffix for path in tmp_path.iterdir()] == [".part"]
        signal.raise_signal(number)

    def missed(*_: Any) -> None:
        raise AssertionError("it would have ended at once")

    monkeypatch.setattr(Progress, "update", told)
    before = signal.signal(number, missed)
    try:
        code = main([*command.split(), str(flight), "-o", str(tmp_path / "out.tlog")])
        assert signal.getsignal(number) is missed
    finally:
        signal.signal(number, before)
    assert code == cli.EXIT_INTERRUPTED and not list(tmp_path.iterdir())


def test_more_logs_than_may_be_open(tmp_path):
    pytest.importorskip("resource")
    for n in range(60):
        (tmp_path / f"{n:02}.tlog").write_bytes(record(heartbeat(n)))
    command = [sys.executable, "-c", MERGE_MANY, str(tmp_path)]
    said = subprocess.run(command, capture_output=True, text=True, timeout=60, check=True).stdout
    assert said.startswith(str(tmp_path)) and "merge fewer" in said
    assert not (tmp_path / "all.out").exists()


def test_merge_of_many(tmp_path):
    random = Random(5)
    times = [sorted(random.randrange(1000) for _ in range(20)) for _ in range(50)]
    expected = []
    for n, some in enumerate(times):
        records = [record(heartbeat(at, sysid=n + 1), T0 + time) for at, time in enumerate(some)]
        (tmp_path / f"{n:02}.tlog").write_bytes(b"".join(records))
        expected += [
            (time, n, at, one) for at, (time, one) in enumerate(zip(some, records, strict=True))
        ]
    out = tmp_path / "all.out"
    assert merge(sorted(tmp_path.glob("*.tlog")), out).written == 1000
    assert out.read_bytes() == b"".join(one[3] for one in sorted(expected))
