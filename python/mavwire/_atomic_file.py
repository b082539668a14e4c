"""Files that are complete or as they were: written beside their place, and moved there at the end."""

from __future__ import annotations

import contextlib
import errno
import os
import stat

from mavwire._native import draft_stem

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterator
    from typing import IO

# Paths below these name open files and devices.
_SYSTEM = ("/dev/", "/proc/")


class Replacement:
    """A file that takes the place of `path` when it is finished; `file` is open for bytes.

    A link is followed, and permissions stay. A pipe, a device and a file `in_place` get each write at once.
    Raises OSError that names `path`.
    """

    def __init__(self, path: str | bytes | os.PathLike[str], in_place: bool = False) -> None:
        self.path = os.fsdecode(path)
        self._place = os.path.realpath(self.path)
        self._beside: str | None = None
        self._mode: int | None = None
        try:
            self.file = self._open(in_place)
        except BaseException as error:  # KeyboardInterrupt leaves a temporary file otherwise
            self._remove()
            if isinstance(error, OSError):
                error.filename = self.path
            raise

    def _open(self, in_place: bool) -> IO[bytes]:
        if not self.path:
            raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), self.path)
        with contextlib.suppress(FileNotFoundError):
            self._mode = os.stat(self.path).st_mode
        if self._mode is not None and not os.access(self.path, os.W_OK):
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), self.path)
        if in_place or not is_replaceable(self.path):
            return open(self.path, "wb")
        self._beside = draft_of(self._place)
        return open(self._beside, "x+b")

    def finish(self, permissions: int | None = None) -> None:
        """Move it to its place."""
        try:
            self._finish(permissions)
        except OSError as error:  # a full disk comes without a name, and a move with two
            self.discard()
            raise OSError(error.errno, error.strerror, self.path) from error
        except BaseException:
            self.discard()
            raise

    def _finish(self, permissions: int | None) -> None:
        self.file.close()
        if self._beside is None:
            return
        if permissions is None and self._mode is not None:
            permissions = stat.S_IMODE(self._mode)
        if permissions is not None:
            os.chmod(self._beside, permissions)
        os.replace(self._beside, self._place)
        self._beside = None

    def discard(self) -> None:
        """Remove what there is of it."""
        try:
            with contextlib.suppress(OSError):  # what is buffered may not fit on the disk
                self.file.close()
        finally:
            self._remove()

    def _remove(self) -> None:
        if self._beside is not None:
            with contextlib.suppress(OSError):  # it may not have been begun
                os.unlink(self._beside)
            self._beside = None


def is_replaceable(path: str) -> bool:
    """Whether a path is that of a file, or of none yet: not of a pipe or a device."""
    try:
        mode = os.stat(path).st_mode
    except OSError:
        return True
    return stat.S_ISREG(mode) and not os.path.abspath(path).startswith(_SYSTEM)


def draft_of(path: str) -> str:
    """A unique name for a file or URL that is not complete yet."""
    name = os.path.basename(path)
    stem = path.removesuffix(name) + draft_stem(name)
    return f"{stem}.{os.getpid()}-{os.urandom(4).hex()}.part"


@contextlib.contextmanager
def replacing(
    path: str | bytes | os.PathLike[str], permissions: int | None = None
) -> Iterator[IO[bytes]]:
    """A file for bytes that takes the place of `path` at the end; an error leaves what was there. Raises
    OSError that names `path`.
    """
    replacement = Replacement(path)
    try:
        yield replacement.file
        replacement.finish(permissions)  # here, as what comes before it begins would leave a draft
    except BaseException as error:
        replacement.discard()
        if isinstance(error, OSError) and error.filename is None:  # a full disk
            error.filename = replacement.path
        raise


def replace_text(
    path: str | bytes | os.PathLike[str], text: str, permissions: int | None = None
) -> None:
    """Put `text` into the file `path` as UTF-8; an error leaves what was there. Raises OSError that
    names `path`, and UnicodeEncodeError.
    """
    data = text.replace("\n", os.linesep).encode()
    with replacing(path, permissions) as file:
        file.write(data)
