"""What `mavlink_connection` makes of devices: mistakes are named, ports have the names of every system."""

from __future__ import annotations

import errno
import math
import os
import re
import socket
import sys
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from pkgutil import iter_modules
from types import SimpleNamespace
from typing import Any, ClassVar

import pytest
from mavwire import links, mavutil
from mavwire.aio import transports
from mavwire.links.chunked import ChunkedLink
from mavwire.links.connection import PREFIXES
from mavwire.links.mavfile import mavfile
from mavwire.links.mcast import mavmcast
from mavwire.links.waiting import set_close_on_exec
from unit.bridge_tools import wait_until
from unit.link_tools import free_port, heartbeat

WAIT = 60.0


def link_classes() -> Iterator[type]:
    for module in iter_modules(links.__path__):
        for name, one in vars(import_module(f"mavwire.links.{module.name}")).items():
            if name.startswith("mav") and isinstance(one, type) and issubclass(one, mavfile):
                yield one


def test_a_link_class_is_known_wherever_links_are() -> None:
    text = Path(mavutil.__file__).read_text()
    for one in link_classes():
        name = one.__name__
        assert getattr(mavutil, name) is one, "mavutil._LAZY"
        assert name in mavutil.__all__
        assert re.search(rf"from \.links\.\w+ import .*\b{name}\b", text), "types of mavutil"
        if issubclass(one, ChunkedLink):
            assert issubclass(getattr(transports, one._aio_transport), transports.Transport)


def test_prefixes_of_links_are_documented() -> None:
    text = (Path(__file__).parents[3] / "docs" / "links.md").read_text()
    assert [prefix for prefix in PREFIXES if f"`{prefix}" not in text] == []


@pytest.mark.parametrize(
    ("device", "what"),
    [
        ("COM3:57600", "behind a comma"),
        ("serial:/dev/ttyUSB0:57600", "'serial:/dev/ttyUSB0:57600' is not"),
        ("udp://127.0.0.1:14550", "'//127.0.0.1:14550' is not"),
        ("mcast:1.2.3.4:5", "'1.2.3.4' is no multicast address"),
        ("mcast:localhost:5", "'localhost' is no multicast address"),
        ("exec:", "the program to run must be named: exec:PROGRAM"),
        ("COM3,fast", "baud rate 'fast' of the serial port COM3 is not a number"),
        ("/dev/ttyS99,", "baud rate '' of the serial port /dev/ttyS99 is not a number"),
    ],
)
def test_mistaken_devices_say_what_is_expected(device: str, what: str) -> None:
    with pytest.raises(ValueError, match=what):
        mavutil.mavlink_connection(device)


