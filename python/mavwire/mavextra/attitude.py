"""Attitudes as quaternions, among them those of tailsitters, whose nose points up in hover.

Arguments and results are radians where they are three angles, degrees where one.
"""

from __future__ import annotations

from math import degrees, pi
from typing import Any

from mavwire.quaternion import Quaternion

__all__ = [
    "euler_p90", "euler_rotated", "euler_to_quat", "qpitch", "qpitch_p90", "qroll", "qroll_p90",
    "quat_to_euler", "qyaw", "qyaw_p90", "rotate_quat",
]  # fmt: skip

Euler = tuple[float, float, float]


def quat_to_euler(q: Any) -> Any:
    """Roll, pitch, yaw of a quaternion [w, x, y, z], an array."""
    return Quaternion(q).euler


def euler_to_quat(e: Any) -> Any:
    """The quaternion [w, x, y, z] of roll, pitch, yaw, an array."""
    return Quaternion(e).q


def rotate_quat(attitude: Any, roll: float, pitch: float, yaw: float) -> Any:
    """A quaternion followed by a turn by these angles in the earth's frame, an array."""
    return (Quaternion([roll, pitch, yaw]) * Quaternion(attitude)).q


def _quaternion(MSG: Any) -> list[float]:
    return [MSG.Q1, MSG.Q2, MSG.Q3, MSG.Q4]


def qroll(MSG: Any) -> float:
    """The roll of a message's quaternion, degrees."""
    return degrees(quat_to_euler(_quaternion(MSG))[0])


def qpitch(MSG: Any) -> float:
    """The pitch of a message's quaternion, degrees."""
    return degrees(quat_to_euler(_quaternion(MSG))[1])


def qyaw(MSG: Any) -> float:
    """The yaw of a message's quaternion, degrees."""
    return degrees(quat_to_euler(_quaternion(MSG))[2])


def euler_rotated(MSG: Any, roll: float, pitch: float, yaw: float) -> Euler:
    """Roll, pitch, yaw of a message's quaternion in a body frame turned back by these angles."""
    # By matrices: the product of quaternions leaves nothing but noise in the yaw where the result
    # points straight up or down, as that of a level vehicle pitched by 90 degrees does.
    turned_back = Quaternion([roll, pitch, yaw]).dcm.transposed()
    euler: Euler = (Quaternion(_quaternion(MSG)).dcm * turned_back).to_euler()
    return euler


def euler_p90(MSG: Any) -> Euler:
    """Roll, pitch, yaw of a message's quaternion, pitched down by 90 degrees."""
    return euler_rotated(MSG, 0, pi / 2, 0)


def qroll_p90(MSG: Any) -> float:
    """The roll of :func:`euler_p90`, degrees."""
    return degrees(euler_p90(MSG)[0])


def qpitch_p90(MSG: Any) -> float:
    """The pitch of :func:`euler_p90`, degrees."""
    return degrees(euler_p90(MSG)[1])


def qyaw_p90(MSG: Any) -> float:
    """The yaw of :func:`euler_p90`, degrees."""
    return degrees(euler_p90(MSG)[2])
