"""From a device string to a link: the dispatch behind `mavlink_connection`.

The classes are looked up in the public module (`mavutil`), so that a program or a test which
puts its own class there is heard. The first form that fits wins; prefixes are lower case.
"""

from __future__ import annotations

import math
import os
import sys
from types import SimpleNamespace

from mavwire._native import LogKind

from . import Any, Callable, state
from .recognise import check_usable, is_log_name, is_serial_name, log_kind, mode_of


class Options(SimpleNamespace):
    """The keyword arguments of `mavlink_connection`. `opts` holds those that only the CSV reader knows."""

    @property
    def common(self) -> dict[str, Any]:
        """The arguments of every live link."""
        names = ("source_system", "source_component", "use_native")
        return {name: getattr(self, name) for name in names}

    @property
    def pauses(self) -> dict[str, float]:
        """`reconnect_delay` unless it is the default. A class that a program puts in place of a link's need not
        know it."""
        delay = self.reconnect_delay
        largest = sys.float_info.max
        _checked(delay, "reconnect_delay", " of seconds from 0 on", 0, largest)
        return {} if delay == 1 else {"reconnect_delay": delay}

    @property
    def reader(self) -> dict[str, Any]:
        """The arguments of the readers of dataflash and CSV logs."""
        names = ("zero_time_base", "progress_callback")
        return {name: getattr(self, name) for name in names}


def _checked(value: Any, name: str, kind: str, least: float, largest: float) -> Any:
    """A number from `least` to `largest`. TypeError for anything else than a number, ValueError for another one."""
    try:
        fits = least <= value <= largest
    except TypeError:
        raise TypeError(f"{name} is a number, not {value!r}") from None
    if not fits:
        raise ValueError(f"{name} is a number{kind}, not {value}")
    return value


def _stream(name: str) -> Callable[[str, Options], Any]:
    """Opens a client over a stream socket, of the class `name`."""

    def open_stream(address: str, o: Options) -> Any:
        retries, pauses = _checked(o.retries, "retries", "", -math.inf, math.inf), o.pauses
        if name == "mavtcp":  # which pymavlink gives the default, too
            pauses = {"reconnect_delay": o.reconnect_delay}
        return getattr(state.public, name)(
            address, autoreconnect=o.autoreconnect, retries=retries, **pauses, **o.common
        )

    return open_stream


def _udp(address: str, o: Options, **kind: Any) -> Any:
    return state.public.mavudp(address, **{"input": o.input, **kind}, **o.common)


def _csv(address: str, o: Options) -> Any:
    filename, options = csv_options(address)
    return _opened(
        state.import_module("mavwire.CSVReader").CSVReader(
            filename, **{**o.reader, **o.opts, **options}
        )
    )


# Clients whose other end may not be up yet, which `retries` is for.
CLIENTS = {"tcp:": "mavtcp", "uds:": "mavuds", "unix:": "mavuds"}

PREFIXES: dict[str, Callable[[str, Options], Any]] = {
    **{prefix: _stream(name) for prefix, name in CLIENTS.items()},
    "tcpin:": lambda at, o: state.public.mavtcpin(at, retries=o.retries, **o.common),
    "udpin:": lambda at, o: _udp(at, o, input=True, timeout=o.udp_timeout),
    "udpout:": lambda at, o: _udp(at, o, input=False),
    **dict.fromkeys(
        ("udpbcast:", "udpcast:"), lambda at, o: _udp(at, o, input=False, broadcast=True)
    ),
    "wsserver:": lambda at, o: state.public.mavwebsocket(at, **o.common),
    "udp:": _udp,
    "mcast:": lambda at, o: state.public.mavmcast(at, **o.common),
    "exec:": lambda at, o: state.public.mavchildexec(at, **o.common),
}


# Modules that only some links need -> their packages, and the extras that bring these.
EXTRAS = {"serial": ("pyserial", "serial"), "wsproto": ("wsproto", "ws")}


