"""`Bridge`: links with a router between them, embedded in a program."""

from __future__ import annotations

import atexit
import dataclasses
import os
import sys
from typing import NamedTuple
from weakref import WeakSet

from mavwire.dialects import UPSTREAM

from .checks import listed, seconds, text, whole
from .endpoints import parse_endpoint
from .errors import BridgeError, ConfigError
from .frames import FrameBatches
from .options import Config, Endpoint, EndpointOptions, Recording, Settings, endpoint_options

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from typing import Any, Self

    from mavwire._native import BridgeCore
    from mavwire.events import EventDefinitions
    from mavwire.logs.dialect import Dialects

    from .sinks import Sink


class Kind(NamedTuple):
    """A message from a component: how many came, and time and link of the last one."""

    id: int
    name: str
    system: int
    component: int
    frames: int
    time: float
    link: str


# To be stopped at the end of the program: a thread inside one would keep it, and the end of its recording.
_running_bridges: WeakSet[Bridge] = WeakSet()


@atexit.register
def _stop_all() -> None:
    for bridge in list(_running_bridges):
        bridge.stop()


class Bridge:
    """A MAVLink router. Frames that arrive over one link leave over those that they are meant for.

    `links` are endpoints (`"udpin:0.0.0.0:14550"`) or `EndpointOptions`; `record` a directory for
    telemetry logs or a `Recording`. `dedup`: copies that arrive over another link within so many
    seconds are dropped, 0 for none. `max_age`: how long a system is known at a link after it was
    heard. `sniffer_sysid`: links where this system is heard get every frame. `dialect`: the
    definitions of messages, or several dialects: the first that knows an id names it.
    `source_system` and `source_component`: who `send` sends as; with a ground station at 255/190,
    where most are, say another one, or it gets none of that.

    ConfigError (a ValueError) for an option; `start` opens what they name.
    """

    def __init__(
        self,
        links: Iterable[str | Endpoint | EndpointOptions] = (),
        *,
        record: str | os.PathLike[str] | Recording | None = None,
        dedup: float = 0.5,
        max_age: float = 60.0,
        sniffer_sysid: int = 0,
        dialect: Dialects = UPSTREAM,
        source_system: int = 255,
        source_component: int = 190,
    ) -> None:
        self.dialect: Any = _module(dialect)
        self._settings = Settings(dedup, max_age, sniffer_sysid)
        self._recording = (
            record if record is None or isinstance(record, Recording) else Recording(record)
        )
        self._mav: Any = self.dialect.MAVLink(
            None,
            whole("source_system", source_system, 255, least=1),
            whole("source_component", source_component, 255, least=1),
        )
        self.event_definitions: EventDefinitions | None = None
        """The texts of PX4's events, for the inspector."""
        self.sinks: list[Sink] = []
        """Those that are open: `open_sink` puts them there."""
        self._groups: list[str] = []
        given: Iterator[Any] = listed("links", links)
        self._links = [self._link(link, {}) for link in given]
        self._core: BridgeCore | None = None

    @classmethod
    def from_config(cls, path: str | os.PathLike[str]) -> Self:
        """A bridge as a file says: mavlink-router's format, or TOML. ConfigError, OSError."""
        from .config_file import load_config

        return cls.from_options(load_config(path))

    @classmethod
    def from_options(cls, config: Config) -> Self:
        """A bridge as a loaded file says."""
        try:
            bridge = cls(record=config.recording, dialect=config.dialect, **config.settings)
        except ConfigError as error:
            raise (error.at(config.path) if config.path else error) from None
        names = set()
        for where, endpoint, options in config.links:
            try:
                link = bridge._link(endpoint, options)
                if link.name in names:
                    raise ConfigError(f"another link is called {link.name!r} too")
            except ConfigError as error:
                raise error.at(where) from None
            bridge._links.append(link)
            names.add(link.name)
        return bridge

    # -- running

    def start(self) -> Self:
        """Open all links and begin to route. OSError names the link that cannot be opened."""
        if self._core is not None:
            raise BridgeError("the bridge is running already")
        core_class = _core_class()
        core = core_class(self._native_dialect(), self._settings, self._recording)
        try:
            for link in self._links:
                _add(core, link)
        except BaseException:
            core.stop()
            raise
        self._core = self._mav.file = core
        _running_bridges.add(self)
        return self

    def stop(self) -> None:
        """Close all sinks and links and finish the recording. Does nothing to a bridge that is not running."""
        _running_bridges.discard(self)
        try:
            if self.sinks:
                from .sinks import close_all

                close_all(self.sinks)
        finally:
            core, self._core = self._core, None
            if core is not None:
                core.stop()

    def __enter__(self) -> Self:
        return self if self._core is not None else self.start()

    def __exit__(self, *exception: object) -> None:
        self.stop()

    @property
    def running(self) -> bool:
        """It was started and not stopped."""
        return self._core is not None

    # -- links

    def add(self, endpoint: str | Endpoint | EndpointOptions, **options: Any) -> str:
        """Add a link, with the options of docs/bridge.md; returns its name.

        ConfigError for an option, BridgeError for a name that is taken, OSError if it cannot be
        opened. Before `start` the link is opened by `start`.
        """
        link = self._link(endpoint, options)
        if self._core is not None:
            _add(self._core, link)
        elif any(one.name == link.name for one in self._links):
            raise BridgeError(f'there is a link called "{link.name}" already')
        self._links.append(link)
        return link.name

    def remove(self, name: str) -> None:
        """Remove a link and close it. BridgeError if there is none of that name."""
        if self._core is not None:
            self._core.remove(name)
        elif all(link.name != name for link in self._links):
            raise BridgeError(f'there is no link called "{name}"')
        self._links = [link for link in self._links if link.name != name]

    def _link(
        self, endpoint: str | Endpoint | EndpointOptions, options: dict[str, Any]
    ) -> EndpointOptions:
        if isinstance(endpoint, EndpointOptions):
            link = endpoint
        else:
            if not isinstance(endpoint, Endpoint):
                endpoint = parse_endpoint(text("a link", endpoint))
            link = endpoint_options(endpoint, options, self._message_id)
        if link.group is None:
            return link
        if link.group not in self._groups:
            self._groups.append(link.group)
        return dataclasses.replace(link, group_number=self._groups.index(link.group))

    # -- frames

    def send(self, message: Any) -> None:
        """Send to whom it is meant for: whole frames in bytes, which leave as they are, or a
        message, which is packed as from `source_system` and `source_component` (255 and 190 unless
        the bridge was made with others). Never to a link where that address was heard.

        ValueError for bytes that are not one whole frame behind the other, or where the checksum of
        a known message is wrong, of which none is sent; TypeError for anything else.
        """
        if isinstance(message, bytes | bytearray | memoryview):
            self._running().write(bytes(message))
            return
        if not hasattr(message, "pack"):
            raise TypeError(f"a message or the bytes of frames can be sent, not {message!r}")
        self._running()
        self._mav.send(message)

    def latest(
        self, type: str | int, system: int | None = None, component: int | None = None
    ) -> Any:
        """The newest message of a type, from a system and component or from any; None if none came."""
        for name, value in (("system", system), ("component", component)):
            if value is not None:
                whole(name, value, 255)
        return self._running().latest(self._message_id(type), system, component)

    def latest_text(self, system: int, component: int) -> str | None:
        """The last status text of a component that is complete; several messages may have brought it.
        None if none came.
        """
        text = self._running().latest_text(system, component)
        return None if text is None else text.decode("utf-8", "replace")

    def frames(
        self,
        types: Iterable[str | int] | None = None,
        systems: Iterable[int] | None = None,
        *,
        max_batch: int = 1024,
        max_latency: float = 0.05,
    ) -> FrameBatches:
        """The frames from now on in batches, of some types and systems or of all.

        A batch has up to `max_batch` frames, which waited up to `max_latency` seconds for it to
        fill. Frames that `send` sent are among them; duplicates and what a filter stopped are not.
        """
        whole("max_batch", max_batch, 2**31, least=1)
        seconds("max_latency", max_latency)
        messages = (
            None if types is None else [self._message_id(one) for one in listed("types", types)]
        )
        wanted = (
            None
            if systems is None
            else [whole("systems", one, 255) for one in listed("systems", systems)]
        )
        tap = self._running().tap(messages, wanted)
        return FrameBatches(tap, max_batch, max_latency)

    # -- what it tells

    def kinds(self) -> list[Kind]:
        """Each message of the dialect from each component that came, by system, component and id."""
        return self.newest_kinds(sys.maxsize)[0]

    def newest_kinds(self, most: int) -> tuple[list[Kind], int]:
        """Those of which a message came last, and how many there are besides."""
        rows, hidden = self._running().kinds(whole("most", most, sys.maxsize))
        return [Kind(*row) for row in rows], hidden

    def stats(self) -> dict[str, Any]:
        """Counters of links and components, recording and sinks: what docs/bridge.md lists. BridgeError
        once it was stopped: ask before.
        """
        stats = self._running().stats()
        stats["sinks"] = [sink.stats() for sink in list(self.sinks)]
        return stats

    def __repr__(self) -> str:
        state = "running" if self.running else "stopped"
        return f"<Bridge of {len(self._links)} links, {state}>"

    def _running(self) -> BridgeCore:
        if self._core is None:
            raise BridgeError("the bridge is not running")
        return self._core

    def _native_dialect(self) -> Any:
        return self._mav._dialect

    def _message_id(self, name: object) -> int:
        if isinstance(name, int) and not isinstance(name, bool):
            return whole("a message id", name, 2**24 - 1)
        if not isinstance(name, str):
            raise ConfigError(f"{name!r} is neither name nor id of a message")
        if name.isdecimal() and len(name) < 20:
            return whole("a message id", int(name), 2**24 - 1)
        msgid = getattr(self.dialect, f"MAVLINK_MSG_ID_{name}", None)
        if msgid is None:
            raise ConfigError(f"the dialect has no message {name!r}")
        return int(msgid)


def _add(core: BridgeCore, link: EndpointOptions) -> None:
    try:
        core.add(link)
    except OSError as error:
        # A name alone does not say what cannot be opened.
        if error.filename == link.name != str(link.endpoint):
            error.filename = f"{link.name} ({link.endpoint})"
        raise


def _core_class() -> type[BridgeCore]:
    if os.name != "posix":
        raise OSError("bridges need a system with POSIX sockets")
    from mavwire._native import BridgeCore

    return BridgeCore


def _module(dialect: Dialects) -> Any:
    from mavwire.logs.dialect import dialect_module

    try:
        return dialect_module(dialect)
    except ValueError as error:
        raise ConfigError(f"dialect: {error}") from None
