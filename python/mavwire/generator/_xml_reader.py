"""Definition files as a small element tree, read so that no file can hurt the reader.

Definitions need elements, attributes and text, nothing else of XML. A document type declaration is
refused, which leaves no entities to expand; size, nesting and number of elements are capped, so
that a wrong or hostile file is refused within milliseconds. Errors say ``file:line:column``.
"""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from xml.parsers import expat

from mavwire.generator._errors import MAVParseError, MAVSyntaxError

MAX_FILE_SIZE = 16 * 1024 * 1024
"""Bytes of one file; the largest published definitions have half a megabyte."""
MAX_DEPTH = 16
"""Elements within elements; definitions need five."""
MAX_ELEMENTS = 100_000
"""Elements of one file; the largest published definitions have 6,000."""


@dataclass(slots=True)
class Element:
    """An XML element; ``text`` is its own text without that of its children."""

    tag: str
    attributes: dict[str, str]
    line: int
    column: int
    children: list[Element] = field(default_factory=list)
    text: str = ""

    def all(self, tag: str) -> list[Element]:
        """Children with this tag, in order."""
        return [child for child in self.children if child.tag == tag]

    def first(self, tag: str) -> Element | None:
        """The first child with this tag."""
        return next((child for child in self.children if child.tag == tag), None)


def read_xml(filename: str, max_elements: int = MAX_ELEMENTS) -> Element:
    """The root element of a file. Raises OSError, or :class:`MAVSyntaxError` with file, line and
    column.
    """
    with open(filename, "rb") as file:
        data = file.read(MAX_FILE_SIZE + 1)
    if len(data) > MAX_FILE_SIZE:
        raise MAVParseError(f"{filename}: larger than {MAX_FILE_SIZE} bytes, not a definition file")
    return _TreeBuilder(filename, max_elements).build(data)


class _TreeBuilder:
    def __init__(self, filename: str, max_elements: int) -> None:
        self._filename = filename
        self._max_elements = max_elements
        self._stack: list[Element] = []
        self._texts: list[list[str]] = []
        self._root: Element | None = None
        self._count = 0
        self._parser = expat.ParserCreate()
        self._parser.buffer_text = True
        self._parser.StartElementHandler = self._start
        self._parser.EndElementHandler = self._end
        self._parser.CharacterDataHandler = self._text
        self._parser.StartDoctypeDeclHandler = self._refuse_doctype

    def build(self, data: bytes) -> Element:
        try:
            self._parser.Parse(data, True)
        except expat.ExpatError as error:
            if isinstance(error, MAVSyntaxError):
                raise
            raise MAVSyntaxError(_describe(self._filename, data, error), error) from None
        except (LookupError, ValueError) as error:
            raise MAVSyntaxError(f"{self._filename}:1:1: {error}", error) from None
        assert self._root is not None  # the parser refuses a text without elements
        return self._root

    def _start(self, tag: str, attributes: dict[str, str]) -> None:
        self._count += 1
        if len(self._stack) == MAX_DEPTH:
            self._refuse(f"elements nested deeper than {MAX_DEPTH}")
        if self._count > self._max_elements:
            self._refuse(f"more than {self._max_elements} elements")
        line, column = self._parser.CurrentLineNumber, self._parser.CurrentColumnNumber + 1
        element = Element(tag, attributes, line, column)
        if self._stack:
            self._stack[-1].children.append(element)
        else:
            self._root = element
        self._stack.append(element)
        self._texts.append([])

    def _end(self, _tag: str) -> None:
        self._stack.pop().text = "".join(self._texts.pop())

    def _text(self, text: str) -> None:
        self._texts[-1].append(text)

    def _refuse_doctype(self, *_declaration: object) -> None:
        self._refuse(
            "a document type declaration (<!DOCTYPE>) has no place in definitions; remove it"
        )

    def _refuse(self, reason: str) -> None:
        line, column = self._parser.CurrentLineNumber, self._parser.CurrentColumnNumber + 1
        raise MAVSyntaxError(f"{self._filename}:{line}:{column}: {reason}")


def _describe(filename: str, data: bytes, error: expat.ExpatError) -> str:
    if not data.strip():
        return f"{filename}:1:1: the file is empty"
    reason = expat.ErrorString(error.code) or str(error)
    return f"{filename}:{error.lineno}:{error.offset + 1}: not well-formed XML: {reason}"


def base_name(filename: str) -> str:
    """A definition file's name without folder and suffix: the name of its dialect."""
    return os.path.splitext(os.path.basename(filename))[0]
