"""A bridge and frames of definitions that differ from its dialect's."""

from __future__ import annotations

import json
import re
import signal
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest
from integration.processes import announced_ports, mavwire
from mavwire import Bridge
from mavwire.bridge.inspector_tables import View
from mavwire.dialects import load
from mavwire.dialects.v20 import all as mavlink
from unit.bridge_tools import LIMIT, UDP, peers, receive, udp_peer, wait_until
from unit.link_tools import heartbeat

CAMERA_FEEDBACK = 180
OTHER_CRC_EXTRA = 5
FRAMES = 20


def foreign(number: int) -> bytes:
    """A frame of id 180 as a vendor defined it: three bytes, CRC_EXTRA 5."""
    body = bytes([3, number, 1, 1, CAMERA_FEEDBACK, number, 0, 60])
    checksum = mavlink.x25crc(body + bytes([OTHER_CRC_EXTRA])).crc
    return b"\xfe" + body + checksum.to_bytes(2, "little")


VENDOR_XML = """<mavlink><messages><message id="180" name="VENDOR_FEEDBACK">
<field type="uint8_t" name="index">Index.</field><field type="uint8_t" name="zero">0.</field>
<field type="uint8_t" name="sixty">60.</field></message></messages></mavlink>"""


def vendor(number: int) -> bytes:
    """A frame of VENDOR_FEEDBACK."""
    module: Any = load(VENDOR_XML)
    message = module.MAVLink_vendor_feedback_message(number, 0, 60)
    return bytes(message.pack(module.MAVLink(None, 1, 1), force_mavlink1=True))


@pytest.fixture
def vendor_xml(tmp_path: Path) -> str:
    path = tmp_path / "vendor.xml"
    path.write_text(VENDOR_XML)
    return str(path)


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


def test_a_message_that_upstream_had_before_has_its_name() -> None:
    history = (Path(__file__).parents[3] / "message_definitions/upstream/history.xml").read_text()
    found = re.search(r'<message id="52" name="(\w+)">.*?</message>', history, re.DOTALL)
    assert found is not None
    before: Any = load(f"<mavlink><messages>{found[0]}</messages></mavlink>")
    message = before.mavlink_map[52]
    packed = message(*[0] * len(message.fieldnames)).pack
    with Bridge() as bridge:
        bridge.send(bytes(packed(before.MAVLink(None, 1, 1))))
        wait_until("it", bridge.kinds)
        (kind,) = bridge.kinds()
        assert (kind.id, kind.name) == (52, found[1])
        (described,) = json.loads(View(bridge).tables())["types"].values()
        assert described["name"] == kind.name
        assert [field[0] for field in described["fields"]] == message.fieldnames


@pytest.mark.parametrize(
    ("make", "options", "taken"),
    [
        (
            foreign,
            {},
            range(6, FRAMES),
        ),  # four for the server, and three more for the peer's stream
        (foreign, {"forward_unverified": True}, range(FRAMES)),
        (vendor, {}, range(FRAMES)),
    ],
)
def test_a_udp_server_takes_a_peer_without_a_heartbeat(
    vendor_xml: str, make: Any, options: dict[str, bool], taken: range
) -> None:
    with Bridge(dialect=["upstream", vendor_xml]) as bridge:
        bridge.add(UDP, name="in", **options)
        bridge.add(UDP, name="out")
        with udp_peer(bridge, "in") as sender, udp_peer(bridge, "out") as receiver:
            receiver.send(heartbeat(1, sysid=9))
            wait_until("the receiver", lambda: peers(bridge, "out"))
            for number in range(FRAMES):
                sender.send(make(number))
            assert [receive(receiver) for _ in taken] == [make(number) for number in taken]


# -- the command

OTHER_UDP = "udpin:localhost:0"
# The first three of a definition that nobody knows are lost.
AGREEING, ALL = list(range(3, FRAMES)), list(range(FRAMES))
KIND = {"id": CAMERA_FEEDBACK, "crc_extra": OTHER_CRC_EXTRA}


