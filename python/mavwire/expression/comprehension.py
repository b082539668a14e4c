"""Comprehensions: the only loops of an expression, so the only place that counts steps.

Their variables live in a scope over the messages. One evaluation has one budget of steps, shared
by all its comprehensions however they nest. A generator expression gives a list.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import Any

from mavwire.expression.limits import MAX_STEPS, ExpressionError

Closure = Callable[[Any], Any]


class Scope:
    """The messages, and over them the variables of comprehensions."""

    __slots__ = ("below", "bound", "budget")

    def __init__(self, below: Any) -> None:
        self.below = below
        self.bound: dict[str, Any] = {}
        self.budget: list[int] = below.budget if isinstance(below, Scope) else [MAX_STEPS]

    def __getitem__(self, name: str) -> Any:
        return self.bound[name] if name in self.bound else self.below[name]

    def __contains__(self, name: str) -> bool:
        return name in self.bound or name in self.below

    def spend(self, steps: int) -> None:
        self.budget[0] -= steps
        if self.budget[0] < 0:
            raise ExpressionError(f"comprehensions of more than {MAX_STEPS} steps")


class Clause:
    """One ``for target in iterable if ... if ...``; ``cost`` is what an iteration spends."""

    def __init__(
        self,
        bind: Callable[[dict[str, Any], Any], None],
        iterable: Closure,
        conditions: list[Closure],
        cost: int,
    ) -> None:
        self.bind, self.iterable, self.conditions, self.cost = bind, iterable, conditions, cost

    def run(self, scope: Scope) -> Iterator[None]:
        """Bind one item after the other, yielding where the conditions hold."""
        items: Iterable[Any] = self.iterable(scope)
        for item in items:
            scope.spend(self.cost)
            self.bind(scope.bound, item)
            if all(condition(scope) for condition in self.conditions):
                yield


def _run_all(clauses: list[Clause], scope: Scope) -> Iterator[None]:
    first, rest = clauses[0], clauses[1:]
    for _ in first.run(scope):
        if rest:
            yield from _run_all(rest, scope)
        else:
            yield


def collect(
    clauses: list[Clause], element: Closure, make: Callable[[Iterator[Any]], Any]
) -> Closure:
    """A closure that gives ``make`` the element of every iteration."""

    def run(variables: Any) -> Any:
        scope = Scope(variables)
        return make(element(scope) for _ in _run_all(clauses, scope))

    return run
