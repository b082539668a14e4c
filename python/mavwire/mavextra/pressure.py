"""Altitude and airspeed from pressure, and the energy errors of a speed controller."""

from __future__ import annotations

from math import cos, exp, log, radians, sin, sqrt
from typing import Any

from mavwire.mavextra import state

__all__ = [
    "C_TO_KELVIN", "EAS2TAS", "ISA_GAS_CONSTANT", "ISA_LAPSE_RATE", "SSL_AIR_DENSITY",
    "SSL_AIR_PRESSURE", "SSL_AIR_TEMPERATURE", "SimpleAtmosphere", "airspeed",
    "airspeed_energy_error", "airspeed_estimate", "airspeed_ratio", "airspeed_tas",
    "airspeed_voltage", "altitude", "altitude2", "eas2tas", "energy_error",
]  # fmt: skip

SSL_AIR_DENSITY = 1.225  # kg/m^3 at standard sea level
SSL_AIR_PRESSURE = 101325.01576  # Pa
SSL_AIR_TEMPERATURE = 288.15  # K
C_TO_KELVIN = 273.15
ISA_GAS_CONSTANT = 287.26  # J/(kg K)
ISA_LAPSE_RATE = 0.0065  # K/m

_GRAVITY = 9.8  # m/s^2, as the energy errors take it
_DEFAULT_RATIO = 1.9936  # of an airspeed sensor: v^2 = ratio * pressure
_VOLTS_PER_COUNT = 5.0 / 4096


def _ground(pressure: float | None, temperature: float | None) -> tuple[float, float] | None:
    """Pressure (Pa) and temperature (K) at the ground, by default from the parameters."""
    if pressure is None:
        if state.current_link().param("GND_ABS_PRESS", None) is None:
            return None
        pressure = float(state.current_link().param("GND_ABS_PRESS", 1))
    if temperature is None:
        temperature = float(state.current_link().param("GND_TEMP", 0))
    return pressure, temperature + C_TO_KELVIN


def altitude(
    SCALED_PRESSURE: Any,
    ground_pressure: float | None = None,
    ground_temp: float | None = None,
) -> float:
    """Metres above the ground, from the barometric formula; 0 without a ground pressure."""
    ground = _ground(ground_pressure, ground_temp)
    if ground is None:
        return 0
    scaling = ground[0] / (SCALED_PRESSURE.press_abs * 100.0)
    return log(scaling) * ground[1] * 29271.267 * 0.001


def altitude2(
    SCALED_PRESSURE: Any,
    ground_pressure: float | None = None,
    ground_temp: float | None = None,
) -> float:
    """Metres above the ground in an atmosphere with a lapse rate; 0 without a ground pressure."""
    ground = _ground(ground_pressure, ground_temp)
    if ground is None:
        return 0
    scaling = SCALED_PRESSURE.press_abs * 100.0 / ground[0]
    return 153.8462 * ground[1] * (1.0 - exp(0.190259 * log(scaling)))


def airspeed(
    VFR_HUD: Any,
    ratio: float | None = None,
    used_ratio: float | None = None,
    offset: float | None = None,
) -> float:
    """The airspeed of VFR_HUD, or of the dataflash message ARSP, with another ``ratio`` and ``offset``
    than the vehicle used.
    """
    measured = VFR_HUD.airspeed if hasattr(VFR_HUD, "airspeed") else VFR_HUD.Airspeed
    if ratio is None:
        ratio = _DEFAULT_RATIO
    if used_ratio is None:
        parameters = state.current_link().params
        if "ARSPD_RATIO" in parameters:
            used_ratio = parameters["ARSPD_RATIO"]
        else:
            print("no ARSPD_RATIO in mav.params")
            used_ratio = ratio
    pressure = measured**2 / used_ratio
    if offset is not None:
        pressure = max(pressure + offset, 0.0)
    return sqrt(pressure * ratio)


