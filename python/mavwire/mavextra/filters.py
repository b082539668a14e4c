"""Filters over the values of an expression: averages, differences, low passes, sums.

Each keeps its history under ``key``, so that one expression can filter several signals. Those
that need the time and are not given one (``tusec``, microseconds) take the open link's timestamp.
"""

from __future__ import annotations

from collections.abc import Callable
from math import isnan, pi
from operator import index
from typing import Any

from mavwire.mavextra import state
from mavwire.mavextra.units import angle_diff

__all__ = [
    "average", "delta", "delta_angle", "diff", "downsample", "integral", "lowpass", "lowpassHz",
    "lpalpha", "second_derivative_5", "second_derivative_9", "sum",
]  # fmt: skip

sum_of: Callable[..., float] = sum  # the builtin, which mavextra's own sum() hides


def average(var: float, key: Any, N: int) -> float:
    """The mean of the last N values, which start as N times the first."""
    history = state.average_data.get(key)
    if history is None:
        state.reserve_values(max(index(N), 0))
        history = [var]
        state.remember(state.average_data, key, history)  # the limit of one history is not for N
        history *= N
        return var
    recent = [*history[1:], var]
    total = sum_of(recent)  # first, since it refuses values that are not numbers
    history[:] = recent
    return total / N


def _second_derivative(var: float, key: Any, weights: tuple[int, ...], scale: float) -> float:
    """The weighted sum over the last values, per ``scale`` squares of the time step."""
    now = state.current_link().timestamp
    last_time, history = state.derivative_data.get(key, (now, []))
    if len(history) != len(weights):
        state.remember(state.derivative_data, key, (now, [var] * len(weights)))
        return 0
    history = [*history[1:], var]
    step = now - last_time
    # A value without a weight has no part in it, be it infinite.
    pairs = zip(weights, history, strict=True)
    total: float = sum_of(weight * value for weight, value in pairs if weight)
    state.derivative_data[key] = (now, history)
    change: float = total / (scale * step**2)
    return change


def second_derivative_5(var: float, key: Any) -> float:
    """The second derivative by a smooth noise-robust differentiator over 5 values."""
    return _second_derivative(var, key, (1, 0, -2, 0, 1), 4.0)


def second_derivative_9(var: float, key: Any) -> float:
    """The second derivative by a smooth noise-robust differentiator over 9 values."""
    return _second_derivative(var, key, (1, 4, 4, -4, -10, -4, 4, 4, 1), 64.0)


def lowpass(var: float, key: Any, factor: float) -> float | None:
    """``factor`` of the last output and the rest of the value; None for NaN, which is skipped."""
    if isnan(var):
        return None
    last = state.lowpass_data.get(key)
    output = var if last is None else factor * last + (1.0 - factor) * var
    state.remember(state.lowpass_data, key, output)
    return output


def lpalpha(sample_rate_hz: float, cutoff_hz: float) -> float:
    """The factor of a first order low pass."""
    step = 1.0 / sample_rate_hz
    time_constant = 1.0 / (2 * pi * cutoff_hz)
    return time_constant / (time_constant + step)


def lowpassHz(var: float, key: Any, sample_rate_hz: float, cutoff_hz: float) -> float:
    """A first order low pass with this cutoff frequency."""
    factor = lpalpha(sample_rate_hz, cutoff_hz)
    known = key in state.lowpass_hz_data
    output = factor * state.lowpass_hz_data[key] + (1.0 - factor) * var if known else var
    state.remember(state.lowpass_hz_data, key, output)
    return output


def diff(var: float, key: Any) -> float:
    """The change since the last call; 0 at first."""
    known = key in state.last_diff
    change = var - state.last_diff[key] if known else 0
    state.remember(state.last_diff, key, var)
    return change


def _slope(var: float, key: Any, tusec: float | None, change: Callable[..., float]) -> float:
    """The change per second since the last call; repeated while the time does not advance."""
    now = tusec * 1.0e-6 if tusec is not None else state.current_link().timestamp
    if key not in state.last_delta:
        state.remember(state.last_delta, key, (var, now, 0))
        return 0
    last, last_time, last_slope = state.last_delta[key]
    if now == last_time:
        return last_slope
    slope = change(var, last) / (now - last_time)
    state.last_delta[key] = (var, now, slope)
    return slope


def slope(var: float, key: Any, tusec: float | None = None) -> float:
    """The slope of a value, per second; NaN passes through."""
    return _slope(var, key, tusec, lambda value, last: value - last)


def delta(var: float, key: Any, tusec: float | None = None) -> float | None:
    """The slope of a value, per second; None for NaN, which is skipped."""
    return None if isnan(var) else slope(var, key, tusec)


def delta_angle(var: float, key: Any, tusec: float | None = None) -> float:
    """The slope of an angle in degrees, per second, the shorter way round."""
    return _slope(var, key, tusec, angle_diff)


def sum(var: float, key: Any) -> float:
    """The sum of all values so far."""
    total = state.last_sum.get(key, 0) + var
    state.remember(state.last_sum, key, total)
    return total


def integral(var: float, key: Any, timeus: float) -> float:
    """The sum of all values times the seconds since the one before."""
    total, last_time = state.last_integral.get(key, (0.0, timeus))
    total += var * (timeus - last_time) * 1.0e-6
    state.remember(state.last_integral, key, (total, timeus))
    return total


def downsample(N: int) -> bool:
    """True at every N-th call."""
    count = (state.SCALARS["_downsample_N"] + 1) % N
    state.SCALARS["_downsample_N"] = count
    return bool(count == 0)
