"""The files that a vehicle shows through FTP: a small tree in memory, and files that are made when
they are opened.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING
from urllib.parse import parse_qs

from .param_file import Entry, pack

if TYPE_CHECKING:
    from .vehicle import Vehicle

MAX_FILES = 64
MAX_FILE = 1 << 18
Made = Callable[[int, str], bytes]


class Files:
    """Paths and contents. A made file is a function of the block size and the query after "?"."""

    def __init__(self, files: Mapping[str, bytes]) -> None:
        self.contents = {_clean(path): data for path, data in files.items()}
        self.made: dict[str, Made] = {}
        self.folders = {"/"} | {folder for path in self.contents for folder in _parents(path)}

    def add_made(self, path: str, make: Made) -> None:
        """Offer a file that is made when it is opened."""
        path = _clean(path)
        self.made[path] = make
        self.folders |= _parents(path)

    def read(self, path: str, block: int) -> bytes | None:
        """A file's content; None when there is none."""
        name, _, query = _clean(path).partition("?")
        if name in self.made:
            return self.made[name](block, query)
        return self.contents.get(name)

    def listing(self, path: str) -> list[bytes] | None:
        """Entries of a folder as FTP writes them, sorted; None when there is no such folder."""
        folder = _clean(path)
        if folder not in self.folders:
            return None
        prefix = folder if folder.endswith("/") else folder + "/"
        found = []
        for name in sorted(self.folders):
            if name != folder and name.startswith(prefix) and "/" not in name[len(prefix) :]:
                found.append(b"D" + name[len(prefix) :].encode())
        for name in sorted({*self.contents, *self.made}):
            if name.startswith(prefix) and "/" not in name[len(prefix) :]:
                size = len(self.read(name, 0) or b"")
                found.append(b"F%s\t%d" % (name[len(prefix) :].encode(), size))
        return found

    def exists(self, path: str) -> bool:
        """Whether there is a file or a folder."""
        name = _clean(path)
        return name in self.contents or name in self.made or name in self.folders

    def writable(self, path: str) -> bool:
        """Whether a file may be put there: its folder exists and there is room."""
        name = _clean(path)
        parent = name.rpartition("/")[0] or "/"
        room = name in self.contents or len(self.contents) < MAX_FILES
        return (
            parent in self.folders and name not in self.made and name not in self.folders and room
        )

    def write(self, path: str, data: bytes) -> None:
        """Store a file."""
        self.contents[_clean(path)] = data

    def remove(self, path: str) -> bool:
        """Delete a file; whether there was one."""
        return self.contents.pop(_clean(path), None) is not None

    def make_folder(self, path: str) -> bool:
        """Create a folder; whether that was possible."""
        name = _clean(path)
        fits = self.writable(name) and len(self.folders) < MAX_FILES
        if fits:
            self.folders.add(name)
        return fits

    def remove_folder(self, path: str) -> bool:
        """Delete an empty folder; whether it was one."""
        name = _clean(path)
        empty = name != "/" and self.listing(name) == []
        if empty:
            self.folders.discard(name)
        return empty


def _clean(path: str) -> str:
    """A path from the root, without doubled or trailing slashes."""
    return "/" + "/".join(part for part in path.split("/") if part not in ("", "."))


def _parents(path: str) -> set[str]:
    parts = path.split("/")
    return {"/".join(parts[:count]) for count in range(2, len(parts))}


def parameter_file(vehicle: Vehicle) -> Made:
    """@PARAM/param.pck with its queries: start, count, withdefaults."""

    def make(block: int, query: str) -> bytes:
        asked = {name: values[-1] for name, values in parse_qs(query).items()}
        params = vehicle.params
        start, count = _number(asked, "start", 0), _number(asked, "count", len(params))
        names = list(params)[start : start + count]
        entries = [Entry(n, params.kind(n), params[n], params.default(n)) for n in names]
        defaults = asked.get("withdefaults") == "1"
        return pack(entries, len(params), block or 239, defaults)

    return make


def _number(asked: Mapping[str, str], name: str, default: int) -> int:
    text = asked.get(name, "")
    return int(text) if text.isascii() and text.isdigit() and len(text) < 9 else default
