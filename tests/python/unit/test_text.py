"""Hints at what was meant, and text from files as a terminal can take it."""

import pytest
from mavwire._text import did_you_mean, in_words, printable


def test_hints():
    assert did_you_mean("grop", ("group", "name")) == "; did you mean 'group'?"
    assert did_you_mean("zzz", ("group", "name")) == ""
    assert did_you_mean("grop", {"group": 1}) == "; did you mean 'group'?"


def test_control_characters_are_written_out():
    assert printable("\x1b[2J\ta\x00\x7f\x9b") == "\\x1b[2J\ta\\x00\\x7f\\x9b"
    assert printable("Größe 5 \N{BLACK STAR} \\x1b") == "Größe 5 \N{BLACK STAR} \\x1b"


@pytest.mark.parametrize(
    ("error", "words"),
    [
        (FileNotFoundError(2, "No such file or directory", "a.tlog"), "No such file or directory"),
        (OSError(28, "No space left on device", "b"), "b: No space left on device"),
        (FileNotFoundError("b"), "no such file: b"),
        (ValueError("no telemetry log"), "no telemetry log"),
        (KeyError("ATT"), "there is no 'ATT'"),
        (MemoryError(), "there is not enough memory"),
        (AssertionError(), "AssertionError"),
        (IndexError(), "IndexError"),
        (IndexError("list index out of range"), "list index out of range"),
    ],
)
def test_errors_in_words(error: BaseException, words: str) -> None:
    assert in_words(error, "a.tlog") == words
