"""The file transfer client with a simulated vehicle: all operations, over links that lose packets."""

from __future__ import annotations

import io
import logging
import os
import random
import zlib
from collections import deque
from pathlib import Path
from typing import Any

import pytest
from mavwire import mavftp, mavutil
from mavwire.dialects.v20 import all as mavlink
from mavwire.mavftp import FtpError
from mavwire.sim import Vehicle
from unit.sim_tools import Station
from watchdog import watched

CONTENT = random.Random(3).randbytes(20_000)
STEP = 0.01


class SimLink:
    """A link to a simulated vehicle; time passes while the client waits. `loss` is a percentage."""

    source_system = 255

    def __init__(self, autopilot: str, loss: int = 0) -> None:
        self.sim = Vehicle(autopilot)
        self.sim.ftp.files.write("/data.bin", CONTENT)
        self.sim.ftp.files.write("/empty", b"")
        self.station = Station(self.sim)
        self.mav = self
        self.loss, self.random = loss, random.Random(7)
        self.arrived: deque[Any] = deque()

    def _lost(self) -> bool:
        return self.random.randrange(100) < self.loss

    def file_transfer_protocol_send(self, *fields: Any) -> None:
        if not self._lost():
            *target, payload = fields
            message = mavlink.MAVLink_file_transfer_protocol_message(*target, list(payload))
            self._keep(self.station.send(message))

    def _keep(self, messages: list[Any]) -> None:
        wanted = (m for m in messages if m.get_type() == "FILE_TRANSFER_PROTOCOL")
        self.arrived += (m for m in wanted if not self._lost())

    def recv_match(self, **options: Any) -> Any:
        if not self.arrived:
            self._keep(self.station.step(STEP))
        return self.arrived.popleft() if self.arrived else None


def client(autopilot: str = "ardupilot", loss: int = 0) -> tuple[SimLink, mavftp.MAVFTP]:
    link = SimLink(autopilot, loss)
    ftp = mavftp.MAVFTP(link, 1, 1)
    for name, value in (("retry_time", 0.02), ("read_retry_time", 0.02), ("burst_read_size", 239)):
        setattr(ftp.ftp_settings, name, value)
    return link, ftp


def well(result: mavftp.MAVFTPReturn) -> mavftp.MAVFTPReturn:
    assert result.error_code == FtpError.Success, result
    return result


@pytest.mark.parametrize("autopilot", ["ardupilot", "px4"])
@pytest.mark.parametrize("loss", [0, 15])
@pytest.mark.parametrize("block", [80, 239])
def test_files_come_whole(autopilot: str, loss: int, block: int, tmp_path: Path) -> None:
    _, ftp = client(autopilot, loss)
    ftp.ftp_settings.burst_read_size = block
    for name, content in (("/data.bin", CONTENT), ("/empty", b""), ("/data.bin", CONTENT)):
        local = tmp_path / "local"
        well(ftp.cmd_get([name, str(local)]))
        well(ftp.process_ftp_reply("get"))
        assert local.read_bytes() == content == ftp.get_result
        assert ftp.remote_file_size == len(content)
    assert [path.name for path in tmp_path.iterdir()] == ["local"]


@pytest.mark.parametrize("autopilot", ["ardupilot", "px4"])
@pytest.mark.parametrize("loss", [0, 15])
def test_files_go_whole(autopilot: str, loss: int, tmp_path: Path) -> None:
    link, ftp = client(autopilot, loss)
    local = tmp_path / "new.bin"
    for content in (CONTENT[:5000], b""):
        local.write_bytes(content)
        well(ftp.cmd_put([str(local), "/new.bin"]))
        well(ftp.process_ftp_reply("put"))
        assert link.sim.ftp.files.read("/new.bin", 239) == content


def test_a_part_of_a_file_is_read() -> None:
    _, ftp = client(loss=10)
    assert ftp.read("/data.bin", 1000, 300) == CONTENT[300:1300]
    assert ftp.read_sector("/data.bin", 19_900, 512) == CONTENT[19_900:]
    assert ftp.read("/data.bin", 10, 30_000) == b""
    assert ftp.read("/data.bin", 0) == b""
    assert ftp.read("/missing", 10) is None


def test_folders_files_and_checksums() -> None:
    link, ftp = client("px4")
    for number in range(40):
        link.sim.ftp.files.write(f"/fs/file{number:02}.txt", b"x" * number)
    listing = well(ftp.cmd_list(["/fs"])).directory_listing
    assert listing == ftp.list_result
    assert [(e.name, e.size_b) for e in ftp.list_result if not e.is_dir] == [
        (f"file{n:02}.txt", n) for n in range(40)
    ]
    assert ftp.list_result[0] == mavftp.DirectoryEntry("microsd", True, 0)
    assert ftp.cmd_list(["/nowhere"]).error_code == FtpError.FileNotFound
    well(ftp.cmd_crc(["/data.bin"]))
    assert ftp.crc_result == zlib.crc32(CONTENT, 0xFFFFFFFF) ^ 0xFFFFFFFF
    well(ftp.cmd_mkdir(["/box"]))
    assert ftp.cmd_mkdir(["/box"]).error_code == FtpError.FileExists
    well(ftp.cmd_rmdir(["/box"]))
    well(ftp.cmd_rename(["/data.bin", "/moved.bin"]))
    well(ftp.cmd_rm(["/moved.bin"]))
    assert ftp.cmd_rm(["/moved.bin"]).error_code == FtpError.FileNotFound
    assert ftp.cmd_crc(["/moved.bin"]).error_code == FtpError.FileNotFound
    assert ftp.crc_result is None