def airspeed_ratio(VFR_HUD: Any) -> float:
    """The airspeed with the ratio taken out and put in again, which is the airspeed."""
    return float(VFR_HUD.airspeed)


def airspeed_voltage(VFR_HUD: Any, ratio: float | None = None) -> float:
    """The volts of an analog sensor; -1 without the parameter ARSPD_OFFSET."""
    parameters = state.current_link().params
    if "ARSPD_OFFSET" not in parameters:
        return -1
    default = _DEFAULT_RATIO if ratio is None else ratio
    used_ratio = parameters.get("ARSPD_RATIO", default)
    pressure = VFR_HUD.airspeed**2 / used_ratio
    return float(pressure + parameters["ARSPD_OFFSET"]) * _VOLTS_PER_COUNT


def SimpleAtmosphere(alt_km: float) -> tuple[float, float, float]:
    """Density, pressure and temperature relative to sea level (US standard atmosphere 1976)."""
    earth_radius = 6369.0  # km, the polar radius of the model
    height = alt_km * earth_radius / (alt_km + earth_radius)  # geopotential
    hydrostatic = 34.163195  # K/km
    if height < 11.0:
        temperature = (SSL_AIR_TEMPERATURE - 6.5 * height) / SSL_AIR_TEMPERATURE
        pressure = temperature ** (hydrostatic / 6.5)
    else:
        temperature = 216.65 / SSL_AIR_TEMPERATURE
        pressure = 0.2233611 * exp(-hydrostatic * (height - 11.0) / 216.65)
    return pressure / temperature, pressure, temperature


def eas2tas(alt_m: float, groundtemp: float = 25.0) -> float:
    """True over equivalent airspeed at this altitude and ground temperature (Celsius)."""
    pressure = SSL_AIR_PRESSURE * SimpleAtmosphere(alt_m * 0.001)[1]
    return _eas2tas(pressure, groundtemp, alt_m)


def EAS2TAS(ARSP: Any, GPS: Any, BARO: Any, ground_temp: float = 25) -> float:
    """True over equivalent airspeed from the barometer and the GPS altitude."""
    return _eas2tas(BARO.Press, ground_temp, GPS.Alt)


def _eas2tas(pressure: float, ground_temp: float, alt_m: float) -> float:
    temperature = ground_temp + C_TO_KELVIN - ISA_LAPSE_RATE * alt_m
    return sqrt(SSL_AIR_DENSITY / (pressure / (ISA_GAS_CONSTANT * temperature)))


def airspeed_tas(VFR_HUD: Any, GLOBAL_POSITION_INT: Any) -> float:
    """The true airspeed."""
    return float(VFR_HUD.airspeed * eas2tas(GLOBAL_POSITION_INT.alt * 0.001))


def airspeed_estimate(GLOBAL_POSITION_INT: Any, WIND: Any) -> float:
    """The horizontal airspeed from the velocity over ground and the wind it comes from."""
    direction = radians(WIND.direction)
    north = GLOBAL_POSITION_INT.vx * 0.01 + WIND.speed * cos(direction)
    east = GLOBAL_POSITION_INT.vy * 0.01 + WIND.speed * sin(direction)
    return sqrt(north**2 + east**2)


def airspeed_energy_error(NAV_CONTROLLER_OUTPUT: Any, VFR_HUD: Any) -> float:
    """The error in kinetic energy per mass, m^2/s^2."""
    target = VFR_HUD.airspeed + NAV_CONTROLLER_OUTPUT.aspd_error * 0.01
    return float(0.5 * (target**2 - VFR_HUD.airspeed**2))


def energy_error(NAV_CONTROLLER_OUTPUT: Any, VFR_HUD: Any) -> float:
    """The error in kinetic and potential energy per mass, m^2/s^2."""
    kinetic = airspeed_energy_error(NAV_CONTROLLER_OUTPUT, VFR_HUD)
    return kinetic + float(NAV_CONTROLLER_OUTPUT.alt_error) * _GRAVITY
