"""The file system over a vehicle's files: what FUSE would ask, answered from a client that is a double."""

from __future__ import annotations

import errno
import os
import stat
from types import SimpleNamespace
from typing import Any

import pytest
from mavwire import mavftpfs
from mavwire.mavftp import DirectoryEntry, FtpError

CONTENT = bytes(range(200))
TREE = {
    "/": [DirectoryEntry("LOGS", True, 0), DirectoryEntry("a.txt", False, 3)],
    "/LOGS": [DirectoryEntry(".", True, 0), DirectoryEntry("1.BIN", False, len(CONTENT))],
    "@SYS": [DirectoryEntry("tasks.txt", False, 10)],
}


class Client:
    """A MAVFTP that knows a tree of files."""

    silent = False

    def __init__(self, *_: Any) -> None:
        self.list_result: list[DirectoryEntry] = []
        self.asked: list[str] = []
        self.reads: list[tuple[str, int, int]] = []

    def cmd_list(self, args: list[str]) -> Any:
        self.asked.append(args[0])
        if self.silent:
            return SimpleNamespace(error_code=FtpError.RemoteReplyTimeout)
        if args[0] not in TREE:
            return SimpleNamespace(error_code=FtpError.FileNotFound)
        self.list_result = TREE[args[0]]
        return SimpleNamespace(error_code=FtpError.Success)

    def read_sector(self, path: str, offset: int, size: int) -> bytes | None:
        self.reads.append((path, offset, size))
        return CONTENT[offset : offset + size] if path == "/LOGS/1.BIN" else None


@pytest.fixture
def files(monkeypatch: pytest.MonkeyPatch) -> Any:
    monkeypatch.setattr(mavftpfs, "MAVFTP", Client)
    return mavftpfs.FTP(SimpleNamespace(target_system=1, target_component=1))


def refused(call: Any, *arguments: Any) -> int:
    """The number of the error that a call ends with."""
    with pytest.raises(OSError) as caught:
        call(*arguments)
    number = caught.value.errno if caught.value.errno is not None else caught.value.args[0]
    assert isinstance(number, int)
    return number


def test_what_stat_shows(files: Any) -> None:
    assert stat.S_ISDIR(files.getattr("/")["st_mode"])
    assert stat.S_ISDIR(files.getattr("/LOGS")["st_mode"])
    attributes = files.getattr("/LOGS/1.BIN")
    assert stat.S_ISREG(attributes["st_mode"])
    assert attributes["st_size"] == len(CONTENT)
    assert not attributes["st_mode"] & 0o222
    assert refused(files.getattr, "/nothing") == errno.ENOENT
    assert refused(files.getattr, "/nothing/below") == errno.ENOENT


def test_folders_that_the_vehicle_makes_up(files: Any) -> None:
    assert stat.S_ISDIR(files.getattr("/@SYS")["st_mode"])
    assert files.getattr("/@SYS/tasks.txt")["st_size"] == 10
    assert refused(files.getattr, "/@NONE") == errno.ENOENT


def test_names_in_a_folder(files: Any) -> None:
    assert files.readdir("/LOGS") == [".", "..", "1.BIN"]
    assert files.readdir("/") == [".", "..", "LOGS", "a.txt"]


def test_a_folder_is_asked_for_once(files: Any) -> None:
    for _ in range(5):
        files.getattr("/LOGS/1.BIN")
        files.readdir("/LOGS")
    assert files.ftp.asked == ["/LOGS"]


def test_reading(files: Any) -> None:
    assert files.open("/LOGS/1.BIN", os.O_RDONLY) == 0
    assert files.read("/LOGS/1.BIN", 50, 10, 0) == CONTENT[10:60]
    assert files.read("/LOGS/1.BIN", 4096, 190, 0) == CONTENT[190:]
    assert files.read("/LOGS/1.BIN", 4096, 200, 0) == b""
    assert files.ftp.reads == [("/LOGS/1.BIN", 10, 50), ("/LOGS/1.BIN", 190, 10)]
    assert refused(files.read, "/a.txt", 3, 0, 0) == errno.EIO


def test_nothing_is_written(files: Any) -> None:
    assert refused(files.open, "/a.txt", os.O_WRONLY) == errno.EROFS
    assert refused(files.write, "/a.txt", b"x", 0, 0) == errno.EROFS
    assert refused(files.unlink, "/a.txt") == errno.EROFS
    assert refused(files.rename, "/a.txt", "/b.txt") == errno.EROFS
    assert refused(files.mkdir, "/x", 0o755) == errno.EROFS


def test_a_vehicle_that_does_not_answer(files: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Client, "silent", True)
    assert refused(files.readdir, "/") == errno.EIO


def test_the_command_without_fuse(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit, match="pip install 'mavwire\\[fuse\\]'"):
        mavftpfs.main(["--mavlink", "udpin:127.0.0.1:0", "--mountpoint", "/mnt"], mount=None)


def test_the_command_mounts_read_only(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mavftpfs, "MAVFTP", Client)
    monkeypatch.setattr(mavftpfs, "wait_heartbeat", lambda link: None)
    mounted: dict[str, Any] = {}

    def mount(files: Any, folder: str, **options: Any) -> None:
        mounted.update(options, names=files.readdir("/"), folder=folder)

    mavftpfs.main(["--mavlink", "udpin:127.0.0.1:0", "--mountpoint", "/mnt/x"], mount=mount)
    assert mounted["names"] == [".", "..", "LOGS", "a.txt"]
    assert (mounted["folder"], mounted["ro"], mounted["foreground"]) == ("/mnt/x", True, True)


def test_a_folder_that_cannot_be_mounted_on(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mavftpfs, "MAVFTP", Client)
    monkeypatch.setattr(mavftpfs, "wait_heartbeat", lambda link: None)

    def mount(*_: Any, **__: Any) -> None:
        raise RuntimeError(1)

    with pytest.raises(SystemExit, match="/mnt/x"):
        mavftpfs.main(["--mavlink", "udpin:127.0.0.1:0", "--mountpoint", "/mnt/x"], mount=mount)


def test_a_path_that_no_request_carries(files: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    answer = SimpleNamespace(error_code=mavftpfs.FtpError.InvalidArguments)
    monkeypatch.setattr(files.ftp, "cmd_list", lambda _: answer)
    assert refused(files.readdir, "/" + "a" * 300) == errno.ENAMETOOLONG
