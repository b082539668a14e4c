"""Signing set-up of a link: keys, link ids and the signature clock's start.

Links with the same key share one table of streams, so that what was heard on one link cannot be
replayed on another.
"""

from __future__ import annotations

import time
from _weakref import ref

from mavwire._native import Signing as SigningState

from . import Any, Callable, state, warn
from .link_ids import section
from .signing_time import EPOCH, MAX_TIMESTAMP, UNITS_PER_SECOND
from .target import Target

KEY_LEN = 32
SECRET_FIELD = "secret_key"
# The id of the message with that field, which a dialect may lack.
SETUP_SIGNING = 256
MAX_LINK_ID = 255
# RADIO_STATUS and RADIO, which a telemetry radio injects without knowing any key.
RADIO_MESSAGES = frozenset((109, 166))

# The signing states that have a key.
# Weak references without callbacks: an exception in a callback would be lost in a signal handler.
_with_key: list[ref[Any]] = []


def shown(field: str, value: Any) -> Any:
    """The value of a field as texts show it: a key reads as 255 over and over."""
    return [0xFF] * KEY_LEN if field == SECRET_FIELD else value


def signing_timestamp(unix_seconds: float) -> int:
    """The signature timestamp of a wall clock time; a clock before the epoch gives 0."""
    return int((max(unix_seconds, EPOCH) - EPOCH) * UNITS_PER_SECOND)


def check_key(secret_key: bytes) -> None:
    """ValueError unless the key has 32 bytes, TypeError if it has none in order. Neither shows it."""
    has_order = hasattr(secret_key, "__len__") and hasattr(secret_key, "__getitem__")
    if not has_order or isinstance(secret_key, (str, dict)):
        kind = type(secret_key).__name__
        raise TypeError(f"secret_key is {KEY_LEN} bytes, not of type {kind}")
    if len(secret_key) != KEY_LEN:
        raise ValueError(f"a signing key has {KEY_LEN} bytes, not {len(secret_key)}")


def _check_number(name: str, value: float, largest: int) -> None:
    """OverflowError unless a signature has room for the value, TypeError if it is no number."""
    try:
        fits = 0 <= value <= largest
    except TypeError:
        raise TypeError(f"{name} is a number, not {value!r}") from None
    if not fits:
        raise OverflowError(f"{name} is 0 to {largest}, not {value}")


