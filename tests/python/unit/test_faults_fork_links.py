"""Links in processes that fork while other threads use them: the parent goes on, and the child can use them too."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from unit.faults import FORKS, python
from unit.link_tools import make_certificate

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork")

HEAD = (
    FORKS
    + r"""
import socket
def stream(**options):
    server = socket.create_server(("127.0.0.1", 0))
    link = mavutil.mavlink_connection(f"tcp:127.0.0.1:{server.getsockname()[1]}", **options)
    return link, server, server.accept()[0]
def heartbeat(link):
    link.mav.heartbeat_send(1, 2, 3, 4, 5)
def frames(peer, count):
    data = peer.recv(count * 21, socket.MSG_WAITALL)
    assert data[::21] == b"\xfd" * count, data
# Threads called "held", and those that connect, stand still before they do what is `held`, until the parent says `go`.
home, inside, go = os.getpid(), threading.Event(), threading.Event()
def held(act):
    def do(*arguments, **options):
        if os.getpid() == home and threading.current_thread().name.startswith(("held", "Dummy")):
            inside.set()
            go.wait()
        return act(*arguments, **options)
    return do
def hold(act, *arguments):
    thread = threading.Thread(target=act, args=arguments, name="held", daemon=True)
    thread.start()
    inside.wait()
    def let_go():
        go.set()
        thread.join()
    return let_go
"""
)

CASES = {
    "a stream that another thread sends on": r"""
link, server, peer = stream()
class Port:
    def __init__(self, port):
        self.send, self._port = held(port.send), port
    def __getattr__(self, name):
        return getattr(self._port, name)
link.port = Port(link.port)
let_go = hold(heartbeat, link)
def child():
    heartbeat(link)
    frames(peer, 1)
    assert link.recv_match() is None
    assert link.frames_dropped == 0
def parent():
    let_go()
    heartbeat(link)
    frames(peer, 2)
forks(child, parent)
""",
    "a frame that was begun and waits": r"""
class Slow:
    def send(self, data):
        if not self.room:
            raise BlockingIOError
        sent, self.room = data[:self.room], self.room - len(data[:self.room])
        taken.extend(sent)
        return len(sent)
link, server, peer = stream()
slow, taken = Slow(), bytearray()
slow.room = 5
link._send_frame(slow, b"one frame")
def each():
    slow.room = 100
    link._send_frame(slow, b"another")
    assert bytes(taken) == b"one frameanother"
forks(each, each)
""",
    "a link that is being connected": r"""
link, server, peer = stream(autoreconnect=True, reconnect_delay=0.01)
link._connect = held(link._connect)
peer.close()
while not inside.is_set():
    link.recv_match(blocking=True, timeout=0.01)
def each():
    while link.port is None:
        link.recv_match(blocking=True, timeout=0.01)
    heartbeat(link)
    frames(server.accept()[0], 1)
forks(each, lambda: (go.set(), each()))
""",
    "a serial port that another thread sends on": r"""
ends = os.openpty()
link = connect(os.ttyname(ends[1]))
link._send_frame = held(link._send_frame)
let_go = hold(heartbeat, link)
def each():
    heartbeat(link)
    assert len(os.read(ends[0], 21)) == 21
forks(each, lambda: (let_go(), each()))
""",
    "a serial port that is being opened": r"""
import serial
ends = os.openpty()
link = connect(os.ttyname(ends[1]))
serial.Serial = held(serial.Serial)
let_go = hold(link.reset)
def each():
    assert link.reset()
    heartbeat(link)
    assert len(os.read(ends[0], 21)) == 21
forks(each, lambda: (let_go(), each()))
""",
    "a child process": r"""
program = path + "/program"
with open(os.open(program, os.O_CREAT | os.O_WRONLY, 0o700), "w") as file:
    file.write("#!/bin/sh\nexec cat\n")
link = connect(f"exec:{program}")
def each():
    heartbeat(link)
    assert link.recv_match(blocking=True, timeout=60)
each()
forks(link.close, each)
""",
    "a recording": r"""
link, out = udp()
link.setup_logfile(path + "/recorded")
def each():
    heartbeat(out)
    assert link.recv_match(blocking=True, timeout=60)
each()
each()
def child():
    each()
    link.close()
def parent():
    child()
    assert os.path.getsize(path + "/recorded") == 4 * 29
forks(child, parent)
""",
}

# A server that sends back what it gets, and a link to it.
WEBSOCKET = """
import ssl, wsproto
listener = socket.create_server(("127.0.0.1", 0))
if len(sys.argv) > 2:
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.load_cert_chain(sys.argv[2])
    os.environ["SSL_CERT_FILE"] = sys.argv[2]
    listener = context.wrap_socket(listener, server_side=True)
def echo(peer):
    ws, data = wsproto.WSConnection(wsproto.ConnectionType.SERVER), b"..."
    while data:
        data = peer.recv(65536)
        ws.receive_data(data or None)
        for event in ws.events():
            if isinstance(event, wsproto.events.Request):
                peer.sendall(ws.send(wsproto.events.AcceptConnection()))
            elif isinstance(event, wsproto.events.BytesMessage):
                peer.sendall(ws.send(wsproto.events.BytesMessage(data=event.data)))
def serve():
    while True:
        threading.Thread(target=echo, args=(listener.accept()[0],), daemon=True).start()
threading.Thread(target=serve, daemon=True).start()
protocol = "wss" if len(sys.argv) > 2 else "ws"
link = mavutil.mavlink_connection(
    f"{protocol}:localhost:{listener.getsockname()[1]}", reconnect_delay=0.01
)
def each():
    heartbeat(link)
    while not link.recv_match(blocking=True, timeout=0.2):
        heartbeat(link)
each()
first = link.port
def child():
    each()
    assert link.port is not first
"""
WEBSOCKETS = {
    "wss": """
SSLSocket = type(listener)
SSLSocket.send = held(SSLSocket.send)
let_go = hold(heartbeat, link)
forks(child, lambda: (let_go(), each()))
""",
    "ws, closed by the child": """
def parent():
    each()
    assert link.port is first
forks(link.close, parent)
""",
    "ws": """
from wsproto.frame_protocol import FrameDecoder
FrameDecoder.process_buffer = held(FrameDecoder.process_buffer)
heartbeat(link)
def receive():
    while not inside.is_set():
        link.recv_msg()
let_go = hold(receive)
forks(child, lambda: (let_go(), each()))
""",
}


@pytest.mark.parametrize("name", CASES)
def test_a_link_in_use_survives_a_fork(name: str, tmp_path: Path) -> None:
    if "serial" in name:
        pytest.importorskip("serial")
    done = python(HEAD + CASES[name], str(tmp_path))
    assert (done.returncode, done.stderr) == (0, ""), name


@pytest.mark.parametrize("kind", WEBSOCKETS)
def test_a_websocket_in_use_survives_a_fork(
    kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("wsproto")
    certificate = [str(make_certificate(tmp_path, monkeypatch))] if kind == "wss" else []
    done = python(HEAD + WEBSOCKET + WEBSOCKETS[kind], str(tmp_path), *certificate)
    assert (done.returncode, done.stderr) == (0, ""), kind
