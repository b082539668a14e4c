"""Route MAVLink between serial ports, UDP and TCP; filter, record and count it.

Endpoints are written as for mavlink_connection or as for mavp2p:
  udpin:HOST:PORT (udps)      listen; answers go to each peer that sent a good frame
  udpout:HOST:PORT (udpc)     send there, and listen to that peer
  udpbcast:HOST:PORT (udpb)   send to a broadcast address
  tcpin:HOST:PORT (tcps)      wait for connections
  tcp:HOST:PORT (tcpc)        connect, again and again
  serial:DEVICE:BAUD          a serial port; DEVICE,BAUD too

examples:
  mavwire bridge --master /dev/ttyACM0,115200 --out udpout:10.0.0.2:14550 --out tcpin:0.0.0.0:5760
  mavwire bridge serial:/dev/ttyAMA0:57600 udps:0.0.0.0:5600 --record logs/
  mavwire bridge --config main.conf --status
  mavwire bridge udpin:0.0.0.0:14550 --http :8080
"""

from __future__ import annotations

import json
import math
import time
from argparse import ArgumentParser, ArgumentTypeError, Namespace
from collections.abc import Iterator
from contextlib import ExitStack, suppress
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from mavwire._signals import ended_in_order
from mavwire.cli._errors import CommandError, describe_link_error, refused, tell
from mavwire.cli._shared_arguments import add_shared
from mavwire.cli._values import duration, size

if TYPE_CHECKING:
    from mavwire.bridge import Bridge, Config
    from mavwire.bridge.sidecars import Listen, SinkOptions
    from mavwire.bridge.sinks import Sink
    from mavwire.bridge.web_server import WebServer
    from mavwire.cli.bridge._bridge_warnings import DropWarnings

# How long the program sleeps at a time when there is nothing to show.
PAUSE = 0.5


def add_arguments(parser: ArgumentParser) -> None:
    # fmt: off
    add = parser.add_argument
    link: dict[str, Any] = {"metavar": "ENDPOINT", "action": "append", "default": []}
    add("endpoints", metavar="ENDPOINT", nargs="*", help="a link")
    add("--master", help="a link too: the word for the vehicle's, as MAVProxy has it", **link)
    add("--out", help="a link too: the word for a ground station's", **link)
    add("--config", metavar="FILE", help="links and options: TOML, or mavlink-router's main.conf")
    add = parser.add_argument_group("routing").add_argument
    add(
        "--dialect", metavar="NAME", action="append",
        help="dialect or XML file; may be repeated: the first that knows an id names it [default: upstream]",
    )
    add(
        "--forward-unverified", action="store_true",
        help="let the links named here forward frames whose definition differs from the dialect's",
    )
    add(
        "--dedup", type=duration, metavar="T",
        help="drop copies that arrive over another link within this time; 0 for none [default: 500ms]",
    )
    add(
        "--max-age", type=duration, metavar="T",
        help="how long a system is known at a link after it was heard there [default: 1m]",
    )
    add(
        "--sniffer-sysid", type=int, metavar="SYSTEM",
        help="links where this system is heard get every frame",
    )
    add = parser.add_argument_group("recording").add_argument
    add("--record", metavar="DIR", help="record telemetry logs there")
    add("--record-size", type=size, metavar="SIZE", help="begin a new log at this size: 100M")
    add("--record-time", type=duration, metavar="T", help="begin a new log after this time: 1h")
    add(
        "--record-flush", type=duration, metavar="T",
        help="write what came after this time at the latest [default: 1s]",
    )
    watching = parser.add_argument_group("watching")
    add_shared(watching, "event_definitions")
    add = watching.add_argument
    add("--status", action="store_true", help="a table that keeps up to date")
    add("--json", type=duration, metavar="T", help="print the counters as a line of JSON this often")
    for option, what in (
        ("--metrics", "/metrics for Prometheus and /stats as JSON"),
        ("--http", "a page with all messages, links and plots"),
    ):
        add(
            option, type=listen_address, metavar="[HOST]:PORT",
            help=f"serve {what}; HOST is 127.0.0.1 if not given",
        )
    parser.add_argument(
        "--sink", metavar="ADDRESS", action="append", default=[],
        help="publish what comes: mqtt://HOST/PREFIX, mqtts://..., zenoh:, zenoh:tcp/HOST:PORT, "
        "or ws://HOST:PORT/PREFIX for others to connect to",
    )
    parser.add_argument("--duration", type=duration, metavar="T", help="end after this time")
    # fmt: on


def main(args: Namespace) -> int:
    """Run until interrupted or told to terminate, or for `--duration`."""
    with ended_in_order():  # what is being recorded is written
        return _run(*_bridge(args), args)


def _run(bridge: Bridge, config: Config, args: Namespace) -> int:
    # Not once it is announced: a Ctrl-C while a class is made by `exec` ends Python with SIGINT, caught or not.
    from mavwire.cli.bridge._bridge_warnings import DropWarnings

    warn = DropWarnings(bridge)
    with refused(OSError, RuntimeError):
        bridge.start()
    last = None
    try:
        # Ctrl-C is the usual way to end it.
        with suppress(KeyboardInterrupt), ExitStack() as stack:
            beside: list[WebServer | Sink] = []
            for server in _servers(bridge, config):
                beside.append(stack.enter_context(server))
            for options in config.sinks:  # which the bridge closes, all of them together
                beside.append(_sink(bridge, options))
            try:  # a script that reads the announcement may end the bridge at once
                tell(_announcement(bridge, beside))
                _watch(bridge, warn, args)
            finally:
                if args.json is not None:
                    last = bridge.stats()
    finally:
        bridge.stop()
    if last is not None:
        print(json.dumps(last), flush=True)
    return 0


