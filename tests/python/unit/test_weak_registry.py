"""Objects that are noted, weakly held."""

from __future__ import annotations

from mavwire.links.weak_registry import WeakRegistry


class One: ...


def test_what_lives_is_noted_until_it_is_discarded() -> None:
    registry, ones = WeakRegistry(), [One() for _ in range(3)]
    for one in ones:
        registry.add(one)
    registry.discard(ones[1])
    registry.discard(One())
    assert list(registry) == [ones[0], ones[2]]
    del ones[0], one
    assert list(registry) == [ones[1]]


def test_what_is_gone_is_not_kept_for_ever() -> None:
    registry, one = WeakRegistry(), One()
    registry.add(one)
    for _ in range(1000):
        registry.add(One())
    assert list(registry) == [one]
    assert len(registry._noted) < 500


def test_what_comes_and_goes_meanwhile_does_no_harm() -> None:
    registry, ones = WeakRegistry(), [One() for _ in range(3)]
    for one in ones:
        registry.add(one)
    seen = []
    for one in registry:
        seen.append(one)
        registry.discard(one)
        registry.add(One())
    assert (seen, list(registry)) == (ones, [])
