"""Definition files out of folders, archives and downloads. Everything is bounded and nothing is unpacked to disk."""

from __future__ import annotations

import io
import os
import posixpath
import tarfile
import zipfile
from collections.abc import Callable, Iterator
from datetime import date, datetime
from http.client import HTTPException
from pathlib import Path
from typing import IO, Any
from urllib import request
from urllib.parse import urljoin, urlsplit

from mavwire.cli._errors import CommandError
from mavwire.cli.dev._definition_facts import texts_of
from mavwire.dialects import _sources

MAX_DOWNLOAD = 64 << 20
MAX_UNPACKED = 256 << 20
TIMEOUT = 30
Files = dict[str, tuple[bytes, date | None]]
"""The bytes of files by path, and the days of their last changes."""


def fetch(source: str) -> tuple[dict[str, str], date | None]:
    """The texts of a folder, file, archive or https address by base name, and the day of the newest file in an archive.
    CommandError, OSError or DefinitionError for a source that cannot be read.
    """
    if os.path.isdir(source):
        return texts_of(Path(source)), None
    if "://" in source:
        files = _downloaded(source)
    elif source.endswith(".xml"):
        return _sources.collect(source, None)[1], None
    else:
        with open(source, "rb") as file:
            files = _unpacked(file, source)
    if len(files) > _sources.MAX_FILES:
        raise CommandError(f"{source}: more than {_sources.MAX_FILES} definition files")
    texts = {Path(name).stem: _sources.decode(data, name) for name, (data, _) in files.items()}
    days = [day for _, day in files.values() if day is not None]
    return texts, max(days, default=None)


class _OnlyHttps(request.HTTPRedirectHandler):
    """Follows no redirect to another scheme."""

    def redirect_request(
        self, req: Any, fp: Any, code: Any, msg: Any, headers: Any, newurl: str
    ) -> Any:
        _check_scheme(newurl)
        return super().redirect_request(req, fp, code, msg, headers, newurl)


def _check_scheme(address: str) -> None:
    if urlsplit(address).scheme != "https":
        raise CommandError(
            f"{address}: definitions come over https alone; download the file and name it"
        )


def _get(address: str) -> bytes:
    """The content at an address, at most `MAX_DOWNLOAD` bytes."""
    _check_scheme(address)
    try:
        with request.build_opener(_OnlyHttps).open(address, timeout=TIMEOUT) as response:
            data: bytes = response.read(MAX_DOWNLOAD + 1)
    except (OSError, HTTPException) as error:
        reason = str(error).removeprefix("<urlopen error ").removesuffix(">")
        raise CommandError(f"{address}: {reason or 'the connection failed'}") from None
    if len(data) > MAX_DOWNLOAD:
        raise CommandError(f"{address}: larger than {MAX_DOWNLOAD} bytes")
    return data


def _downloaded(address: str) -> Files:
    """An archive, or an XML file with those that it includes. An address that ends in `/` has `all.xml`."""
    if address.endswith("/"):
        address += "all.xml"
    if not urlsplit(address).path.endswith(".xml"):
        return _unpacked(io.BytesIO(_get(address)), address)
    files: Files = {}
    pending = [address]
    while pending and len(files) <= _sources.MAX_FILES:
        one = pending.pop(0)
        if one not in files:
            data = _get(one)
            files[one] = data, None
            pending += [
                urljoin(one, path) for path in _sources.includes(_sources.decode(data, one))
            ]
    return files


def _unpacked(file: IO[bytes], name: str) -> Files:
    """The definition files of an archive."""
    members = _of_zip if zipfile.is_zipfile(file) else _of_tar
    file.seek(0)
    total, files = 0, Files()
    try:
        for path, size, day, read in members(file):
            total += size
            if total > MAX_UNPACKED:
                raise CommandError(f"{name}: unpacks to more than {MAX_UNPACKED} bytes")
            if path.endswith(".xml"):
                files[path] = read(_sources.MAX_BYTES + 1), day
    except CommandError:
        raise
    except Exception as error:  # a damaged archive may raise anything
        reason = str(error).partition("\n")[0].rstrip(":")
        raise CommandError(f"{name}: not a zip or tar archive of definitions: {reason}") from None
    folders = {posixpath.dirname(path) for path in files}
    places = {one for one in folders if f"/{one}".endswith("/message_definitions/v1.0")} or folders
    if len(places) != 1:
        raise CommandError(f"{name}: no folder message_definitions/v1.0 in the archive")
    return {path: row for path, row in files.items() if posixpath.dirname(path) in places}


Member = tuple[str, int, date, Callable[[int], bytes]]


def _of_zip(file: IO[bytes]) -> Iterator[Member]:
    with zipfile.ZipFile(file) as archive:
        for info in archive.infolist():
            with archive.open(info) as content:
                yield info.filename, info.file_size, date(*info.date_time[:3]), content.read


def _of_tar(file: IO[bytes]) -> Iterator[Member]:
    with tarfile.open(fileobj=file) as archive:
        for info in archive:
            if info.isfile():
                content: Any = archive.extractfile(info)
                yield info.name, info.size, datetime.fromtimestamp(info.mtime).date(), content.read