def csv_options(address: str) -> tuple[str, dict[str, str]]:
    """FILE[:name=value]... as a pair; a value may be a colon only for `separator`."""
    filename, *parts = address.split(":")
    while parts and "=" not in parts[0]:  # a drive letter, or a colon in the name
        filename = f"{filename}:{parts.pop(0)}"
    options: dict[str, str] = {}
    while parts:
        name, _, value = parts.pop(0).partition("=")
        if name == "separator" and not value and parts and not parts[0]:
            parts.pop(0)
            value = ":"
        options[name] = value
    return filename, options


def _opened(reader: Any) -> Any:
    """Make a log reader that is no `mavfile` the current one."""
    state.mavfile_global = reader
    return reader


def _telemetry_log(device: str, kind: LogKind, o: Options) -> Any:
    is_raw = o.notimestamps or kind is LogKind.RAW
    if not (o.write or o.append or is_raw):
        # The index depends on the policy, so that it has to be known before it is made.
        resync = {} if o.resync is None else {"resync": o.resync}
        return state.public.mavmmaplog(device, progress_callback=o.progress_callback, **resync)
    log = state.public.mavlogfile(
        device, planner_format=o.planner_format, write=o.write, append=o.append,
        robust_parsing=o.robust_parsing, notimestamps=is_raw, **o.common,
    )  # fmt: skip
    if is_raw and not o.notimestamps:
        # A raw stream that was recognised has the times of its own clock, those of `open_log`.
        log.notimestamps = False
    return log


def _log(device: str, kind: LogKind, o: Options) -> Any:
    if kind.is_telemetry:
        return _telemetry_log(device, kind, o)
    module = state.import_module("mavwire.DFReader")
    reader = module.DFReader_text if kind is LogKind.DATAFLASH_TEXT else module.DFReader_binary
    return _opened(reader(device, **o.reader))


def _serial(device: str, o: Options) -> Any:
    return state.public.mavserial(
        device, baud=o.baud, autoreconnect=o.autoreconnect,
        force_connected=o.force_connected, **o.pauses, **o.common,
    )  # fmt: skip


def connect(device: str | os.PathLike[str] | bytes, options: Options) -> Any:
    """The link that `device`, a string or a path, names. Errors name it and say what it lacks."""
    device = os.fsdecode(device)
    try:
        return _connect(device, options)
    except OSError as error:
        # Beside the text, which programs compare with that of the operating system.
        error.add_note(f"while opening {device!r}")
        raise
    except ModuleNotFoundError as error:
        if error.name not in EXTRAS:
            raise
        package, extra = EXTRAS[error.name]
        reason = f"{device} needs {package}: pip install 'mavwire[{extra}]'"
        raise ModuleNotFoundError(reason, name=error.name) from error


def _connect(device: str, options: Options) -> Any:
    if device.startswith("exec:") and os.path.lexists(device):
        # The name that a stranger gave a log, found in a folder, must not run a program.
        return _connect_unprefixed(os.path.join(os.curdir, device), options)
    for prefix, open_link in PREFIXES.items():
        if device.startswith(prefix):
            return open_link(device[len(prefix) :], options)
    if device.startswith(("ws:", "wss:")):
        return state.public.mavwebsocket_client(device, **options.pauses, **options.common)
    if device.lower().startswith("csv:"):
        return _csv(device[4:], options)
    return _connect_unprefixed(device, options)


def _connect_unprefixed(device: str, o: Options) -> Any:
    readonly = not (o.write or o.notimestamps)
    kind = log_kind(device, readonly)
    if kind is None and ":" in device and not is_log_name(device):
        return _udp(device, o)
    if kind is None or not kind.is_dataflash:
        check_usable(device, creating=o.write)
    if kind is None and o.write and not mode_of(device) and not is_serial_name(device):
        kind = LogKind.TLOG
    return _serial(device, o) if kind is None else _log(device, kind, o)
