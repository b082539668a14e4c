"""Queries over logs: the arguments that `read`, `scan`, `convert` and others share."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable, Iterator
from datetime import datetime
from functools import wraps
from inspect import Parameter
from typing import Any, ParamSpec, TypedDict, TypeVar

from mavwire._text import did_you_mean

P = ParamSpec("P")
T = TypeVar("T")

Types = str | type | Iterable[str | type] | None
"""Names or message classes, one or several; None means all."""


class Records(TypedDict, total=False):
    """The part of a `Query` that chooses records."""

    systems: int | Iterable[int] | None
    start: float | str | datetime | None
    end: float | str | datetime | None


class Values(Records, total=False):
    """The part of a `Query` that chooses records and how values are shown."""

    units: str | None
    enums: str | None
    invalid: str | None


class Query(Values, total=False):
    """Which records and fields to read, and how values are shown. None means all, and values as sent.

    - `systems`: system ids, one or several.
    - `start`, `end`: records with `start <= time < end`. A time is seconds since 1970, a datetime, or a
      text such as 2024-01-31T12:00:00.
    - `fields`: the fields that become columns, one or several.
    - `units`: "si" scales values to SI units. Angles stay degrees or radians.
    - `enums`: "names" makes names of enum values.
    - `invalid`: "null" makes nulls of invalid values, such as 65535 mV or NaN, as the definitions say.
      "keep" keeps them. The default is "null" with `units="si"` and "keep" otherwise.
    - `unknown`: "table" makes a table `mavwire.unknown` of messages that the dialect does not define, "ignore"
      leaves them out without a warning.
    """

    fields: str | Iterable[str] | None
    unknown: str | None


def takes(query: type, *positional: str) -> Callable[[Callable[P, T]], Callable[P, T]]:
    """Name the arguments that a function takes as `**query`, for `help` and at each call.

    Those in `positional` need no name, in this order. A name that is unknown is a TypeError which lists
    the known ones.
    """

    def named(function: Callable[P, T]) -> Callable[P, T]:
        own = inspect.signature(function)
        signature = own.replace(parameters=[*_parameters(own, query, positional)])
        known = signature.parameters.keys()

        @wraps(function)
        def call(*args: P.args, **given: P.kwargs) -> T:
            called = f"{function.__name__}()"
            for name in (one for one in given if one not in known):
                names = ", ".join(one for one in known if one != "self")
                hint = did_you_mean(name, known)
                raise TypeError(f"{called} has no argument {name!r}{hint}; it takes {names}")
            try:
                arguments: dict[str, Any] = signature.bind(*args, **given).arguments
            except TypeError as error:
                raise TypeError(f"{called}: {error}") from None
            return function(**arguments)  # type: ignore[call-arg]

        call.__signature__ = signature  # type: ignore[attr-defined]
        return call

    return named


def _parameters(
    own: inspect.Signature, query: type, positional: tuple[str, ...]
) -> Iterator[Parameter]:
    """The parameters of a function, with those of a query in place of `*positional` and `**query`."""
    every = own.parameters.values()
    yield from (one for one in every if one.kind is Parameter.POSITIONAL_OR_KEYWORD)
    names = query.__annotations__
    for name in (*positional, *(one for one in names if one not in positional)):
        kind = Parameter.POSITIONAL_OR_KEYWORD if name in positional else Parameter.KEYWORD_ONLY
        yield Parameter(name, kind, default=None, annotation=names[name].__forward_arg__)
    yield from (one for one in every if one.kind is Parameter.KEYWORD_ONLY)