def _units_ahead(max_ahead: float | None, follows_clock: bool) -> int | None:
    """`max_ahead` seconds as units. ValueError where there is no clock to be ahead of, otherwise as `_check_number`."""
    if max_ahead is None:
        return None
    if not follows_clock:
        raise ValueError("max_ahead is measured by the clock, which an initial_timestamp replaces")
    _check_number("max_ahead", max_ahead, MAX_TIMESTAMP // UNITS_PER_SECOND)
    return int(max_ahead * UNITS_PER_SECOND)


def stored_timestamp(store: Any) -> int:
    """The timestamp that `store` loads, or 0. TypeError or OverflowError for anything else than a timestamp."""
    stored = store.load() or 0
    if not isinstance(stored, int):
        raise TypeError(f"a timestamp store loads an int, not {stored!r}")
    _check_number("a stored timestamp", stored, MAX_TIMESTAMP)
    return stored


def allow_radio_status(mav: Any, msgid: int) -> bool:
    """An `allow_unsigned_callback` that lets the telemetry radio's own reports pass, and nothing else."""
    return msgid in RADIO_MESSAGES


def _others(signing: Any) -> list[Any]:
    """The other signing states that have a key."""
    living = (noted() for noted in _with_key)
    return [one for one in living if one is not None and one is not signing]


def _set_up(signing: Any, arguments: tuple[Any, ...]) -> None:
    """Use what was `prepared`, and share the streams of a link that has the same key."""
    signing._set_up(*arguments)
    others = _others(signing)
    any(signing._share(other) for other in others)
    _with_key[:] = map(ref, (*others, signing))


def _callback(given: Any) -> Any:
    """An `allow_unsigned_callback`, or None for a false value. TypeError for anything else than a function."""
    if callable(given):
        return given
    if given:
        reason = "allow_unsigned_callback is a function of mav and message id"
        raise TypeError(f"{reason}, not {given!r}")
    return None


def _tried(
    secret_key: bytes,
    sign_outgoing: object,
    allow_unsigned_callback: Any,
    timestamp: int,
    link_id: int | None,
) -> SigningState:
    """A signing state of no link that was set up with these, so that they can be used on a link.
    ValueError, OverflowError or TypeError."""
    check_key(secret_key)
    number = state.global_link_id if link_id is None else link_id
    _check_number("link_id", number, MAX_LINK_ID)
    _check_number("initial_timestamp", timestamp, MAX_TIMESTAMP)
    tried = SigningState()
    tried._set_up(
        secret_key, sign_outgoing, allow_unsigned_callback, number, timestamp, False, None, None
    )
    return tried


def _forget_key(signing: Any) -> None:
    signing._set_up(None, False, None, 0, 0, False, None, None)
    _with_key[:] = map(ref, _others(signing))


def _next_link_id() -> int:
    with section:
        number = state.global_link_id
        state.global_link_id = min(number + 1, MAX_LINK_ID)
    return number


def _own_link_id(claim: Callable[[int], bool]) -> int:
    """The next number, of those that `claim` says no other process has which shares the store."""
    number = 0
    # Not 0, which would follow the target's link id to one that another process may have.
    while number == 0 or not claim(number):
        if number == MAX_LINK_ID:
            _say_shared(number)
            break
        number = _next_link_id()
    return number


def _number(link_id: int | None, claim: Callable[[int], bool] | None) -> Any:
    """The link id that was asked for, or the next one."""
    if link_id is None:
        return _next_link_id() if claim is None else _own_link_id(claim)
    if claim is not None and not claim(link_id):
        _say_shared(link_id)
    return link_id


def _say_shared(number: int) -> None:
    warn("another process signs with link id %d, too: only one of both will be believed", number)


def prepared(
    secret_key: bytes,
    sign_outgoing: bool = True,
    allow_unsigned_callback: Callable[[Any, int], bool] | None = None,
    initial_timestamp: int | None = None,
    link_id: int | None = None,
    timestamp_store: Any = None,
    max_ahead: float | None = None,
) -> tuple[Any, ...]:
    """The arguments of `_begin_signing`, made from those of `setup_signing`. Raises its errors, and is as slow as
    the store. All is checked before anything is touched, and the store is the last that may fail.
    """
    allow_unsigned_callback = _callback(allow_unsigned_callback)
    follows_clock = initial_timestamp is None
    units_ahead = _units_ahead(max_ahead, follows_clock)
    if initial_timestamp is None:
        initial_timestamp = signing_timestamp(time.time())
    tried = _tried(secret_key, sign_outgoing, allow_unsigned_callback, initial_timestamp, link_id)
    store, keep, timestamp = None, None, tried.timestamp
    if timestamp_store is not None:
        from .timestamp_store import keeper, store_of

        store = store_of(timestamp_store)
        timestamp = max(timestamp, stored_timestamp(store))
        keep = keeper(store, timestamp)
    asked = None if link_id is None else tried.link_id
    number = _number(asked, getattr(store, "_claim", None))
    return (
        tried.secret_key, tried.sign_outgoing, allow_unsigned_callback,
        number, timestamp, follows_clock, keep, units_ahead,
    )  # fmt: skip


class Signing(Target):
    """The signing methods of `mavfile`."""

    def setup_signing(
        self,
        secret_key: bytes,
        sign_outgoing: bool = True,
        allow_unsigned_callback: Callable[[Any, int], bool] | None = None,
        initial_timestamp: int | None = None,
        link_id: int | None = None,
        timestamp_store: Any = None,
        max_ahead: float | None = None,
    ) -> None:
        """Sign what is sent and check what is received with the 32-byte `secret_key`.

        `allow_unsigned_callback(mav, msgid)` decides about frames without a good signature;
        without one, be it None or False, they are rejected. `initial_timestamp` is in 10 us units since 2015-01-01
        and defaults to now, and then follows the clock. Links without a `link_id` are numbered in
        order, process-wide. `timestamp_store`, the path of a file or an object with `load` and
        `save`, keeps timestamps rising over restarts, also with a wrong clock; links of processes
        that share a file are numbered differently. A signature more than `max_ahead` seconds ahead of
        the clock is a bad one; None sets no limit. ValueError for a key of another length, and for
        `max_ahead` beside an `initial_timestamp`, which replaces the clock; OverflowError for numbers
        that a signature has no room for; TypeError for what is no number, key, function or
        store; OSError, or what the object raises, for a store that cannot be used. Nothing is changed by an
        error.
        """
        self._begin_signing(
            prepared(
                secret_key, sign_outgoing, allow_unsigned_callback, initial_timestamp, link_id,
                timestamp_store, max_ahead,
            )
        )  # fmt: skip

    def _begin_signing(self, arguments: tuple[Any, ...]) -> None:
        """Use what was `prepared`, which cannot fail: half a set-up would send with timestamps used before."""
        with section:
            _set_up(self.mav.signing, arguments)

    def send_signing_key(self, secret_key: bytes, initial_timestamp: int | None = None) -> None:
        """Send the target a SETUP_SIGNING with `secret_key`, which it will sign with from then on.

        The key travels in clear: send it over a cable, never over the air. `initial_timestamp`
        defaults to now. There is no answer; a target that took the key signs what it sends.
        ValueError without a target, since the key is not for everyone, or for a key of another
        length than 32 bytes.
        """
        check_key(secret_key)
        if not self.target_system:
            raise ValueError("a signing key is sent to one system: set target_system first")
        if initial_timestamp is None:
            initial_timestamp = signing_timestamp(time.time())
        self.mav.setup_signing_send(
            self.target_system, self.target_component, list(secret_key), initial_timestamp
        )

    def disable_signing(self) -> None:
        """Forget the key and send unsigned; counters and known streams stay."""
        with section:
            _forget_key(self.mav.signing)
