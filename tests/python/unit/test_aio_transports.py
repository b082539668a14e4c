"""Every transport of `mavlink_connection` in a loop: receiving, sending, losing the other end."""

from __future__ import annotations

import asyncio
import os
import shutil
import socket
import ssl
import stat
import subprocess
import sys
from contextlib import AsyncExitStack

import pytest
from mavwire import aio, mavutil
from unit.aio_tools import LOOPS, WAIT, eventually, has, run
from unit.link_tools import free_port, heartbeat


@pytest.fixture(params=LOOPS)
def loop(request):
    return LOOPS[request.param]


pytestmark = pytest.mark.usefixtures("mavlink20")


async def converse(one, other, rounds=3):
    """Both send and both receive what the other sent, `other` first, which knows where to. Datagrams
    may need to be sent again."""
    for seq in range(rounds):
        for sender, receiver in ((other, one), (one, other)):
            msg = None
            while msg is None:
                sender.mav.heartbeat_send(6, 8, 0, seq, 0)
                await sender.drain()
                condition = f"HEARTBEAT.custom_mode=={seq}"
                msg = await receiver.recv_match(condition, "HEARTBEAT", timeout=0.5)


def test_links_that_open_at_once_have_their_own_dialects(loop):
    async def dialect(name):
        async with aio.connect("udpin:127.0.0.1:0", dialect=name) as link:
            return type(link.sync.mav).__module__.rpartition(".")[2]

    async def every(names):
        return await asyncio.gather(*map(dialect, names))

    names = ["upstream", "common", "all", "minimal"] * 3
    assert run(every(names), loop) == names


# Kind of link -> the end that listens, and what the other one connects to when it knows the port.
PAIRS = {
    "udp": ("udpin:127.0.0.1:0", "udpout:localhost:{}"),
    "udpbcast": ("udp:0.0.0.0:0", "udpbcast:127.255.255.255:{}"),
    "tcp": ("tcpin:127.0.0.1:0", "tcp:127.0.0.1:{}"),
    "mcast": ("mcast:{}", "mcast:{}"),
    "ws": ("wsserver:127.0.0.1:0", "ws:127.0.0.1:{}"),
}


def port_of(link):
    """Where a link listens."""
    listening = getattr(link.sync, "listen", None) or link.sync.port
    return listening.getsockname()[1]


@pytest.mark.parametrize("kind", ["udp", "udpbcast", "tcp", "mcast", "ws"])
def test_both_ways(kind, loop):
    if kind == "ws" and not has("wsproto"):
        pytest.skip("wsproto is not installed")
    if kind == "mcast":
        skip_without_multicast()
    server, client = PAIRS[kind]
    if kind == "mcast":
        server = server.format(free_port(socket.SOCK_DGRAM))

    async def main():
        async with AsyncExitStack() as links:
            one = await links.enter_async_context(aio.connect(server, source_system=1))
            # A WebSocket client waits for the answer to its handshake in the background.
            opening = aio.connect(client.format(port_of(one)), source_system=2)
            other = await links.enter_async_context(opening)
            await converse(one, other)
            assert (one.frames_dropped, other.frames_dropped) == (0, 0)

    run(main(), loop)


def skip_without_multicast():
    try:
        link = mavutil.mavlink_connection(f"mcast:{free_port(socket.SOCK_DGRAM)}")
        link.mav.heartbeat_send(6, 8, 0, 0, 0)
        works = link.write_errors == 0
        link.close()
    except OSError:
        works = False
    if not works:
        pytest.skip("no multicast here")


def test_unix_domain_sockets(loop, tmp_path):
    path = str(tmp_path / "s")

    async def main():
        connected = asyncio.get_running_loop().create_future()

        def accept(reader, writer):
            connected.set_result((reader, writer))

        server = await asyncio.start_unix_server(accept, path)
        async with aio.connect(f"uds:{path}") as link:
            reader, writer = await connected
            writer.write(heartbeat(5))
            assert (await link.recv_match(timeout=WAIT)).get_seq() == 5
            link.mav.heartbeat_send(6, 8, 0, 0, 0)
            assert (await reader.readexactly(10))[0] == 0xFD
            writer.close()
        server.close()

    run(main(), loop)


