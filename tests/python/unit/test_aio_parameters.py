"""Parameters by `mavwire.aio`, of a vehicle that answers as a test has it answer."""

from __future__ import annotations

import asyncio
import math
import struct
from contextlib import asynccontextmanager

import pytest
from mavwire import aio
from mavwire.aio.parameters import decoded, encoded
from mavwire.dialects.v20 import all as mavlink
from unit.aio_tools import WAIT, run, udp_link

REAL32, INT32 = mavlink.MAV_PARAM_TYPE_REAL32, mavlink.MAV_PARAM_TYPE_INT32
UNLISTED = 65535
COUNT = 3
# As often as a busy machine needs.
OFTEN = 1000
# -5,000,000 is the one that a vehicle was seen with; the others are the ends of what is no quiet NaN.
SIGNALLING = [-5_000_000, 0x7F800001, 0x7FBFFFFF, -0x7FFFFF, -0x400001]


class Scripted:
    """The vehicle at the other end of a link."""

    def __init__(self, peer):
        self.peer = peer
        self.mav = mavlink.MAVLink(None)
        self.heard = []

    async def asked(self, kind):
        """The next message of a type that the link sends."""
        while True:
            while self.heard:
                msg = self.heard.pop(0)
                if msg.get_type() == kind:
                    return msg
            data = await asyncio.get_running_loop().sock_recv(self.peer.sock, 4096)
            self.heard += self.mav.parse_buffer(data) or []

    def tell(self, name, value, index=UNLISTED, kind=REAL32):
        self.peer.send(mavlink.MAVLink_param_value_message(name, value, kind, COUNT, index))

    def tell_bytes(self, name, data, kind):
        """A value as PX4 sends it."""
        payload = data + struct.pack("<HH16sB", COUNT, 0, name, kind)
        msg = mavlink.MAVLink_param_value_message(name, 0.0, kind, COUNT, 0)
        sender = mavlink.MAVLink(None, srcSystem=1, srcComponent=1)
        self.peer.sock.send(msg._pack(sender, msg.crc_extra, payload))


@asynccontextmanager
async def scripted(autopilot=mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA):
    """A link and its vehicle."""
    async with udp_link() as (link, peer):
        peer.send(mavlink.MAVLink_heartbeat_message(2, autopilot, 81, 4, 4, 3), sysid=1)
        await link.wait_heartbeat(timeout=WAIT)
        yield link, Scripted(peer)


def test_an_old_value_meanwhile_is_no_refusal():
    async def main():
        async with scripted() as (link, vehicle):
            setting = asyncio.create_task(link.param_set("GAIN", 2.0, timeout=WAIT))
            await vehicle.asked("PARAM_REQUEST_READ")
            vehicle.tell(b"GAIN", 1.0)
            await vehicle.asked("PARAM_SET")
            vehicle.tell(b"GAIN", 1.0)  # somebody else had asked
            vehicle.tell(b"GAIN", 2.0)
            assert await setting == 2.0

    run(main())


def test_an_old_value_of_a_vehicle_that_heard_nothing_is_no_refusal():
    async def main():
        async with scripted() as (link, vehicle):
            setting = asyncio.create_task(link.param_set("GAIN", 2.0, retries=OFTEN, timeout=0.05))
            await vehicle.asked("PARAM_REQUEST_READ")
            vehicle.tell(b"GAIN", 1.0)
            await vehicle.asked("PARAM_SET")  # and lost
            vehicle.tell(b"GAIN", 1.0)
            await vehicle.asked("PARAM_SET")
            vehicle.tell(b"GAIN", 2.0)
            assert await setting == 2.0

    run(main())


