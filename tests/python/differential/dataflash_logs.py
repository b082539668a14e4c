"""Generated dataflash logs for the comparison with pymavlink, binary and text."""

from __future__ import annotations

import math
import random
from pathlib import Path

from dataflash_writer import CODES, Log

INTEGERS = {
    "b": 8, "B": 8, "M": 8, "h": 16, "H": 16, "c": 16, "C": 16, "i": 32, "I": 32, "e": 32,
    "E": 32, "L": 32, "q": 64, "Q": 64,
}  # fmt: skip
FLOATS = [0.0, -0.0, 1.5, -1e-9, 3.0e38, 1.1, math.inf, -math.inf, math.nan, 65504.0, 123456.789]
TEXTS = [b"", b"abc", "café".encode(), b"caf\xe9", b"a\0junk", b"0123", b'quoted "x", y']
GPS_COLUMNS = "TimeUS,I,Status,GMS,GWk,NSats,Lat,Lng,Alt"


def stored(rng: random.Random, character: str) -> object:
    """A random stored value of a format character, often an extreme one."""
    bits = INTEGERS.get(character)
    if bits is not None:
        low = 0 if character in "BHIQCE" else -(1 << bits - 1)
        high = low + (1 << bits) - 1
        return rng.choice([low, high, 0, rng.randint(low, high), rng.randint(low, high)])
    if character in "gfd":
        value = rng.choice(FLOATS)
        return value if character != "g" or not math.isfinite(value) or abs(value) < 65505 else 1.0
    if character == "a":
        return rng.randbytes(64)
    size = int(CODES[character][:-1])
    return rng.choice(TEXTS)[:size]


def every_kind(seed: int) -> Log:
    """All format characters with random values, in types of up to 16 columns."""
    rng, log = random.Random(seed), Log()
    formats = ["QbBhHiIfd", "QnNZ", "QcCeEL", "QMqQg", "Qa", "QBBBBBBBBBBBBBBB", "QZZ", "NnZ"]
    for number, format in enumerate(formats):
        columns = ["TimeUS" if c == "Q" and n == 0 else f"F{n}" for n, c in enumerate(format)]
        log.define(f"K{number}", format, ",".join(columns))
    log.define("FILE", "NhIBZ", "FileName,Seq,Off,Length,Data")
    for _ in range(120):
        name = rng.choice(list(log.types))
        log.add(name, *(stored(rng, character) for character in log.types[name][1]))
    log.define("PARM", "QNf", "TimeUS,Name,Value").add("PARM", 5, "ANY", 1.0)
    return log


