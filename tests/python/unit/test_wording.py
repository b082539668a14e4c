"""Hints at what was meant, and text from files as a terminal can take it."""

from mavwire._wording import did_you_mean, printable


def test_hints():
    assert did_you_mean("grop", ("group", "name")) == "; did you mean 'group'?"
    assert did_you_mean("zzz", ("group", "name")) == ""
    assert did_you_mean("grop", {"group": 1}) == "; did you mean 'group'?"


def test_control_characters_are_written_out():
    assert printable("\x1b[2J\ta\x00\x7f\x9b") == "\\x1b[2J\ta\\x00\\x7f\\x9b"
    assert printable("Größe 5 \N{BLACK STAR} \\x1b") == "Größe 5 \N{BLACK STAR} \\x1b"
