"""The dataflash log that the benches read: the types and rates of a copter's log, made up values."""

from __future__ import annotations

import random
import struct
from pathlib import Path

CODES = {"Q": "Q", "B": "B", "h": "h", "H": "H", "I": "I", "f": "f", "c": "h", "C": "H", "L": "i", "e": "i",
         "n": "4s", "N": "16s", "Z": "64s", "M": "b"}  # fmt: skip
# Name, format, columns, records of a hundred.
TYPES = (
    ("IMU", "QBffffffIIfBBHH", "TimeUS,I,GyrX,GyrY,GyrZ,AccX,AccY,AccZ,EG,EA,T,GH,AH,GHz,AHz", 30),
    ("ATT", "QccccCCCCB", "TimeUS,DesRoll,Roll,DesPitch,Pitch,DesYaw,Yaw,ErrRP,ErrYaw,AEKF", 20),
    ("RATE", "Qffffffffffff", "TimeUS,RDes,R,ROut,PDes,P,POut,YDes,Y,YOut,ADes,A,AOut", 20),
    ("XKF1", "QBccCfffffffccce", "TimeUS,C,Roll,Pitch,Yaw,VN,VE,VD,dPD,PN,PE,PD,GX,GY,GZ,OH", 10),
    ("RCOU", "QHHHHHHHH", "TimeUS,C1,C2,C3,C4,C5,C6,C7,C8", 8),
    ("BARO", "QBffcf", "TimeUS,I,Alt,Press,Temp,CRt", 6),
    ("GPS", "QBBIHBcLLeffff", "TimeUS,I,Status,GMS,GWk,NSats,HDop,Lat,Lng,Alt,Spd,GCrs,VZ,Yaw", 4),
    ("MODE", "QMBB", "TimeUS,Mode,ModeNum,Rsn", 1),
    ("PARM", "QNff", "TimeUS,Name,Value,Default", 1),
)
FIRST_TYPE = 64
HEAD_LEN = 89 * (1 + len(TYPES))
"""Bytes of the records that describe the others, which come first."""
RANGES = {"B": 5, "h": 9000, "H": 9000, "c": 9000, "C": 35999, "I": 9999, "L": 10**9, "e": 99999,
          "M": 7}  # fmt: skip


def record(type_id: int, codes: str, *values: object) -> bytes:
    """A record."""
    return bytes((0xA3, 0x95, type_id)) + struct.pack(codes, *values)


def described(type_id: int, name: str, format: str, columns: str) -> bytes:
    """A FMT record."""
    length = struct.calcsize(struct_of(format)) + 3
    texts = (text.encode() for text in (name, format, columns))
    return record(128, "<BB4s16s64s", type_id, length, *texts)


def struct_of(format: str) -> str:
    """The struct format of a record's body."""
    return "<" + "".join(CODES[character] for character in format)


def write(path: Path, messages: int) -> None:
    """Write a log of so many records behind those that describe it."""
    rng = random.Random(7)
    cycle = [index for index, (*_, share) in enumerate(TYPES) for _ in range(share)]
    rng.shuffle(cycle)
    formats = [struct_of(format) for _, format, _, _ in TYPES]
    with path.open("wb") as file:
        file.write(described(128, "FMT", "BBnNZ", "Type,Length,Name,Format,Columns"))
        for index, (name, format, columns, _) in enumerate(TYPES):
            file.write(described(FIRST_TYPE + index, name, format, columns))
        for number in range(messages):
            index = cycle[number % len(cycle)]
            values = [value(rng, c, number) for c in TYPES[index][1]]
            file.write(record(FIRST_TYPE + index, formats[index], *values))


def value(rng: random.Random, character: str, number: int) -> object:
    """A stored value."""
    if character == "Q":
        return number * 500
    if character == "N":
        return f"PARAM_{number % 900}".encode()
    return rng.uniform(-9, 9) if character == "f" else rng.randrange(RANGES[character])
