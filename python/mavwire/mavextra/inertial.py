"""Attitude, rates, accelerations and velocities from inertial sensors and GPS.

Angles and rates are in degrees unless a name says otherwise; vectors are north, east, down in
the earth's frame and forward, right, down in the body's, in m/s, m/s^2 or rad/s.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import asin, cos, degrees, radians, sin, tan
from typing import Any

from mavwire.mavextra import filters
from mavwire.rotmat import Matrix3, Vector3

__all__ = [
    "earth_accel", "earth_accel2", "earth_accel2_df", "earth_accel_df", "earth_gyro",
    "earth_rates", "gps_velocity", "gps_velocity_body", "gps_velocity_df", "gps_velocity_old",
    "gravity", "pitch_estimate", "pitch_rate", "pitch_sim", "roll_estimate", "roll_rate",
    "rotation", "rotation2", "rotation_df", "sim_body_rates", "yaw_rate",
]  # fmt: skip

Triple = Sequence[float] | None

_MILLI_G = 9.81 / 1000.0


def _acceleration(RAW_IMU: Any) -> Vector3:
    return Vector3(RAW_IMU.xacc, RAW_IMU.yacc, RAW_IMU.zacc) * _MILLI_G


def _recalibrated(accel: Vector3, SENSOR_OFFSETS: Any, ofs: Triple, mul: Triple) -> Vector3:
    """With the offsets ``ofs`` in place of those of SENSOR_OFFSETS and scaled by ``mul``."""
    if SENSOR_OFFSETS is None or ofs is None:
        return accel
    used = SENSOR_OFFSETS
    accel = accel + Vector3(used.accel_cal_x, used.accel_cal_y, used.accel_cal_z) - Vector3(*ofs)
    if mul is not None:
        accel = Vector3(accel.x * mul[0], accel.y * mul[1], accel.z * mul[2])
    return accel


def gravity(
    RAW_IMU: Any,
    SENSOR_OFFSETS: Any = None,
    ofs: Triple = None,
    mul: Triple = None,
    smooth: float = 0.7,
) -> float:
    """The length of the acceleration, m/s^2, of RAW_IMU or of the dataflash message IMU."""
    if hasattr(RAW_IMU, "xacc"):
        accel = _acceleration(RAW_IMU)
    else:
        accel = Vector3(RAW_IMU.AccX, RAW_IMU.AccY, RAW_IMU.AccZ)
    return _recalibrated(accel, SENSOR_OFFSETS, ofs, mul).length()


def _without_turn(accel: Vector3, GPS_RAW_INT: Any, ATTITUDE: Any) -> Vector3:
    """The acceleration less what turning at this speed causes, if both messages are given."""
    if GPS_RAW_INT is None or ATTITUDE is None:
        return accel
    speed = GPS_RAW_INT.vel * 0.01
    turning = Vector3(0, ATTITUDE.yawspeed * speed, -ATTITUDE.pitchspeed * speed)
    return accel - turning


def roll_estimate(
    RAW_IMU: Any,
    GPS_RAW_INT: Any = None,
    ATTITUDE: Any = None,
    SENSOR_OFFSETS: Any = None,
    ofs: Triple = None,
    mul: Triple = None,
    smooth: float = 0.7,
) -> float | None:
    """The roll of the accelerometers, smoothed."""
    accel = _without_turn(_acceleration(RAW_IMU), GPS_RAW_INT, ATTITUDE)
    accel = _recalibrated(accel, SENSOR_OFFSETS, ofs, mul)
    return filters.lowpass(degrees(-asin(accel.y / accel.length())), "_roll", smooth)


def pitch_estimate(
    RAW_IMU: Any,
    GPS_RAW_INT: Any = None,
    ATTITUDE: Any = None,
    SENSOR_OFFSETS: Any = None,
    ofs: Triple = None,
    mul: Triple = None,
    smooth: float = 0.7,
) -> float | None:
    """The pitch of the accelerometers, smoothed."""
    accel = _without_turn(_acceleration(RAW_IMU), GPS_RAW_INT, ATTITUDE)
    accel = _recalibrated(accel, SENSOR_OFFSETS, ofs, mul)
    return filters.lowpass(degrees(asin(accel.x / accel.length())), "_pitch", smooth)


def pitch_sim(SIMSTATE: Any, GPS_RAW: Any) -> float:
    """The pitch of a simulated aircraft from its accelerometers and speed; 0 where none fits."""
    # the factor makes up for the loss of the filter, which a speed in steps passes through
    surge = filters.lowpass(filters.slope(GPS_RAW.v, "v") * 6.6, "v", 0.9)
    forward = SIMSTATE.xacc - (0.0 if surge is None else surge)
    down = SIMSTATE.zacc + SIMSTATE.ygyro * GPS_RAW.v
    sine = forward / down
    return degrees(-asin(sine)) if abs(sine) <= 1 else 0


def _from_euler(roll: float, pitch: float, yaw: float) -> Matrix3:
    matrix = Matrix3()
    matrix.from_euler(roll, pitch, yaw)
    return matrix


def euler(ATTITUDE: Any) -> tuple[float, float, float]:
    """(roll, pitch, yaw) in radians, of ATTITUDE or of the dataflash message ATT."""
    if hasattr(ATTITUDE, "roll"):
        return ATTITUDE.roll, ATTITUDE.pitch, ATTITUDE.yaw
    return radians(ATTITUDE.Roll), radians(ATTITUDE.Pitch), radians(ATTITUDE.Yaw)


def rotation(ATTITUDE: Any) -> Matrix3:
    """The rotation from body to earth, of ATTITUDE or of the dataflash message ATT."""
    return _from_euler(*euler(ATTITUDE))


def rotation2(AHRS2: Any) -> Matrix3:
    """The rotation from body to earth of AHRS2."""
    return _from_euler(AHRS2.roll, AHRS2.pitch, AHRS2.yaw)


def rotation_df(ATT: Any) -> Matrix3:
    """The rotation from body to earth of the dataflash message ATT."""
    return _from_euler(radians(ATT.Roll), radians(ATT.Pitch), radians(ATT.Yaw))


def earth_rates(ATTITUDE: Any) -> tuple[float, float, float]:
    """The rates of the Euler angles (roll, pitch, yaw), rad/s."""
    p, q, r = ATTITUDE.rollspeed, ATTITUDE.pitchspeed, ATTITUDE.yawspeed
    roll, pitch = ATTITUDE.roll, ATTITUDE.pitch
    turning = q * sin(roll) + r * cos(roll)
    return p + tan(pitch) * turning, q * cos(roll) - r * sin(roll), turning / cos(pitch)


def roll_rate(ATTITUDE: Any) -> float:
    """The rate of the roll angle, rad/s."""
    return earth_rates(ATTITUDE)[0]


def pitch_rate(ATTITUDE: Any) -> float:
    """The rate of the pitch angle, rad/s."""
    return earth_rates(ATTITUDE)[1]


def yaw_rate(ATTITUDE: Any) -> float:
    """The rate of the yaw angle, rad/s."""
    return earth_rates(ATTITUDE)[2]


def sim_body_rates(SIM: Any) -> Vector3:
    """The body rates that the changes of the Euler angles (degrees) amount to, rad/s."""
    rates = {
        key: radians(filters.slope(angle, key, SIM.TimeUS))
        for key, angle in (("sbr", SIM.Roll), ("sbp", SIM.Pitch), ("sby", SIM.Yaw))
    }
    roll, pitch = radians(SIM.Roll), radians(SIM.Pitch)
    p = rates["sbr"] - rates["sby"] * sin(pitch)
    q = rates["sbp"] * cos(roll) + rates["sby"] * sin(roll) * cos(pitch)
    r = rates["sby"] * cos(roll) * cos(pitch) - rates["sbp"] * sin(roll)
    return Vector3(p, q, r)


def gps_velocity(GLOBAL_POSITION_INT: Any) -> Vector3:
    """The velocity over ground."""
    m = GLOBAL_POSITION_INT
    return Vector3(m.vx, m.vy, m.vz) * 0.01


def _over_ground(speed: float, course: float, down: float) -> Vector3:
    return Vector3(speed * cos(radians(course)), speed * sin(radians(course)), down)


def gps_velocity_old(GPS_RAW_INT: Any) -> Vector3:
    """The horizontal velocity over ground, from speed and course."""
    return _over_ground(GPS_RAW_INT.vel * 0.01, GPS_RAW_INT.cog * 0.01, 0)


def gps_velocity_body(GPS_RAW_INT: Any, ATTITUDE: Any) -> Vector3:
    """The velocity in the body's frame, of a flight in the direction of the pitch."""
    velocity = gps_velocity_old(GPS_RAW_INT)
    velocity.z = -GPS_RAW_INT.vel * 0.01 * tan(euler(ATTITUDE)[1])
    return rotation(ATTITUDE).transposed() * velocity


