"""What the golden cases of mavutil run in: links that need no device, logs, a dispatch recorder.

The same names work over mavwire and over pymavlink, so the cases can be checked against the
package they were observed on.
"""

from __future__ import annotations

import ast
import contextlib
import importlib
import io
import os
import socket
import struct
import sys
import threading
import time
import types

T0 = 1_600_000_000_000_000
# Readers that live in modules of their own; the dispatch recorder replaces them there.
READERS = {"DFReader": ("DFReader_binary", "DFReader_text"), "CSVReader": ("CSVReader",)}
LINK_CLASSES = (
    "mavtcp", "mavtcpin", "mavuds", "mavudp", "mavmcast", "mavwebsocket", "mavwebsocket_client",
    "mavserial", "mavchildexec", "mavlogfile", "mavmmaplog",
)  # fmt: skip


class Cases:
    """The namespace of the cases for one `package`, and the way to run a case in it."""

    def __init__(self, package: str) -> None:
        self.package = package
        self.before = {k: v for k, v in os.environ.items() if k != "MAVLINK_DIALECT"}
        os.environ.pop("MAVLINK_DIALECT", None)
        os.environ.pop("MAVLINK20", None)
        self.mavutil = importlib.import_module(f"{package}.mavutil")
        self.c1 = importlib.import_module(f"{package}.dialects.v10.all")
        self.c2 = importlib.import_module(f"{package}.dialects.v20.all")

    def reset20(self, wanted: bool) -> None:
        """The dialect `all` of protocol 2.0 if `wanted`, else of 1.0."""
        os.environ.pop("MAVLINK20", None)
        if wanted:
            os.environ["MAVLINK20"] = "1"
        if hasattr(self.mavutil, "set_wire_protocol"):
            self.mavutil.set_wire_protocol(None)
        self.mavutil.set_dialect("all")

    # -- messages and frames

    def hb(self, mod=None, type=2, ap=3, bm=81, cm=4):
        return (mod or self.c2).MAVLink_heartbeat_message(type, ap, bm, cm, 4, 3)

    def pkt(self, msg, sys=1, comp=1, seq=0, v1=False) -> bytes:
        mav = self.c2.MAVLink(None, srcSystem=sys, srcComponent=comp)
        mav.seq = seq
        return bytes(msg.pack(mav, force_mavlink1=v1))

    def hbb(self, sys=1, comp=1, seq=0, v1=False, **fields) -> bytes:
        return self.pkt(self.hb(**fields), sys, comp, seq, v1)

    def batt(self, i):
        return self.c2.MAVLink_battery_status_message(i, 0, 0, 0, [i + 1] * 10, 0, 0, 0, 50)

    def att(self, roll):
        return self.c2.MAVLink_attitude_message(1000, roll, 0, 0, 0, 0, 0)

    # -- links and logs

    def cap_class(self):
        mavutil, c2 = self.mavutil, self.c2

        class Cap(mavutil.mavfile):
            def __init__(self, **kw):
                self.tx = bytearray()
                self.rx = bytearray()
                super().__init__(None, "cap", **kw)

            def recv(self, n=None):
                n = len(self.rx) if n is None else n
                data = bytes(self.rx[:n])
                del self.rx[:n]
                return data

            def write(self, buf):
                self.tx += buf

            def sent(self):
                return [str(m) for m in c2.MAVLink(None).parse_buffer(bytes(self.tx)) or []]

        return Cap

    @staticmethod
    def drain(link, **kw):
        found = []
        while (msg := link.recv_match(**kw)) is not None:
            found.append(msg)
        return found

    @staticmethod
    def rec(us: int, frame: bytes) -> bytes:
        return struct.pack(">Q", us) + frame

    @staticmethod
    def mklog(name: str, parts: list[bytes]) -> None:
        with open(name, "wb") as log:
            log.write(b"".join(parts))

    def make_files(self) -> None:
        """The logs and other files of the cases, in the current directory."""
        rec, pkt, hb, att, batt, c2 = self.rec, self.pkt, self.hb, self.att, self.batt, self.c2
        ms = 1000
        std = [
            rec(T0, pkt(hb())),
            rec(T0 + 100 * ms + 1, pkt(att(0.5), seq=1)),
            rec(T0 + 200 * ms + 2, pkt(batt(0), seq=2)),
            rec(T0 + 300 * ms + 3, pkt(att(1.5), seq=3)),
            rec(T0 + 400 * ms, pkt(batt(1), seq=4)),
            rec(T0 + 500 * ms, pkt(hb(cm=5), seq=6)),
            rec(T0 + 600 * ms, pkt(c2.MAVLink_param_value_message(b"ABC", 1.5, 9, 1, 0), seq=7)),
        ]
        wheel = c2.MAVLink_wheel_distance_message(1, 2, [1.0] * 16)
        bad_crc, unknown = bytearray(std[1]), bytearray(std[1])
        bad_crc[-1] ^= 0x55
        unknown[8 + 7 : 8 + 10] = b"\xff\xff\x01"
        named = c2.MAVLink_named_value_float_message(1, b"foo", 1.5)
        array = c2.MAVLink_debug_float_array_message(1, b"x", 300, [1.0] * 58)
        logs = {
            "std.tlog": std,
            "empty.tlog": [],
            "trunc.tlog": [std[0], std[2][:-10]],
            "junk.tlog": [std[0], rb"\x55\x44\x55\x44\x55", std[1], std[2]],
            "raw.bin.raw": [pkt(hb()), pkt(att(0.5), seq=1)],
            "jump.tlog": [std[0], rec(1, pkt(att(0.5), seq=1)), std[3]],
            "badcrc.tlog": [std[0], bytes(bad_crc), std[3]],
            "unk.tlog": [std[0], bytes(unknown), std[3]],
            "v1.tlog": [rec(T0, pkt(hb(), v1=True)), rec(T0 + 1, pkt(att(1), v1=True))],
            "mix.tlog": [rec(T0, pkt(hb(), v1=True)), rec(T0 + 1, pkt(wheel))],
            "inst.tlog": [
                rec(T0 + i, pkt(m)) for i, m in enumerate((hb(), batt(0), batt(200), array, named))
            ],
        }
        for name, parts in logs.items():
            self.mklog(name, parts)

    def make_dispatch_files(self) -> None:
        """Files that only their names matter of, in the current directory."""
        os.makedirs("bin", exist_ok=True)
        for name in ("x.tlog", "y.log", "plain", "a.elf", "bin/prog", "f.csv"):
            with open(name, "w") as file:
                file.write("content")
        with open("x.log", "w") as file:
            file.write("FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\n")
        os.chmod("bin/prog", 0o755)

    def dispatch(self, device: str, **kw):
        """(class name, args, kwargs) of the link that `mavlink_connection` would make."""

        def recorder(name):
            return lambda *args, **kwargs: (name, args, kwargs)

        with contextlib.ExitStack() as stack:
            for name in LINK_CLASSES:
                stack.enter_context(replaced(self.mavutil, name, recorder(name)))
            package = importlib.import_module(self.package)
            for module, names in READERS.items():
                fake = types.ModuleType(f"{self.package}.{module}")
                for name in names:
                    setattr(fake, name, recorder(name))
                stack.enter_context(replaced(package, module, fake))
                stack.enter_context(replaced_item(sys.modules, fake.__name__, fake))
            return self.mavutil.mavlink_connection(device, **kw)

    # -- running

    def namespace(self) -> dict:
        names = ("mavutil", "c1", "c2", "before", "reset20", "hb", "pkt", "hbb", "batt", "att",
                 "drain", "rec", "mklog", "dispatch")  # fmt: skip
        shared = {name: getattr(self, name) for name in names}
        modules = {m.__name__: m for m in (io, os, socket, struct, sys, threading, time)}
        return {**shared, **modules, "sys": sys, "cap": self.cap_class(), "T0": T0}

    def run(self, code: str) -> tuple[str, str]:
        """The text of the last expression's value, or of the exception, and what was printed."""
        tree = ast.parse(code)
        names = self.namespace()
        last = ast.Expression(tree.body.pop().value)
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            try:
                exec(compile(tree, "case", "exec"), names)
                value = eval(compile(last, "case", "eval"), names)
                text = f"str: {value}" if isinstance(value, str) else repr(value)
            except Exception as error:
                kind = type(error)
                text = f"RAISES {kind.__module__}.{kind.__name__}: {error}"
        text = text.replace("\n", "⏎").replace(f"{self.package}.", "PACKAGE.")
        return text, printed.getvalue()


@contextlib.contextmanager
def replaced(owner, name, value):
    """`owner.name` is `value` for a while."""
    missing = object()
    old = vars(owner).get(name, missing)
    setattr(owner, name, value)
    try:
        yield
    finally:
        if old is missing:
            delattr(owner, name)
        else:
            setattr(owner, name, old)


@contextlib.contextmanager
def replaced_item(mapping, key, value):
    """`mapping[key]` is `value` for a while."""
    missing = object()
    old = mapping.get(key, missing)
    mapping[key] = value
    try:
        yield
    finally:
        if old is missing:
            del mapping[key]
        else:
            mapping[key] = old
