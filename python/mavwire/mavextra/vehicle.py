"""Facts of particular vehicles: turns, rovers, servo mixers, arming, motor currents."""

from __future__ import annotations

from math import cos, degrees, pi, radians, sin, tan
from typing import Any

from mavwire.mavextra import state

__all__ = [
    "armed", "demix1", "demix2", "mix1", "mix2", "mixer", "mm_curr", "mode", "rate_of_turn",
    "rover_lat_accel", "rover_turn_circle", "rover_yaw_rate", "sawtooth", "wingloading",
]  # fmt: skip

_GCS = 6  # MAV_TYPE_GCS
_SAFETY_ARMED = 128  # MAV_MODE_FLAG_SAFETY_ARMED
_SERVO_CENTRE = 1500  # microseconds


def sawtooth(ATTITUDE: Any, amplitude: float = 2.0, period: float = 5.0) -> float:
    """A triangle wave over the message's time: up in ``period`` minutes and down again."""
    rise = period * 60.0
    phase = (ATTITUDE.usec * 1.0e-6) % (2 * rise)
    return float(amplitude * (phase if phase < rise else 2 * rise - phase) / rise)


def rate_of_turn(speed: float, bank: float) -> float:
    """Degrees per second of a coordinated turn; 0 below 2 m/s or beyond 80 degrees of bank."""
    if abs(speed) < 2 or abs(bank) > 80:
        return 0
    return degrees(9.81 * tan(radians(bank)) / speed)


def wingloading(bank: float) -> float:
    """The load factor of a coordinated turn; ``bank`` in radians."""
    return 1.0 / cos(bank)


def rover_turn_circle(SERVO_OUTPUT_RAW: Any) -> float:
    """The diameter in metres of the circle a small car drives with this steering."""
    max_wheel_turn, wheelbase, wheeltrack = 35, 0.335, 0.296  # degrees, m, m
    steering = max_wheel_turn * (SERVO_OUTPUT_RAW.servo1_raw - _SERVO_CENTRE) / 400.0
    return wheeltrack / 2 + wheelbase / sin(radians(steering))


def rover_yaw_rate(VFR_HUD: Any, SERVO_OUTPUT_RAW: Any) -> float:
    """Degrees per second of that car."""
    speed = VFR_HUD.groundspeed
    if speed == 0 or SERVO_OUTPUT_RAW.servo1_raw == _SERVO_CENTRE:
        return 0
    return float(360.0 * speed / (pi * rover_turn_circle(SERVO_OUTPUT_RAW)))


def rover_lat_accel(VFR_HUD: Any, SERVO_OUTPUT_RAW: Any) -> float:
    """Lateral acceleration of that car, m/s^2."""
    return float(VFR_HUD.groundspeed * radians(rover_yaw_rate(VFR_HUD, SERVO_OUTPUT_RAW)))


def demix1(servo1: float, servo2: float, gain: float = 0.5) -> float:
    """The common part of two mixed servos, microseconds."""
    return (servo1 - _SERVO_CENTRE + servo2 - _SERVO_CENTRE) * gain + _SERVO_CENTRE


def demix2(servo1: float, servo2: float, gain: float = 0.5) -> float:
    """The difference of two mixed servos, microseconds."""
    return (servo1 - servo2) * gain + _SERVO_CENTRE


def mixer(servo1: float, servo2: float, mixtype: int = 1, gain: float = 0.5) -> tuple[float, float]:
    """Two servos as elevons or a V tail, 900..2100 us; ``mixtype`` 1 to 4 picks the signs."""
    difference = (servo1 - servo2) * gain
    common = (servo1 - _SERVO_CENTRE + servo2 - _SERVO_CENTRE) * gain
    first = -difference if mixtype in (3, 4) else difference
    second = -common if mixtype in (2, 4) else common
    return _servo(first), _servo(second)


def _servo(offset: float) -> float:
    return min(max(_SERVO_CENTRE + offset, 900), 2100)


def mix1(servo1: float, servo2: float, mixtype: int = 1, gain: float = 0.5) -> float:
    """The first output of :func:`mixer`."""
    return mixer(servo1, servo2, mixtype, gain)[0]


def mix2(servo1: float, servo2: float, mixtype: int = 1, gain: float = 0.5) -> float:
    """The second output of :func:`mixer`."""
    return mixer(servo1, servo2, mixtype, gain)[1]


def armed(HEARTBEAT: Any) -> int:
    """1 if armed, else 0. At the heartbeat of a ground station it is the state of the open link."""
    if HEARTBEAT.type == _GCS:
        return int(bool(state.current_link().motors_armed()))
    return int(bool(HEARTBEAT.base_mode & _SAFETY_ARMED))


def mode(HEARTBEAT: Any) -> int | None:
    """The custom mode; None for a ground station."""
    return None if HEARTBEAT.type == _GCS else HEARTBEAT.custom_mode


def mm_curr(
    RCOU: Any,
    BAT: Any,
    PWM_MIN: float,
    PWM_MAX: float,
    Mfirst: int,
    Mlast: int,
) -> float:
    """A measure of the current of motors Mfirst to Mlast: the squares of their voltages.

    0 when RCOU lacks one of them.
    """
    total = 0.0
    volts = BAT.Volt
    for motor in range(Mfirst, Mlast + 1):
        pwm = getattr(RCOU, f"C{motor}", None)
        if pwm is None:
            return 0.0
        total += (max(pwm - PWM_MIN, 0.0) * volts / (PWM_MAX - PWM_MIN)) ** 2
    return total
