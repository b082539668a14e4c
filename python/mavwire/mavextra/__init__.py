"""The functions that conditions and graph expressions may use, with pymavlink's names.

They take messages or their fields and compute what a log does not hold: distances, headings,
airspeeds, filtered values. Angles are in degrees unless a function says otherwise. This module
only gathers them; the modules beside it are one topic each. As in pymavlink the names of ``math``
are here too, and ``sum`` and ``mode`` are not the builtin ones.
"""

import builtins as _builtins
import math as _math
from math import *  # noqa: F403
from types import ModuleType as _ModuleType
from typing import Any as _Any

from mavwire.mavextra import earth_field as _earth_field
from mavwire.mavextra import state as _state
from mavwire.mavextra.attitude import (
    euler_p90,
    euler_rotated,
    euler_to_quat,
    qpitch,
    qpitch_p90,
    qroll,
    qroll_p90,
    quat_to_euler,
    qyaw,
    qyaw_p90,
    rotate_quat,
)
from mavwire.mavextra.compass import (
    RotateMag,
    get_motor_offsets,
    mag_field,
    mag_field_df,
    mag_field_motors,
    mag_heading,
    mag_heading_df,
    mag_heading_motors,
    mag_pitch,
    mag_roll,
    mag_rotation,
)
from mavwire.mavextra.earth_field import (
    SAMPLING_MAX_LAT,
    SAMPLING_MAX_LON,
    SAMPLING_MIN_LAT,
    SAMPLING_MIN_LON,
    SAMPLING_RES,
    earth_field_error,
    expected_earth_field,
    expected_earth_field_lat_lon,
    expected_mag,
    expected_mag_latlon,
    expected_mag_yaw,
    get_lat_lon_status,
    get_mag_field_ef,
    interpolate_table,
    mag_yaw,
)
from mavwire.mavextra.estimators import (
    DCM_State,
    DCM_update,
    PX4_State,
    PX4_update,
)
from mavwire.mavextra.filters import (
    average,
    delta,
    delta_angle,
    diff,
    downsample,
    integral,
    lowpass,
    lowpassHz,
    lpalpha,
    second_derivative_5,
    second_derivative_9,
    sum,
)
from mavwire.mavextra.inertial import (
    earth_accel,
    earth_accel2,
    earth_accel2_df,
    earth_accel_df,
    earth_gyro,
    earth_rates,
    gps_velocity,
    gps_velocity_body,
    gps_velocity_df,
    gps_velocity_old,
    gravity,
    pitch_estimate,
    pitch_rate,
    pitch_sim,
    roll_estimate,
    roll_rate,
    rotation,
    rotation2,
    rotation_df,
    sim_body_rates,
    yaw_rate,
)
from mavwire.mavextra.position import (
    _distance_two,
    distance_from,
    distance_gps2,
    distance_home,
    distance_home_df,
    distance_lat_lon,
    distance_two,
    ekf1_pos,
    get_lat_lon_alt,
    get_origin,
    gps_newpos,
    gps_offset,
    radius_of_earth,
)
from mavwire.mavextra.pressure import (
    C_TO_KELVIN,
    EAS2TAS,
    ISA_GAS_CONSTANT,
    ISA_LAPSE_RATE,
    SSL_AIR_DENSITY,
    SSL_AIR_PRESSURE,
    SSL_AIR_TEMPERATURE,
    SimpleAtmosphere,
    airspeed,
    airspeed_energy_error,
    airspeed_estimate,
    airspeed_ratio,
    airspeed_tas,
    airspeed_voltage,
    altitude,
    altitude2,
    eas2tas,
    energy_error,
)
from mavwire.mavextra.state import (
    average_data,
    derivative_data,
    last_delta,
    last_diff,
    last_integral,
    last_sum,
    lowpass_data,
    lowpass_hz_data,
    reset_state_data,
)
from mavwire.mavextra.terrain import (
    radio_margin,
    terrain_height,
    terrain_margin,
    terrain_margin_lat_lon,
)
from mavwire.mavextra.units import (
    angle_diff,
    constrain,
    feet,
    gps_time_to_epoch,
    kmh,
    knots,
    wrap_180,
    wrap_360,
    wrap_valid_longitude,
)
from mavwire.mavextra.vehicle import (
    armed,
    demix1,
    demix2,
    mix1,
    mix2,
    mixer,
    mm_curr,
    mode,
    rate_of_turn,
    rover_lat_accel,
    rover_turn_circle,
    rover_yaw_rate,
    sawtooth,
    wingloading,
)
from mavwire.quaternion import Quaternion
from mavwire.rotmat import Matrix3, Vector3

builtin_sum = _builtins.sum

_STATE = frozenset(name for name in vars(_state) if not name.startswith("_"))

EXPRESSION_NAMES: tuple[str, ...] = (
    *_earth_field.TABLES,
    *(
        name
        for name in sorted(globals())
        if not (name.startswith("_") or hasattr(_math, name) or name in _STATE)
        and not isinstance(globals()[name], _ModuleType)
    ),
)
"""The names of this module that an expression knows: all but what is remembered."""

__all__ = [
    name
    for name, value in globals().items()
    if not name.startswith("_") and not isinstance(value, _ModuleType)
]


def __getattr__(name: str) -> _Any:
    """The tables, read from their file on first use, and what is remembered, as it is now."""
    if name in _earth_field.TABLES:
        return _earth_field.table(name)
    if name in _state.SCALARS:
        return _state.SCALARS[name]
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*globals(), *_earth_field.TABLES, *_state.SCALARS})