def through_command(frames: list[bytes], *arguments: str) -> tuple[list[int], list[Any]]:
    """The numbers of the frames that `mavwire bridge` forwards, and what it could not name."""
    with mavwire("bridge", *arguments, "--json", "1h") as (process, lines):
        first, second = announced_ports(lines)
        with udp_peer() as sender, udp_peer() as receiver:
            sender.connect(("127.0.0.1", first))
            receiver.connect(("127.0.0.1", second))
            receiver.send(heartbeat(1, sysid=9))
            receiver.settimeout(0.1)
            for _ in range(int(LIMIT / 0.1)):
                sender.send(heartbeat(0))
                with suppress(TimeoutError):
                    receive(receiver)
                    break
            receiver.settimeout(LIMIT)
            for frame in frames:
                sender.send(frame)
            sender.send(heartbeat(2))
            arrived = []
            while (frame := receive(receiver)) != heartbeat(2):
                if frame in frames:
                    arrived.append(frames.index(frame))
        process.send_signal(signal.SIGINT)
        assert process.stdout is not None
        stats = json.loads(process.stdout.read())
        assert process.wait(LIMIT) == 0
    return arrived, [kind for link in stats["links"] for kind in link["unknown"]]


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        (["--dialect", "ardupilotmega"], AGREEING),
        (["--dialect", "ardupilotmega", "--forward-unverified"], ALL),
        (["--dialect", "minimal"], ALL),  # which does not have the id
    ],
)
def test_the_command_forwards_and_counts_what_it_cannot_name(
    options: list[str], expected: list[int]
) -> None:
    frames = [foreign(number) for number in range(FRAMES)]
    arrived, unknown = through_command(frames, UDP, OTHER_UDP, *options)
    assert (arrived, unknown) == (expected, [{**KIND, "frames": len(expected)}])


@pytest.mark.parametrize("first", ["minimal", "ardupilotmega"])
def test_the_command_takes_definitions_from_files(vendor_xml: str, first: str) -> None:
    frames = [vendor(number) for number in range(FRAMES)]
    options = ["--dialect", first, "--dialect", vendor_xml]
    arrived, unknown = through_command(frames, UDP, OTHER_UDP, *options)
    assert (arrived, unknown) == (ALL, [])


def test_a_file_says_the_same(tmp_path: Path, vendor_xml: str) -> None:
    config = tmp_path / "bridge.toml"
    config.write_text(f"""
dialect = ["ardupilotmega", "{vendor_xml}"]
[[link]]
endpoint = "{UDP}"
forward_unverified = true
[[link]]
endpoint = "{OTHER_UDP}"
""")
    frames = [foreign(number) for number in range(FRAMES)]
    frames += [vendor(number) for number in range(FRAMES)]
    arrived, unknown = through_command(frames, "--config", str(config))
    assert (arrived, unknown) == (list(range(2 * FRAMES)), [{**KIND, "frames": FRAMES}])


def test_the_first_dialect_that_knows_an_id_names_it(vendor_xml: str) -> None:
    with Bridge(dialect=["ardupilotmega", vendor_xml, "ASLUAV"]) as bridge:
        feedback = mavlink.MAVLink_camera_feedback_message(0, 1, 2, 3, 0, 0, 0, 0, 0, 0, 0, 0, 0)
        bridge.add(UDP, name="in")
        frames = bridge.frames(types=["CAMERA_FEEDBACK"])
        with udp_peer(bridge, "in") as sender:
            sender.send(feedback.pack(mavlink.MAVLink(None, 1, 1)))
            sender.send(vendor(7))
        names: list[str] = []
        while len(names) < 2:
            batch = frames.next(LIMIT)
            assert batch is not None
            names += [message.get_type() for message in batch]
        assert names == ["CAMERA_FEEDBACK", "VENDOR_FEEDBACK"]
        assert bridge._message_id("SENS_POWER") == 8002
        assert [one["unknown"] for one in bridge.stats()["links"]] == [[], [], []]
        assert [kind.name for kind in bridge.kinds()] == ["VENDOR_FEEDBACK"]  # the newest