def test_a_serial_port_is_unplugged_and_plugged_in_again(loop, tmp_path, capsys):
    pytest.importorskip("serial")
    pytest.importorskip("tty")
    device = tmp_path / "port"

    async def main():
        ends = plug_in(device)
        async with aio.connect(
            str(device), baud=57600, autoreconnect=True, reconnect_delay=0.02
        ) as link:
            os.write(ends[0], heartbeat(1) + heartbeat(2)[:9])
            assert (await link.recv_match(timeout=WAIT)).get_seq() == 1
            link.mav.heartbeat_send(6, 8, 0, 0, 0)
            await link.drain()
            assert os.read(ends[0], 100)[0] == 0xFD
            for end in ends:
                os.close(end)
            device.unlink()
            await eventually(lambda: not link.connected)
            link.mav.heartbeat_send(6, 8, 0, 0, 0)
            assert link.frames_dropped == 1
            ends = plug_in(device)
            await eventually(lambda: link.connected)
            os.write(ends[0], heartbeat(3))
            assert (await link.recv_match(type="HEARTBEAT", timeout=WAIT)).get_seq() == 3
        for end in ends:
            os.close(end)

    run(main(), loop)
    assert capsys.readouterr().out == ""


def plug_in(device):
    import tty

    vehicle, port = os.openpty()
    for end in (vehicle, port):
        tty.setraw(end)
    device.unlink(missing_ok=True)
    device.symlink_to(os.ttyname(port))
    return vehicle, port


def test_a_serial_port_that_takes_nothing_does_not_block(tmp_path):
    pytest.importorskip("serial")
    pytest.importorskip("tty")
    device = tmp_path / "port"

    async def main():
        vehicle, port = plug_in(device)
        async with aio.connect(str(device)) as link:
            sent = 3000
            for _ in range(sent):
                link.mav.heartbeat_send(6, 8, 0, 0, 0)
            drained = asyncio.create_task(link.drain())
            await asyncio.sleep(0.02)
            assert not drained.done()
            received = b""
            os.set_blocking(vehicle, False)
            while not drained.done() or len(received) < sent * 21:
                try:
                    received += os.read(vehicle, 65536)
                except BlockingIOError:
                    await asyncio.sleep(0.001)
            assert received.count(b"\xfd\x09\x00\x00") == sent
            assert link.frames_dropped == 0
        os.close(vehicle)
        os.close(port)

    run(main())


def test_a_child_process(loop, tmp_path):
    program = tmp_path / "vehicle"
    program.write_text(
        f"#!{sys.executable}\nimport os\n"
        "while frame := os.read(0, 21):\n"
        "    os.write(1, frame)\n    if frame[4] == 4: break\n"
    )
    program.chmod(program.stat().st_mode | stat.S_IXUSR)

    async def main():
        async with aio.connect(f"exec:{program}") as link:
            for seq in range(5):
                link.mav.heartbeat_send(6, 8, 0, 0, 0)
                assert (await link.recv_match(timeout=WAIT)).get_seq() == seq
            with pytest.raises(aio.LinkClosedError, match="gone"):
                await link.recv_match(timeout=WAIT)

    run(main(), loop)


def test_tcp_servers_take_the_next_client(loop):
    async def main():
        async with aio.connect("tcpin:127.0.0.1:0") as link:
            for seq in range(3):
                _, writer = await asyncio.open_connection("127.0.0.1", port_of(link))
                writer.write(heartbeat(seq) + heartbeat(9)[:5])
                assert (await link.recv_match(type="HEARTBEAT", timeout=WAIT)).get_seq() == seq
                writer.close()
                await writer.wait_closed()

    run(main(), loop)


class Server:
    """A TCP server that can be taken down and put up again."""

    def __init__(self):
        self.port = free_port()
        self.connections = 0
        self.hangs_up = False
        self.says = b""
        self.writer = None

    def _accept(self, reader, writer):
        self.connections += 1
        self.reader, self.writer = reader, writer
        if self.hangs_up:
            writer.write(self.says)
            writer.close()

    async def up(self):
        self.server = await asyncio.start_server(self._accept, "127.0.0.1", self.port)

    async def down(self):
        self.server.close()
        self.writer.transport.abort()
        self.writer = None  # until the next connection is accepted
        await asyncio.sleep(0)


