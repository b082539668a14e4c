"""The batches of fast samples in a dataflash log, as a log of single samples (extract_batch_imu.py).

ACC0, GYR0 and so on have the number of the sensor in their names. Incomplete batches count too.
"""

from __future__ import annotations

import struct
from argparse import ArgumentParser, Namespace
from collections.abc import Iterator
from typing import Any

from mavwire.cli._batches import TYPES, Batch, begin, samples
from mavwire.cli._errors import CommandError
from mavwire.cli._output import writing
from mavwire.cli._reading import definitions, reading

NAMES = ("ACC", "GYR")
FMT = struct.Struct("<3sBB4s16s64s")
SAMPLE = struct.Struct("<2sBQfff")
HEAD = b"\xa3\x95"
FMT_HEAD = HEAD + b"\x80"
# The first type of samples; those of the other sensors go down from it.
FIRST_TYPE = 254
MOST_SENSORS = 100
LAST_TIME = 2**64 - 1


def add_arguments(parser: ArgumentParser) -> None:
    parser.add_argument("inlog", help="dataflash log")
    parser.add_argument("outlog", help="dataflash log to write")


def main(args: Namespace) -> int:
    print(f"Processing log {args.inlog}")
    types: dict[tuple[int, int], int] = {}
    count = 0
    batch: Batch | None = None
    with (
        definitions(),
        reading("extract_batch_imu", args.inlog) as log,
        writing(args.outlog, [args.inlog], option="") as file,
    ):
        for msg in log.messages(TYPES):
            if msg.get_type() == "ISBH":
                batch = begin(msg)
                count += 1
            elif batch is not None and batch.number == msg.N:
                if batch.sensor not in types:
                    if len(types) == MOST_SENSORS:
                        raise CommandError(f"{args.inlog} has more than {MOST_SENSORS} sensors")
                    types[batch.sensor] = FIRST_TYPE - len(types)
                    file.write(_format(types[batch.sensor], batch.sensor))
                file.write(b"".join(_samples(types[batch.sensor], batch, msg)))
    print(f"Extracted {count} frames")
    return 0


def _format(number: int, sensor: tuple[int, int]) -> bytes:
    """The record that describes the samples of a sensor."""
    name = f"{NAMES[sensor[0]]}{sensor[1]}".encode()
    return FMT.pack(FMT_HEAD, number, SAMPLE.size, name, b"Qfff", b"TimeUS,X,Y,Z")


def _samples(number: int, batch: Batch, msg: Any) -> Iterator[bytes]:
    """The records of one part of a batch."""
    rows = list(samples(msg))
    step = int(1.0e6 / batch.rate)  # whole microseconds, as the script takes them
    for index, sample in enumerate(rows, msg.seqno * len(rows)):
        micros = min(batch.start + index * step, LAST_TIME)
        yield SAMPLE.pack(HEAD, number, micros, *(one / batch.multiplier for one in sample))