@pytest.mark.parametrize("loss", [0, 15])
def test_all_parameters_come_in_one_file(loss: int, tmp_path: Path) -> None:
    link, ftp = client(loss=loss)
    link.sim.params["WPNAV_SPEED"] = 700
    values, defaults = tmp_path / "values", tmp_path / "defaults"
    well(ftp.cmd_getparams([str(values), str(defaults)]))
    well(ftp.process_ftp_reply("getparams"))
    found = dict(line.split(",") for line in values.read_text().splitlines())
    assert {n: float(v) for n, v in found.items()} == pytest.approx(dict(link.sim.params), abs=1e-6)
    assert "WPNAV_SPEED,1000" in defaults.read_text().splitlines()
    assert list(found) == sorted(found, key=ftp.missionplanner_sort)


def test_callbacks_hear_of_progress_and_of_the_end() -> None:
    _, ftp = client()
    progress: list[Any] = []
    got: list[bytes] = []
    well(ftp.cmd_get(["/data.bin"], lambda f: got.append(f.read()), progress.append))
    well(ftp.process_ftp_reply("get"))
    assert got == [CONTENT]
    assert progress[-2:] == [1.0, None]
    assert progress[:-1] == sorted(progress[:-1])
    ended: list[Any] = []
    well(ftp.cmd_put(["name", "/up"], io.BytesIO(b"x" * 500), ended.append, progress.append))
    well(ftp.process_ftp_reply("put"))
    assert (ended, progress[-1]) == ([500], 1.0)
    well(ftp.cmd_get(["/missing"], ended.append))
    assert ftp.process_ftp_reply("get").error_code == FtpError.FileNotFound
    assert ended == [500, None]


def test_a_callback_that_fails_is_an_error_of_the_download() -> None:
    _, ftp = client()

    def fail(content: Any) -> None:
        raise RuntimeError("no")

    well(ftp.cmd_get(["/data.bin"], fail))
    assert ftp.process_ftp_reply("get").error_code == FtpError.Fail


def test_a_failed_download_leaves_nothing(tmp_path: Path) -> None:
    _, ftp = client()
    kept = tmp_path / "kept"
    kept.write_bytes(b"before")
    ftp.cmd_get(["/missing", str(kept)])
    assert ftp.process_ftp_reply("get").error_code == FtpError.FileNotFound
    ftp.cmd_get(["/data.bin", str(kept)])
    ftp.cmd_cancel()
    assert ftp.process_ftp_reply("get").error_code == FtpError.Fail
    assert [path.name for path in tmp_path.iterdir()] == ["kept"]
    assert kept.read_bytes() == b"before"
    assert ftp.cmd_get(["/data.bin", str(tmp_path / "no" / "x")]).error_code == (
        FtpError.FailToOpenLocalFile
    )


def test_a_new_download_replaces_one_that_is_under_way(tmp_path: Path) -> None:
    _, ftp = client()
    ftp.cmd_get(["/data.bin", str(tmp_path / "first")])
    well(ftp.cmd_get(["/empty", str(tmp_path)]))
    well(ftp.process_ftp_reply("get"))
    assert [path.name for path in tmp_path.iterdir()] == ["empty"]


