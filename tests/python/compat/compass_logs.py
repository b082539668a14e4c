"""Measurements of a compass: points on a sphere, and a log of a vehicle that turns in the Earth's field."""

from __future__ import annotations

from math import radians
from pathlib import Path
from random import Random

import dataflash_writer
import numpy as np
from mavwire.mavextra import expected_earth_field_lat_lon
from mavwire.rotmat import Matrix3

CENTRE = (30.0, -50.0, 12.0)


def sphere(random: Random, count: int, radius: float = 450.0) -> list[tuple[float, ...]]:
    """Points around CENTRE."""
    found = []
    for _ in range(count):
        away = np.array([random.gauss(0, 1) for _ in range(3)])
        place = np.array(CENTRE) + away / np.linalg.norm(away) * radius
        found.append(tuple(float(one) for one in place))
    return found


def compass_log(path: Path, offsets: tuple[float, ...], diagonals: tuple[float, ...]) -> Path:
    """A second compass that needs these corrections besides half a milligauss for each ampere."""
    field = expected_earth_field_lat_lon(-35.36, 149.16)
    random = Random(9)
    log = dataflash_writer.Log()
    log.define("PARM", "QNf", "TimeUS,Name,Value")
    log.define("GPS", "QBIHLLf", "TimeUS,Status,GMS,GWk,Lat,Lng,Alt")
    log.define("XKF1", "QBccC", "TimeUS,C,Roll,Pitch,Yaw")
    log.define("BAT", "QBf", "TimeUS,Inst,Curr")
    log.define("MAG", "QBhhhhhhhhh", "TimeUS,I,MagX,MagY,MagZ,OfsX,OfsY,OfsZ,MOX,MOY,MOZ")
    parameters = {"AHRS_EKF_TYPE": 3, "COMPASS_OFS2_X": 10, "AHRS_TRIM_X": 0.05}
    for name, value in (parameters | {"AHRS_TRIM_Y": 0, "AHRS_TRIM_Z": 0}).items():
        log.add("PARM", 0, name, float(value))
    log.add("GPS", 1, 3, 1, 2200, -353600000, 1491600000, 0.0)
    for number in range(150):
        angles = [random.uniform(-80, 80), random.uniform(-60, 60), random.uniform(1, 359)]
        ampere = random.uniform(0, 40)
        log.add("XKF1", number * 10, 0, *(round(one * 100) for one in angles))
        log.add("XKF1", number * 10 + 1, 1, 0, 0, 0)  # the second filter is not asked
        log.add("BAT", number * 10 + 2, 0, ampere)
        vehicle, trim = Matrix3(), Matrix3()
        vehicle.from_euler(*(radians(round(one * 100) / 100) for one in angles))
        trim.from_euler(0.05, 0.0, 0.0)
        seen = (vehicle * trim).transposed() * field
        raw = [
            (one - 0.5 * ampere) / diagonal - offset
            for one, diagonal, offset in zip(
                (seen.x, seen.y, seen.z), diagonals, offsets, strict=True
            )
        ]
        log.add("MAG", number * 10 + 3, 0, 1, 2, 3, 0, 0, 0, 0, 0, 0)
        measured = round(raw[0]) + 10, round(raw[1]), round(raw[2])
        log.add("MAG", number * 10 + 4, 1, *measured, 10, 0, 0, 0, 0, 0)
    return Path(log.write(path))
