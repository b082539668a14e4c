"""Comprehensions: the only loops of an expression, so the only place that charges steps.

Their variables live in a scope over the messages. A generator expression gives a list.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator
from typing import Any

from mavwire.expression.limits import SCALARS, Budget, charge, spend

Closure = Callable[[Any, Budget], Any]


class Scope:
    """The messages, and over them the variables of comprehensions."""

    __slots__ = ("below", "bound")

    def __init__(self, below: Any) -> None:
        self.below = below
        self.bound: dict[str, Any] = {}

    def __getitem__(self, name: str) -> Any:
        return self.bound[name] if name in self.bound else self.below[name]

    def __contains__(self, name: str) -> bool:
        return name in self.bound or name in self.below


class Clause:
    """One ``for target in iterable if ... if ...`` of ``node``; an iteration spends ``cost``."""

    def __init__(
        self,
        bind: Callable[[dict[str, Any], Any], None],
        iterable: Closure,
        conditions: list[Closure],
        cost: int,
        node: ast.AST,
    ) -> None:
        self.bind, self.iterable, self.conditions = bind, iterable, conditions
        self.cost, self.node = cost, node

    def run(self, scope: Scope, budget: Budget) -> Iterator[None]:
        """Bind one item after the other, yielding where the conditions hold."""
        for item in self.iterable(scope, budget):
            spend(self.cost, budget, self.node)
            self.bind(scope.bound, item)
            if all(condition(scope, budget) for condition in self.conditions):
                yield


def _run_all(clauses: list[Clause], scope: Scope, budget: Budget) -> Iterator[None]:
    first, rest = clauses[0], clauses[1:]
    for _ in first.run(scope, budget):
        if rest:
            yield from _run_all(rest, scope, budget)
        else:
            yield


def collect(
    clauses: list[Clause], element: Closure, make: Callable[[Iterator[Any]], Any], node: ast.AST
) -> Closure:
    """A closure that gives ``make`` the element of every iteration."""

    def run(variables: Any, budget: Budget) -> Any:
        scope = Scope(variables)
        return make(_elements(scope, budget))

    def _elements(scope: Scope, budget: Budget) -> Iterator[Any]:
        for _ in _run_all(clauses, scope, budget):
            item = element(scope, budget)
            yield item if type(item) in SCALARS else charge(item, budget, node)

    return run