def _bridge(args: Namespace) -> tuple[Bridge, Config]:
    """The bridge, not running yet, and what the file and the options say together."""
    from mavwire.bridge import Bridge, Config, ConfigError, Recording, load_config, parse_endpoint
    from mavwire.bridge.checks import seconds

    with refused(OSError), refused(ConfigError, exit_code=2):
        config = load_config(args.config) if args.config else Config()
        for warning in config.warnings:
            tell(f"mavwire bridge: warning: {warning}")
        for text in [*args.master, *args.out, *args.endpoints]:
            options = {"forward_unverified": True} if args.forward_unverified else {}
            config.links.append((repr(text), parse_endpoint(text), options))
        if not config.links:
            raise CommandError("nothing to route: name endpoints, or --config FILE", 2)
        for name in ("dedup", "max_age", "sniffer_sysid"):
            if getattr(args, name) is not None:
                config.settings[name] = getattr(args, name)
        config.dialect = args.dialect or config.dialect
        _add_options(config, args)
        if args.json is not None:
            seconds("--json", args.json, least=1e-3)
        limits = {
            "max_bytes": args.record_size, "max_age": args.record_time,
            "flush_interval": args.record_flush,
        }  # fmt: skip
        given = {name: value for name, value in limits.items() if value is not None}
        if args.record is not None:
            try:
                config.recording = Recording(args.record, **given)
            except ConfigError as error:
                raise error.at("--record") from None
        elif given:
            raise CommandError("--record-size, --record-time and --record-flush need --record", 2)
        bridge = Bridge.from_options(config)
        bridge.event_definitions = args.event_definitions
        return bridge, config


def _add_options(config: Config, args: Namespace) -> None:
    """Options say more than the file, or something else."""
    from mavwire.bridge.sidecars import Listen, SinkOptions

    for name in ("http", "metrics"):
        if getattr(args, name) is not None:
            host, port = getattr(args, name)
            known = getattr(config, name) or Listen(host, port)
            place = f"--{name} {host}:{port}"
            setattr(config, name, replace(known, host=host, port=port, place=place))
    config.sinks += [SinkOptions(text, place="--sink") for text in args.sink]
    if args.json is None:
        args.json = config.json


def _servers(bridge: Bridge, config: Config) -> Iterator[WebServer]:
    """The web servers that are asked for, opened one by one."""
    try:
        if config.metrics is not None:
            from mavwire.bridge.metrics import MetricsServer

            yield _served(MetricsServer, bridge, config.metrics)
        if config.http is not None:
            from mavwire.bridge.inspector_server import Inspector

            yield _served(Inspector, bridge, config.http)
    except ImportError as error:
        first = config.metrics or config.http
        assert first is not None
        raise CommandError(f"{first.place}: {error}") from None


def _sink(bridge: Bridge, options: SinkOptions) -> Sink:
    from mavwire.bridge import ConfigError
    from mavwire.bridge.sinks import open_sink

    try:
        password, names = options.password, options.names
        return open_sink(bridge, options.address, password=password, names=names)
    except ImportError as error:
        raise CommandError(f"{options.place}: {error}") from None
    except ConfigError as error:
        raise CommandError(f"{options.place}: {error}", 2) from None
    except OSError as error:
        raise CommandError(f"{options.place}: {describe_link_error(error)}") from None


def _served(server: type[WebServer], bridge: Bridge, where: Listen) -> WebServer:
    try:
        return server(bridge, where.host, where.port, names=where.names)
    except OSError as error:
        raise CommandError(f"{where.place}: {error.strerror or error}") from None


def _announcement(bridge: Bridge, beside: list[WebServer | Sink]) -> str:
    stats = bridge.stats()
    links = dict.fromkeys(one["endpoint"] for one in stats["links"] if one["endpoint"])
    text = f"routing between {', '.join(links)}"
    if stats["recording"]:
        text += f"; recording to {stats['recording']['path']}"
    text += "".join(f"; {one.note}" for one in beside)
    return f"{text}; Ctrl-C ends it"


def _watch(bridge: Bridge, warn: DropWarnings, args: Namespace) -> None:
    now = time.monotonic()
    end = math.inf if args.duration is None else now + args.duration
    interval = args.json or PAUSE
    due = now + interval
    show = _shower(bridge, args)
    tells_losses = getattr(show, "is_live", False)
    try:
        while (now := time.monotonic()) < end:
            time.sleep(max(min(PAUSE, due - now, end - now), 0.0))
            if not tells_losses:
                warn()
            if time.monotonic() >= min(due, end):
                due = time.monotonic() + interval
                show()
    finally:
        getattr(show, "close", lambda: None)()
        if not tells_losses and bridge.running:
            warn(at_end=True)


def _shower(bridge: Bridge, args: Namespace) -> Any:
    if args.status:
        from mavwire.cli.bridge._bridge_status import StatusTable

        return StatusTable(bridge)
    if args.json is not None:
        return lambda: print(json.dumps(bridge.stats()), flush=True)
    return lambda: None


# -- values of options


def listen_address(text: str) -> tuple[str, int]:
    """[HOST]:PORT."""
    from mavwire.bridge import sidecars

    try:
        return sidecars.listen_address(text)
    except ValueError as error:
        raise ArgumentTypeError(str(error)) from None
