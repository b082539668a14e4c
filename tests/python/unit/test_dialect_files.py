"""`dialects.load`: what cannot be read as a definition file is refused at once, by name."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from mavwire import dialects
from mavwire._native import DefinitionError


def test_dialect_files_that_cannot_be_read_are_named(tmp_path: Path) -> None:
    text = "<?xml version='1.0'?>\n<mavlink>\n<!-- \xe9 -->\n</mavlink>"
    latin = tmp_path / "latin.xml"
    latin.write_text(text, encoding="latin-1")
    with pytest.raises(DefinitionError, match=r"latin\.xml:3: the text is not in UTF-8"):
        dialects.load(latin)
    latin.write_text(text, encoding="utf-16")
    with pytest.raises(DefinitionError, match=r"latin\.xml:1: the text is not in UTF-8"):
        dialects.load(latin)
    os.mkfifo(tmp_path / "pipe.xml")
    for path in (tmp_path / "pipe.xml", "/dev/zero"):
        with pytest.raises(DefinitionError, match=rf"{path}: not a regular file"):
            dialects.load(path)
    large = tmp_path / "large.xml"
    with large.open("wb") as file:
        file.truncate(16 * 1024 * 1024 + 1)
    with pytest.raises(DefinitionError, match=r"large\.xml: definition file larger than"):
        dialects.load(large)