def gps_velocity_df(GPS: Any) -> Vector3:
    """The velocity over ground from the dataflash message."""
    return _over_ground(GPS.Spd, GPS.GCrs, GPS.VZ)


def earth_accel(IMU: Any, ATT: Any) -> Vector3:
    """The acceleration in the earth's frame, of RAW_IMU or IMU with ATTITUDE or ATT."""
    if hasattr(IMU, "xacc"):
        return earth_accel2(IMU, ATT)
    return rotation(ATT) * Vector3(IMU.AccX, IMU.AccY, IMU.AccZ)


def earth_accel2(RAW_IMU: Any, ATTITUDE: Any) -> Vector3:
    """The acceleration in the earth's frame, of RAW_IMU."""
    return rotation(ATTITUDE) * (Vector3(RAW_IMU.xacc, RAW_IMU.yacc, RAW_IMU.zacc) * _MILLI_G)


def earth_accel_df(IMU: Any, ATT: Any) -> Vector3:
    """The acceleration in the earth's frame, of dataflash messages."""
    return rotation_df(ATT) * Vector3(IMU.AccX, IMU.AccY, IMU.AccZ)


def earth_accel2_df(IMU: Any, IMU2: Any, ATT: Any) -> Vector3:
    """The mean acceleration of two sensors in the earth's frame."""
    first, second = Vector3(IMU.AccX, IMU.AccY, IMU.AccZ), Vector3(IMU2.AccX, IMU2.AccY, IMU2.AccZ)
    return rotation_df(ATT) * ((first + second) * 0.5)


def earth_gyro(IMU: Any, ATT: Any) -> Vector3:
    """The rotation rates in the earth's frame; those of RAW_IMU become degrees/s."""
    if hasattr(IMU, "xgyro"):
        rates = Vector3(degrees(IMU.xgyro), degrees(IMU.ygyro), degrees(IMU.zgyro)) * 0.001
    else:
        rates = Vector3(IMU.GyrX, IMU.GyrY, IMU.GyrZ)
    return rotation(ATT) * rates
