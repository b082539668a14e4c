"""Each call that FUSE makes of a vehicle's file system, without a mount: against a simulated vehicle behind a
socket, whose files are what they should be to the byte.
"""

from __future__ import annotations

import errno
import os
import socket
import stat
from collections.abc import Iterator
from random import Random
from typing import Any, NamedTuple

import pytest
from mavwire import mavftpfs, mavutil
from mavwire.mavftp import wait_heartbeat
from mavwire.sim import Impairment, Vehicle, serve
from unit.link_tools import free_port

CONTENT = Random(5).randbytes(10_000)
# What the kernel asks for at once.
PAGE = 4096


class Mounted(NamedTuple):
    """A vehicle and what FUSE would be given of it."""

    vehicle: Vehicle
    files: Any


@pytest.fixture(params=["ardupilot", "px4"])
def mounted(request: pytest.FixtureRequest) -> Iterator[Mounted]:
    vehicle = Vehicle(request.param, impairment=Impairment(loss=0.02))
    vehicle.ftp.files.write("/LOGS/1.BIN", CONTENT)
    vehicle.ftp.files.write("/LOGS/empty", b"")
    vehicle.ftp.files.write("/LOGS/below/übung 1.txt", b"abc")
    for name in ("/LOGS", "/LOGS/below"):
        vehicle.ftp.files.folders.add(name)
    port = free_port(socket.SOCK_DGRAM)
    with serve(f"udpout:127.0.0.1:{port}", vehicle, speed=5):
        link = mavutil.mavlink_connection(f"udpin:127.0.0.1:{port}")
        try:
            wait_heartbeat(link)
            yield Mounted(vehicle, mavftpfs.FTP(link))
        finally:
            link.close()


def refused(call: Any, *arguments: Any) -> int:
    """The number of the error that a call ends with."""
    with pytest.raises(OSError) as caught:
        call(*arguments)
    return int(caught.value.args[0])


def walk(files: Any, folder: str = "/") -> Iterator[str]:
    """What `find` prints."""
    for name in files.readdir(folder, None):
        if name not in (".", ".."):
            path = f"{folder.rstrip('/')}/{name}"
            yield path
            if stat.S_ISDIR(files.getattr(path, None)["st_mode"]):
                yield from walk(files, path)


def test_a_walk_finds_every_file(mounted: Mounted) -> None:
    found = set(walk(mounted.files))
    assert {"/LOGS", "/LOGS/1.BIN", "/LOGS/below", "/LOGS/below/übung 1.txt"} <= found
    for path in found:
        attributes = mounted.files.getattr(path)
        if not stat.S_ISDIR(attributes["st_mode"]):
            content = mounted.vehicle.ftp.files.read(path, 0)
            assert content is not None and attributes["st_size"] == len(content)


def test_what_stat_shows(mounted: Mounted) -> None:
    files = mounted.files
    for path, size, kind in (
        ("/", 0, stat.S_IFDIR), ("/LOGS", 0, stat.S_IFDIR), ("/LOGS/below", 0, stat.S_IFDIR),
        ("/LOGS/1.BIN", len(CONTENT), stat.S_IFREG), ("/LOGS/empty", 0, stat.S_IFREG),
    ):  # fmt: skip
        attributes = files.getattr(path, None)
        assert (attributes["st_size"], stat.S_IFMT(attributes["st_mode"])) == (size, kind)
        assert attributes["st_uid"] == os.getuid() and not attributes["st_mode"] & 0o222
    for path in ("/none", "/none/below", "/LOGS/none", "/LOGS/1.BIN/below", "/@NONE"):
        assert refused(files.getattr, path, None) == errno.ENOENT
    assert refused(files.readdir, "/none", None) == errno.ENOENT
    assert refused(files.readdir, "/LOGS/1.BIN", None) in (errno.ENOENT, errno.ENOTDIR)
    assert refused(files.readdir, f"/{'a' * 300}", None) == errno.ENAMETOOLONG


