"""State of the functions of mavextra between calls.

A filter keeps its history under the ``key`` that an expression gives it; others keep the first
fix, the origin or an estimator. ``reset_state_data`` forgets all of it, before another log is read.
"""

from __future__ import annotations

from typing import Any

from mavwire.expression.limits import ExpressionError, weight

__all__ = [
    "average_data", "derivative_data", "last_delta", "last_diff", "last_integral", "last_sum",
    "lowpass_data", "lowpass_hz_data", "reset_state_data",
]  # fmt: skip

average_data: dict[Any, Any] = {}
derivative_data: dict[Any, tuple[float, list[float]]] = {}
lowpass_data: dict[Any, float] = {}
lowpass_hz_data: dict[Any, float] = {}
last_diff: dict[Any, float] = {}
last_delta: dict[Any, tuple[float, float, float]] = {}
last_sum: dict[Any, float] = {}
last_integral: dict[Any, tuple[float, float]] = {}

_HISTORIES: tuple[dict[Any, Any], ...] = (
    *(average_data, derivative_data, lowpass_data, lowpass_hz_data),
    *(last_diff, last_delta, last_sum, last_integral),
)

SCALARS: dict[str, Any] = {
    "first_fix": None,  # the first GPS message with a fix
    "dcm_state": None,
    "px4_state": None,
    "ORGN": None,  # the origin in use
    "ekf_origin": None,
    "earth_declination": None,  # degrees, of the last expected field
    "EleModel": None,  # MAVProxy's elevation model
    "_downsample_N": 0,
    "_average_values": 0,
}
"""The single values, by the name under which ``mavwire.mavextra`` shows them."""

# Bounds for expressions from elsewhere: keys of all histories together, and values of averages.
MAX_KEYS = 4096
MAX_VALUES = 1_000_000
MAX_KEY = 256  # items of one key
MAX_STATE = 4096  # items of one history at first

_KEPT = frozenset({"EleModel"})  # a cache that does not depend on the log


def remember(history: dict[Any, Any], key: Any, value: Any) -> None:
    """Keep the state of a filter. ExpressionError for too many keys, or a key that is too long."""
    if key not in history:
        if sum(map(len, _HISTORIES)) >= MAX_KEYS:
            raise ExpressionError(
                f"filters have more than {MAX_KEYS} keys: give each signal one constant key"
            )
        if weight(key, MAX_KEY) > MAX_KEY or weight(value, MAX_STATE) > MAX_STATE:
            raise ExpressionError(
                f"the value of a filter is not a number, or its key has more than {MAX_KEY} items"
            )
    history[key] = value


def reserve_values(count: int) -> None:
    """Count the values that a new average keeps; ExpressionError where all together are too many."""
    if SCALARS["_average_values"] + count > MAX_VALUES:
        raise ExpressionError(f"average() over more than {MAX_VALUES} values")
    SCALARS["_average_values"] += count


def reset_state_data() -> None:
    """Forget everything that was remembered from earlier messages."""
    for history in _HISTORIES:
        history.clear()
    SCALARS.update({name: None for name in SCALARS if name not in _KEPT})
    SCALARS["_downsample_N"] = SCALARS["_average_values"] = 0


def current_link() -> Any:
    """The link or log opened last; AttributeError if there is none."""
    from mavwire.links import state

    if state.mavfile_global is None:
        raise AttributeError("no link or log is open, so there is no time and no parameter")
    return state.mavfile_global
