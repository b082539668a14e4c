"""A ground station made of mavsdk_server and its gRPC client: flies a PX4-like vehicle and prints
what it saw as JSON.

python mavsdk_grpc_station.py udpin://127.0.0.1:PORT GRPC_PORT
"""

from __future__ import annotations

import asyncio
import json
import math
import sys
from typing import Any

from mavsdk_grpc import System
from mavsdk_grpc.mission_raw import MissionItem

WAIT = 60.0
HOME = (47.397742, 8.545594)


async def until(stream: Any, condition: Any) -> Any:
    """The first value of a telemetry stream that fulfils the condition."""
    async for value in stream:
        if condition(value):
            return value
    raise SystemExit("the stream ended")


async def parameters(drone: Any) -> dict[str, Any]:
    await drone.param.set_param_int("COM_FLTMODE1", -5)
    await drone.param.set_param_float("MPC_XY_CRUISE", 7.5)
    return {
        "autostart": await drone.param.get_param_int("SYS_AUTOSTART"),
        "mode": await drone.param.get_param_int("COM_FLTMODE1"),
        "cruise": await drone.param.get_param_float("MPC_XY_CRUISE"),
    }


def items() -> list[Any]:
    """A route of four points, ten metres apart."""
    return [
        MissionItem(
            seq, 6, 16, int(seq == 0), 1, 0.0, 0.0, 0.0, math.nan,
            int((HOME[0] + 1e-4 * seq) * 1e7), int(HOME[1] * 1e7), 12.0, 0,
        )
        for seq in range(4)
    ]  # fmt: skip


async def mission(drone: Any) -> list[float]:
    await drone.mission_raw.upload_mission(items())
    return [item.z for item in await drone.mission_raw.download_mission()]


async def fly(drone: Any) -> dict[str, Any]:
    await drone.connect(system_address=sys.argv[1])
    await until(drone.core.connection_state(), lambda state: state.is_connected)
    await until(drone.telemetry.health(), lambda state: state.is_armable)
    found = {"params": await parameters(drone), "mission": await mission(drone)}
    await drone.action.set_takeoff_altitude(6.0)
    await drone.action.arm()
    await drone.action.takeoff()
    position = await until(
        drone.telemetry.position(), lambda at: abs(at.relative_altitude_m - 6) < 0.5
    )
    found["height"] = position.relative_altitude_m
    await drone.action.land()
    await until(drone.telemetry.armed(), lambda armed: not armed)
    return found


async def main() -> None:
    drone = System(port=int(sys.argv[2]))
    print(json.dumps(await asyncio.wait_for(fly(drone), WAIT)))


if __name__ == "__main__":
    asyncio.run(main())
