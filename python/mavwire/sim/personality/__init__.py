"""The autopilots that a simulated vehicle can be like."""

from __future__ import annotations

from .ardupilot import ArduPilot
from .base import Mode, Personality, Role
from .px4 import Px4

__all__ = ["PERSONALITIES", "Mode", "Personality", "Role"]

PERSONALITIES: dict[str, type[Personality]] = {"ardupilot": ArduPilot, "px4": Px4}
"""Name -> personality."""
