"""Where a file goes that appears when it is complete: it takes the place of a file, and of nothing else."""

from __future__ import annotations

import os
import stat


def file_to_write(path: str | os.PathLike[str]) -> str:
    """The file behind a name, links followed. ValueError for a device or a pipe, whose place a file
    would take, and for a folder.
    """
    path = os.fsdecode(path)
    try:
        mode = os.stat(path).st_mode
    except (FileNotFoundError, NotADirectoryError):
        return os.path.realpath(path) if os.path.islink(path) else path
    if stat.S_ISDIR(mode):
        raise ValueError(f"{path!r} is a folder: name the file to write")
    if not stat.S_ISREG(mode):
        raise ValueError(f"{path!r} is a device or a pipe: name a file to write")
    return os.path.realpath(path) if os.path.islink(path) else path
