"""A bridge's counters over HTTP: `/metrics` for Prometheus, `/stats` as JSON."""

from __future__ import annotations

from .web_server import WebServer, web

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

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

    def family(name: str, kind: str, text: str, samples: list[tuple[dict[str, str], Any]]) -> None:
        lines.append(f"# HELP {PREFIX}_{name} {text}")
        lines.append(f"# TYPE {PREFIX}_{name} {kind}")
        for labels, value in samples:
            inner = ",".join(f'{key}="{_escaped(text)}"' for key, text in labels.items())
            lines.append(
                f"{PREFIX}_{name}{{{inner}}} {value}" if inner else f"{PREFIX}_{name} {value}"
            )

    family("uptime_seconds", "gauge", "seconds since the start", [({}, stats["uptime"])])
    links = [({"link": one["name"], "peer": one["peer"] or ""}, one) for one in stats["links"]]
    for key, text in LINK_COUNTERS.items():
        family(f"link_{key}_total", "counter", text, [(who, one[key]) for who, one in links])
    family("link_queued_bytes", "gauge", "bytes that wait to be sent",
           [(who, one["queued_bytes"]) for who, one in links])  # fmt: skip
    family("link_up", "gauge", "1 if the link is connected or listening",
           [(who, int(one["state"] in ("up", "listening"))) for who, one in links])  # fmt: skip
    overruns = [(who, one["overrun"]) for who, one in links if one["overrun"] is not None]
    family("link_overrun_total", "counter", "datagrams that the system dropped unread", overruns)
    family("link_latency_seconds", "summary", "from a frame's arrival to its leaving over the link",
           [({**who, "quantile": quantile}, one["latency"][key]) for who, one in links
            for key, quantile in QUANTILES.items() if one["latency"][key] is not None])  # fmt: skip
    components = [
        ({"system": str(one["system"]), "component": str(one["component"])}, one)
        for one in stats["components"]
    ]
    for key, text in COMPONENT_COUNTERS.items():
        samples = [(who, one[key]) for who, one in components]
        family(f"component_{key}_total", "counter", text, samples)
    recording = stats["recording"]
    for key, text in RECORDING_COUNTERS.items() if recording else ():
        family(f"recording_{key}_total", "counter", text, [({}, recording[key])])
    sinks = [({"sink": one["name"]}, one) for one in stats["sinks"]]
    for key, text in SINK_COUNTERS.items():
        family(f"sink_{key}_total", "counter", text, [(who, one[key]) for who, one in sinks])
    return "\n".join(lines) + "\n"


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