def test_a_value_that_a_vehicle_keeps_is_a_refusal():
    async def main():
        async with scripted() as (link, vehicle):

            async def refuse():
                while True:
                    await vehicle.asked("PARAM_SET")
                    vehicle.tell(b"GAIN", 1.5)

            setting = asyncio.create_task(link.param_set("GAIN", 2.0, retries=9, timeout=0.1))
            await vehicle.asked("PARAM_REQUEST_READ")
            vehicle.tell(b"GAIN", 1.0)
            refusing = asyncio.create_task(refuse())
            with pytest.raises(aio.ParameterError, match="GAIN was not set to 2.0") as refused:
                await setting
            assert refused.value.value == 1.5
            refusing.cancel()

    run(main())


def test_what_is_known_does_not_put_off_asking_again():
    async def main():
        async with scripted() as (link, vehicle):

            async def chatter():
                while True:
                    vehicle.tell(b"A", 1.0, 0)
                    vehicle.tell(b"STAT_RUNTIME", 1.0)
                    await asyncio.sleep(0)

            fetching = asyncio.create_task(link.param_fetch_all(retries=OFTEN, timeout=0.05))
            await vehicle.asked("PARAM_REQUEST_LIST")
            vehicle.tell(b"A", 1.0, 0)
            vehicle.tell(b"B", 2.0, 1)
            chattering = asyncio.create_task(chatter())
            request = await asyncio.wait_for(vehicle.asked("PARAM_REQUEST_READ"), WAIT)
            assert request.param_index == 2
            vehicle.tell(b"C", 3.0, 2)
            assert await fetching == {"A": 1.0, "B": 2.0, "C": 3.0}
            chattering.cancel()

    run(main())


def test_chatter_does_not_keep_a_list_alive():
    async def main():
        async with scripted() as (link, vehicle):

            async def chatter():
                while True:
                    vehicle.tell(b"A", 1.0, 0)
                    await asyncio.sleep(0)

            chattering = asyncio.create_task(chatter())
            with pytest.raises(TimeoutError, match="1 of 3 parameters"):
                await asyncio.wait_for(link.param_fetch_all(retries=2, timeout=0.1), WAIT)
            chattering.cancel()

    run(main())


@pytest.mark.parametrize("value", [*SIGNALLING, -1, 0, 7])
def test_integers_keep_their_bytes(value):
    data = struct.pack("<i", value)

    async def main():
        async with scripted(mavlink.MAV_AUTOPILOT_PX4) as (link, vehicle):
            getting = asyncio.create_task(link.param_get("NUMBER", timeout=WAIT))
            await vehicle.asked("PARAM_REQUEST_READ")
            vehicle.tell_bytes(b"NUMBER", data, INT32)
            got = await getting
            assert (got, type(got)) == (value, int)

            setting = asyncio.create_task(link.param_set("NUMBER", value, timeout=WAIT))
            await vehicle.asked("PARAM_REQUEST_READ")
            vehicle.tell_bytes(b"NUMBER", bytes(4), INT32)
            sent = await vehicle.asked("PARAM_SET")
            assert sent.get_msgbuf()[10:14] == data
            assert (sent.param_id, sent.param_type) == ("NUMBER", INT32)
            assert (sent.get_srcSystem(), sent.get_seq()) == (255, 2)
            # One bit further is another value, however close.
            vehicle.tell_bytes(b"NUMBER", struct.pack("<i", value ^ 1), INT32)
            vehicle.tell_bytes(b"NUMBER", data, INT32)
            assert await setting == value

    run(main())


@pytest.mark.parametrize(
    ("value", "kind"), [(1.5, INT32), (2**31, INT32), (256, 1), (float("nan"), 6), (1e39, REAL32)]
)
@pytest.mark.parametrize("bytewise", [False, True])
def test_what_a_type_cannot_hold_is_refused(value, kind, bytewise):
    with pytest.raises(ValueError, match="does not fit a parameter of type"):
        encoded(value, kind, bytewise)


def test_an_integer_that_is_no_number_is_shown_as_it_came():
    """From a vehicle that copies bytes and did not say so."""
    msg = mavlink.MAVLink_param_value_message(b"NUMBER", float("nan"), INT32, COUNT, 0)
    assert math.isnan(decoded(msg, False))