def test_a_tcp_connection_that_breaks_is_made_again(loop):
    async def main():
        server = Server()
        await server.up()
        options = {"autoreconnect": True, "reconnect_delay": 0.01}
        async with aio.connect(f"tcp:127.0.0.1:{server.port}", **options) as link:
            stream = link.stream("HEARTBEAT")
            for seq in range(3):
                await eventually(lambda: link.connected and server.writer)
                server.writer.write(heartbeat(seq) + heartbeat(9)[:7])
                assert (await asyncio.wait_for(anext(stream), WAIT)).get_seq() == seq
                await server.down()
                await eventually(lambda: not link.connected)
                link.mav.heartbeat_send(6, 8, 0, 0, 0)
                assert link.frames_dropped == seq + 1
                await asyncio.sleep(0.03)
                await server.up()
            await eventually(lambda: link.connected)
            server.server.close()

    run(main(), loop)


def test_why_a_connection_does_not_come_back_is_told(caplog):
    """Once for each reason, as with links of mavutil."""

    async def main():
        server = Server()
        await server.up()
        options = {"autoreconnect": True, "reconnect_delay": 0.01}
        async with aio.connect(f"tcp:127.0.0.1:{server.port}", **options) as link:
            await eventually(lambda: server.writer)
            assert link.sync.connect_error is None
            await server.down()
            await eventually(lambda: link.sync.connect_error)
            first = link.sync.connect_error
            assert isinstance(first, ConnectionRefusedError)
            await eventually(lambda: link.sync.connect_error is not first)
            await server.up()
            await eventually(lambda: link.connected)
            assert link.sync.connect_error is None
            await eventually(lambda: server.writer)
            await server.down()

    run(main())
    told = [one.getMessage() for one in caplog.records if one.name == "mavwire.mavutil"]
    assert told[0].endswith("trying again")
    assert len(told) <= 2  # the connection was lost twice


@pytest.mark.parametrize("says", [b"", heartbeat()], ids=["nothing", "a message"])
def test_a_peer_that_only_hangs_up_is_left_in_peace(says):
    """Each attempt waits longer, though connecting itself succeeds."""

    async def main():
        server = Server()
        server.hangs_up, server.says = True, says
        await server.up()
        options = {"autoreconnect": True, "reconnect_delay": 1000}
        async with aio.connect(f"tcp:127.0.0.1:{server.port}", **options) as link:
            await eventually(lambda: server.connections == 2 and not link.connected)
            await asyncio.sleep(0.2)
            assert server.connections == 2
        server.server.close()

    run(main())


def test_without_reconnection_a_stream_ends_with_its_peer(loop, capsys):
    async def main():
        server = Server()
        await server.up()
        async with aio.connect(f"tcp:127.0.0.1:{server.port}") as link:
            stream = link.stream()
            await eventually(lambda: server.writer)
            server.writer.write(heartbeat(1) + heartbeat(2))
            server.writer.close()
            assert [msg.get_seq() async for msg in stream] == [1, 2]
            assert not link.connected
            with pytest.raises(aio.LinkClosedError, match="gone"):
                await link.recv_match()
        server.server.close()

    run(main(), loop)
    assert capsys.readouterr().out == ""


def test_attempts_to_connect(capsys):
    port = free_port()

    async def main():
        with pytest.raises(ConnectionRefusedError):
            await aio.connect(f"tcp:127.0.0.1:{port}", retries=2, reconnect_delay=0.01)
        server = Server()
        server.port = port
        opening = asyncio.ensure_future(
            aio.connect(f"tcp:127.0.0.1:{port}", retries=1000, reconnect_delay=0.01).__aenter__()
        )
        await asyncio.sleep(0.05)
        await server.up()
        link = await opening
        await eventually(lambda: server.writer)
        await link.close()
        server.server.close()

    run(main())
    assert capsys.readouterr().out == ""