@pytest.mark.parametrize("name", ["COM3", "COM12,57600", r"\\.\COM10", "/dev/ttyUSB0,921600"])
def test_serial_ports_have_the_names_of_every_system(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(mavutil, "mavserial", lambda device, **kw: (device, kw["baud"]))
    assert mavutil.mavlink_connection(name, baud=9600) == (name, 9600)


def test_errors_of_the_system_name_the_device(tmp_path) -> None:
    with pytest.raises(FileNotFoundError) as error:
        mavutil.mavlink_connection(f"uds:{tmp_path}/none", retries=1)
    assert error.value.__notes__ == [f"while opening 'uds:{tmp_path}/none'"]


def test_a_path_is_a_device_too(tmp_path) -> None:
    with pytest.raises(FileNotFoundError, match="no such log"):
        mavutil.mavlink_connection(tmp_path / "none.tlog")
    with pytest.raises(TypeError, match="PathLike"):
        mavutil.mavlink_connection(14550)


@pytest.mark.parametrize("kind", ["uds", "ws", "serial"])
def test_connections_are_made_again_after_the_pause_that_was_asked_for(kind: str, tmp_path) -> None:
    if kind == "uds":
        listener = socket.socket(socket.AF_UNIX)
        listener.bind(str(tmp_path / "socket"))
        listener.listen()
        device = f"uds:{tmp_path}/socket"
    elif kind == "ws":
        pytest.importorskip("wsproto")
        device = f"ws:127.0.0.1:{free_port()}"
    else:
        pytest.importorskip("serial")
        device = os.ttyname(os.openpty()[1])
    for asked, pause in (({}, 1), ({"reconnect_delay": 0.25}, 0.25)):
        with mavutil.mavlink_connection(device, **asked) as link:
            assert link.reconnect_delay == pause


@pytest.mark.parametrize(
    ("device", "name"),
    [("uds:x", "mavuds"), ("ws:x:1", "mavwebsocket_client"), ("/dev/ttyS0", "mavserial")],
)
def test_classes_of_a_program_are_given_a_pause_when_it_asks_for_one(
    device: str, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(mavutil, name, lambda _, **options: options.get("reconnect_delay"))
    assert mavutil.mavlink_connection(device) is None
    assert mavutil.mavlink_connection(device, reconnect_delay=2) == 2


def test_wrong_pauses_are_named(tmp_path) -> None:
    for device in ("tcp:127.0.0.1:9", f"uds:{tmp_path}/none"):
        for wrong in ({"reconnect_delay": "a"}, {"retries": "a"}, {"retries": None}):
            with pytest.raises(TypeError, match=f"^{next(iter(wrong))} is a number, not "):
                mavutil.mavlink_connection(device, **wrong)  # type: ignore[call-overload]
        for delay in (-1, math.nan, math.inf):
            with pytest.raises(ValueError, match=f"^reconnect_delay is .* not {delay}$"):
                mavutil.mavlink_connection(device, reconnect_delay=delay)
        with pytest.raises(ValueError, match="^retries is a number, not nan$"):
            mavutil.mavlink_connection(device, retries=math.nan)  # type: ignore[call-overload]


def test_pauses_may_be_anything_where_nobody_pauses() -> None:
    """As with pymavlink."""
    options: dict[str, Any] = {"retries": None, "reconnect_delay": -1}
    for device in ("udpin:127.0.0.1:0", "tcpin:127.0.0.1:0"):
        mavutil.mavlink_connection(device, **options).close()


@pytest.mark.parametrize(("retries", "attempts"), [(-1, 1), (0, 1), (1.5, 2), (math.inf, 7)])
def test_retries_may_be_any_number(
    retries: Any, attempts: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    tried: list[object] = []

    def refuse(*arguments: object) -> None:
        tried.append(arguments)
        raise (ConnectionRefusedError if len(tried) < 7 else KeyboardInterrupt)(111, "refused")

    monkeypatch.setattr("mavwire.links.tcp.connect_to", refuse)
    with pytest.raises((ConnectionRefusedError, KeyboardInterrupt)):
        mavutil.mavlink_connection("tcp:127.0.0.1:9", retries=retries, reconnect_delay=0)
    assert len(tried) == attempts


def test_numbers_of_sockets_are_no_descriptors_on_windows(monkeypatch: pytest.MonkeyPatch) -> None:
    read, write = os.pipe()
    os.set_inheritable(read, True)
    with monkeypatch.context() as patch:
        patch.setattr(sys, "platform", "win32")
        set_close_on_exec(read)
    assert os.get_inheritable(read)
    set_close_on_exec(read)
    assert not os.get_inheritable(read)
    os.close(read)
    os.close(write)


def test_a_client_without_a_host_connects_to_this_machine() -> None:
    with socket.create_server(("127.0.0.1", 0)) as listener:
        listener.settimeout(WAIT)
        with mavutil.mavlink_connection(f"tcp::{listener.getsockname()[1]}") as link:
            peer, _ = listener.accept()
            peer.send(heartbeat())
            assert link.recv_match(blocking=True, timeout=WAIT).get_type() == "HEARTBEAT"
            peer.close()


def link_local_address() -> str:
    """An address of this machine that means something on one of its networks only."""
    try:
        lines = Path("/proc/net/if_inet6").read_text().splitlines()
    except OSError:
        lines = []
    for line in lines:
        digits, _, _, scope, _, interface = line.split()
        if scope == "20":
            groups = ":".join(digits[start : start + 4] for start in range(0, 32, 4))
            return f"{groups}%{interface}"
    pytest.skip("no network interface has a link-local address")


@pytest.mark.parametrize(
    ("here", "there"),
    [
        ("udpin:[{}]:{}", "udpout:[{}]:{}"),
        ("tcpin:[{}]:{}", "tcp:[{}]:{}"),
        ("wsserver:[{}]:{}", "tcp:[{}]:{}"),
        ("mcast:[{}]:{}", "mcast:[{}]:{}"),
    ],
)
def test_link_local_addresses_of_a_network_interface(here: str, there: str) -> None:
    if "ws" in here:
        pytest.importorskip("wsproto")
    host, port = link_local_address(), free_port()
    if "mcast" in here:
        host = "ff02::4d41%" + host.partition("%")[2]
    try:
        first = mavutil.mavlink_connection(here.format(host, port))
    except OSError as error:
        # An address that is still being looked into, an interface that is down.
        assert error.errno in (errno.EADDRNOTAVAIL, errno.ENETUNREACH, errno.ENODEV)
        pytest.skip(f"no link-local network: {error}")
    with first, mavutil.mavlink_connection(there.format(host, port)) as second:
        if "ws" in here:
            return  # who connects by TCP has found it
        second.mav.heartbeat_send(6, 8, 0, 0, 7)
        assert first.recv_match(blocking=True, timeout=WAIT).system_status == 7
        first.mav.heartbeat_send(6, 8, 0, 0, 8)
        assert second.recv_match(blocking=True, timeout=WAIT).system_status == 8


@pytest.mark.parametrize("device", ["udpin:[fe80::1%{}]:5", "mcast:[ff02::1%{}]:5"])
@pytest.mark.parametrize("interface", ["nosuch0", str(10**30)])
def test_a_network_interface_that_is_none_is_named(device: str, interface: str) -> None:
    with pytest.raises(OSError, match=f"no network interface '{interface}'"):
        mavutil.mavlink_connection(device.format(interface))


class Joining(socket.socket):
    """A socket that only says which groups it is asked to join."""

    joined: ClassVar[list[bytes]] = []

    def bind(self, address: object) -> None:
        pass

    def setsockopt(self, level: int, option: int, value: Any, *_: Any) -> None:
        if (level, option) == (socket.IPPROTO_IPV6, socket.IPV6_JOIN_GROUP):
            self.joined.append(value)


def test_a_multicast_group_is_joined_on_the_interface_it_names(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(Joining, "joined", [])
    monkeypatch.setattr(socket, "if_nametoindex", {"uplink": 5}.__getitem__)
    module = SimpleNamespace(**{**vars(socket), "socket": Joining})
    for group in ("ff02::1%uplink", "ff02::1%7", "ff02::1"):
        mavmcast._receiver(module, group, 14550).close()
    interfaces = [int.from_bytes(value[16:], sys.byteorder) for value in Joining.joined]
    assert interfaces == [5, 7, 0]
    assert {value[:16] for value in Joining.joined} == {
        socket.inet_pton(socket.AF_INET6, "ff02::1")
    }


def test_sending_on_closed_and_unconnected_links(capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("serial")
    ends = os.openpty()
    with mavutil.mavlink_connection(os.ttyname(ends[1])) as link:
        pass
    assert link.write(heartbeat()) == -1
    assert capsys.readouterr().out == ""
    for end in ends:
        os.close(end)
    pytest.importorskip("wsproto")
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
    for device in ("wsserver:127.0.0.1:0", f"ws:127.0.0.1:{port}"):
        with mavutil.mavlink_connection(device) as link:
            link.mav.heartbeat_send(6, 8, 0, 0, 0)
        link.mav.heartbeat_send(6, 8, 0, 0, 0)
        assert link.frames_dropped == 2
        if device.startswith(
            "ws:"
        ):  # an attempt to connect looks an address up, which other tests count
            wait_until("the end of the attempt", lambda: not link._connecting.locked())
