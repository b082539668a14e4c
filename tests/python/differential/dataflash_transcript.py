"""Reads dataflash logs through one package and writes down what can be seen, line by line.

`python -m differential.dataflash_transcript PACKAGE WAY,WAY... LOG...`
"""

from __future__ import annotations

import importlib
import io
import os
import sys
import time
from collections.abc import Iterator
from typing import Any

TYPES = ["IMU", "ATT", "GPS", "PARM"]


def drain(log: Any, **arguments: Any) -> Iterator[Any]:
    """All messages that `recv_match` gives."""
    yield from iter(lambda: log.recv_match(**arguments), None)


def fields(message: Any) -> str:
    """Type and value of each column, as attributes and as a dictionary."""
    names = message.get_fieldnames()
    values = [getattr(message, name) for name in names]
    kinds = [type(value).__name__ for value in values]
    return f"{message._timestamp!r} {message} {message.to_dict()} {values} {kinds}"


def opened(log: Any) -> Iterator[str]:
    """What is known right after opening."""
    yield repr((log._count, log.params, log.mav_type, log.flightmode))
    yield repr((type(log.clock).__name__, log.clock.timebase, log.name_to_id, log.id_to_name))
    yield repr((sorted(log.unit_lookup.items()), sorted(log.mult_lookup.items())))
    for key in sorted(log.formats, key=str):
        fmt = log.formats[key]
        yield repr((str(fmt), fmt.len, fmt.units, fmt.instance_field, fmt.msg_struct))


def read_all(log: Any) -> Iterator[str]:
    """Every message, with the state that it leaves."""
    for message in iter(log.recv_msg, None):
        yield f"{fields(message)} {log.flightmode} {log.mav_type} {len(log.params)}"
    yield repr((sorted(log.messages), log.params, log.flightmode_list(), log.last_timestamp()))
    log.rewind()
    yield repr((log.flightmode, log.percent, log.offset, sorted(log.messages)))


def read_types(log: Any) -> Iterator[str]:
    """Some types, and the state that the others leave meanwhile."""
    for message in drain(log, type=TYPES):
        yield f"{fields(message)} {log.flightmode} {sorted(log.messages)}"
    log.rewind()
    for message in drain(log, type="IMU", strict=True):
        yield f"{message._timestamp!r} {message._elements} {message.get_msgbuf()!r}"


def read_condition(log: Any) -> Iterator[str]:
    """Conditions over types, instances and the state."""
    for condition in ("GPS.Status>2", "IMU[1].AccZ<-9", "ATT.Roll>1"):
        log.rewind()
        for message in drain(log, condition=condition):
            yield f"{condition}: {message._timestamp!r} {message.get_type()}"


def read_verbose(log: Any) -> Iterator[str]:
    """Messages line by line."""
    for number, message in enumerate(iter(log.recv_msg, None)):
        if number % 5 == 0:
            text = io.StringIO()
            message.dump_verbose(text)
            yield text.getvalue()


def read_zero(log: Any) -> Iterator[str]:
    """Times since start."""
    for message in drain(log):
        yield f"{message._timestamp!r} {message.get_type()}"


WAYS = {
    "open": opened,
    "all": read_all,
    "types": read_types,
    "condition": read_condition,
    "verbose": read_verbose,
    "zero": read_zero,
}


def main(package: str, ways: str, *paths: str) -> None:
    """Print the transcript; an exception is its last line, and its traceback is not shown."""
    sys.tracebacklimit = 0
    os.environ["TZ"] = "UTC"
    time.tzset()
    mavutil = importlib.import_module(f"{package}.mavutil")
    for path in paths:
        for way in ways.split(","):
            print(way)
            with mavutil.mavlink_connection(path, zero_time_base=way == "zero") as log:
                for line in WAYS[way](log):
                    sys.stdout.write(line.replace(package, "PACKAGE") + "\n")


if __name__ == "__main__":
    main(*sys.argv[1:])
