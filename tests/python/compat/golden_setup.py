"""The names that the golden cases of the dialect modules use, built for one package, and how a
result is written down.

A case is code whose last line is an expression; the outcome is text: `bytes:` and `bytearray:` with
a hex dump, `str:` with the plain string, `RAISES module.Class: text`, or the repr. Everything a
case needs is in the namespace made here.
"""

from __future__ import annotations

import ast
import contextlib
import copy
import importlib
import io
import logging
import pickle
import struct
from collections.abc import Iterator
from types import ModuleType
from typing import Any

KEY = b"A" * 32


class Receivers:
    """Makes senders, receivers and frames out of one package's dialect modules."""

    def __init__(self, package: str) -> None:
        self.common = importlib.import_module(f"{package}.dialects.v20.common")

    def mav(self, mod: ModuleType | None = None, sys: int = 1, comp: int = 1, **attrs: Any) -> Any:
        """A MAVLink writing into a BytesIO that is also its `out`."""
        out = io.BytesIO()
        mav = (mod or self.common).MAVLink(out, srcSystem=sys, srcComponent=comp)
        mav.out = out
        for name, value in attrs.items():
            setattr(mav, name, value)
        return mav

    def hbmsg(self, mod: ModuleType | None = None) -> Any:
        """HEARTBEAT with the values every case expects."""
        return (mod or self.common).MAVLink_heartbeat_message(2, 3, 81, 4, 4, 3)

    def sgn(self, ts: int = 1000, key: bytes = KEY, link: int = 3, msg: Any = None) -> bytearray:
        """A signed frame."""
        mav = self.mav()
        mav.signing.secret_key = key
        mav.signing.sign_outgoing = True
        mav.signing.link_id = link
        mav.signing.timestamp = ts
        return bytearray((msg or self.hbmsg()).pack(mav))

    def rxs(self, key: bytes = KEY, cb: Any = None, ts: int = 0) -> Any:
        """A receiver that verifies."""
        mav = self.mav()
        mav.signing.secret_key = key
        mav.signing.allow_unsigned_callback = cb
        mav.signing.timestamp = ts
        return mav


def counters(mav: Any) -> dict[str, Any]:
    """The signing counters of a receiver."""
    s = mav.signing
    return {
        "sig": s.sig_count,
        "good": s.goodsig_count,
        "bad": s.badsig_count,
        "unsigned": s.unsigned_count,
        "rej": s.reject_count,
        "ts": s.timestamp,
        "st": s.stream_timestamps,
    }


def namespace(package: str) -> dict[str, Any]:
    """Globals for one case; made afresh each time so that no case sees another one's changes."""
    make = Receivers(package)
    dialects = {
        "c2": "v20.common",
        "c1": "v10.common",
        "a2": "v20.all",
        "t2": "v20.test",
        "pa2": "v20.python_array_test",
        "ap2": "v20.ardupilotmega",
    }
    names: dict[str, Any] = {
        short: importlib.import_module(f"{package}.dialects.{path}")
        for short, path in dialects.items()
    }
    names |= {"nan": float("nan"), "inf": float("inf"), "struct": struct, "copy": copy}
    names |= {"pickle": pickle, "io": io, "cnt": counters, "ba": bytearray.fromhex}
    names |= {"mav": make.mav, "rx": make.mav, "hbmsg": make.hbmsg}
    names |= {"sgn": make.sgn, "rxs": make.rxs}
    names["HB2"] = make.hbmsg().pack(make.mav())
    names["HB1"] = make.hbmsg().pack(make.mav(), force_mavlink1=True)
    return names


def outcome(code: str, names: dict[str, Any]) -> str:
    """Run a case and write its result down."""
    tree = ast.parse(code)
    last = tree.body.pop()
    assert isinstance(last, ast.Expr), code
    try:
        with contextlib.redirect_stdout(io.StringIO()):
            exec(compile(tree, "<golden>", "exec"), names)
            value = eval(compile(ast.Expression(last.value), "<golden>", "eval"), names)
    except Exception as error:
        kind = type(error)
        module = "builtins" if kind.__module__ == "builtins" else kind.__module__
        return f"RAISES {module}.{kind.__qualname__}: {error}"
    return written(value)


def written(value: object) -> str:
    """A value in the notation of the vectors."""
    if isinstance(value, bytes | bytearray):
        return f"{type(value).__name__}:{value.hex()}"
    if isinstance(value, str):
        return f"str: {value}"
    return repr(value)


@contextlib.contextmanager
def module_logs(package: str) -> Iterator[list[str]]:
    """Lines that the package's dialect modules log meanwhile."""
    lines: list[str] = []

    class Collect(logging.Handler):
        def emit(self, record: logging.LogRecord) -> None:
            lines.extend(record.getMessage().split("\n"))

    logger = logging.getLogger(f"{package}.dialects")
    handler, before = Collect(), logger.level
    logger.addHandler(handler)
    logger.setLevel(logging.DEBUG)
    try:
        yield lines
    finally:
        logger.removeHandler(handler)
        logger.setLevel(before)
