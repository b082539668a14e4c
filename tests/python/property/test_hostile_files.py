"""Any CSV file, configuration and request over HTTP is read, or refused in words."""

from __future__ import annotations

import json
import socket
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from mavwire import Bridge, mavutil
from mavwire.bridge import ConfigError, load_config
from mavwire.bridge.border import AUTOMATION_OPTIONS, BORDER_OPTIONS
from mavwire.bridge.main_conf import _KEYS
from mavwire.CSVReader import CSVReader
from property.hostile import PROFILE, ordinary
from watchdog import watched

CELLS = st.sampled_from(
    ["1", "2.5", "-0", "nan", "inf", "1e999", "9" * 400, "x", "", '"', '""', '"a;b"', '"a\nb"', "\0", "é",
     "\udc80", "'", " 7 ", "0x10", "1_000", "٣"]
) | st.text(max_size=6)  # fmt: skip
ROWS = st.lists(st.lists(CELLS, max_size=4).map(";".join), max_size=6)


@PROFILE
@given(heads=st.sampled_from(["t;x", "t", "", "t;t;__class__;_timestamp", "MAV;line;fmt"]), rows=ROWS,
       end=st.sampled_from(["\n", "\r\n", "\r"]))  # fmt: skip
def test_any_csv_log(heads: str, rows: list[str], end: str, tmp_path: Path) -> None:
    """R67: the same rows each time, as many as are counted, and an end."""
    path = tmp_path / "log.csv"
    path.write_bytes(end.join([heads, *rows]).encode("utf-8", "surrogateescape"))
    with watched():
        try:
            log: Any = CSVReader(str(path))
        except ValueError as error:
            assert str(path) in str(error)
            return
        with log:
            found = [msg.line for msg in iter(log.recv_msg, None)]
            assert len(found) <= sum(row.count("\n") + row.count("\r") + 1 for row in rows)
            log.rewind()
            again = list(iter(log.recv_msg, None))
            assert [str(msg.line) for msg in again] == [str(line) for line in found]
            for msg in again:
                assert msg.get_type() == "CSV"
                assert str(msg)
                assert msg.to_dict()["mavpackettype"]
                with ordinary():
                    assert msg._timestamp is not NotImplemented
            log.rewind()
            with ordinary():
                log.recv_match(condition="CSV.x > 1")
        with mavutil.mavlink_connection(f"csv:{path}") as link:
            assert sum(1 for _ in iter(link.recv_msg, None)) == len(found)


VALUES = st.recursive(
    st.sampled_from(
        [0, 1, -1, 255, 256, 14550, 70000, 1 << 70, 0.5, -1.0, 1e300, True, False, "", "x", "udpin", "normal",
         "server", "udpin:127.0.0.1:0", "tcp:[::1]:5", "/dev/ttyX:9", "all", "no", "HEARTBEAT", "1.2.3.4",
         "mqtt:h:1", "\0", "a.b", "9" * 30]
    ),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.sampled_from("ab"), inner, max_size=2),
    max_leaves=4,
)  # fmt: skip
# What a table needs, and what else may be in it.
TABLES: dict[str, tuple[list[str], list[str]]] = {
    "[[link]]": (
        ['endpoint = "udpin:127.0.0.1:0"'],
        ["name", "group", "private", "sniffer", "forward_unverified", "bytes_per_second", "rate", "rates", "queue_bytes",
         "datagram_bytes", "peer_timeout", "retry", "urgent", "read_only", "silent", "allow_messages_in",
         "block_messages_out", "allow_systems_in", "block_components_out", *BORDER_OPTIONS, *AUTOMATION_OPTIONS],
    ),
    "[record]": (['directory = "x"'], ["max_bytes", "max_age", "flush_interval"]),
    "[[sink]]": (['address = "mqtt:h"'], ["topic", "username", "password_file", "rate", "name", "format"]),
    "[http]": (['listen = "127.0.0.1:0"'], ["token", "names", "host"]),
    "[metrics]": (['listen = ":0"'], ["names"]),
    "": ([], ["dedup", "max_age", "sniffer_sysid", "dialect", "json", "record", "http", "link", "nothing"]),
}  # fmt: skip


