"""A small text template: ``${name}`` is a value, ``${{name:text}}`` repeats the text for each item
of a list.

Names are looked up as keys of a mapping or attributes of an object; inside a repetition the item's
own names come first and the names outside stay visible. Values are substituted again, so a value
may itself hold ``${name}``.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Protocol

from mavwire.generator._errors import MAVParseError

MAX_DEPTH = 32
"""Values within values. A value that holds its own name would otherwise never end."""


class _Writable(Protocol):
    def write(self, text: str, /) -> object: ...


class _Scope:
    """Names of one repetition, then those around it."""

    def __init__(self, names: Any, outer: _Scope | None = None) -> None:
        self._names = names
        self._outer = outer

    def get(self, name: str) -> tuple[bool, Any]:
        """``(found, value)``."""
        scope: _Scope | None = self
        while scope is not None:
            names = scope._names
            if isinstance(names, Mapping):
                if name in names:
                    return True, names[name]
            elif name and hasattr(names, name):
                return True, getattr(names, name)
            scope = scope._outer
        return False, None


@dataclass(eq=False, repr=False)
class MAVTemplate:
    """Substitutes values into text. The four tokens can be chosen freely."""

    start_var_token: str = "${"
    end_var_token: str = "}"
    start_rep_token: str = "${{"
    end_rep_token: str = "}}"
    trim_leading_lf: bool = True
    checkmissing: bool = True

    def find_end(
        self, text: str, start_token: str, end_token: str, ignore_end_token: str | None = None
    ) -> int:
        """Offset just after the token that closes the one ``text`` starts with."""
        return _find_end(text, 0, start_token, end_token, ignore_end_token)

    def find_var_end(self, text: str) -> int:
        """Offset just after the variable ``text`` starts with."""
        return self.find_end(text, self.start_var_token, self.end_var_token)

    def find_rep_end(self, text: str) -> int:
        """Offset just after the repetition ``text`` starts with."""
        return self.find_end(
            text, self.start_rep_token, self.end_rep_token, ignore_end_token=self.end_var_token
        )

    def substitute(
        self,
        text: str,
        subvars: Any = {},  # noqa: B006 - part of the known signature; never changed
        trim_leading_lf: bool | None = None,
        checkmissing: bool | None = None,
    ) -> str:
        """The text with every variable replaced.

        An unknown variable raises :class:`MAVParseError`, or stays as it is with
        ``checkmissing=False``.
        """
        trim = self.trim_leading_lf if trim_leading_lf is None else trim_leading_lf
        check = self.checkmissing if checkmissing is None else checkmissing
        return self._substitute(text, _Scope(subvars), trim, check)

    def write(
        self,
        file: _Writable,
        text: str,
        subvars: Any = {},  # noqa: B006 - part of the known signature; never changed
        trim_leading_lf: bool = True,
    ) -> None:
        """Substitute and write to an open text file."""
        file.write(self.substitute(text, subvars=subvars, trim_leading_lf=trim_leading_lf))

    def _substitute(self, text: str, scope: _Scope, trim: bool, check: bool) -> str:
        text = self._repeat(text, scope, check)
        if trim and text.startswith("\n"):
            text = text[1:]
        return self._replace_variables(text, scope, check)

    def _repeat(self, text: str, scope: _Scope, check: bool) -> str:
        done: list[str] = []
        position = 0
        while (start := text.find(self.start_rep_token, position)) >= 0:
            end = _find_end(
                text, start, self.start_rep_token, self.end_rep_token, self.end_var_token
            )
            before = text[position:start]
            inner = text[start + len(self.start_rep_token) : end - len(self.end_rep_token)]
            repeated = self._repetition(inner, scope, check)
            # The line feed before the closing token belongs to the token.
            done.append((before + repeated).removesuffix("\n"))
            position = end
        done.append(text[position:])
        return "".join(done)

    def _repetition(self, inner: str, scope: _Scope, check: bool) -> str:
        name, colon, body = inner.partition(":")
        if not colon:
            raise MAVParseError(f"repetition '{inner}' has no ':' after the name of its list")
        found, items = scope.get(name)
        if not found:
            raise MAVParseError(f"unable to find field {name}")
        return "".join(self._substitute(body, _Scope(item, scope), False, check) for item in items)

    def _replace_variables(self, text: str, scope: _Scope, check: bool, depth: int = 0) -> str:
        done: list[str] = []
        position = 0
        while (start := text.find(self.start_var_token, position)) >= 0:
            end = text.find(self.end_var_token, start)
            if end < 0:
                raise MAVParseError(f"missing end of variable: {text[start : start + 10]}")
            end += len(self.end_var_token)
            done.append(text[position:start])
            done.append(self._variable(text[start:end], scope, check, depth))
            position = end
        done.append(text[position:])
        return "".join(done)

    def _variable(self, token: str, scope: _Scope, check: bool, depth: int) -> str:
        name = token[len(self.start_var_token) : len(token) - len(self.end_var_token)]
        found, value = scope.get(name)
        if not found:
            if check:
                raise MAVParseError(f"unknown variable in '{token}'")
            return token
        if depth == MAX_DEPTH:
            raise MAVParseError(f"variable '{name}' holds itself")
        return self._replace_variables(str(value), scope, check, depth + 1)


def _find_end(text: str, start: int, opening: str, closing: str, ignore: str | None) -> int:
    """Offset just after the ``closing`` token of the ``opening`` one at ``start``."""
    if not text.startswith(opening, start):
        raise MAVParseError("invalid token start")
    depth, position = 1, start + len(opening)
    while depth > 0:
        end = text.find(closing, position)
        if end < 0:
            raise MAVParseError("token nesting error")
        nested = text.find(opening, position, end)
        if nested >= 0:
            depth += 1
            position = nested + len(opening)
            continue
        if ignore and text.startswith(ignore + closing, end):
            # ``}}}`` is the end of a variable and then the end of the repetition around it.
            end += len(ignore)
        depth -= 1
        position = end + len(closing)
    return position
