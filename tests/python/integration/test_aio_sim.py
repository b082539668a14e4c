"""`mavwire.aio` with simulated vehicles, over UDP and TCP."""

from __future__ import annotations

import asyncio
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager

import pytest
from mavwire import aio, mavutil
from mavwire.component_metadata import Kind
from mavwire.events import EventDefinitions
from mavwire.sim import Impairment, Runner, Vehicle, serve
from unit.aio_tools import LOOPS, run
from unit.link_tools import KEY, free_port
from unit.sim_tools import PATIENT

ARM = 400
TAKEOFF = 22
LAND = 21
SPEED = 10
WAIT = 60
# How long and how often to ask a vehicle that has to share a busy machine.
PATIENCE = {"retries": 30, "timeout": 2.0}
# On a link that loses much.
PERSISTENCE = {"retries": 200, "timeout": 0.3}


pytestmark = pytest.mark.usefixtures("mavlink20")


@contextmanager
def flying(kind: str, *vehicles: Vehicle, speed: float = SPEED) -> Iterator[tuple[str, Runner]]:
    """The device to connect to, and the vehicles' runner."""
    port = free_port(socket.SOCK_DGRAM if kind == "udp" else socket.SOCK_STREAM)
    theirs, ours = {"udp": ("udpout", "udpin"), "tcp": ("tcpin", "tcp")}[kind]
    with serve(f"{theirs}:127.0.0.1:{port}", *vehicles, speed=speed) as runner:
        yield f"{ours}:127.0.0.1:{port}", runner