def test_local_names_are_those_of_the_current_directory(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    link, ftp = client()
    link.sim.ftp.files.write("/APM/x..y", b"1")
    monkeypatch.chdir(tmp_path)
    well(ftp.cmd_get(["/APM/x..y"]))
    well(ftp.process_ftp_reply("get"))
    assert (tmp_path / "x..y").read_bytes() == b"1"
    for remote in ("/", "..", "/a/..", "a\\..", "/a/.", "x\0"):
        assert ftp.cmd_get([remote]).error_code == FtpError.InvalidArguments


def test_a_download_is_printed(capfdbinary: pytest.CaptureFixture[bytes]) -> None:
    link, ftp = client()
    link.sim.ftp.files.write("/note", b"text\n")
    with capfdbinary.disabled():
        pass
    ftp.cmd_get(["/note", "-"])
    well(ftp.process_ftp_reply("get"))
    assert capfdbinary.readouterr().out.endswith(b"text\n")


def test_status_says_how_far_it_is(caplog: pytest.LogCaptureFixture) -> None:
    _, ftp = client()
    caplog.set_level(logging.INFO)
    ftp.cmd_status()
    ftp.cmd_put(["name", "/up"], io.BytesIO(b"x"))
    ftp.cmd_status()
    assert "No transfer in progress" in caplog.text
    assert "Transfer at offset 0 with 0 gaps 0 retries" in caplog.text


def test_making_a_client_waits_for_nothing() -> None:
    class Silent:
        mav = type("Mav", (), {"file_transfer_protocol_send": lambda *fields: None})()

        def recv_match(self, **options: Any) -> Any:
            raise AssertionError("waits")

    ftp = mavftp.MAVFTP(Silent(), 1, 1)
    assert (ftp.seq, ftp.session, ftp.done) == (1, 0, False)


LONG = "/" + "a" * 239


@pytest.mark.parametrize("path", [LONG, LONG * 2, "/" + "\u00e4" * 120])
def test_a_path_that_no_request_carries(path: str, tmp_path: Path) -> None:
    _, ftp = client()
    local = tmp_path / "local"
    local.write_bytes(b"x")
    commands = [
        ["list", path], ["rm", path], ["rmdir", path], ["mkdir", path], ["rename", "/a", path],
        ["crc", path], ["get", path, str(tmp_path / "new")], ["put", str(local), path],
    ]  # fmt: skip
    for command in commands:
        assert ftp.cmd_ftp(command).error_code == FtpError.InvalidArguments, command[0]
    assert ftp.read(path, 5) is None
    assert ftp.cmd_rename(["/" + "a" * 119, "/" + "b" * 119]).error_code == (
        FtpError.InvalidArguments
    )
    assert [one.name for one in tmp_path.iterdir()] == ["local"]
    well(ftp.cmd_mkdir([LONG[:-1]]))


@pytest.mark.parametrize("error", [KeyboardInterrupt, OSError])
def test_what_ends_a_transfer_leaves_nothing(
    error: type[BaseException], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    link, ftp = client()
    well(ftp.cmd_get(["/data.bin", str(tmp_path / "local")]))

    def fail(**_: Any) -> Any:
        raise error

    monkeypatch.setattr(link, "recv_match", fail)
    with pytest.raises(error):
        ftp.process_ftp_reply("get")
    assert list(tmp_path.iterdir()) == []
    monkeypatch.undo()
    assert ftp.read("/data.bin", 10) == CONTENT[:10]


def test_a_link_that_fails_at_once_leaves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    link, ftp = client()

    def fail(*_: Any) -> None:
        raise OSError("gone")

    monkeypatch.setattr(link, "file_transfer_protocol_send", fail)
    with pytest.raises(OSError, match="gone"):
        ftp.cmd_get(["/data.bin", str(tmp_path / "local")])
    assert list(tmp_path.iterdir()) == []


def test_a_download_follows_links_and_keeps_devices(tmp_path: Path) -> None:
    _, ftp = client()
    link, target = tmp_path / "link", tmp_path / "target"
    link.symlink_to("target")
    well(ftp.cmd_get(["/data.bin", str(link)]))
    well(ftp.process_ftp_reply("get"))
    assert link.is_symlink()
    assert target.read_bytes() == CONTENT
    result = ftp.cmd_get(["/data.bin", os.devnull])
    assert result.error_code == FtpError.FailToOpenLocalFile


def test_a_pipe_is_no_file_to_send() -> None:
    """Blocks that are lost are read again."""
    _, ftp = client()
    reading, writing = os.pipe()
    os.write(writing, b"text")
    os.close(writing)
    try:
        result = ftp.cmd_put([f"/dev/fd/{reading}", "/text"])
        assert result.error_code == FtpError.FailToOpenLocalFile
    finally:
        os.close(reading)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="there are no named pipes")
def test_a_pipe_that_nobody_writes_to_is_not_waited_for(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    _, ftp = client()
    with watched():
        result = ftp.cmd_put([str(pipe), "/text"])
    assert result.error_code == FtpError.FailToOpenLocalFile


@pytest.mark.parametrize(
    ("error", "code"),
    [
        (KeyboardInterrupt(), 130),
        (ImportError("pyserial is needed"), "mavftp: pyserial is needed"),
        (OSError("no such port"), "mavftp: no such port"),
    ],
)
def test_how_the_program_ends(
    error: BaseException, code: int | str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: Any, **__: Any) -> None:
        raise error

    monkeypatch.setattr(mavutil, "mavlink_connection", fail)
    monkeypatch.setattr("sys.argv", ["mavftp", "--device", "/dev/ttyX", "list"])
    with pytest.raises(SystemExit) as ended:
        mavftp.main()
    assert ended.value.code == code


def test_an_unknown_log_level(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.argv", ["mavftp", "--loglevel", "loud", "list"])
    with pytest.raises(SystemExit) as ended:
        mavftp.main()
    assert ended.value.code == 2
    monkeypatch.setattr(
        "sys.argv", ["mavftp", "--loglevel", "warn", "--device", "none.tlog", "list"]
    )
    with pytest.raises(SystemExit, match="none.tlog"):
        mavftp.main()


def test_the_end_of_a_part_may_be_lost() -> None:
    """Blocks behind what is wanted arrive all the same, and say nothing of those before them."""
    _, ftp = client(loss=15)
    for number in range(40):
        offset = number * 450
        assert ftp.read("/data.bin", 500, offset) == CONTENT[offset : offset + 500]
