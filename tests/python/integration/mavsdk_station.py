"""A ground station made of MAVSDK: flies a PX4-like vehicle and prints what it saw as JSON.

python mavsdk_station.py udpin://127.0.0.1:PORT [visit]

`visit`: it only waits for a position and for parameters.
"""

from __future__ import annotations

import asyncio
import json
import math
import sys
import tempfile
from pathlib import Path
from typing import Any

from mavsdk.asyncio import ComponentType, Configuration, Mavsdk
from mavsdk.asyncio.plugins.action import ActionAsync
from mavsdk.asyncio.plugins.ftp import FtpAsync
from mavsdk.asyncio.plugins.geofence import GeofenceAsync
from mavsdk.asyncio.plugins.mission_raw import MissionRawAsync
from mavsdk.asyncio.plugins.offboard import OffboardAsync
from mavsdk.asyncio.plugins.param import ParamAsync
from mavsdk.asyncio.plugins.telemetry import TelemetryAsync
from mavsdk.plugins.geofence import Circle, FenceType, GeofenceData, Point
from mavsdk.plugins.mission_raw import MissionItem
from mavsdk.plugins.offboard import PositionNedYaw

WAIT = 60.0
HOME = (47.397742, 8.545594)


async def health(telemetry: Any) -> str:
    async for state in telemetry.subscribe_health():
        if state.is_armable and state.is_global_position_ok and state.is_home_position_ok:
            return str(state)
    raise SystemExit("the health stream ended")


async def climbs(telemetry: Any, height: float) -> float:
    async for position in telemetry.subscribe_position():
        if abs(position.relative_altitude_m - height) < 0.5:
            return float(position.relative_altitude_m)
    raise SystemExit("the position stream ended")


async def lands(telemetry: Any) -> bool:
    async for armed in telemetry.subscribe_armed():
        if not armed:
            return True
    return False


async def parameters(param: Any) -> dict[str, Any]:
    await param.set_param_int("COM_FLTMODE1", -5)
    await param.set_param_float("MPC_XY_CRUISE", 7.5)
    everything = await param.get_all_params()
    return {
        "autostart": await param.get_param_int("SYS_AUTOSTART"),
        "mode": await param.get_param_int("COM_FLTMODE1"),
        "cruise": await param.get_param_float("MPC_XY_CRUISE"),
        "count": len(everything.int_params) + len(everything.float_params),
    }


def items() -> list[Any]:
    """A route of four points, ten metres apart."""
    made = []
    for seq in range(4):
        x, y = int((HOME[0] + 1e-4 * seq) * 1e7), int(HOME[1] * 1e7)
        made.append(
            MissionItem(seq, 6, 16, int(seq == 0), 1, 0.0, 0.0, 0.0, math.nan, x, y, 12.0, 0)
        )
    return made


async def mission(system: Any) -> dict[str, Any]:
    raw = MissionRawAsync(system)
    await raw.upload_mission(items())
    back = await raw.download_mission()
    await raw.start_mission()
    progress = []
    async for state in raw.subscribe_mission_progress():
        progress.append(state.current)
        if state.current == state.total:
            break
    return {"downloaded": len(back), "progress": progress}


async def offboard(system: Any, telemetry: Any) -> list[float]:
    control = OffboardAsync(system)
    await control.set_position_ned(PositionNedYaw(5.0, -5.0, -8.0, 90.0))
    await control.start()
    async for state in telemetry.subscribe_position_velocity_ned():
        at = state.position
        if abs(at.north_m - 5) < 0.5 and abs(at.east_m + 5) < 0.5 and abs(at.down_m + 8) < 0.5:
            break
    await control.stop()
    return [at.north_m, at.east_m, at.down_m]


async def files(system: Any) -> dict[str, Any]:
    ftp = FtpAsync(system)
    listing = await ftp.list_directory("/etc")
    with tempfile.TemporaryDirectory() as folder:
        async for _ in ftp.download("/etc/version.txt", folder, True):
            pass
        text = (Path(folder) / "version.txt").read_text()
        note = Path(folder) / "note.txt"
        note.write_text("x" * 1000)
        async for _ in ftp.upload(str(note), "/fs/microsd"):
            pass
        same = await ftp.are_files_identical(str(note), "/fs/microsd/note.txt")
    return {"files": [entry.name for entry in listing.entries],
            "text": text, "same": bool(same)}  # fmt: skip


async def fence(system: Any) -> int:
    geofence = GeofenceAsync(system)
    data = GeofenceData([], [Circle(Point(*HOME), 200.0, FenceType(0))])
    await geofence.upload_geofence(data)
    return len((await geofence.download_geofence()).circles)


async def fly(system: Any) -> dict[str, Any]:
    telemetry, action = TelemetryAsync(system), ActionAsync(system)
    found: dict[str, Any] = {"health": await health(telemetry)}
    found["params"] = await parameters(ParamAsync(system))
    found["files"] = await files(system)
    found["circles"] = await fence(system)
    await action.set_takeoff_altitude(6.0)
    await action.arm()
    await action.takeoff()
    found["height"] = await climbs(telemetry, 6.0)
    found["mission"] = await mission(system)
    found["offboard"] = await offboard(system, telemetry)
    await action.hold()
    await action.goto_location(*HOME, 488.0 + 9.0, 0.0)
    found["goto"] = await climbs(telemetry, 9.0)
    await action.return_to_launch()
    found["landed"] = await lands(telemetry)
    return found


async def visit(system: Any) -> dict[str, Any]:
    found: dict[str, Any] = {"health": await health(TelemetryAsync(system))}
    found["params"] = await parameters(ParamAsync(system))
    return found


async def main() -> None:
    task = visit if sys.argv[2:] == ["visit"] else fly
    configuration = Configuration.create_with_component_type(ComponentType.GROUND_STATION)
    async with Mavsdk(configuration) as mavsdk:
        await mavsdk.add_any_connection(sys.argv[1])
        system = await mavsdk.first_autopilot(WAIT)
        print(json.dumps(await asyncio.wait_for(task(system), 2 * WAIT)))


if __name__ == "__main__":
    asyncio.run(main())
