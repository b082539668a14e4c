"""A bridge's counters over HTTP: `/metrics` for Prometheus, `/stats` as JSON."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from .web_server import WebServer, web

_Entries = list[tuple[dict[str, Any], dict[str, Any]]]
# Name, kind, help text, samples with their labels.
_Family = tuple[str, str, str, list[tuple[dict[str, Any], Any]]]

PREFIX = "mavwire_bridge"
# Key of `Bridge.stats()["links"]` -> what it counts.
LINK_COUNTERS = {
    "received": "frames received",
    "received_bytes": "bytes of frames received",
    "duplicates": "frames dropped that had come over another link",
    "filtered_in": "frames stopped by the inbound filter",
    "withheld": "frames with keys, which are not forwarded",
    "unroutable": "frames to a target that nobody knows",
    "sent": "frames sent",
    "sent_bytes": "bytes of frames sent",
    "filtered_out": "frames stopped by the outbound filter",
    "limited": "frames held back by rate limits",
    "dropped": "frames dropped because the link was down or too slow",
    "send_errors": "attempts to send that the system refused",
    "damaged": "damaged frames received",
    "junk_bytes": "bytes received that belong to no good frame",
    "unverified": "frames received without the signature that they need",
    "unconverted": "frames that the version of the link cannot carry",
    "refused": "peers turned away",
    "connections": "connections made",
}
# Key of a link's `latency` -> Prometheus' word for it.
QUANTILES = {"p50": "0.5", "p99": "0.99", "p99.9": "0.999"}
COMPONENT_COUNTERS = {
    "frames": "frames heard from a component",
    "bytes": "bytes of these frames",
    "lost": "frames missing in the sequence numbers",
    "duplicates": "copies of its frames that came over another link",
}
RECORDING_COUNTERS = {
    "records": "records written",
    "bytes": "bytes of records written",
    "dropped": "records that could not be written",
    "files": "logs begun",
}
# Key of an entry of `Bridge.stats()["sinks"]` -> what it counts.
SINK_COUNTERS = {
    "published": "frames published",
    "failed": "frames that did not leave whole",
    "dropped": "frames or messages dropped because an end was too slow",
}


def prometheus(stats: dict[str, Any]) -> str:
    """Statistics in Prometheus' text format."""
    lines: list[str] = []
    for name, kind, text, samples in _families(stats):
        lines.append(f"# HELP {PREFIX}_{name} {text}")
        lines.append(f"# TYPE {PREFIX}_{name} {kind}")
        for labels, value in samples:
            inner = ",".join(f'{key}="{_escaped(str(label))}"' for key, label in labels.items())
            lines.append(f"{PREFIX}_{name}{f'{{{inner}}}' if inner else ''} {value}")
    return "\n".join(lines) + "\n"


def _families(stats: dict[str, Any]) -> Iterator[_Family]:
    yield "uptime_seconds", "gauge", "seconds since the start", [({}, stats["uptime"])]
    yield from _link_families(
        [({"link": one["name"], "peer": one["peer"] or ""}, one) for one in stats["links"]]
    )
    components = [
        ({"system": one["system"], "component": one["component"]}, one)
        for one in stats["components"]
    ]
    yield from _counters("component", COMPONENT_COUNTERS, components)
    if stats["recording"]:
        yield from _counters("recording", RECORDING_COUNTERS, [({}, stats["recording"])])
    yield from _counters(
        "sink", SINK_COUNTERS, [({"sink": one["name"]}, one) for one in stats["sinks"]]
    )


def _link_families(links: _Entries) -> Iterator[_Family]:
    yield from _counters("link", LINK_COUNTERS, links)
    yield (
        "link_unknown_total", "counter", "frames that the dialect does not define",
        [({**who, "id": kind["id"], "crc_extra": kind["crc_extra"]}, kind["frames"])
         for who, one in links for kind in one["unknown"]],
    )  # fmt: skip
    yield (
        "link_queued_bytes", "gauge", "bytes that wait to be sent",
        [(who, one["queued_bytes"]) for who, one in links],
    )  # fmt: skip
    yield (
        "link_up", "gauge", "1 if the link is connected or listening",
        [(who, int(one["state"] in ("up", "listening"))) for who, one in links],
    )  # fmt: skip
    yield (
        "link_overrun_total", "counter", "datagrams that the system dropped unread",
        [(who, one["overrun"]) for who, one in links if one["overrun"] is not None],
    )  # fmt: skip
    yield (
        "link_latency_seconds", "summary", "from a frame's arrival to its leaving over the link",
        [({**who, "quantile": quantile}, one["latency"][key]) for who, one in links
         for key, quantile in QUANTILES.items() if one["latency"][key] is not None],
    )  # fmt: skip


def _counters(prefix: str, counters: dict[str, str], entries: _Entries) -> Iterator[_Family]:
    for key, text in counters.items():
        yield f"{prefix}_{key}_total", "counter", text, [(who, one[key]) for who, one in entries]


def _escaped(text: str) -> str:
    return text.replace("\\", r"\\").replace('"', r"\"").replace("\n", r"\n")


class MetricsServer(WebServer):
    """Answers `/metrics` and `/stats` on a thread, until it is closed. OSError if the port is taken."""

    purpose = "metrics"

    async def get(self, request: web.BaseRequest) -> web.Response:
        if request.path not in ("/metrics", "/stats"):
            raise web.HTTPNotFound
        stats = self.bridge.stats()
        if request.path == "/stats":
            return web.json_response(stats)
        return web.Response(
            text=prometheus(stats),
            headers={"Content-Type": "text/plain; version=0.0.4; charset=utf-8"},
        )
