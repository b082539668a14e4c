"""Messages as mavlogdump prints them: text, JSON lines, CSV rows, or line by line for people."""

from __future__ import annotations

import io
import json
from argparse import Namespace
from typing import Any

from mavwire._log_link import kind_of
from mavwire._native import csv_safe, recordable
from mavwire.cli._errors import CommandError
from mavwire.links.inspect_message import local_stamp
from mavwire.links.signing import SETUP_SIGNING, shown


class Standard:
    """`2020-09-13 12:26:40.00: HEARTBEAT {type : 2, ...}`"""

    def __init__(self, args: Namespace) -> None:
        self._show_source = args.show_source
        self._show_seq = args.show_seq
        self._events = args.event_definitions

    def line(self, msg: Any) -> str:
        """The message without a newline."""
        text = f"{local_stamp(msg._timestamp)}: {msg}"
        if self._show_source:
            text += f" srcSystem={msg.get_srcSystem()} srcComponent={msg.get_srcComponent()}"
        if self._show_seq:
            text += f" seq={msg.get_seq()}"
        if self._events and msg.get_type() == "EVENT":
            event = self._events.event(msg)
            text += f" {event.level}: {event.text}"
        return text


class Verbose:
    """A line for each field, with units, enum names and the bits of bitmasks, and an empty line."""

    def line(self, msg: Any) -> str:
        """The message without its last newline."""
        from mavwire import mavutil

        text = io.StringIO()
        if hasattr(msg, "get_header"):
            mavutil.dump_message_verbose(text, msg)
        else:
            msg.dump_verbose(text)
        return text.getvalue()


class Json:
    """`{"meta": {"type": ..., "timestamp": ...}, "data": {...}}`"""

    def __init__(self, args: Namespace) -> None:
        self._show_source = args.show_source
        self._events = args.event_definitions

    def line(self, msg: Any, text: bytes | None = None) -> str:
        """The message without a newline; `text` replaces a part of it."""
        meta: dict[str, Any] = {"type": msg.get_type(), "timestamp": msg._timestamp}
        if self._show_source:
            meta["srcSystem"] = msg.get_srcSystem()
            meta["srcComponent"] = msg.get_srcComponent()
        data = {field: shown(field, value) for field, value in msg.to_dict().items()}
        if data.pop("mavpackettype") == f"UNKNOWN_{SETUP_SIGNING}":
            data["data"] = recordable(bytes(data["data"]))
        if text is not None:
            data["text"] = text.decode("ascii", "replace")
        line = {"meta": meta, "data": data}
        if self._events and msg.get_type() == "EVENT":
            line["event"] = self._events.event(msg)._asdict()
        return json.dumps(line, default=_plain)


def _plain(value: Any) -> Any:
    """Bytes of a frame as numbers, texts that are no text as well as they can be read."""
    if isinstance(value, bytes):
        return value.decode("utf-8", "backslashreplace")
    return list(value)


class Csv:
    """One table over all wanted types; a row has cells for its own type only."""

    def __init__(self, args: Namespace, log: Any) -> None:
        self.separator = "\t" if args.csv_sep == "tab" else args.csv_sep
        self._cell = csv_safe if args.csv_safe else str
        if args.types is None:
            raise CommandError(
                "CSV needs the message types that make its columns: --types ATTITUDE,VFR_HUD"
            )
        self.types: list[str] = args.types.split(",")
        if kind_of(log) == "telemetry":
            self._columns = [(name, _telemetry_fields(name)) for name in self.types]
            self._titles = [f"{name}.{field}" for name, fields in self._columns for field in fields]
        else:
            self._columns = [_columns_of(self.types, log)]
            self._titles = self._columns[0][1]

    def header(self) -> str:
        """The first line, without a newline."""
        return self.separator.join(["timestamp", *map(self._cell, self._titles)])

    def line(self, msg: Any) -> str:
        """A row without a newline."""
        kind = msg.get_type()
        cells = [f"{msg._timestamp:.8f}"]
        for name, fields in self._columns:
            if name == kind:
                values = (shown(field, getattr(msg, field)) for field in fields)
                cells += [self._cell(one) if isinstance(one, str) else str(one) for one in values]
            else:
                cells += [""] * len(fields)
        return self.separator.join(cells)


def _telemetry_fields(name: str) -> list[str]:
    from mavwire import mavutil

    message = getattr(mavutil.mavlink, f"MAVLink_{name.lower()}_message", None)
    if message is None or message.msgname != name:
        raise CommandError(
            f"no message type {name!r} in dialect {mavutil.current_dialect}; CSV needs exact names"
        )
    fields: list[str] = message.fieldnames
    return fields


def _columns_of(types: list[str], log: Any) -> tuple[str, list[str]]:
    """The only type of a table over a log without a dialect, and its fields."""
    kind = kind_of(log)
    if len(types) != 1:
        raise CommandError(f"CSV of a {kind} log takes exactly one message type: --types IMU")
    name = types[0]
    if name not in ([log.message_type] if kind == "CSV" else log.name_to_id):
        raise CommandError(f"no message type {name!r} in this log; CSV needs an exact name")
    if kind == "CSV":
        return name, list(log.fmt.headings)
    described = next(one for one in log.formats.values() if one.name == name)
    return name, list(described.columns)


def formatter(args: Namespace, log: Any) -> Standard | Verbose | Json | Csv:
    """The form that the command line asks for."""
    if args.format == "json":
        return Json(args)
    if args.format == "csv":
        return Csv(args, log)
    return Verbose() if args.verbose and kind_of(log) != "CSV" else Standard(args)