def toml(value: Any) -> str:
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key} = {toml(one)}" for key, one in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(toml, value)) + "]"
    return json.dumps(value)


@st.composite
def toml_files(draw: st.DrawFn) -> str:
    """The plain keys first; each other table once, links as often as they like."""
    titles = [
        "",
        *draw(st.lists(st.sampled_from(sorted(set(TABLES) - {""})), max_size=4, unique=True)),
    ]
    lines = []
    for title in titles + ["[[link]]"] * draw(st.integers(0, 2)):
        needed, optional = TABLES[title]
        given_too = draw(st.dictionaries(st.sampled_from(optional), VALUES, max_size=2))
        lines += [title, *needed, *(f"{key} = {toml(value)}" for key, value in given_too.items())]
    return "\n".join(lines)


SECTIONS = {
    "general": ("[General]", []),
    "udpendpoint": ("[UdpEndpoint a]", ["Mode = Normal", "Address = 127.0.0.1", "Port = 14550"]),
    "tcpendpoint": ("[TcpEndpoint b]", ["Address = 127.0.0.1", "Port = 5760"]),
    "uartendpoint": ("[UartEndpoint c]", ["Device = /dev/x"]),
}
WORDS = st.sampled_from(
    [
        "1",
        "0,1,255",
        "300",
        "true",
        "x",
        "",
        "server",
        "Eavesdropping",
        "-1",
        "1,",
        "57600,x",
        "9" * 5000,
        "\0",
    ]
)


@st.composite
def main_confs(draw: st.DrawFn) -> str:
    lines = []
    for kind in draw(st.lists(st.sampled_from(sorted(SECTIONS)), max_size=4)):
        title, needed = SECTIONS[kind]
        lines += [title, *needed]
        for key in draw(st.lists(st.sampled_from(sorted(_KEYS[kind])), max_size=2)):
            lines.append(f"{key} = {draw(WORDS)}")
        lines += draw(st.lists(st.sampled_from(["# c", "", "x", "=", "[", "key = 1"]), max_size=1))
    return "\n".join(lines)


@pytest.mark.parametrize("name", ["bridge.toml", "main.conf"])
@PROFILE
@given(data=st.data())
def test_any_configuration_of_known_words(name: str, data: st.DataObject, tmp_path: Path) -> None:
    """R69: a bridge, which is not started, or an error that names the file."""
    path = tmp_path / name
    text = data.draw(toml_files() if name.endswith("toml") else main_confs())
    path.write_text(text, encoding="utf-8", errors="surrogatepass")
    with watched():
        try:
            config = load_config(path)
            assert all(str(path) in warning for warning in config.warnings)
            Bridge.from_options(config)
        except ConfigError as error:
            assert str(path) in str(error)
        except OSError:  # a key's file that is not there
            assert "key" in text


