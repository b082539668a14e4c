"""Prints the public attributes of a package's objects as JSON: `python -m ... PACKAGE`, in an empty folder.

An attribute is its type and value. What begins with an underscore is the package's own, but for `_timestamp` and what
programs read of dataflash messages.
"""

from __future__ import annotations

import importlib
import json
import math
import os
import sys
from functools import partial
from pathlib import Path
from typing import Any

from dataflash_writer import CODES, Log

PRIVATE = ("_timestamp", "_elements", "_fieldnames", "_apply_multiplier")
SAMPLES: dict[str, Any] = {
    "a": b"\x01" * 64, "n": b"nm", "N": b"Name", "Z": b"Some text", "f": 1.25, "d": 2.5, "g": 0.5, "M": 4,
}  # fmt: skip
LINES = {
    "a": "[1, 2]",
    "n": "nm",
    "N": "Name",
    "Z": "Some text",
    "f": "1.25",
    "d": "2.5",
    "g": "0.5",
    "M": "LOITER",
}
Found = dict[str, str]


def shown(value: Any, depth: int = 0) -> str:
    """Type and value; of what a package makes itself the type's name alone."""
    kind = type(value).__name__
    if kind == "MessageMap":
        kind = "dict"  # it notices what programs replace
    if isinstance(value, type):
        return f"type {value.__name__}"
    if isinstance(value, float) and math.isnan(value):
        return "float nan"
    if depth < 4 and isinstance(value, list | tuple):
        return f"{kind} [{', '.join(shown(one, depth + 1) for one in value)}]"
    if depth < 4 and isinstance(value, dict):
        items = (f"{shown(key)}: {shown(one, depth + 1)}" for key, one in value.items())
        return f"{kind} {{{', '.join(items)}}}"
    if isinstance(value, int | float | str | bytes | bytearray | type(None)) or kind == "array":
        return f"{kind} {value!r}"
    return "callable" if callable(value) else kind


def record(found: Found, label: str, thing: Any, *, names: list[str] | None = None) -> None:
    """Note all attributes that `dir` gives."""
    for name in dir(thing) if names is None else names:
        if name.startswith("_") and not (name in PRIVATE and label.endswith(" message")):
            continue
        try:
            found[f"{label}.{name}"] = shown(getattr(thing, name))
        except AttributeError:
            continue  # the descriptor of a field on a class
        except Exception as error:
            found[f"{label}.{name}"] = f"raises {type(error).__name__}"


def attempt(found: Found, label: str, call: Any) -> None:
    """Note the outcome of a call."""
    try:
        found[label] = shown(call())
    except Exception as error:
        found[label] = f"raises {type(error).__name__}"


def dataflash(found: Found, package: str, folder: Path) -> None:
    """Formats and messages with each format character, of binary and text logs."""
    reader = importlib.import_module(f"{package}.DFReader")
    for number, character in enumerate(CODES):
        made = reader.DFFormat(7, "TST", 100, f"Q{character}", "TimeUS,X")
        record(found, f"{character} format", made)
        units = partial(made.set_unit_ids, "s#", {"s": "s", "#": "instance"})
        attempt(found, f"{character} unit", units)
        record(found, f"{character} format with units", made)
        log = Log().define("TST", f"Q{character}", "TimeUS,X", 7)
        path = log.add("TST", 1000, SAMPLES.get(character, 5)).write(folder / f"{number}.BIN")
        text = folder / f"{number}.log"
        text.write_text(
            "FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\n"
            f"FMT, 7, 20, TST, Q{character}, TimeUS,X\nTST, 1000, {LINES.get(character, 5)}\nTST, 2, 3\n"
        )
        for kind, opened in (
            ("binary", reader.DFReader_binary(path)),
            ("text", reader.DFReader_text(str(text))),
        ):
            msg = opened.recv_match(type="TST")
            label = f"{character} {kind}"
            record(found, f"{label} message", msg)
            record(found, f"{label} message.fmt", msg.fmt)
            calls = {"dict": msg.to_dict, "text": msg.__str__, "bytes": msg.get_msgbuf}
            for name, call in calls.items():
                attempt(found, f"{label} {name}", call)
            value = msg.X
            msg.X = value
            attempt(found, f"{label} bytes as set", msg.get_msgbuf)
            opened.close() if hasattr(opened, "close") else None


def rows(found: Found, package: str, folder: Path) -> None:
    """A CSV log and its messages."""
    path = folder / "log.csv"
    path.write_text("time;a;b\n1;2;text\n3;4.5;\n")
    log = importlib.import_module(f"{package}.CSVReader").CSVReader(str(path))
    record(found, "csv", log)
    msg = log.recv_msg()
    record(found, "csv message", msg)
    record(found, "csv format", msg.fmt)
    attempt(found, "csv text", lambda: str(msg))


def dialect(found: Found, package: str, name: str) -> None:
    """A dialect's module, classes, messages, enums and `MAVLink`."""
    module = importlib.import_module(f"{package}.dialects.{name}")
    record(found, f"{name}", module)
    for cls in module.mavlink_map.values():
        lengths = dict(zip(cls.ordered_fieldnames, cls.array_lengths, strict=True))
        kinds = zip(cls.fieldnames, cls.fieldtypes, strict=True)
        values = [
            b"x" if kind == "char" else [0] * lengths[one] if lengths[one] else 0
            for one, kind in kinds
        ]
        msg = cls(*values)
        names = [one for one in dir(cls) if one not in cls.fieldnames]
        record(found, f"{name} {cls.__name__}", cls, names=names)
        record(found, f"{name} {cls.__name__}()", msg)
        msg.pack(module.MAVLink(None, 1, 1))
        record(found, f"{name} {cls.__name__}() packed", msg)
    for enum, entries in module.enums.items():
        for value, entry in entries.items():
            found[f"{name} {enum} {value}"] = shown(
                {key: vars(entry)[key] for key in sorted(vars(entry))}
            )
    mav = module.MAVLink(None, 1, 1)
    mav.startup_time = 0.0
    record(found, f"{name} MAVLink", mav)
    mav.parse_buffer(bytes(module.MAVLink_statustext_message(1, b"x").pack(mav)))
    record(found, f"{name} MAVLink that parsed", mav)
    record(found, f"{name} signing", mav.signing)
    record(found, f"{name} header", module.MAVLink_header(5))
    record(found, f"{name} bad data", module.MAVLink_bad_data(b"x", "reason"))
    attempt(
        found,
        f"{name} enums as JSON",
        lambda: json.dumps(module.enums, default=vars, sort_keys=True),
    )


def main() -> None:
    """Print all."""
    package, folder = sys.argv[1], Path()
    found: Found = {}
    printed = sys.stdout
    sys.stdout = open(os.devnull, "w", encoding="utf-8")  # a package may print about `.name`
    dataflash(found, package, folder)
    rows(found, package, folder)
    for name in ("v10.common", "v20.all", "v20.python_array_test"):
        os.environ.pop("MAVLINK20", None)
        if name.startswith("v20"):
            os.environ["MAVLINK20"] = "1"
        dialect(found, package, name)
    json.dump(found, printed)


if __name__ == "__main__":
    main()
