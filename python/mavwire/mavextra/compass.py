"""Heading and field strength from magnetometers (mGauss), headings in degrees."""

from __future__ import annotations

from collections.abc import Sequence
from math import atan2, copysign, cos, degrees, radians, sin
from typing import Any

from mavwire.mavextra import inertial, state
from mavwire.mavextra.units import constrain
from mavwire.rotmat import Matrix3, Vector3

__all__ = [
    "RotateMag", "get_motor_offsets", "mag_field", "mag_field_df", "mag_field_motors",
    "mag_heading", "mag_heading_df", "mag_heading_motors", "mag_pitch", "mag_roll",
    "mag_rotation",
]  # fmt: skip

Offsets = Sequence[float]


def _calibrated(RAW_IMU: Any, SENSOR_OFFSETS: Any, ofs: Offsets | None) -> Vector3:
    """The field with the offsets ``ofs`` in place of those of SENSOR_OFFSETS, if both are given."""
    field = Vector3(RAW_IMU.xmag, RAW_IMU.ymag, RAW_IMU.zmag)
    if SENSOR_OFFSETS is None or ofs is None:
        return field
    used = SENSOR_OFFSETS
    return field + Vector3(*ofs) - Vector3(used.mag_ofs_x, used.mag_ofs_y, used.mag_ofs_z)


def _calibrated_df(MAG: Any, ofs: Offsets | None) -> Vector3:
    """The same for the dataflash message, which carries the offsets in use."""
    field = Vector3(MAG.MagX, MAG.MagY, MAG.MagZ)
    if ofs is None:
        return field
    return field + Vector3(*ofs) - Vector3(MAG.OfsX, MAG.OfsY, MAG.OfsZ)


def heading(field: Vector3, roll: float, pitch: float, declination: float) -> float:
    """The tilt compensated heading of a body field; roll and pitch in radians."""
    upright = copysign(1.0, cos(pitch))  # beyond 90 degrees the nose points the other way
    level_y = upright * (field.y * cos(roll) - field.z * sin(roll))
    down = field.y * sin(roll) + field.z * cos(roll)
    level_x = upright * (field.x * cos(pitch) + down * sin(pitch))
    result = degrees(atan2(-level_y, level_x)) + declination
    return result + 360.0 if result < 0 else result


def _declination(declination: float | None) -> float:
    if declination is None:
        return degrees(state.current_link().param("COMPASS_DEC", 0))
    return declination


def mag_heading(
    RAW_IMU: Any,
    ATTITUDE: Any,
    declination: float | None = None,
    SENSOR_OFFSETS: Any = None,
    ofs: Offsets | None = None,
) -> float:
    """The heading of the compass; the declination defaults to the parameter COMPASS_DEC."""
    declination = _declination(declination)
    field = _calibrated(RAW_IMU, SENSOR_OFFSETS, ofs)
    roll, pitch, _ = inertial.euler(ATTITUDE)
    return heading(field, roll, pitch, declination)


def mag_heading_df(
    MAG: Any,
    ATT: Any,
    declination: float | None = None,
    ofs: Offsets | None = None,
    diagonals: Offsets = (1.0, 1.0, 1.0),
    offdiagonals: Offsets = (0.0, 0.0, 0.0),
) -> float:
    """The heading from dataflash messages; with ``ofs`` also the soft iron matrix is applied."""
    declination = _declination(declination)
    field = _calibrated_df(MAG, ofs)
    if ofs is not None:
        field = _soft_iron(diagonals, offdiagonals) * field
    return heading(field, radians(ATT.Roll), radians(ATT.Pitch), declination)


def _soft_iron(diagonals: Offsets, offdiagonals: Offsets) -> Matrix3:
    xy, xz, yz = offdiagonals
    return Matrix3(
        Vector3(diagonals[0], xy, xz),
        Vector3(xy, diagonals[1], yz),
        Vector3(xz, yz, diagonals[2]),
    )


def get_motor_offsets(
    SERVO_OUTPUT_RAW: Any,
    ofs: Offsets,
    motor_ofs: Offsets,
) -> tuple[float, float, float]:
    """``ofs`` plus the part of ``motor_ofs`` that the mean throttle of four motors calls for."""
    link = state.current_link()
    servos = SERVO_OUTPUT_RAW
    mean = (servos.servo1_raw + servos.servo2_raw + servos.servo3_raw + servos.servo4_raw) * 0.25
    low, high = link.param("RC3_MIN", 1100), link.param("RC3_MAX", 1900)
    throttle = constrain((mean - low) / float(high - low), 0.0, 1.0)
    x, y, z = (base + motor * throttle for base, motor in zip(ofs, motor_ofs, strict=False))
    return x, y, z


def mag_heading_motors(
    RAW_IMU: Any,
    ATTITUDE: Any,
    declination: float | None,
    SENSOR_OFFSETS: Any,
    ofs: Offsets,
    SERVO_OUTPUT_RAW: Any,
    motor_ofs: Offsets,
) -> float:
    """:func:`mag_heading` with offsets that follow the throttle."""
    ofs = get_motor_offsets(SERVO_OUTPUT_RAW, ofs, motor_ofs)
    return mag_heading(RAW_IMU, ATTITUDE, declination, SENSOR_OFFSETS, ofs)


def mag_field(
    RAW_IMU: Any,
    SENSOR_OFFSETS: Any = None,
    ofs: Offsets | None = None,
) -> float:
    """The strength of the field."""
    return _calibrated(RAW_IMU, SENSOR_OFFSETS, ofs).length()


def mag_field_df(MAG: Any, ofs: Offsets | None = None) -> float:
    """The strength of the field from the dataflash message."""
    return _calibrated_df(MAG, ofs).length()


def mag_field_motors(
    RAW_IMU: Any,
    SENSOR_OFFSETS: Any,
    ofs: Offsets,
    SERVO_OUTPUT_RAW: Any,
    motor_ofs: Offsets,
) -> float:
    """:func:`mag_field` with offsets that follow the throttle."""
    ofs = get_motor_offsets(SERVO_OUTPUT_RAW, ofs, motor_ofs)
    return mag_field(RAW_IMU, SENSOR_OFFSETS, ofs)


def mag_rotation(RAW_IMU: Any, inclination: float, declination: float) -> Matrix3:
    """The rotation from the Earth's field of these angles (degrees) to the measured one."""
    field = Vector3(RAW_IMU.xmag, RAW_IMU.ymag, RAW_IMU.zmag)
    direction = Matrix3()
    direction.from_euler(0, -radians(inclination), radians(declination))
    earth = direction * Vector3(field.length(), 0, 0)
    rotation = Matrix3()
    rotation.from_two_vectors(earth, field)
    return rotation


def mag_pitch(RAW_IMU: Any, inclination: float, declination: float) -> float:
    """The pitch of :func:`mag_rotation`, degrees."""
    return degrees(mag_rotation(RAW_IMU, inclination, declination).to_euler()[1])


def mag_roll(RAW_IMU: Any, inclination: float, declination: float) -> float:
    """The roll of :func:`mag_rotation`, degrees."""
    return degrees(mag_rotation(RAW_IMU, inclination, declination).to_euler()[0])


def RotateMag(MAG: Any, rotation: int) -> Vector3 | None:
    """The field turned by a board orientation (enum ROTATION); None beyond the table."""
    return Vector3(MAG.MagX, MAG.MagY, MAG.MagZ).rotate_by_id(rotation)
