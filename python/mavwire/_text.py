"""Error texts for users, and a filter for terminal control characters."""

from __future__ import annotations

import sys
from contextlib import contextmanager

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence
    from typing import Any

# Characters that change the direction of text, so that it looks like another text.
_BIDIRECTIONAL = (0x061C, 0x200E, 0x200F, *range(0x202A, 0x202F), *range(0x2066, 0x206A))
# Characters that terminals act upon: C0 except tabs, DEL, C1 and changes of direction.
_CONTROLS = {
    code: f"\\x{code:02x}" for code in (*range(0x20), *range(0x7F, 0xA0)) if code != ord("\t")
} | {code: f"\\u{code:04x}" for code in _BIDIRECTIONAL}
_CONTROLS_WITHIN_LINES = {code: text for code, text in _CONTROLS.items() if code != ord("\n")}

OTHER_TEXT = "convert it first: iconv -f UTF-16 -t UTF-8 in.log > out.log, or tr '\\r' '\\n' < in.log > out.log"
"""Advice for text logs in UTF-16, or with carriage returns alone."""


def cannot_write(path: str, suffixes: Sequence[str]) -> str:
    """The error text for a file whose suffix names no format."""
    *most, last = suffixes
    return f"cannot write {path!r}: use {', '.join(most)} or {last}"


def callers_level() -> int:
    """The `stacklevel` with which a warning of the calling function names the line outside mavwire that led to it."""
    level, frame = 1, sys._getframe(1)
    while frame.f_back is not None and frame.f_globals["__name__"].split(".")[0] == "mavwire":
        level, frame = level + 1, frame.f_back
    return level


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """`; did you mean 'mode'?` if one of the known names is close to this one, else nothing."""
    from difflib import get_close_matches

    close = get_close_matches(name, list(known), n=1)
    return f"; did you mean {close[0]!r}?" if close else ""


def in_words(error: BaseException, path: str | None = None) -> str:
    """The text of an exception, without the name of its class unless the exception has no text.

    The name of a file is left out where it is `path`: the caller writes that in front.
    """
    if isinstance(error, OSError) and error.strerror:
        named = error.filename is not None and error.filename != path
        return f"{error.filename}: {error.strerror}" if named else error.strerror
    if isinstance(error, FileNotFoundError):  # what file systems of Python raise has no number
        return f"no such file: {error}"
    if isinstance(error, KeyError) and error.args:
        return f"there is no {error.args[0]!r}"
    if isinstance(error, NameError) and error.name:
        return f"there is no {error.name!r}"
    if isinstance(error, AttributeError) and hasattr(error.obj, "get_type"):  # a message's
        return f"{error.obj.get_type()} has no field {error.name!r}"
    if isinstance(error, SyntaxError) and error.msg:  # without the place, which is that of a file
        return error.msg
    if isinstance(error, MemoryError) and not error.args:
        return "there is not enough memory"
    text = str(error) or type(error).__name__
    return text if path is None else text.removesuffix(f": {path!r}")


@contextmanager
def naming(path: str) -> Iterator[None]:
    """Gives errors of reading, which name no file, this name."""
    try:
        yield
    except OSError as error:
        if error.filename is None and error.errno is not None:
            error.filename = path
        raise


def no_such_dialect(dialect: str) -> str:
    """The error text for an unknown dialect. It names a similar one, or all of them."""
    from mavwire.dialects import names

    built_in = names()
    hint = did_you_mean(dialect, built_in)
    text = f"no dialect {dialect!r}; name a built-in one, one in $MDEF/v1.0, or a path to XML"
    return text + (hint or f"; built in are {', '.join(built_in)}")


def is_terminal(stream: Any) -> bool:
    """Whether a stream is a terminal. None, a closed one and one that cannot tell are not."""
    try:
        return bool(stream.isatty())
    except (AttributeError, ValueError):
        return False


def shown_to(stream: Any, text: str) -> str:
    """A text from a log as a stream may take it: a terminal without control characters, so that a log
    cannot steer it; a pipe or a file as it is.
    """
    return text.translate(_CONTROLS_WITHIN_LINES) if is_terminal(stream) else text


def printable(text: str) -> str:
    """A line of a file with its control characters, but for tabs, as `\\x1b`."""
    return text.translate(_CONTROLS)


class _Guarded:
    """A terminal that shows control characters of a printed text as escapes."""

    def __init__(self, terminal: Any) -> None:
        self._terminal = terminal

    def __getattr__(self, name: str) -> Any:
        return getattr(self._terminal, name)

    def write(self, text: str) -> int:
        self._terminal.write(text.translate(_CONTROLS_WITHIN_LINES))
        return len(text)

    def writelines(self, lines: Iterable[str]) -> None:
        for line in lines:
            self.write(line)


def drawn_on(stream: Any) -> Any:
    """The terminal behind guards, for who moves its cursor and shows strangers' texts as `printable`.

    Between two guards there is what rich puts in place of a stream while it draws.
    """
    while True:
        if isinstance(stream, _Guarded):
            stream = stream._terminal
        elif hasattr(stream, "rich_proxied_file"):
            stream = stream.rich_proxied_file
        else:
            return stream


def guard_streams() -> None:
    """Put a guard before standard output and standard error where they are terminals."""
    sys.stdout, sys.stderr = _guarded(sys.stdout), _guarded(sys.stderr)


def _guarded(stream: Any) -> Any:
    if is_terminal(stream) and not isinstance(stream, _Guarded):
        return _Guarded(stream)
    return stream


@contextmanager
def guarded_output() -> Iterator[None]:
    """While it lasts, what a command prints of strangers' texts, its errors among them, does not steer
    the terminal.
    """
    streams = sys.stdout, sys.stderr
    guard_streams()
    try:
        yield
    except SystemExit as ending:
        # Python prints a text when the guard has gone.
        if isinstance(ending.code, str):
            ending.code = shown_to(sys.stderr, ending.code)
        raise
    finally:
        sys.stdout, sys.stderr = streams
