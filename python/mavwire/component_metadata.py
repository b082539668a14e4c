"""Component metadata: JSON files in which a vehicle describes its parameters, events and actuators.

The vehicle names its general file in COMPONENT_METADATA. That file names the others.
"""

from __future__ import annotations

import json
import time
from enum import IntEnum
from typing import Any

__all__ = ["Kind", "decompressed", "fetch"]

MAX_BYTES = 16 * 1024 * 1024
"""Larger files are refused, compressed or not."""

MFTP = "mftp://"
_XZ_MAGIC = b"\xfd7zXZ\x00"
_XZ_MEMORY = 256 * 1024 * 1024
_COMPONENT_METADATA = 397
_REQUEST_MESSAGE = 512
_ASK_EVERY = 1.0


class Kind(IntEnum):
    """Kinds of metadata, COMP_METADATA_TYPE in the definitions."""

    GENERAL = 0
    PARAMETER = 1
    EVENTS = 4
    ACTUATORS = 5


def decompressed(data: bytes) -> bytes:
    """The content of a metadata file, plain or compressed with xz. ValueError."""
    if data.startswith(_XZ_MAGIC):
        import lzma  # which few programs need

        reader = lzma.LZMADecompressor(lzma.FORMAT_XZ, memlimit=_XZ_MEMORY)
        try:
            data = reader.decompress(data, MAX_BYTES + 1)
        except lzma.LZMAError as error:
            raise ValueError(str(error)) from None
        if not reader.eof and len(data) <= MAX_BYTES:
            raise ValueError("the compressed data is incomplete")
    if len(data) > MAX_BYTES:
        raise ValueError(f"more than {MAX_BYTES} bytes")
    return data


def fetch(link: Any, kind: Kind, timeout: float = 10.0) -> bytes:
    """The metadata file of a kind as the vehicle offers it over MAVFTP, which may be compressed.

    `link` is a connection of `mavutil` that knows its target, with the dialect `upstream`. `timeout` is in seconds,
    for each answer. TimeoutError; LookupError where the vehicle offers none of this kind.
    """
    general = _read(link, _general_uri(link, timeout), timeout)
    if kind == Kind.GENERAL:
        return general
    return _read(link, uri_of(general, kind), timeout)


def uri_of(general: bytes, kind: Kind) -> str:
    """Where a general file says that the file of a kind is: on the vehicle, if one of its two places is. LookupError;
    ValueError.
    """
    try:
        offers = {
            offer["type"]: [str(offer["uri"]), str(offer.get("uriFallback", ""))]
            for offer in json.loads(decompressed(general))["metadataTypes"]
        }
    except (LookupError, TypeError, AttributeError, ValueError, RecursionError) as error:
        raise ValueError(f"the vehicle's general metadata cannot be read: {error!r}") from None
    if kind not in offers:
        raise LookupError(f"the vehicle offers no metadata of the kind {kind.name.lower()}")
    return next((uri for uri in offers[kind] if uri.startswith(MFTP)), offers[kind][0])


def path_of(uri: str) -> str:
    """The path in a MAVFTP URI, `mftp://[;comp=ID]/PATH`. LookupError for others."""
    path = uri.removeprefix(MFTP)
    if path == uri:
        raise LookupError(f"the metadata is not on the vehicle: download {uri} and name the file")
    if path.startswith("[;"):
        path = path.partition("]")[2]
    return "/" + path.lstrip("/")


def _general_uri(link: Any, timeout: float) -> str:
    end = time.monotonic() + timeout
    while (left := end - time.monotonic()) > 0:
        link.mav.command_long_send(
            link.target_system, link.target_component,
            _REQUEST_MESSAGE, 0, _COMPONENT_METADATA, 0, 0, 0, 0, 0, 0,
        )  # fmt: skip
        answer = link.recv_match(
            type="COMPONENT_METADATA", blocking=True, timeout=min(left, _ASK_EVERY)
        )
        if answer is not None and answer.get_srcSystem() == link.target_system:
            return str(answer.uri)
    raise TimeoutError(f"no COMPONENT_METADATA of system {link.target_system} within {timeout} s")


def _read(link: Any, uri: str, timeout: float) -> bytes:
    from mavwire.mavftp import MAVFTP

    path = path_of(uri)
    content: list[bytes | None] = []
    client = MAVFTP(link, link.target_system, link.target_component)
    client.cmd_get([path], lambda file: content.append(file and file.read()))
    result = client.process_ftp_reply("OpenFileRO", timeout)
    if not content or content[0] is None:
        raise LookupError(
            f"cannot read {path} from system {link.target_system}: {result.error_code}"
        )
    return content[0]
