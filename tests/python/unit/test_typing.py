"""The package is typed: what users' type checkers say about code that uses the dialect modules.

That the stubs agree with the modules is stubtest's business (`make lint`); here a checker is given
right code and wrong code.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[3]
EXAMPLE = ROOT / "examples" / "typed.py"
PROJECT = sorted((ROOT / "tests" / "typed").glob("*.py"))

PRELUDE = """
from mavwire import mavutil, mavwp
from mavwire.dialects.v10 import common as v10
from mavwire.dialects.v20 import ardupilotmega, common, minimal
mav = ardupilotmega.MAVLink(None)
link = mavutil.mavlink_connection("")
"""

# Line of code -> a part of what the checker has to say about it, None for nothing.
CASES: dict[str, str | None] = {
    "mav.heartbeat_send(2, 3, 81, 4, 4)": None,
    'mav.heartbeat_send("2", 3, 81, 4, 4)': 'Argument 1 to "heartbeat_send"',
    "mav.heartbeat_send(2, 3, 81, 4)": "Missing positional argument",
    "mav.heartbeat_send(2, 3, 81, 4, 4, force_mavlink1=True)": None,
    "common.MAVLink(None).statustext_send(6, b'x')": None,
    "common.MAVLink(None).statustext_send(6, 'x')": '"str"; expected "bytes"',
    "v10.MAVLink(None).statustext_send(6, b'x', id=7)": 'Unexpected keyword argument "id"',
    "common.MAVLink_heartbeat_message(1, 2, 3, 4, 5)": 'Missing positional argument "mavlink_ver',
    "mav.attitude_encode(1, 0, 0, 0, 0, 0, 0).yaww": '"MAVLink_attitude_message" has no attribute',
    "reveal_type(mav.param_value_encode(b'A', 1, 9, 1, 0).param_id)": '"str"',
    "reveal_type(mav.param_value_encode(b'A', 1, 9, 1, 0)._param_id_raw)": '"bytes"',
    "reveal_type(mav.attitude_encode(1, 0, 0, 0, 0, 0, 0).yaw)": '"float"',
    "reveal_type(mav.battery_status_encode(0, 0, 0, 0, [], 0, 0, 0, 0).voltages)": "list[int]",
    "reveal_type(mav.parse_char(b''))": "MAVLink_message | None",
    "reveal_type(mavwp.MAVWPLoader().load(''))": '"int"',
    "reveal_type(ardupilotmega.MAV_TYPE_QUADROTOR)": '"int"',
    "reveal_type(ardupilotmega.COPTER_MODE_LOITER)": '"int"',
    "minimal.MAVLink_attitude_message": 'has no attribute "MAVLink_attitude_message"',
    "minimal.MAVLink(None).attitude_send": 'has no attribute "attitude_send"',
    "v10.MAVLINK_MSG_ID_BUTTON_CHANGE": "has no attribute",
    "base: common.MAVLink = mav": None,
    "other: ardupilotmega.MAVLink = common.MAVLink(None)": "Incompatible types",
    "mavutil.mavlink_connection(14550)": 'Argument 1 to "mavlink_connection"',
    "mavutil.mavlink_connection('', resync='all')": 'Argument "resync" to "mavlink_connection"',
    "reveal_type(link.recv_match(type='ATTITUDE'))": "ReceivedMessage | None",
    "reveal_type(link.recv_match(type='ATTITUDE', blocking=True).yaw)": '"Any"',
    "link.recv_match(type='ATTITUDE').yaw": 'Item "None" of',
    "link.rewind()": None,
    "link.mav.heartbeat_send(2, 3, 81, 4, 4)": None,
    "mavutil.mavudp('').rewind()": '"mavudp" has no attribute "rewind"',
    "mavutil.mavudp('').set_mode(b'AUTO')": 'Argument 1 to "set_mode"',
    "reveal_type(mavwp.MAVWPLoader().count())": '"int"',
    "msg: common.MAVLink_message = ardupilotmega.MAVLink_ahrs_message(0, 0, 0, 0, 0, 0, 0)": None,
}


def check(folder: Path, *files: Path) -> tuple[int, list[str]]:
    """Exit status and lines of `mypy --strict` as a user of the installed package would run it."""
    run = subprocess.run(
        [
            *(sys.executable, "-m", "mypy", "--strict", "--no-error-summary"),
            *("--config-file=", "--cache-dir", str(folder / "cache")),
            *map(str, files),
        ],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
    )
    assert not run.stderr, run.stderr
    return run.returncode, run.stdout.splitlines()


def test_example_and_project_are_strictly_typed(tmp_path: Path) -> None:
    assert len(PROJECT) > 3
    assert check(tmp_path, EXAMPLE, *PROJECT) == (0, [])


def test_example_runs() -> None:
    run = subprocess.run([sys.executable, str(EXAMPLE)], capture_output=True, text=True, check=True)
    assert run.stdout.splitlines() == [
        "MAV_SEVERITY_INFO: ready",
        "heading 90",
        "battery 0: 12.3 V",
        "1 bad bytes: Bad prefix",
    ]


def test_checker_accepts_right_code_and_names_what_is_wrong(tmp_path: Path) -> None:
    code = tmp_path / "sample.py"
    code.write_text(PRELUDE + "\n".join(CASES) + "\n")
    _, lines = check(tmp_path, code)
    first = PRELUDE.count("\n") + 1
    for number, (source, expected) in enumerate(CASES.items(), first):
        said = [line for line in lines if line.startswith(f"sample.py:{number}:")]
        if expected is None:
            assert not said, source
        else:
            assert said and expected in said[0], (source, said)
