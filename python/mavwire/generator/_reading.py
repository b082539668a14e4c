"""Definition files as text, for the native reader."""

from __future__ import annotations

import codecs
import re

from mavwire.generator._errors import MAVParseError, MAVSyntaxError

MAX_FILE_SIZE = 16 * 1024 * 1024
"""Bytes of one file; the largest published definitions have half a megabyte."""

_DECLARATION = re.compile(rb"""<\?xml[^>]{0,200}?encoding\s{0,9}=\s{0,9}["']([\w-]{1,40})""")
# Others take more than linear time, or are no encodings of text.
_ENCODING = re.compile(r"utf-?(8|16)|(us-)?ascii|(iso-?8859|latin|koi8|windows|cp)[\w-]*", re.I)


def read_text(filename: str) -> str:
    """The text of a file. Raises OSError, or :class:`MAVParseError` where it cannot be one."""
    with open(filename, "rb") as file:
        data = file.read(MAX_FILE_SIZE + 1)
    if len(data) > MAX_FILE_SIZE:
        raise MAVParseError(f"{filename}: larger than {MAX_FILE_SIZE} bytes, not a definition file")
    encoding = _encoding(data)
    try:
        if not _ENCODING.fullmatch(encoding):
            raise LookupError(f"unknown encoding: {encoding}")
        return data.decode(encoding)
    except (LookupError, UnicodeError) as error:
        raise MAVSyntaxError(f"{filename}:1:1: not well-formed XML: {error}", error) from None


def _encoding(data: bytes) -> str:
    if data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return "utf-16"
    declared = _DECLARATION.match(data)
    return declared[1].decode() if declared else "utf-8"
