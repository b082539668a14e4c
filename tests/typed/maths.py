"""Vectors, expressions, functions of expressions, generators."""

from __future__ import annotations

from typing import Any, assert_type

import mavwire
from mavwire import mavexpression, mavextra, mavutil
from mavwire.generator import mavgen, mavparse
from mavwire.rotmat import Line, Matrix3, Plane, Vector3


def turned(roll: float, pitch: float, yaw: float) -> Vector3:
    """A vector in the earth's frame."""
    attitude = Matrix3()
    attitude.from_euler(roll, pitch, yaw)
    assert_type(attitude.to_euler(), tuple[float, float, float])
    assert_type(attitude * Vector3(1, 2, 3), Vector3)
    assert_type(attitude * attitude, Matrix3)
    assert_type(Vector3(1, 2, 3) * Vector3(1, 2, 3), float)
    assert_type(Vector3(1, 2, 3) * 2.0, Vector3)
    assert_type(Vector3(1, 2, 3) % Vector3(3, 2, 1), Vector3)
    assert_type(Line().plane_intersection(Plane()), Vector3 | None)
    return attitude * Vector3(0, 0, 1) + Vector3()


def numbers() -> float:
    """Functions that expressions use."""
    assert_type(mavextra.wrap_180(190.0), float)
    assert_type(mavextra.distance_lat_lon(-35.0, 149.0, -35.1, 149.1), float)
    degrees: float = mavexpression.wrap_360(-10.0)
    return mavextra.kmh(1.0) + degrees


def value(messages: dict[str, Any]) -> bool:
    """An expression over messages: its value can be anything."""
    assert_type(mavexpression.evaluate_expression("GPS_RAW_INT.alt*0.001", messages), Any)
    return bool(mavutil.evaluate_condition("VFR_HUD.alt>10", messages))


def generate(path: str) -> bool:
    """A dialect module out of XML."""
    xml = mavparse.MAVXML(path, mavparse.PROTOCOL_2_0)
    assert_type(xml.message_names, dict[int, str])
    assert_type(mavwire.__version__, str)
    mavutil.sys.path.insert(0, mavutil.os.path.dirname(path))
    return mavgen.mavgen(mavgen.Opts("mine", wire_protocol="2.0"), [path])