def test_connecting_can_be_cancelled():
    async def main():
        opening = asyncio.ensure_future(
            aio.connect(f"tcp:127.0.0.1:{free_port()}", retries=1000).__aenter__()
        )
        await asyncio.sleep(0.02)
        opening.cancel()
        with pytest.raises(asyncio.CancelledError):
            await opening

    run(main())


def test_a_peer_that_does_not_read_stalls_nobody(loop):
    async def main():
        server = Server()
        await server.up()
        async with aio.connect(f"tcp:127.0.0.1:{server.port}") as link:
            await eventually(lambda: server.writer)
            server.reader._transport.pause_reading()
            # The system keeps megabytes otherwise.
            link.sync.port.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 1 << 14)
            accepted = server.writer.get_extra_info("socket")
            accepted.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 14)
            frames, settled = 0, False
            writer = link.sync._writer
            while not settled:  # the system may find room for more a little later
                while len(writer.unsent) < 1 << 17:
                    link.mav.heartbeat_send(6, 8, 0, 0, 0)
                    frames += 1
                await asyncio.sleep(0.1)
                settled = len(writer.unsent) >= 1 << 16
            with pytest.raises(TimeoutError):
                await asyncio.wait_for(link.drain(), 0.02)
            server.writer.write(heartbeat(3))
            assert (await link.recv_match(timeout=WAIT)).get_seq() == 3
            reading = asyncio.create_task(server.reader.readexactly(frames * 21))
            server.reader._transport.resume_reading()
            await asyncio.wait_for(link.drain(), WAIT)
            assert (await reading).count(b"\xfd\x09\x00\x00") == frames
            assert link.frames_dropped == 0
            server.writer.close()
        server.server.close()

    run(main(), loop)


def test_a_websocket_server_may_come_later():
    pytest.importorskip("wsproto")
    port = free_port()

    async def main():
        async with aio.connect(f"ws:127.0.0.1:{port}", reconnect_delay=0.01) as client:
            assert not client.connected
            assert isinstance(client.sync.connect_error, ConnectionRefusedError)
            client.mav.heartbeat_send(6, 8, 0, 0, 0)
            assert client.frames_dropped == 1
            async with aio.connect(f"wsserver:127.0.0.1:{port}") as server:
                await eventually(lambda: client.connected)
                assert client.sync.connect_error is None
                await converse(server, client)

    run(main())


def test_secure_websockets(tmp_path, monkeypatch):
    wsproto = pytest.importorskip("wsproto")
    from wsproto import events

    openssl = shutil.which("openssl")
    if openssl is None:
        pytest.skip("no openssl to make a certificate with")
    key, certificate = tmp_path / "key.pem", tmp_path / "certificate.pem"
    subprocess.run(
        [openssl, "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-subj", "/CN=localhost",
         "-addext", "subjectAltName=IP:127.0.0.1", "-keyout", key, "-out", certificate],
        check=True, capture_output=True,
    )  # fmt: skip
    monkeypatch.setenv("SSL_CERT_FILE", str(certificate))
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.load_cert_chain(certificate, key)
    count = 2000

    async def serve(reader, writer):
        ws = wsproto.WSConnection(wsproto.ConnectionType.SERVER)
        while data := await reader.read(65536):
            ws.receive_data(data)
            for event in ws.events():
                if isinstance(event, events.Request):
                    writer.write(ws.send(events.AcceptConnection()))
                    for seq in range(count):
                        writer.write(ws.send(events.BytesMessage(data=heartbeat(seq & 255))))
                elif isinstance(event, events.BytesMessage):
                    writer.write(ws.send(events.BytesMessage(data=event.data)))
        writer.close()

    async def main():
        server = await asyncio.start_server(serve, "127.0.0.1", 0, ssl=context)
        port = server.sockets[0].getsockname()[1]
        async with aio.connect(f"wss:127.0.0.1:{port}") as link:
            await eventually(lambda: link.sync.mav_count == count)
            assert link.sync.mav_loss == 0
            link.mav.heartbeat_send(6, 8, 0, 0, 0)
            assert (await link.recv_match(sysid=255, timeout=WAIT)).type == 6
        server.close()

    run(main())
