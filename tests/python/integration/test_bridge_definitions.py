"""A bridge and frames of definitions that differ from its dialect's."""

from __future__ import annotations

from mavwire import Bridge
from mavwire.dialects.v20 import all as mavlink
from unit.bridge_tools import UDP, peers, receive, udp_peer, wait_until
from unit.link_tools import heartbeat

CAMERA_FEEDBACK = 180
OTHER_CRC_EXTRA = 5
FRAMES = 20


def foreign(number: int) -> bytes:
    """A frame of id 180 as a vendor defined it: three bytes, CRC_EXTRA 5."""
    body = bytes([3, number, 1, 1, CAMERA_FEEDBACK, number, 0, 60])
    checksum = mavlink.x25crc(body + bytes([OTHER_CRC_EXTRA])).crc
    return b"\xfe" + body + checksum.to_bytes(2, "little")


def forwarded(**options: bool) -> list[bytes]:
    """The frames that arrive on the other side of a bridge, of 20 that are followed by a heartbeat."""
    with Bridge() as bridge:
        bridge.add(UDP, name="in", **options)
        bridge.add(UDP, name="out")
        with udp_peer(bridge, "in") as sender, udp_peer(bridge, "out") as receiver:
            receiver.send(heartbeat(1, sysid=9))
            wait_until("the receiver", lambda: peers(bridge, "out"))
            sender.send(heartbeat(0))  # a known frame proves that the peer speaks MAVLink
            assert receive(receiver) == heartbeat(0)
            for number in range(FRAMES):
                sender.send(foreign(number))
            sender.send(heartbeat(2))
            arrived = []
            while (frame := receive(receiver)) != heartbeat(2):
                arrived.append(frame)
            return arrived


def test_frames_that_agree_on_another_definition_are_forwarded() -> None:
    assert forwarded() == [foreign(number) for number in range(3, FRAMES)]


def test_a_link_may_forward_all_of_them() -> None:
    assert forwarded(forward_unverified=True) == [foreign(number) for number in range(FRAMES)]
