"""A bridge's counters over HTTP: `/metrics` for Prometheus, `/stats` as JSON."""

from __future__ import annotations

import json
import threading
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Self

    from .bridge import Bridge

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
    "refused": "peers turned away",
    "connections": "connections made",
}
COMPONENT_COUNTERS = {
    "frames": "frames heard from a component",
    "bytes": "bytes of these frames",
    "lost": "frames missing in the sequence numbers",
}
RECORDING_COUNTERS = {
    "records": "records written",
    "bytes": "bytes of records written",
    "dropped": "records that could not be written",
    "files": "logs begun",
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
    return "\n".join(lines) + "\n"


def _escaped(text: str) -> str:
    return text.replace("\\", r"\\").replace('"', r"\"").replace("\n", r"\n")


class MetricsServer:
    """Answers HTTP requests about a bridge on a thread, until it is closed. OSError if the port is taken."""

    def __init__(self, bridge: Bridge, host: str, port: int) -> None:
        self._server = _Server((host, port), _Handler)
        self._server.bridge = bridge
        self._thread = threading.Thread(
            target=self._server.serve_forever, args=(0.1,), name="mavwire-metrics", daemon=True
        )
        self._thread.start()

    @property
    def port(self) -> int:
        """The port it listens on."""
        return int(self._server.server_address[1])

    def close(self) -> None:
        """Answer no more."""
        self._server.shutdown()
        self._server.server_close()
        self._thread.join()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()


class _Server(ThreadingHTTPServer):
    daemon_threads = True
    bridge: Bridge

    def handle_error(self, request: Any, client_address: Any) -> None:
        """A client that went away or talks nonsense is its own affair."""


class _Handler(BaseHTTPRequestHandler):
    server: _Server
    timeout = 10.0
    server_version = "mavwire"
    sys_version = ""

    def do_GET(self) -> None:
        path = self.path.partition("?")[0]
        if path not in ("/metrics", "/stats"):
            self.send_error(404)
            return
        try:
            stats = self.server.bridge.stats()
        except RuntimeError:
            self.send_error(503, "the bridge has stopped")
            return
        if path == "/stats":
            self._answer("application/json", json.dumps(stats))
        else:
            self._answer("text/plain; version=0.0.4; charset=utf-8", prometheus(stats))

    def _answer(self, content_type: str, text: str) -> None:
        body = text.encode()
        self.send_response(200)
        self.send_header("Content-Type", content_type)
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    def log_message(self, format: str, *args: Any) -> None:
        """Nothing: standard error belongs to the program."""
