"""The functions that conditions and graph expressions may use, with pymavlink's names.

They take messages or their fields and compute what a log does not hold: distances, headings,
airspeeds, filtered values. Angles are in degrees unless a function says otherwise. This module
only gathers them; the modules beside it are one topic each. As in pymavlink the names of ``math``
are here too, and ``sum`` and ``mode`` are not the builtin ones.
"""

import builtins as _builtins
import math as _math
import sys as _sys
from math import *  # noqa: F403
from types import ModuleType as _ModuleType
from typing import Any as _Any

from mavwire._hooks import (
    IN_STANDARD_MODULE as _IN_STANDARD_MODULE,
    ReplaceableModule as _ReplaceableModule,
    make_replaceable as _make_replaceable,
)
from mavwire.mavextra import earth_field as _earth_field
from mavwire.mavextra import state as _state
from mavwire.mavextra.attitude import (
    euler_p90 as euler_p90,
    euler_rotated as euler_rotated,
    euler_to_quat as euler_to_quat,
    qpitch as qpitch,
    qpitch_p90 as qpitch_p90,
    qroll as qroll,
    qroll_p90 as qroll_p90,
    quat_to_euler as quat_to_euler,
    qyaw as qyaw,
    qyaw_p90 as qyaw_p90,
    rotate_quat as rotate_quat,
)
from mavwire.mavextra.compass import (
    RotateMag as RotateMag,
    get_motor_offsets as get_motor_offsets,
    mag_field as mag_field,
    mag_field_df as mag_field_df,
    mag_field_motors as mag_field_motors,
    mag_heading as mag_heading,
    mag_heading_df as mag_heading_df,
    mag_heading_motors as mag_heading_motors,
    mag_pitch as mag_pitch,
    mag_roll as mag_roll,
    mag_rotation as mag_rotation,
)
from mavwire.mavextra.earth_field import (
    SAMPLING_MAX_LAT as SAMPLING_MAX_LAT,
    SAMPLING_MAX_LON as SAMPLING_MAX_LON,
    SAMPLING_MIN_LAT as SAMPLING_MIN_LAT,
    SAMPLING_MIN_LON as SAMPLING_MIN_LON,
    SAMPLING_RES as SAMPLING_RES,
    earth_field_error as earth_field_error,
    expected_earth_field as expected_earth_field,
    expected_earth_field_lat_lon as expected_earth_field_lat_lon,
    expected_mag as expected_mag,
    expected_mag_latlon as expected_mag_latlon,
    expected_mag_yaw as expected_mag_yaw,
    get_lat_lon_status as get_lat_lon_status,
    get_mag_field_ef as get_mag_field_ef,
    interpolate_table as interpolate_table,
    mag_yaw as mag_yaw,
)
from mavwire.mavextra.estimators import (
    DCM_State as DCM_State,
    DCM_update as DCM_update,
    PX4_State as PX4_State,
    PX4_update as PX4_update,
)
from mavwire.mavextra.filters import (
    average as average,
    delta as delta,
    delta_angle as delta_angle,
    diff as diff,
    downsample as downsample,
    integral as integral,
    lowpass as lowpass,
    lowpassHz as lowpassHz,
    lpalpha as lpalpha,
    second_derivative_5 as second_derivative_5,
    second_derivative_9 as second_derivative_9,
    sum as sum,
)
from mavwire.mavextra.inertial import (
    earth_accel as earth_accel,
    earth_accel2 as earth_accel2,
    earth_accel2_df as earth_accel2_df,
    earth_accel_df as earth_accel_df,
    earth_gyro as earth_gyro,
    earth_rates as earth_rates,
    gps_velocity as gps_velocity,
    gps_velocity_body as gps_velocity_body,
    gps_velocity_df as gps_velocity_df,
    gps_velocity_old as gps_velocity_old,
    gravity as gravity,
    pitch_estimate as pitch_estimate,
    pitch_rate as pitch_rate,
    pitch_sim as pitch_sim,
    roll_estimate as roll_estimate,
    roll_rate as roll_rate,
    rotation as rotation,
    rotation2 as rotation2,
    rotation_df as rotation_df,
    sim_body_rates as sim_body_rates,
    yaw_rate as yaw_rate,
)
from mavwire.mavextra.position import (
    _distance_two as _distance_two,
    distance_from as distance_from,
    distance_gps2 as distance_gps2,
    distance_home as distance_home,
    distance_home_df as distance_home_df,
    distance_lat_lon as distance_lat_lon,
    distance_two as distance_two,
    ekf1_pos as ekf1_pos,
    get_lat_lon_alt as get_lat_lon_alt,
    get_origin as get_origin,
    gps_newpos as gps_newpos,
    gps_offset as gps_offset,
    radius_of_earth as radius_of_earth,
)
from mavwire.mavextra.pressure import (
    C_TO_KELVIN as C_TO_KELVIN,
    EAS2TAS as EAS2TAS,
    ISA_GAS_CONSTANT as ISA_GAS_CONSTANT,
    ISA_LAPSE_RATE as ISA_LAPSE_RATE,
    SSL_AIR_DENSITY as SSL_AIR_DENSITY,
    SSL_AIR_PRESSURE as SSL_AIR_PRESSURE,
    SSL_AIR_TEMPERATURE as SSL_AIR_TEMPERATURE,
    SimpleAtmosphere as SimpleAtmosphere,
    airspeed as airspeed,
    airspeed_energy_error as airspeed_energy_error,
    airspeed_estimate as airspeed_estimate,
    airspeed_ratio as airspeed_ratio,
    airspeed_tas as airspeed_tas,
    airspeed_voltage as airspeed_voltage,
    altitude as altitude,
    altitude2 as altitude2,
    eas2tas as eas2tas,
    energy_error as energy_error,
)
from mavwire.mavextra.state import (
    average_data as average_data,
    derivative_data as derivative_data,
    last_delta as last_delta,
    last_diff as last_diff,
    last_integral as last_integral,
    last_sum as last_sum,
    lowpass_data as lowpass_data,
    lowpass_hz_data as lowpass_hz_data,
    reset_state_data as reset_state_data,
)
from mavwire.mavextra.terrain import (
    radio_margin as radio_margin,
    terrain_height as terrain_height,
    terrain_margin as terrain_margin,
    terrain_margin_lat_lon as terrain_margin_lat_lon,
)
from mavwire.mavextra.units import (
    angle_diff as angle_diff,
    constrain as constrain,
    feet as feet,
    gps_time_to_epoch as gps_time_to_epoch,
    kmh as kmh,
    knots as knots,
    wrap_180 as wrap_180,
    wrap_360 as wrap_360,
    wrap_valid_longitude as wrap_valid_longitude,
)
from mavwire.mavextra.vehicle import (
    armed as armed,
    demix1 as demix1,
    demix2 as demix2,
    mix1 as mix1,
    mix2 as mix2,
    mixer as mixer,
    mm_curr as mm_curr,
    mode as mode,
    rate_of_turn as rate_of_turn,
    rover_lat_accel as rover_lat_accel,
    rover_turn_circle as rover_turn_circle,
    rover_yaw_rate as rover_yaw_rate,
    sawtooth as sawtooth,
    wingloading as wingloading,
)
from mavwire.quaternion import Quaternion as Quaternion
from mavwire.rotmat import Matrix3 as Matrix3
from mavwire.rotmat import Vector3 as Vector3

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
    for name in (*globals(), *_earth_field.TABLES, *_state.SCALARS)
    if not (name.startswith("_") or isinstance(globals().get(name), _ModuleType))
]


class _Mavextra(_ReplaceableModule):
    _users = ("mavwire.mavextra",)
    _not_called = dict.fromkeys(
        (name for name in vars(_math) if name[0] != "_"), _IN_STANDARD_MODULE
    )


_make_replaceable(_sys.modules[__name__], _Mavextra)


def __getattr__(name: str) -> _Any:
    """The tables, read from their file on first use, and what is remembered, as it is now."""
    if name in _earth_field.TABLES:
        return _earth_field.table(name)
    if name in _state.SCALARS:
        return _state.SCALARS[name]
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*globals(), *_earth_field.TABLES, *_state.SCALARS})
