"""Paths of output files that appear when they are complete. They replace files, and nothing else."""

from __future__ import annotations

import errno
import os
import stat

A_FOLDER = "is a folder: name the logs in it, such as FOLDER/*.tlog"
A_DEVICE = "a device is no log: save what is on it in a file"
A_PIPE = "a pipe or a socket is no log: save what comes out of it in a file"
OPEN_ALREADY = ("/dev/std", "/dev/fd/", "/proc/")
"""Names of open files, which must not be replaced (`--out /dev/stdout >> FILE`)."""


def file_to_write(path: str | os.PathLike[str]) -> str:
    """The file behind a name, links followed. ValueError for a device or a pipe, whose place a file
    would take, and for a folder; FileNotFoundError where the folder for it is not there;
    PermissionError for a file that is not to be written, as taking its place asks nobody.
    """
    path = os.fsdecode(path)
    try:
        mode = os.stat(path).st_mode
    except (FileNotFoundError, NotADirectoryError):
        target = os.path.realpath(path) if os.path.islink(path) else path
        folder = os.path.dirname(target)
        if folder and not os.path.isdir(folder):
            raise FileNotFoundError(errno.ENOENT, "there is no such folder", folder) from None
        return target
    if stat.S_ISDIR(mode):
        raise ValueError(f"{path!r} is a folder: name the file to write")
    if not stat.S_ISREG(mode) or path.startswith(OPEN_ALREADY):
        raise ValueError(f"{path!r} is a device or a pipe: name a file to write")
    if not os.access(path, os.W_OK):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), path)
    return os.path.realpath(path) if os.path.islink(path) else path
