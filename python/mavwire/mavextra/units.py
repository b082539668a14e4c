"""Conversions of units, times and angles. Angles are in degrees."""

from __future__ import annotations

__all__ = [
    "angle_diff", "constrain", "feet", "gps_time_to_epoch", "kmh", "knots", "wrap_180",
    "wrap_360", "wrap_valid_longitude",
]  # fmt: skip

_GPS_EPOCH = 315_964_800  # 1980-01-06 in unix seconds
_LEAP_SECONDS = 18  # GPS time is ahead of UTC by this
_WEEK = 604_800


def kmh(mps: float) -> float:
    """Metres per second as kilometres per hour."""
    return mps * 3.6


def feet(meters: float) -> float:
    """Metres as feet."""
    return meters / 0.3048


def knots(mps: float) -> float:
    """Metres per second as knots."""
    return mps / 0.51444


def gps_time_to_epoch(week: float, msec: float) -> float:
    """GPS week and milliseconds in it as unix seconds."""
    return _GPS_EPOCH - _LEAP_SECONDS + _WEEK * week + msec * 0.001


def angle_diff(angle1: float, angle2: float) -> float:
    """``angle1 - angle2``, wrapped once into -180..180."""
    difference = angle1 - angle2
    if difference > 180:
        return difference - 360
    if difference < -180:
        return difference + 360
    return difference


def wrap_180(angle: float) -> float:
    """``angle`` wrapped once into -180..180."""
    if angle > 180:
        return angle - 360.0
    if angle < -180:
        return angle + 360.0
    return angle


def wrap_360(angle: float) -> float:
    """``angle`` wrapped once into 0..360."""
    if angle > 360:
        return angle - 360.0
    if angle < 0:
        return angle + 360.0
    return angle


def wrap_valid_longitude(lon: float) -> float:
    """A longitude wrapped into -180 up to but not including 180."""
    return ((lon + 180.0) % 360.0) - 180.0


def constrain(v: float, minv: float, maxv: float) -> float:
    """``v`` limited to the range, the upper limit last."""
    return min(max(v, minv), maxv)
