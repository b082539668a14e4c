"""Handlers of signals are those of before again."""

from __future__ import annotations

import math
import signal
from collections.abc import Iterator
from contextlib import nullcontext
from types import SimpleNamespace
from typing import Any

import pytest
from mavwire import _signals
from mavwire._signals import ended_in_order, handled, put_off

NUMBERS = (signal.SIGTERM, signal.SIGINT)


class Before(Exception):
    """Of the handler that was there before."""


class Ended(Exception):
    """Of the handler meanwhile."""


def end(*_: Any) -> None:
    raise Ended


@pytest.fixture(autouse=True)
def before() -> Iterator[list[Any]]:
    """The handlers of this process, which it has again afterwards."""
    handlers = [signal.getsignal(number) for number in NUMBERS]
    set_handler = signal.signal
    yield handlers
    for number, handler in zip(NUMBERS, handlers, strict=True):
        set_handler(number, handler)


def test_a_signal_between_two_handlers_leaves_none_behind(
    before: list[Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The first of two handlers is set when it comes."""
    set_handler, calls = signal.signal, []

    def interrupted(number: int, handler: Any) -> Any:
        replaced = set_handler(number, handler)
        calls.append(number)
        if len(calls) == 1:
            signal.raise_signal(number)
        return replaced

    monkeypatch.setattr(signal, "signal", interrupted)
    with pytest.raises((Ended, KeyboardInterrupt)), handled(NUMBERS, end):
        pass
    assert [signal.getsignal(number) for number in NUMBERS] == before


@pytest.mark.parametrize("fails", [False, True])
def test_signals_that_are_put_off_are_heard_afterwards(fails: bool) -> None:
    heard: list[int] = []
    for number in NUMBERS:
        signal.signal(number, lambda number, frame: heard.append(number))

    with pytest.raises(Before) if fails else nullcontext(), put_off(NUMBERS):
        signal.raise_signal(signal.SIGTERM)
        assert not heard
        if fails:
            raise Before
    assert heard == [signal.SIGTERM]


def test_what_is_not_for_python_is_not_put_off() -> None:
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    with put_off([signal.SIGTERM]):
        assert signal.getsignal(signal.SIGTERM) is signal.SIG_IGN


def test_a_handler_that_python_cannot_give_back_is_left_alone(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(signal, "getsignal", lambda number: None)
    monkeypatch.setattr(signal, "signal", lambda *_: pytest.fail("it is replaced"))
    with handled(NUMBERS, end):
        pass


def test_what_comes_together_is_one_end() -> None:
    """As SIGTERM and SIGHUP do: the second must not disturb what the first lets be removed."""
    signal.signal(signal.SIGTERM, end)
    with ended_in_order():
        with pytest.raises(KeyboardInterrupt), ended_in_order():
            signal.raise_signal(signal.SIGTERM)
        try:
            signal.raise_signal(signal.SIGTERM)
        except KeyboardInterrupt:
            pytest.fail("it ends what is ending")
    with pytest.raises(Ended):
        signal.raise_signal(signal.SIGTERM)


def test_a_process_that_went_on_can_be_ended_later(monkeypatch: pytest.MonkeyPatch) -> None:
    with ended_in_order():
        for _ in range(2):
            with pytest.raises(KeyboardInterrupt):
                signal.raise_signal(signal.SIGTERM)
            monkeypatch.setattr(_signals, "time", SimpleNamespace(monotonic=lambda: math.inf))
