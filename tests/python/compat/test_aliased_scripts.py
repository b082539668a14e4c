"""pymavlink's installed scripts under `mavwire run`: the same output, files and exit code as on pymavlink.

`compare` of `tool_runs` and of `dump_logs` runs most of them so, beside mavwire's own subcommands. The others are here.
"""

from __future__ import annotations

import shlex
from importlib.metadata import distribution
from pathlib import Path
from random import Random

import pytest
from compass_logs import compass_log, sphere
from mavwire.dialects.v20 import ardupilotmega as mavlink
from tool_runs import Log, aliased, gps, in_folder, program, result_of

MINIMAL = Path(__file__).parents[3] / "message_definitions" / "v1.0" / "minimal.xml"
ELSEWHERE = (
    "mavbitmask_change mavextract mavfft mavfft_isb mavflightmodes mavflighttime mavgpslock mavgraph mavkml "
    "mavlink_bitmask_decoder mavlogdump mavloss mavmission mavparmdiff mavparms mavsearch mavsensor_status_change "
    "mavsigloss mavsummarize mavtogpx mavtomfile"
).split()
# Some end with a traceback: mavwire's text of the exception is the same, and so is all that came before.
RUNS = (
    ("magfit", "LOG"),
    ("magfit_WMM", "LOG --mag 2 --elliptical --cmot"),
    ("magfit_delta", "LOG"),
    ("magfit_delta", "--no-timestamps --verbose LOG"),
    ("magfit_gps", "LOG"),
    ("magfit_motors", "LOG"),
    ("mavgen", "--help"),
    ("mavgen", "--lang C --wire-protocol 2.0 --no-validate --output out MINIMAL"),
    ("mavplayback", "LOG"),
)


def test_every_installed_script_is_run(oracle: str) -> None:
    files = distribution(oracle).files or []
    installed = {Path(file).stem for file in files if Path(file).parent.name in ("bin", "Scripts")}
    assert installed == {*ELSEWHERE, *(script for script, _ in RUNS)}


@pytest.mark.parametrize("log_name", ["compass.bin", "compass.tlog"])
@pytest.mark.parametrize(("script", "options"), RUNS)
def test_script(script: str, options: str, log_name: str, tmp_path: Path, oracle: str) -> None:
    log = LOGS[log_name](tmp_path / log_name)
    arguments = shlex.split(options.replace("LOG", log.name).replace("MINIMAL", str(MINIMAL)))
    folders = in_folder(tmp_path / "theirs", (log,)), in_folder(tmp_path / "aliased", (log,))
    theirs = result_of([*program(script), *arguments], folders[0])
    ours = result_of([*aliased(script), *arguments], folders[1])
    assert ours.stdout == theirs.stdout
    assert ours.returncode == theirs.returncode
    assert ours.stderr.splitlines()[-1:] == theirs.stderr.splitlines()[-1:]
    ours_files, theirs_files = (
        {
            path.relative_to(folder): path.read_bytes()
            for path in folder.rglob("*")
            if path.is_file()
        }
        for folder in reversed(folders)
    )
    assert ours_files == theirs_files


def dataflash_log(path: Path) -> Path:
    return compass_log(path, (40.0, -30.0, 70.0), (1.05, 1.0, 0.95))


def telemetry_log(path: Path) -> Path:
    """A flight in circles with a compass that has offsets."""
    log = Log(path)
    log.add(0, mavlink.MAVLink_sensor_offsets_message(5, -7, 9, 0.0, 0, 0, 0, 0, 0, 0, 0, 0))
    for number, (x, y, z) in enumerate(sphere(Random(2), 60), 1):
        field = round(x) + 5, round(y) - 7, round(z) + 9
        log.add(number / 10, gps(number, 10 + number * 1e-4, 5.0))
        angles = 0.1, 0.2, number * 0.03
        log.add(number / 10, mavlink.MAVLink_attitude_message(number * 100, *angles, 0, 0, 0))
        log.add(number / 10, mavlink.MAVLink_vfr_hud_message(5, 5, 10, 50, 10, 0))
        log.add(number / 10, mavlink.MAVLink_servo_output_raw_message(0, 0, *[1000 + number] * 8))
        log.add(number / 10, mavlink.MAVLink_raw_imu_message(0, 0, 0, 0, 0, 0, 0, *field))
    return log.done()


LOGS = {"compass.bin": dataflash_log, "compass.tlog": telemetry_log}
