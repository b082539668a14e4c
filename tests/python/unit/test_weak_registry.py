"""Objects that are noted, weakly held."""

from __future__ import annotations

from mavwire.links.weak_registry import Living


class One: ...


def test_what_lives_is_noted_until_it_is_discarded() -> None:
    living, ones = Living(), [One() for _ in range(3)]
    for one in ones:
        living.add(one)
    living.discard(ones[1])
    living.discard(One())
    assert list(living) == [ones[0], ones[2]]
    del ones[0], one
    assert list(living) == [ones[1]]


def test_what_is_gone_is_not_kept_for_ever() -> None:
    living, one = Living(), One()
    living.add(one)
    for _ in range(1000):
        living.add(One())
    assert list(living) == [one]
    assert len(living._noted) < 500


def test_what_comes_and_goes_meanwhile_does_no_harm() -> None:
    living, ones = Living(), [One() for _ in range(3)]
    for one in ones:
        living.add(one)
    seen = []
    for one in living:
        seen.append(one)
        living.discard(one)
        living.add(One())
    assert (seen, list(living)) == (ones, [])
