"""Logs as mavutil gives them."""

from __future__ import annotations

import os
from contextlib import contextmanager, nullcontext

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from contextlib import AbstractContextManager
    from typing import Any


@contextmanager
def definitions(
    dialect: str | list[str] | None = None,
    wire_protocol: str | None = None,
    choosing: Callable[[Any], AbstractContextManager[None]] = lambda name: nullcontext(),
) -> Iterator[None]:
    """The dialect and wire protocol of this run, in place of the process's own, which are back
    afterwards. None leaves either as it is. `choosing` surrounds loading a dialect.
    """
    from mavwire import mavutil  # noqa: F401 - which chooses a dialect when it is first imported
    from mavwire.links import state

    before = state.definitions_in_use()
    try:
        if wire_protocol is not None:
            state.wire_protocol = wire_protocol
        with choosing(state.current_dialect if dialect is None else dialect):
            if dialect is None:
                state.renew_dialect()
            else:
                state.choose_dialect(dialect)
        yield
    finally:
        state.use_definitions(before)


def open_link(path: str, **options: Any) -> Any:
    """`mavlink_connection`, but an empty dataflash log, which the readers of those refuse, is opened
    as an empty telemetry log.
    """
    from mavwire import mavutil
    from mavwire._native import LogKind
    from mavwire.links.recognise import log_kind

    if ":" in path and os.path.lexists(path) and not os.path.isabs(path):
        path = os.path.join(os.curdir, path)  # it is a log, even if it is called tcp:HOST:PORT.tlog
    is_empty = os.path.isfile(path) and not os.path.getsize(path)
    if is_empty and log_kind(path, True) is LogKind.DATAFLASH:
        return mavutil.mavmmaplog(path)
    if not options.get("notimestamps"):
        _foresee_version(path)
    return mavutil.mavlink_connection(path, **options)


def kind_of(link: Any) -> str:
    """The kind of a link or log: "telemetry", "dataflash" or "CSV"."""
    if hasattr(link, "mav"):
        return "telemetry"
    return "CSV" if hasattr(link, "message_type") else "dataflash"


def _foresee_version(path: str) -> None:
    """Choose MAVLink 2 for a telemetry log that begins with a frame of it before the definitions of
    version 1 are loaded, which the log would replace as soon as it is opened.
    """
    from mavwire._native import LogKind
    from mavwire.links import state
    from mavwire.links.mavfile import MARKER_V2
    from mavwire.links.recognise import STAMP_LEN, kind_of

    if not state.is_postponed() or kind_of(path) is not LogKind.TLOG:
        return
    with open(path, "rb") as file:
        file.seek(STAMP_LEN)
        if file.read(1) == bytes((MARKER_V2,)):
            state.set_wire_protocol("2.0")