def has_listener(port: int) -> bool:
    """Whether somebody listens to a UDP port: where nobody does, the system says so to the next send."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.connect(("127.0.0.1", port))
        probe.send(b"?")
        try:
            probe.send(b"?")
        except ConnectionRefusedError:
            return False
    return True


@pytest.mark.parametrize("loop", ["asyncio", "uvloop"])
@pytest.mark.parametrize("kind", ["udp", "tcp"])
def test_a_whole_flight(kind, loop):
    async def fly(device, vehicle):
        async with aio.connect(device, source_component=190) as link:
            await link.wait_heartbeat(timeout=WAIT)
            assert link.target_system == 1
            seen = asyncio.create_task(heights(link))  # ends with the link
            await link.set_message_interval("GLOBAL_POSITION_INT", 50, **PATIENCE)
            await link.recv_match("EKF_STATUS_REPORT.flags & 16", "EKF_STATUS_REPORT", timeout=WAIT)
            link.sync.set_mode("GUIDED")
            await link.recv_match(condition="MAV.flightmode=='GUIDED'", timeout=WAIT)
            assert link.flightmode == "GUIDED"
            await link.command(ARM, 1, **PATIENCE)
            assert vehicle.armed
            await link.command(TAKEOFF, 0, 0, 0, 0, 0, 0, 10, **PATIENCE)
            async for position in link.newest("GLOBAL_POSITION_INT"):
                if position.relative_alt > 9000:
                    break
            await link.command(LAND, **PATIENCE)
            await link.recv_match(condition="not MAV.armed", type="HEARTBEAT", timeout=WAIT)
            assert not vehicle.armed
            assert link.dropped == 0
        assert max(await seen) == pytest.approx(10, abs=1)

    async def heights(link):
        return [msg.relative_alt / 1000 async for msg in link.stream("GLOBAL_POSITION_INT")]

    with flying(kind, Vehicle(params=PATIENT["ardupilot"])) as (device, runner):
        run(fly(device, runner.vehicles[0]), LOOPS[loop])


@pytest.mark.parametrize("autopilot", ["ardupilot", "px4"])
def test_parameters(autopilot):
    name, integer = {
        "ardupilot": ("BATT_LOW_VOLT", "BATT_LOW_MAH"), "px4": ("MIS_TAKEOFF_ALT", "COM_RC_IN_MODE"),
    }[autopilot]  # fmt: skip

    async def main(device, vehicle):
        async with aio.connect(device) as link:
            with pytest.raises(aio.NoVehicleError):
                await link.param_get(name)
            await link.wait_heartbeat(timeout=WAIT)
            assert await link.param_set(name, 7.5, **PATIENCE) == 7.5
            assert await link.param_get(name, **PATIENCE) == vehicle.params[name] == 7.5
            if integer in vehicle.params:
                value = await link.param_get(integer, **PATIENCE)
                assert value == vehicle.params[integer]
                for other in (value + 1, -5_000_000):
                    assert await link.param_set(integer, other, **PATIENCE) == other
                    assert vehicle.params[integer] == other
            values = await link.param_fetch_all(**PATIENCE)
            assert values == pytest.approx({n: vehicle.params[n] for n in vehicle.params}, rel=1e-6)
            with pytest.raises(TimeoutError, match="NO_SUCH"):
                await link.param_get("NO_SUCH", retries=1, timeout=0.05)

    with flying("udp", Vehicle(autopilot)) as (device, runner):
        run(main(device, runner.vehicles[0]))


def test_commands_that_are_refused_and_unanswered():
    async def main(device):
        async with aio.connect(device) as link:
            await link.wait_heartbeat(timeout=WAIT)
            with pytest.raises(aio.CommandError, match="MAV_RESULT_UNSUPPORTED") as refused:
                await link.command(31000, **PATIENCE)
            assert refused.value.result == refused.value.ack.result == 3
            with pytest.raises(TimeoutError, match="MAV_CMD_NAV_LAND from system 9 after 2"):
                await link.command(LAND, sysid=9, retries=1, timeout=0.02)
            with pytest.raises(TimeoutError, match="from system 9 after 1"):
                await link.set_message_interval("ATTITUDE", 9, sysid=9, retries=0, timeout=0.02)
            with pytest.raises(ValueError, match="seven"):
                await link.command(LAND, *range(8))
            with pytest.raises(ValueError, match="NOT_A_MESSAGE"):
                await link.request_message("NOT_A_MESSAGE")
            # Equal ones wait for each other, so that each gets an answer of its own.
            acks = await asyncio.gather(*[link.command(ARM, 0, **PATIENCE) for _ in range(5)])
            assert len({id(ack) for ack in acks}) == 5

    with flying("udp", Vehicle()) as (device, _):
        run(main(device))


def test_a_bad_link():
    """Everything arrives in the end, because it is asked for again."""

    async def main(device, vehicle):
        async with aio.connect(device) as link:
            await link.wait_heartbeat(timeout=WAIT)
            for _ in range(5):
                await link.command(ARM, 0, **PERSISTENCE)
                msg = await link.request_message("AUTOPILOT_VERSION", **PERSISTENCE)
                assert msg.get_srcSystem() == 1
            values = await link.param_fetch_all(**PERSISTENCE)
            assert len(values) == len(vehicle.params)
            assert link.sync.packet_loss() > 5

    vehicle = Vehicle(impairment=Impairment(loss=0.2, corruption=0.05))
    with flying("udp", vehicle) as (device, _):
        run(main(device, vehicle))


def test_several_vehicles_at_once():
    async def main(device, runner):
        async with aio.connect(device) as link:

            async def arm(sysid):
                await link.wait_heartbeat(sysid, timeout=WAIT)
                await link.recv_match("GPS_RAW_INT.fix_type>=3", sysid=sysid, timeout=WAIT)
                await link.command(ARM, 1, 21196, sysid=sysid, **PATIENCE)
                newest = await link.wait_newer("HEARTBEAT", sysid=sysid, timeout=WAIT)
                return newest.get_srcSystem()

            found = await asyncio.gather(*[arm(sysid) for sysid in (1, 2, 3)])
            assert found == [1, 2, 3]
            assert all(vehicle.armed for vehicle in runner.vehicles)

    kinds = ("ardupilot", "px4", "ardupilot")
    vehicles = [
        Vehicle(kind, sysid=sysid, params=PATIENT[kind]) for sysid, kind in enumerate(kinds, 1)
    ]
    with flying("udp", *vehicles, speed=5) as (device, runner):
        run(main(device, runner))


def test_signed_links():
    async def main(device):
        async with aio.connect(device) as link:
            link.sync.setup_signing(KEY)
            await link.wait_heartbeat(timeout=WAIT)
            assert (await link.command(ARM, 0, **PATIENCE)).get_signed()
            assert (await link.recv_match(type="ATTITUDE", timeout=WAIT)).get_signed()

    with flying("udp", Vehicle(signing_key=KEY)) as (device, _):
        run(main(device))


def test_a_vehicle_that_is_switched_off_and_on():
    port = free_port()

    async def main():
        options = {"autoreconnect": True, "reconnect_delay": 0.02, "retries": 100}
        connecting = asyncio.ensure_future(
            aio.connect(f"tcp:127.0.0.1:{port}", **options).__aenter__()
        )
        for _ in range(3):
            with serve(f"tcpin:127.0.0.1:{port}", Vehicle(), speed=SPEED) as runner:
                link = await connecting
                await link.wait_heartbeat(timeout=WAIT)
                assert (await link.command(ARM, 0, **PATIENCE)).result == 0
                await asyncio.get_running_loop().run_in_executor(None, runner.stop)
            while link.connected:
                await asyncio.sleep(0.005)
        await link.close()

    run(main())


def test_a_vehicle_offers_its_events_and_files():
    async def ask(device):
        async with aio.connect(device, source_component=190) as link:
            await link.wait_heartbeat(timeout=WAIT)
            events = link.stream("EVENT")
            definitions = EventDefinitions(await link.component_metadata(Kind.EVENTS))
            assert definitions.event(await anext(events)).text == "Ready for takeoff!"
            assert await link.read_file("/etc/version.txt") == b"PX4 1.15.4 (mavwire)\n"
            with pytest.raises(OSError, match=r"/none: system 1 answers FileNotFound"):
                await link.read_file("/none")
            with pytest.raises(LookupError, match="no metadata of the kind actuators"):
                await link.component_metadata(Kind.ACTUATORS)

    with flying("udp", Vehicle("px4")) as (device, _):
        run(ask(device))


def test_a_synchronous_link_fetches_events():
    with flying("udp", Vehicle("px4")) as (device, _):
        link = mavutil.mavlink_connection(device, dialect="upstream")
        assert link.wait_heartbeat(timeout=WAIT) is not None
        assert len(EventDefinitions.of_vehicle(link)) > 10
        link.close()


def test_an_event_that_arrives_before_its_words_is_shown(tmp_path):
    saved = tmp_path / "events.json.xz"
    port = free_port(socket.SOCK_DGRAM)
    device = f"udpin:127.0.0.1:{port}"
    command = [sys.executable, "-m", "mavwire", "events", device, "--save", str(saved)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        while not has_listener(port):
            time.sleep(0.01)
        # An answer takes 10 s, and the event comes after 3 s.
        late = Vehicle("px4", impairment=Impairment(delay=5))
        with serve(f"udpout:127.0.0.1:{port}", late, speed=100):
            end = threading.Timer(WAIT, process.kill)
            end.start()
            line = process.stdout.readline()
            end.cancel()
        process.kill()
    assert line.endswith(": 1/1 info: Ready for takeoff!\n")
    assert len(EventDefinitions.read(saved)) > 10
