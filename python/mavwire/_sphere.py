"""Distances on a spherical Earth, for modules that do not need all of mavextra."""

from __future__ import annotations

from math import atan2, cos, sin, sqrt

# Metres: the mean radius.
RADIUS = 6371000.0


def great_circle(lat1: float, lon1: float, lat2: float, lon2: float) -> float:
    """Metres between two points given in radians (haversine)."""
    a = sin((lat2 - lat1) / 2) ** 2 + sin((lon2 - lon1) / 2) ** 2 * cos(lat1) * cos(lat2)
    return RADIUS * 2.0 * atan2(sqrt(a), sqrt(max(0.0, 1.0 - a)))
