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
import signal
import sys
import time
from argparse import ArgumentParser, ArgumentTypeError, Namespace
from contextlib import ExitStack, suppress
from typing import TYPE_CHECKING, Any

from mavwire.cli._errors import CommandError, describe_link_error
from mavwire.cli.sim import duration

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavwire.bridge import Bridge
    from mavwire.bridge.serving import HttpServer
    from mavwire.bridge.sinks import Sink

# How long the program sleeps at a time when there is nothing to show.
PAUSE = 0.5


def add_arguments(parser: ArgumentParser) -> None:
    """The options."""
    parser.add_argument("endpoints", metavar="ENDPOINT", nargs="*", help="a link")
    parser.add_argument(
        "--master",
        metavar="ENDPOINT",
        action="append",
        default=[],
        help="a link too: the word for the vehicle's, as MAVProxy has it",
    )
    parser.add_argument(
        "--out",
        metavar="ENDPOINT",
        action="append",
        default=[],
        help="a link too: the word for a ground station's",
    )
    parser.add_argument(
        "--config", metavar="FILE", help="links and options: TOML, or mavlink-router's main.conf"
    )
    routing = parser.add_argument_group("routing")
    routing.add_argument(
        "--dedup", type=duration, metavar="T",
        help="drop copies that arrive over another link within this time; 0 for none [default: 500ms]",
    )  # fmt: skip
    record = parser.add_argument_group("recording")
    record.add_argument("--record", metavar="DIR", help="record telemetry logs there")
    record.add_argument(
        "--record-size", type=size, metavar="SIZE", help="begin a new log at this size: 100M"
    )
    record.add_argument(
        "--record-time", type=duration, metavar="T", help="begin a new log after this time: 1h"
    )
    record.add_argument(
        "--record-flush", type=duration, metavar="T",
        help="write what came after this time at the latest [default: 1s]",
    )  # fmt: skip
    show = parser.add_argument_group("watching")
    show.add_argument("--status", action="store_true", help="a table that keeps up to date")
    show.add_argument(
        "--json", type=duration, metavar="T", help="print the counters as a line of JSON this often"
    )
    show.add_argument(
        "--metrics", type=listen_address, metavar="[HOST]:PORT",
        help="serve /metrics for Prometheus and /stats as JSON; HOST is 127.0.0.1 if not given",
    )  # fmt: skip
    show.add_argument(
        "--http", type=listen_address, metavar="[HOST]:PORT",
        help="serve a page with all messages, links and plots; HOST is 127.0.0.1 if not given, "
        "and on others the address that is printed has a token",
    )  # fmt: skip
    parser.add_argument(
        "--sink", metavar="ADDRESS", action="append", default=[],
        help="publish what comes: mqtt://HOST/PREFIX, mqtts://..., zenoh:, zenoh:tcp/HOST:PORT, "
        "or ws://HOST:PORT/PREFIX for others to connect to",
    )  # fmt: skip
    parser.add_argument("--duration", type=duration, metavar="T", help="end after this time")


def main(args: Namespace) -> int:
    """Run until interrupted or told to terminate, or for `--duration`."""
    before = signal.signal(signal.SIGTERM, _interrupt)
    try:
        return _run(_bridge(args), args)
    finally:
        signal.signal(signal.SIGTERM, before)


def _interrupt(number: int, frame: object) -> None:
    """End as Ctrl-C does, so that what is being recorded is written."""
    raise KeyboardInterrupt


def _run(bridge: Bridge, args: Namespace) -> int:
    try:
        bridge.start()
    except OSError as error:
        raise CommandError(describe_link_error(error)) from None
    except RuntimeError as error:
        raise CommandError(str(error)) from None
    last = None
    try:
        # Ctrl-C is the usual way to end it.
        with suppress(KeyboardInterrupt), ExitStack() as stack:
            beside: list[HttpServer | Sink] = []
            for one in _beside(bridge, args):
                stack.push(one)
                beside.append(one)
            print(_announcement(bridge, beside), file=sys.stderr, flush=True)
            _watch(bridge, args)
    finally:
        if args.json is not None:
            last = bridge.stats()
        bridge.stop()
    if last is not None:
        print(json.dumps(last), flush=True)
    return 0


