"""Both packages' tools over the same logs: the same lines on standard output, the same files."""

from __future__ import annotations

import shlex
import subprocess
import sys
from itertools import zip_longest
from pathlib import Path
from random import Random
from struct import pack

from dump_logs import environment
from mavwire.dialects.v20 import ardupilotmega as mavlink

START = 1_600_000_000
SCRIPTS = Path(sys.executable).parent


def result_of(command: list[str], folder: Path) -> subprocess.CompletedProcess[bytes]:
    """The result of a program with its arguments in `folder`."""
    return subprocess.run(
        [sys.executable, *command],
        capture_output=True, check=False, cwd=folder, env=environment(), timeout=250,
    )  # fmt: skip


def run(command: list[str], folder: Path) -> tuple[list[str], int]:
    """Lines on standard output, and the exit code, of a program that works in `folder`."""
    result = result_of(command, folder)
    return result.stdout.decode(errors="replace").split("\n"), result.returncode


def in_folder(folder: Path, logs: tuple[Path, ...]) -> Path:
    """A folder that links to the logs, where a tool may write beside them."""
    folder.mkdir()
    for log in logs:
        (folder / log.name).symlink_to(log)
    return folder


def program(script: str) -> list[str]:
    """How Python runs one of pymavlink's scripts."""
    installed = SCRIPTS / f"{script}.py"
    return [str(installed)] if installed.exists() else ["-m", f"pymavlink.tools.{script}"]


def aliased(script: str) -> list[str]:
    """How Python runs an installed script of pymavlink on mavwire."""
    return ["-m", "mavwire", "run", *program(script)]


def compare(script: str, verb: str, options: str, folder: Path, *logs: Path) -> list[str]:
    """Run pymavlink's script, mavwire's subcommand, and the script where pymavlink is mavwire; what they print, which is
    the same.

    `LOG` in the options stands for the names of the logs, which otherwise follow them.
    """
    names = " ".join(log.name for log in logs)
    text = options.replace("LOG", names) if "LOG" in options else f"{options} {names}"
    arguments = shlex.split(text)
    command = program(script)
    their_folder = in_folder(folder / "theirs", logs)
    theirs, their_code = run([*command, *arguments], their_folder)
    assert their_code == 0, text
    ways = {"ours": ["-m", "mavwire", verb]}
    if command[0] != "-m":
        ways["aliased"] = aliased(script)
    for name, way in ways.items():
        our_folder = in_folder(folder / name, logs)
        ours, our_code = run([*way, *arguments], our_folder)
        for number, (our, their) in enumerate(zip_longest(ours, theirs), 1):
            assert our == their, f"line {number} of {way} {text}"
        assert our_code == 0, (way, text)
        compare_files(our_folder, their_folder)
    return theirs


def compare_files(ours: Path, theirs: Path) -> None:
    """The same files with the same bytes."""
    names = sorted(path.name for path in theirs.iterdir())
    assert sorted(path.name for path in ours.iterdir()) == names
    for name in names:
        assert (ours / name).read_bytes() == (theirs / name).read_bytes(), name


class Log:
    """A telemetry log that is being written; times are seconds since START."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._file = path.open("wb")
        self._senders: dict[tuple[int, int], mavlink.MAVLink] = {}

    def add(
        self,
        seconds: float,
        msg: mavlink.MAVLink_message,
        source: tuple[int, int] = (1, 1),
        link: int = 0,
        lost: int = 0,
        version_1: bool = False,
    ) -> None:
        """Append a record, `lost` messages after the sender's last one."""
        sender = self._senders.get(source)
        if sender is None:
            sender = mavlink.MAVLink(None, srcSystem=source[0], srcComponent=source[1])
            self._senders[source] = sender
        sender.seq = (sender.seq + lost) % 256
        self.add_bytes(seconds, msg.pack(sender, version_1), link)
        sender.seq = (sender.seq + 1) % 256

    def add_bytes(self, seconds: float, frame: bytes, link: int = 0) -> None:
        """Append a record of any bytes."""
        self._file.write(pack(">Q", (int((START + seconds) * 1e6) & ~3) | link) + frame)

    def done(self) -> Path:
        """Close the log."""
        self._file.close()
        return self.path


def heartbeat(mode: int = 0, base_mode: int = 81, kind: int = 2) -> mavlink.MAVLink_message:
    return mavlink.MAVLink_heartbeat_message(kind, 3, base_mode, mode, 4, 3)