LONG = "a line that is too long"
LINES = st.sampled_from(
    ["Host: localhost", "Host: evil", "Host: [", "Host: [::1]:8", "Origin: http://x", "Origin: http://[",
     "Upgrade: websocket",
     "Connection: Upgrade", "Sec-WebSocket-Version: 13", "Sec-WebSocket-Version: x",
     "Sec-WebSocket-Key: a2tra2tra2tra2tra2traw==", "Sec-WebSocket-Key: \xff", "Content-Length: 99999999999999999999",
     "Transfer-Encoding: chunked", "Expect: 100-continue", "Range: bytes=0-", ": x", "x", " folded", LONG,
     "Sec-WebSocket-Extensions: permessage-deflate; x", "Sec-WebSocket-Protocol: ,,"]
) | st.text(st.characters(max_codepoint=255), max_size=30)  # fmt: skip
PATHS = st.sampled_from(
    ["/", "/ws", "/metrics", "/../x", "/%00", "//", "*", "http://x/ws", "/ws?x=1", "/\xff", ""]
)
REQUESTS = st.builds(
    lambda method, path, version, lines: "\r\n".join(
        [f"{method} {path} {version}", *lines, "", ""]
    ),
    st.sampled_from(["GET", "POST", "HEAD", "OPTIONS", "get", ""]),
    PATHS,
    st.sampled_from(["HTTP/1.1", "HTTP/1.0", "HTTP/0.9", "HTTP/9.9", "HTTP/x", ""]),
    st.lists(LINES, max_size=8),
)
UPGRADE = "\r\n".join(
    ["GET /ws HTTP/1.1", "Host: localhost", "Upgrade: websocket", "Connection: Upgrade", "Sec-WebSocket-Version: 13",
     "Sec-WebSocket-Key: a2tra2tra2tra2tra2traw==", "", ""]
)  # fmt: skip
BAD_UPGRADES = [
    UPGRADE.replace("Host: localhost\r\n", ""),
    UPGRADE.replace("Upgrade:", "Transfer-Encoding: chunked\r\n" * 2 + "Upgrade:", 1),
    UPGRADE.replace("Upgrade:", "Content-Length: x\r\nUpgrade:", 1),
]
PIECES = st.binary(max_size=60) | st.builds(
    lambda head, length, rest: bytes([head, length]) + rest,
    st.sampled_from([0x81, 0x82, 0x01, 0x00, 0x80, 0x88, 0x89, 0x8A, 0xF1, 0x83]),
    st.sampled_from([0x80, 0x82, 0x85, 0xFE, 0xFF, 0x00, 0x7D]),
    st.binary(max_size=40) | st.just(b"\0" * 4 + b'{"open": [[1, 1, 0]]}'),
)
CONVERSATIONS = st.lists(PIECES, max_size=6).map(
    lambda pieces: UPGRADE.encode("latin-1") + b"".join(pieces)
)


@pytest.fixture(scope="module")
def server() -> Iterator[tuple[int, list[BaseException]]]:
    """Port of an inspector, and what its handlers raised that is no end of a connection."""
    pytest.importorskip("aiohttp")
    from aiohttp import web
    from mavwire.bridge.inspector_server import Inspector

    raised: list[BaseException] = []

    class Watched(Inspector):
        async def get(self, request: web.BaseRequest) -> web.StreamResponse:
            try:
                return await super().get(request)
            except (OSError, web.HTTPException):
                raise
            except Exception as error:
                raised.append(error)
                raise

    with Bridge(["udpin:127.0.0.1:0"]) as bridge, Watched(bridge, "127.0.0.1", 0) as inspector:
        yield inspector.port, raised


def answer(port: int, data: bytes) -> bytes:
    """Everything that is said to who says this, and no more."""
    found = b""
    with socket.create_connection(("127.0.0.1", port), 60) as client:
        try:
            client.sendall(data)
            client.shutdown(socket.SHUT_WR)
            while piece := client.recv(65536):
                found += piece
        except OSError:  # hung up on
            pass
    return found


@PROFILE
@given(
    data=REQUESTS.map(lambda text: text.encode("latin-1", "replace"))
    | CONVERSATIONS
    | st.binary(max_size=99)
)
def test_any_request_over_http(data: bytes, server: tuple[int, list[BaseException]]) -> None:
    """R65, R69: it is answered or hung up on, no handler fails, and the next one is served."""
    port, raised = server
    with watched():
        answer(port, data.replace(LONG.encode(), b"A" * 70_000))
        served = answer(port, b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n")
    assert served.startswith(b"HTTP/1.1 200 "), served[:80]
    assert raised == []


@pytest.mark.parametrize("request_text", BAD_UPGRADES)
def test_an_upgrade_that_http_forbids_is_refused(
    request_text: str, server: tuple[int, list[BaseException]]
) -> None:
    port, raised = server
    assert b" 400 " in answer(port, request_text.encode()).partition(b"\r\n")[0]
    assert raised == []