def _bridge(args: Namespace) -> Bridge:
    from mavwire.bridge import Bridge, Config, ConfigError, Recording, load_config, parse_endpoint

    try:
        config = load_config(args.config) if args.config else Config()
        for warning in config.warnings:
            print(f"mavwire bridge: warning: {warning}", file=sys.stderr)
        for text in [*args.master, *args.out, *args.endpoints]:
            config.links.append((repr(text), parse_endpoint(text), {}))
        if not config.links:
            raise CommandError("nothing to route: name endpoints, or --config FILE", 2)
        if args.dedup is not None:
            config.settings["dedup"] = args.dedup
        recording = {
            "max_bytes": args.record_size,
            "max_age": args.record_time,
            "flush_interval": args.record_flush,
        }
        given: dict[str, Any] = {
            name: value for name, value in recording.items() if value is not None
        }
        if args.record is not None:
            config.recording = Recording(args.record, **given)
        elif given:
            raise CommandError("--record-size, --record-time and --record-flush need --record", 2)
        return Bridge.from_options(config)
    except ConfigError as error:
        raise CommandError(str(error), 2) from None
    except OSError as error:
        raise CommandError(describe_link_error(error)) from None


def _beside(bridge: Bridge, args: Namespace) -> Iterator[HttpServer | Sink]:
    """The HTTP servers and sinks that are asked for, opened one by one."""
    from mavwire.bridge.metrics import MetricsServer

    if args.metrics is not None:
        yield _served("--metrics", MetricsServer, bridge, args.metrics)
    if args.http is not None:
        from mavwire.bridge.inspector import Inspector

        try:
            yield _served("--http", Inspector, bridge, args.http)
        except ImportError:
            raise CommandError("--http needs wsproto: pip install 'mavwire[ws]'") from None
    for text in args.sink:
        yield _sink(bridge, text)


def _sink(bridge: Bridge, text: str) -> Sink:
    from mavwire.bridge import ConfigError
    from mavwire.bridge.sinks import open_sink

    try:
        return open_sink(bridge, text)
    except ImportError as error:
        word = text.partition(":")[0]
        extra = {"mqtts": "mqtt"}.get(word, word)
        raise CommandError(f"--sink: {error}: pip install 'mavwire[{extra}]'") from None
    except ConfigError as error:
        raise CommandError(f"--sink: {error}", 2) from None
    except OSError as error:
        raise CommandError(f"--sink: {error}") from None


def _served(
    option: str, server: type[HttpServer], bridge: Bridge, address: tuple[str, int]
) -> HttpServer:
    host, port = address
    try:
        return server(bridge, host, port)
    except OSError as error:
        raise CommandError(f"{option} {host}:{port}: {error.strerror or error}") from None


def _announcement(bridge: Bridge, beside: list[HttpServer | Sink]) -> str:
    stats = bridge.stats()
    links = dict.fromkeys(one["endpoint"] for one in stats["links"] if one["endpoint"])
    text = f"routing between {', '.join(links)}"
    if stats["recording"]:
        text += f"; recording to {stats['recording']['path']}"
    text += "".join(f"; {one.note}" for one in beside)
    return f"{text}; Ctrl-C ends it"


def _watch(bridge: Bridge, args: Namespace) -> None:
    from mavwire.cli._bridge_warnings import DropWarnings

    now = time.monotonic()
    end = math.inf if args.duration is None else now + args.duration
    interval = args.json or PAUSE
    due = now + interval
    show, warn = _shower(bridge, args), DropWarnings(bridge)
    try:
        while (now := time.monotonic()) < end:
            time.sleep(max(min(PAUSE, due - now, end - now), 0.0))
            if not args.status:  # which shows it
                warn()
            if time.monotonic() >= min(due, end):
                due = time.monotonic() + interval
                show()
    finally:
        getattr(show, "close", lambda: None)()
        if not args.status and bridge.running:
            warn(at_end=True)


def _shower(bridge: Bridge, args: Namespace) -> Any:
    if args.status:
        from mavwire.cli._bridge_status import StatusTable

        return StatusTable(bridge)
    if args.json is not None:
        return lambda: print(json.dumps(bridge.stats()), flush=True)
    return lambda: None


# -- values of options


def size(text: str) -> int:
    """1000, 500k, 100M, 2G."""
    units = {"k": 10**3, "m": 10**6, "g": 10**9}
    number, unit = (
        (text[:-1], units[text[-1:].lower()]) if text[-1:].lower() in units else (text, 1)
    )
    if not (number.isascii() and number.isdecimal() and len(number) < 15 and int(number)):
        raise ArgumentTypeError(f"not a size: {text!r}; say 500k, 100M or 2G")
    return int(number) * unit


def listen_address(text: str) -> tuple[str, int]:
    """[HOST]:PORT."""
    host, _, port = text.rpartition(":")
    if not (port.isascii() and port.isdecimal() and len(port) < 6 and int(port) < 65536):
        raise ArgumentTypeError(f"not [HOST]:PORT: {text!r}")
    return host.strip("[]") or "127.0.0.1", int(port)
