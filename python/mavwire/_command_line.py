"""Command lines that need no argparse.

Most of them name a log, with an option or two. Those are understood here: argparse, with all that it
imports, takes as long as reading 100,000 messages. What else a line may hold is left to argparse:
help, mistakes, a part of an option's name; and all lines of a command that declares what is not
known here.
"""

from __future__ import annotations

from types import SimpleNamespace

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

# Which texts are the value of an option as they stand, or by a call that refuses them by ValueError.
KNOWN_TYPES = (None, str, int, float)
FLAGS = {"store_true": True, "store_false": False}
OPERANDS_MAY_SAY = {"nargs", "metavar", "help"}


class UnusualError(Exception):
    """This is for argparse."""


def understood(declare: Callable[[Any], None], words: list[str]) -> SimpleNamespace | None:
    """What argparse would make of `words` for a command that declares its arguments by `declare(parser)`;
    None where argparse has to be asked.
    """
    try:
        line = _CommandLine()
        declare(line)
        return SimpleNamespace(**line.parse(words))
    except UnusualError:
        return None


class _CommandLine:
    """In place of a parser: what a command declares, and the values of a line."""

    def __init__(self) -> None:
        self._defaults: dict[str, Any] = {}
        # How an option is written -> its name, and what was declared of it.
        self._options: dict[str, tuple[str, dict[str, Any]]] = {}
        self._required: set[str] = set()
        # What is no option, and whether there may be several.
        self._operands: str | None = None
        self._is_list = False

    def __getattr__(self, name: str) -> Any:
        raise UnusualError(name)

    def add_argument(self, *written: str, **declared: Any) -> None:
        """As a parser's."""
        action, default = declared.get("action", "store"), declared.get("default")
        if not isinstance(action, str):
            raise UnusualError(written[0])
        # argparse converts a default that is a text, and knows texts that are none.
        if isinstance(default, str) and (declared.get("type") or default.startswith("=")):
            raise UnusualError(written[0])
        if not written[0].startswith("-"):
            self._add_operands(written[0], declared)
            return
        name = declared.get("dest") or _name(written)
        for one in written:
            self._options[one] = name, declared
        if declared.get("required"):
            self._required.add(name)
        if "default" not in declared and action in FLAGS:
            default = not FLAGS[action]
        self._defaults.setdefault(name, default)

    def _add_operands(self, name: str, declared: dict[str, Any]) -> None:
        number = declared.get("nargs")
        if self._operands or number not in (None, "+") or not declared.keys() <= OPERANDS_MAY_SAY:
            raise UnusualError(name)
        self._operands, self._is_list = name, number is not None

    def parse(self, words: list[str]) -> dict[str, Any]:
        """Name -> value. UnusualError for what is not simple, or wrong."""
        values, missing = dict(self._defaults), set(self._required)
        operands: list[str] = []
        left = list(reversed(words))
        while left:
            if _is_operand(left[-1]):
                if operands:  # there is an option between them
                    raise UnusualError(left[-1])
                while left and _is_operand(left[-1]):
                    operands.append(left.pop())
            else:
                name, values[name] = self._option(left)
                missing.discard(name)
        if missing or self._operands is None or not operands:
            raise UnusualError(missing)
        if not self._is_list and len(operands) > 1:
            raise UnusualError(operands[1])
        values[self._operands] = operands if self._is_list else operands[0]
        return values

    def _option(self, left: list[str]) -> tuple[str, Any]:
        """Name and value of the option that comes next."""
        written, equals, value = left.pop().partition("=")
        name, declared = self._options.get(written, ("", {}))
        action = declared.get("action", "store")
        if action in FLAGS and not equals:
            return name, FLAGS[action]
        if not equals and left and _is_operand(left[-1]):
            value = left.pop()
        kind = declared.get("type")
        if not name or action != "store" or "nargs" in declared or kind not in KNOWN_TYPES:
            raise UnusualError(written)
        if not value or (equals and not written.startswith("--")):
            raise UnusualError(written)
        try:
            converted = value if kind is None else kind(value)
        except ValueError as error:
            raise UnusualError(value) from error
        if "choices" in declared and converted not in declared["choices"]:
            raise UnusualError(value)
        return name, converted


def _is_operand(word: str) -> bool:
    return not word.startswith("-") or word == "-"


def _name(written: tuple[str, ...]) -> str:
    """The attribute of an option that is written so."""
    long = [one for one in written if one.startswith("--")]
    return (long or written)[0].lstrip("-").replace("-", "_")