def flight(seed: int, *, units: bool = True, fix: bool = True, back: bool = False) -> Log:
    """A flight with instances, mode changes, and times that may go back."""
    rng, log = random.Random(seed), Log()
    if units:
        log.define("UNIT", "QbZ", "TimeUS,Id,Label", 150).define(
            "MULT", "Qbd", "TimeUS,Id,Mult", 151
        )
        log.define("FMTU", "QBNN", "TimeUS,FmtType,UnitIds,MultIds", 152)
    log.define("IMU", "QBfff", "TimeUS,I,AccX,AccY,AccZ", 40)
    log.define("BAT", "QNf", "TimeUS,Name,Volt", 41)
    log.define("GPS", "QBBIHBLLe", GPS_COLUMNS, 42)
    log.define("ATT", "Qcc", "TimeUS,Roll,Pitch", 43).define("OLD", "IB", "TimeMS,X", 44)
    log.define("MODE", "QMBB", "TimeUS,Mode,ModeNum,Rsn", 45).define("EV", "BB", "Id,X", 46)
    log.define("MSG", "QZ", "TimeUS,Message", 47).define(
        "PARM", "QNff", "TimeUS,Name,Value,Default", 48
    )
    log.define("STAT", "QB", "TimeUS,MainState", 49).define("ACC1", "IB", "TimeMS,X", 50)
    if units:
        for unit_id, label in ("s", "s"), ("#", "instance"), ("o", "m/s/s"), ("d", "deg"):
            log.add("UNIT", 1, ord(unit_id), label)
        for mult_id, factor in ("F", 1e-6), ("-", 0.0), ("B", 0.01), ("G", 1e-7), ("!", 3.6):
            log.add("MULT", 1, ord(mult_id), factor)
        log.add("FMTU", 1, 40, "s#ooo", "F-0B!").add("FMTU", 1, 41, "s#v", "F--")
        log.add("FMTU", 1, 42, "s#---Sddm", "F----0GGB").add("FMTU", 1, 43, "sdd", "FBB")
    log.add("EV", 1, 2).add("PARM", 900, "FIRST", 1.5, math.nan).add("PARM", 901, "SECOND", 2, 3)
    log.add("MSG", 950, rng.choice(["ArduCopter V4.5", "ArduPlane V4", "ArduSub V4", "Rover"]))
    time = 1000
    for number in range(150):
        time += rng.randint(100, 20000) * (-1 if back and number % 20 == 19 else 1)
        time = max(time, 0)
        log.add("IMU", time, number % 3, rng.random(), -rng.random(), -9.8)
        choice = rng.randrange(9)
        if choice == 0:
            log.add(
                "GPS",
                time,
                number % 2,
                3,
                100_000 + time // 1000,
                2200 * fix,
                9,
                473_977_418,
                -85_455_939,
                12_345,
            )
        elif choice == 1:
            log.add("MODE", time, number % 7, number % 7, 1)
        elif choice == 2:
            log.add("BAT", time, rng.choice(["main", "aux"]), 12.5)
        elif choice == 3:
            log.add("ATT", time, rng.randint(-999, 999), 5).add("EV", number, 1)
        elif choice == 4:
            log.add("OLD", time // 1000, 3).add("ACC1", 77, 1)
        elif choice == 5:
            log.add("PARM", time, f"P{number}", number, 1.0)
    return log


def text_log(seed: int) -> str:
    """A log as text, with lines that are none, and values that are odd but read."""
    rng = random.Random(seed)
    lines = [
        "FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns",
        "FMT, 40, 23, IMU, QBfff, TimeUS,I,AccX,AccY,AccZ",
        "FMT, 41, 14, MODE, QMBB, TimeUS,Mode,ModeNum,Rsn",
        "FMT, 42, 45, GPS, QBBIHBLLe, " + GPS_COLUMNS,
        "FMT, 43, 31, PARM, QNff, TimeUS,Name,Value,Default",
        "FMT, 44, 75, MSG, QZ, TimeUS,Message",
        "FMT, 45, 75, KIND, QcCeELdgMnqi, TimeUS,a,b,c,d,e,f,g,h,i,j,k",
        "PARM, 10, ONE, 1.5, nan",
        "PARM, 11, TWO, 2, 3",
        "MSG, 12, ArduCopter V4.5 (abc), with, commas",
        "KIND, 13, 1.5, 2, -3.25, 4, -35.1234567, 1e300, inf, Auto, abc, -9007199254740993, -5",
    ]
    for number in range(60):
        time = 1000 + number * 7
        lines.append(f"IMU, {time}, {number % 2}, {rng.random()}, -0.0, nan")
        if number % 9 == 3:
            lines.append(f"MODE, {time}, {rng.choice(['Loiter', 'Auto', 'RTL'])}, 5, 1")
        if number % 11 == 5:
            lines.append(f"GPS, {time}, 0, 3, {number}, 2200, 7, 47.3977418, 8.5455939, 500.25")
        if number % 13 == 6:
            lines.append("GARBAGE, 1, 2, 3, 4, 5, 6")
    return "\n".join(lines) + "\n"


def generated(directory: Path) -> list[Path]:
    """Writes all of them and returns their paths."""
    logs = {f"kinds{seed}": every_kind(seed) for seed in range(3)}
    logs["flight"] = flight(1)
    logs["no_units"] = flight(2, units=False)
    logs["no_fix"] = flight(3, fix=False)
    logs["back"] = flight(4, back=True)
    paths = [Path(log.write(directory / f"{name}.bin")) for name, log in logs.items()]
    for seed in range(2):
        path = directory / f"text{seed}.log"
        path.write_text(text_log(seed), encoding="utf-8")
        paths.append(path)
    return paths
