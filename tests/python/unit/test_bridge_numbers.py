"""What a bridge counts and limits, and whom it tells of."""

from __future__ import annotations

import json
import socket
import time

import pytest
from mavwire import Bridge
from mavwire.bridge import ConfigError
from mavwire.bridge.inspector_tables import MAX_KINDS, View
from mavwire.dialects.v20 import all as mavlink
from unit.bridge_tools import TCP, UDP, report, udp_peer, wait_until
from unit.link_tools import KEY, heartbeat

BEAT = mavlink.MAVLink_heartbeat_message(2, 3, 81, 4, 4, 3)


@pytest.mark.parametrize("option", ["heartbeat", "request_streams"])
def test_a_silent_link_says_nothing_itself(option: str) -> None:
    with pytest.raises(ConfigError, match=f"silent and {option} exclude each other"):
        Bridge().add(UDP, silent=True, **{option: 4})
    Bridge().add(UDP, silent=False, **{option: 4})


def test_bytes_are_limited_as_they_leave_and_so_are_heartbeats_of_the_bridge() -> None:
    with Bridge() as bridge, udp_peer() as station, udp_peer() as other:
        bridge.add(
            f"udpout:127.0.0.1:{station.getsockname()[1]}", name="radio",
            bytes_per_second=34 * 40, sign_out=True, signing_key=KEY, rates={"SYSTEM_TIME": 1},
        )  # fmt: skip
        bridge.add(
            f"udpout:127.0.0.1:{other.getsockname()[1]}", name="quiet", heartbeat=0.01,
            block_messages_out=["HEARTBEAT"],
        )  # fmt: skip
        began = time.monotonic()
        bridge.send(b"".join(heartbeat(seq % 256) for seq in range(1000)))
        wait_until(
            "all",
            lambda: report(bridge, "radio")["limited"] + report(bridge, "radio")["sent"] == 1000,
        )
        # Heartbeats may run ahead by three seconds and the longest frame.
        most = 34 * 40 * (time.monotonic() - began + 3) + 280 + 34
        assert 0 < report(bridge, "radio")["sent_bytes"] <= most
        wait_until("beats", lambda: report(bridge, "quiet")["filtered_out"] > 1000)
        assert report(bridge, "quiet")["sent"] == 0


def test_made_up_addresses_do_not_make_every_look_slow() -> None:
    with Bridge() as bridge:
        bridge.add(UDP, name="in")
        assert bridge.stats()["hidden_components"] == 0
        made_up = heartbeats(256 * 32)
        bridge.send(b"".join(made_up))
        wait_until("them", lambda: report(bridge, "program")["received"] == len(made_up))
        bridge.send(heartbeat(sysid=1, compid=1))
        wait_until("one", lambda: report(bridge, "program")["received"] == len(made_up) + 1)
        stats = bridge.stats()
        assert len(stats["components"]) + stats["hidden_components"] == len(made_up)
        assert len(stats["components"]) == 4096
        assert (1, 1) in {(one["system"], one["component"]) for one in stats["components"]}


def heartbeats(count: int) -> list[bytes]:
    """From as many components."""
    mav = mavlink.MAVLink(None)
    frames = []
    for n in range(count):
        mav.srcSystem, mav.srcComponent = n % 256, n >> 8
        frames.append(bytes(BEAT.pack(mav)))
    return frames


def test_newest_values_are_kept_of_a_thousand_vehicles() -> None:
    with Bridge() as bridge, bridge.frames(["HEARTBEAT"]) as batches:
        bridge.send(b"".join(heartbeats(20_000)))
        got = 0
        while got < 20_000:
            batch = batches.next(10.0)
            assert batch is not None
            got += len(batch)
        assert len(bridge.kinds()) == 20_000
        told = json.loads(View(bridge).tables())
        assert (len(told["kinds"]), told["hidden"]) == (MAX_KINDS, 20_000 - MAX_KINDS)
        newest = [frame[5:7] for frame in heartbeats(20_000)[-MAX_KINDS:]]
        assert sorted(bytes(row[:2]) for row in told["kinds"]) == sorted(newest)


def test_a_name_that_nobody_knows_is_told_with_its_link() -> None:
    endpoint = f"udpout:{'x' * 300}:14550"  # no name server is asked for so long a name
    with pytest.raises(OSError, match="lookup") as caught:
        Bridge([endpoint]).start()
    assert caught.value.filename == endpoint and caught.value.errno is not None
    assert "lookup" in caught.value.strerror


def test_a_server_counts_who_came() -> None:
    with Bridge() as bridge:
        bridge.add(TCP, name="tcp")
        bridge.add(UDP, name="udp")
        port = int(report(bridge, "tcp")["endpoint"].rpartition(":")[2])
        for count in (1, 2):
            socket.create_connection(("127.0.0.1", port)).close()
            wait_until("it", lambda count=count: report(bridge, "tcp")["connections"] == count)
        with udp_peer(bridge, "udp") as vehicle:
            vehicle.send(heartbeat())
            wait_until("it", lambda: report(bridge, "udp")["connections"] == 1)