def test_reads_as_the_kernel_makes_them(mounted: Mounted) -> None:
    files = mounted.files
    handle = files.open("/LOGS/1.BIN", os.O_RDONLY)
    pages = [files.read("/LOGS/1.BIN", PAGE, offset, handle) for offset in range(0, 20_000, PAGE)]
    assert b"".join(pages) == CONTENT
    order = list(range(0, len(CONTENT), 1000))
    Random(1).shuffle(order)
    for offset in order[:5]:
        assert files.read("/LOGS/1.BIN", 100, offset, handle) == CONTENT[offset : offset + 100]
    assert files.read("/LOGS/1.BIN", 0, 0, handle) == b""
    assert files.read("/LOGS/empty", PAGE, 0, files.open("/LOGS/empty", os.O_RDONLY)) == b""
    assert files.read("/LOGS/below/übung 1.txt", PAGE, 0, 0) == b"abc"


def test_a_file_that_is_gone_or_was_cut(mounted: Mounted) -> None:
    files = mounted.files
    assert files.read("/LOGS/1.BIN", 10, 0, 0) == CONTENT[:10]
    mounted.vehicle.ftp.files.write("/LOGS/1.BIN", CONTENT[:100])
    assert files.read("/LOGS/1.BIN", PAGE, 0, 0) == CONTENT[:100]
    mounted.vehicle.ftp.files.remove("/LOGS/1.BIN")
    assert refused(files.read, "/LOGS/1.BIN", PAGE, 0, 0) == errno.EIO
    assert refused(files.read, "/LOGS/none", PAGE, 0, 0) == errno.ENOENT


def test_files_that_the_vehicle_makes_up(mounted: Mounted) -> None:
    if mounted.vehicle.personality.name != "ardupilot":
        pytest.skip("ArduPilot's")
    files = mounted.files
    assert stat.S_ISDIR(files.getattr("/@PARAM", None)["st_mode"])
    size = files.getattr("/@PARAM/param.pck", None)["st_size"]
    assert size == len(mounted.vehicle.ftp.files.read("@PARAM/param.pck", 0) or b"")
    assert len(files.read("/@PARAM/param.pck", 100, 0, 0)) == 100


WRITES = {
    "chmod": ("/LOGS/1.BIN", 0o777), "chown": ("/LOGS/1.BIN", 0, 0), "create": ("/a", 0o644, None),
    "link": ("/a", "/LOGS/1.BIN"), "mkdir": ("/a", 0o755), "mknod": ("/a", 0o644, 0),
    "rename": ("/LOGS/1.BIN", "/a"), "rmdir": ("/LOGS/below",), "symlink": ("/a", "/LOGS/1.BIN"),
    "truncate": ("/LOGS/1.BIN", 0, None), "unlink": ("/LOGS/1.BIN",),
    "utimens": ("/LOGS/1.BIN", None), "write": ("/LOGS/1.BIN", b"x", 0, 0),
}  # fmt: skip


def test_nothing_is_changed(mounted: Mounted) -> None:
    contents = mounted.vehicle.ftp.files.contents
    before = dict(contents), set(mounted.vehicle.ftp.files.folders)
    for name, arguments in WRITES.items():
        assert refused(getattr(mounted.files, name), *arguments) == errno.EROFS, name
    for flag in (os.O_WRONLY, os.O_RDWR, os.O_APPEND, os.O_TRUNC, os.O_CREAT):
        assert refused(mounted.files.open, "/LOGS/1.BIN", flag) == errno.EROFS
    assert (contents, mounted.vehicle.ftp.files.folders) == before


def test_each_operation_is_called_here() -> None:
    own = {
        name
        for name, value in vars(mavftpfs.FTP).items()
        if callable(value) or isinstance(value, staticmethod)
    }
    assert {name for name in own if not name.startswith("_")} == {
        "getattr", "readdir", "open", "read", *WRITES,
    }  # fmt: skip
