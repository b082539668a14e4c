"""The package's own `contextmanager` does what that of `contextlib` does."""

from __future__ import annotations

import contextlib
import inspect
import traceback
from collections.abc import Callable, Iterator
from typing import Any

import pytest
from mavwire import _context

MAKERS = [contextlib.contextmanager, _context.contextmanager]


@pytest.fixture(params=MAKERS, ids=["contextlib", "own"])
def make(request: pytest.FixtureRequest) -> Callable[..., Any]:
    return request.param  # type: ignore[no-any-return]


def test_what_is_around_happens_before_and_behind(make):
    done = []

    @make
    def around(first: int, *, last: int) -> Iterator[str]:
        """Told."""
        done.append(first)
        try:
            yield "value"
        finally:
            done.append(last)

    with around(1, last=3) as value:
        done.append(2)
    assert (value, done, around.__doc__) == ("value", [1, 2, 3], "Told.")


def test_an_error_passes_unless_it_is_dealt_with(make):
    @make
    def around(dealt_with: type[BaseException]) -> Iterator[None]:
        with contextlib.suppress(dealt_with):
            yield

    with around(ValueError):
        raise ValueError
    with pytest.raises(KeyError), around(ValueError):
        raise KeyError
    for error in (StopIteration, GeneratorExit, KeyboardInterrupt):
        with pytest.raises(error), around(ValueError):
            raise error


def test_an_error_may_become_another(make):
    @make
    def around() -> Iterator[None]:
        try:
            yield
        except ValueError as error:
            raise KeyError("told") from error

    with pytest.raises(KeyError, match="told") as caught, around():
        raise ValueError
    assert isinstance(caught.value.__cause__, ValueError)


def test_the_traceback_of_an_error_names_no_generator(make):
    @make
    def around() -> Iterator[None]:
        yield

    with pytest.raises(ValueError) as caught, around():
        raise ValueError
    assert "around" not in [one.name for one in traceback.extract_tb(caught.value.__traceback__)]


def test_a_function_keeps_its_name_and_signature(make):
    entered = []

    @make
    def around() -> Iterator[None]:
        entered.append(1)
        yield

    @around()
    def double(number: int, by: int = 2) -> int:
        """Told."""
        return number * by

    assert [double(2), double(3, by=3)] == [4, 9]
    assert (len(entered), double.__name__, double.__doc__) == (2, "double", "Told.")
    assert list(inspect.signature(double).parameters) == ["number", "by"]
