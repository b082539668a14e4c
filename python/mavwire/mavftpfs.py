"""The files of a vehicle as a file system to look into: pymavlink's `mavftpfs`.

`python -m mavwire.mavftpfs --mavlink LINK --mountpoint FOLDER` mounts them, read-only, through FUSE
(`pip install 'mavwire[fuse]'`, and libfuse of the system). The vehicle's answers are checked where it
matters: names that lead elsewhere are left out, and a missing answer is an error of the read.
"""

from __future__ import annotations

import errno
import os
import posixpath
import stat
import sys
import time
from collections.abc import Callable, Sequence
from typing import Any

from mavwire._arguments import PlainParser
from mavwire._text import guarded_output
from mavwire.mavftp import MAVFTP, DirectoryEntry, FtpError, wait_heartbeat

try:
    from fuse import FUSE, FuseOSError, Operations
except (ImportError, OSError):  # without fusepy, and without libfuse under it
    FUSE, FuseOSError, Operations = None, OSError, object

NEEDED = "mounting needs fusepy and libfuse: pip install 'mavwire[fuse]', and FUSE of your system"
# How long a listing is believed: a walk asks for each file of a directory at once.
LISTING_SECONDS = 5.0
MOST_LISTINGS = 256
READ_ONLY = 0o444
SEARCHABLE = 0o555
# Folders that are made up by the vehicle, and are in no listing.
MADE_UP = "@"


class FTP(Operations):
    """The calls of FUSE over a MAVFTP client of the link `mav`."""

    def __init__(self, mav: Any) -> None:
        self.mav = mav
        self.ftp = MAVFTP(mav, mav.target_system, mav.target_component)
        self._listings: dict[str, tuple[float, dict[str, DirectoryEntry]]] = {}

    def getattr(self, path: str, fh: Any = None) -> dict[str, Any]:
        """The attributes of a path; ENOENT where there is nothing."""
        if path == "/":
            return _attributes(is_dir=True, size=0)
        folder, name = posixpath.split(path)
        entry = self._listing(folder).get(name)
        if entry is not None:
            return _attributes(entry.is_dir, entry.size_b)
        if name.startswith(MADE_UP):
            self._listing(path)  # ENOENT unless it is a folder
            return _attributes(is_dir=True, size=0)
        raise FuseOSError(errno.ENOENT)

    def readdir(self, path: str, fh: Any = None) -> list[str]:
        """The names in a folder, the two that every folder has among them."""
        names = (name for name in self._listing(path) if name not in (".", ".."))
        return [".", "..", *names]

    def open(self, path: str, flags: int) -> int:
        """A file to be read; EROFS for any other purpose."""
        if flags & (os.O_WRONLY | os.O_RDWR | os.O_APPEND | os.O_CREAT | os.O_TRUNC):
            raise FuseOSError(errno.EROFS)
        return 0

    def read(self, path: str, size: int, offset: int, fh: Any = None) -> bytes:
        """Some bytes of a file, fewer at its end; EIO where the vehicle does not give them."""
        left = self.getattr(path)["st_size"] - offset
        if left <= 0:
            return b""
        data = self.ftp.read_sector(_remote(path), offset, min(size, left))
        if data is None:
            raise FuseOSError(errno.EIO)
        return data

    def _listing(self, path: str) -> dict[str, DirectoryEntry]:
        """The entries of a folder by name, some seconds old at most."""
        now = time.monotonic()
        known = self._listings.get(path)
        if known is not None and now - known[0] < LISTING_SECONDS:
            return known[1]
        result = self.ftp.cmd_list([_remote(path)])
        if result.error_code == FtpError.RemoteReplyTimeout:
            raise FuseOSError(errno.EIO)
        if result.error_code == FtpError.InvalidArguments:
            raise FuseOSError(errno.ENAMETOOLONG)
        if result.error_code != FtpError.Success:
            raise FuseOSError(errno.ENOENT)
        entries = {entry.name: entry for entry in self.ftp.list_result}
        while len(self._listings) >= MOST_LISTINGS:
            del self._listings[next(iter(self._listings))]
        self._listings[path] = (now, entries)
        return entries


def _read_only(*_arguments: Any) -> Any:
    """A call that would change the file system."""
    raise FuseOSError(errno.EROFS)


for _name in (
    "chmod", "chown", "create", "link", "mkdir", "mknod", "rename", "rmdir", "symlink", "truncate",
    "unlink", "utimens", "write",
):  # fmt: skip
    setattr(FTP, _name, staticmethod(_read_only))


def _attributes(is_dir: bool, size: int) -> dict[str, Any]:
    mode = stat.S_IFDIR | SEARCHABLE if is_dir else stat.S_IFREG | READ_ONLY
    owner = {"st_uid": os.getuid(), "st_gid": os.getgid()} if hasattr(os, "getuid") else {}
    times = {"st_atime": 0, "st_mtime": 0, "st_ctime": 0}
    return {"st_mode": mode, "st_nlink": 2 if is_dir else 1, "st_size": size, **times, **owner}


def _remote(path: str) -> str:
    """The vehicle's name of a path: files that the vehicle makes up are beside its root."""
    return path[1:] if path.startswith(f"/{MADE_UP}") else path


@guarded_output()
def main(arguments: Sequence[str] | None = None, mount: Callable[..., Any] | None = FUSE) -> None:
    """Connect, and mount until unmounted or interrupted."""
    from mavwire import mavutil

    parser = PlainParser(description="Mount the files of a vehicle, read-only.")
    parser.add_argument(
        "-m", "--mavlink", default="udpin:0.0.0.0:14550", help="link (default %(default)s)"
    )
    parser.add_argument("--baudrate", type=int, default=115200, help="default %(default)s")
    parser.add_argument("--mountpoint", required=True, help="an empty folder")
    options = parser.parse_args(arguments)
    if mount is None:
        sys.exit(f"mavftpfs: {NEEDED}")
    try:
        link = mavutil.mavlink_connection(options.mavlink, baud=options.baudrate)
    except (OSError, ValueError, ImportError) as error:
        sys.exit(f"mavftpfs: {error}")
    try:
        wait_heartbeat(link)
        mount(FTP(link), options.mountpoint, foreground=True, nothreads=True, ro=True)
    except RuntimeError as error:  # the number that FUSE ended with
        sys.exit(f"mavftpfs: FUSE cannot mount on {options.mountpoint} (error {error})")
    except OSError as error:
        sys.exit(f"mavftpfs: {options.mountpoint}: {error}")
    finally:
        link.close()


if __name__ == "__main__":
    main()
