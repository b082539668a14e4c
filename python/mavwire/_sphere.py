"""Distances on a spherical Earth, for whoever needs them without all of mavextra."""

from __future__ import annotations

from math import atan2, cos, sin, sqrt

# Metres: the mean radius.
RADIUS = 6371000.0


def great_circle(lat1: float, lon1: float, lat2: float, lon2: float) -> float:
    """Metres between two points given in radians (haversine)."""
    return great_circle_between(lat2 - lat1, lon2 - lon1, cos(lat1), cos(lat2))


def great_circle_between(lat: float, lon: float, cos1: float, cos2: float) -> float:
    """The same of two points' differences in latitude and longitude, and the cosines of their
    latitudes, for who goes on from point to point.
    """
    a = sin(lat / 2) ** 2 + sin(lon / 2) ** 2 * cos1 * cos2
    return RADIUS * 2.0 * atan2(sqrt(a), sqrt(max(0.0, 1.0 - a)))