def attitude(seconds: float) -> mavlink.MAVLink_message:
    return mavlink.MAVLink_attitude_message(int(seconds * 1000), 0.1, -0.2, 0.3, 0.0, 1e-9, 1e20)


def gps(
    seconds: float, lat: float, speed: float, fix: int = 3, lon: float = 20.0
) -> mavlink.MAVLink_message:
    return mavlink.MAVLink_gps_raw_int_message(
        int(seconds * 1e6), fix, int(lat * 1e7), int(lon * 1e7), 123456, 100, 100,
        int(speed * 100), 4500, 9,
    )  # fmt: skip


def position(seconds: float, lat: float) -> mavlink.MAVLink_message:
    return mavlink.MAVLink_global_position_int_message(
        int(seconds * 1000), int(lat * 1e7), -1234567, 123456, 1000, -307, 404, 500, 12345
    )


def flight_log(path: Path) -> Path:
    """Two flights, one of them autonomous, with stations and other systems in between."""
    log = Log(path)
    lat, seconds = 10.0, 0.0
    legs = (
        (20, 0.0, 0, 81),
        (40, 10.0, 5, 81),
        (15, 0.0, 0, 81),
        (30, 6.0, 3, 93),
        (9, 3.0, 6, 81),
    )
    for count, speed, mode, base_mode in legs:
        for step in range(count):
            log.add(seconds, heartbeat(mode, base_mode), lost=step % 7 == 3)
            log.add(seconds + 0.1, gps(seconds, lat, speed, fix=3 if step % 5 else 2), link=1)
            log.add(seconds + 0.15, gps(seconds, lat, speed))  # the same position again
            log.add(seconds + 0.2, position(seconds, lat), link=2)
            log.add(seconds + 0.3, heartbeat(0, 0, 6), source=(255, 190))
            log.add(seconds + 0.4, attitude(seconds), source=(1, 1) if step % 4 else (7, 1))
            lat += speed / 111194.9
            seconds += 1.0
    log.add(seconds, gps(seconds, 0.0, 0.0))
    return log.done()


def random_log(path: Path, seed: int) -> Path:
    """Modes, parameters, mission items and texts in any order, over four links and two systems."""
    random = Random(seed)
    log = Log(path)
    seconds = 0.0
    for number in range(150):
        seconds += random.random()
        options = {"link": random.randrange(4), "lost": random.choice((0, 0, 0, 0, 2, 255))}
        log.add(seconds, _random_message(random, number, seconds), **options)
        if random.random() < 0.1:
            log.add(seconds, attitude(seconds), source=(2, 1), link=random.randrange(4))
    return log.done()


def _random_message(random: Random, number: int, seconds: float) -> mavlink.MAVLink_message:
    kind = random.randrange(6)
    if kind == 0:
        return heartbeat(random.choice((0, 0, 3, 4, 5)), random.choice((81, 89, 209)))
    if kind == 1:
        return attitude(seconds)
    if kind == 2:
        name = b"P%d" % random.randrange(5)
        value = random.choice((random.random(), 1e10, float("nan"), -0.5, 3))
        return mavlink.MAVLink_param_value_message(name, value, 9, 5, 1)
    if kind == 3:
        items = (mavlink.MAVLink_mission_item_message, mavlink.MAVLink_mission_item_int_message)
        return items[number % 2](
            1, 1, random.randrange(8), 3, random.choice((16, 22, 177)), 0, 1,
            0.0, 1.5, 2.0, 3.0, number * 100, -number, 3.25,
        )  # fmt: skip
    if kind == 4:
        health = random.getrandbits(32)
        return mavlink.MAVLink_sys_status_message(1, 3, health, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0)
    return mavlink.MAVLink_statustext_message(6, b"caf\xc3\xa9 %d" % number)


def damaged_log(path: Path) -> Path:
    """Frames with wrong checksums, and unknown messages.

    Other damage is not compared: it spoils the record that pymavlink visits next.
    """
    log = Log(path)
    wrong = bytearray(attitude(0).pack(mavlink.MAVLink(None)))
    for number in range(60):
        source = (51, 68) if number % 6 == 0 else (1, 1)
        log.add(number, attitude(number), lost=number % 9 == 0)
        log.add(number + 0.1, heartbeat(number // 20), source)
        if number % 10 == 4:
            unknown = bytes((0xFD, 3, 0, 0, 7, 1, 1, 0x11, 0x99, 1, 1, 2, 3, 4, 5))
            log.add_bytes(number + 0.2, unknown)
        if number % 15 == 7:
            wrong[-1] ^= number
            log.add_bytes(number + 0.3, bytes(wrong))
    return log.done()
