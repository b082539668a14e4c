"""Ordinary use of both packages, for the comparison of what it calls: logs, links, messages, files.

Nothing here calls a function of a module itself, but for those that open logs and links.
"""

from __future__ import annotations

import contextlib
import importlib
import io
import os
import socket
from collections.abc import Callable, Iterable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from differential.dataflash_logs import flight, text_log
from differential.test_called_twice import telemetry
from unit.link_tools import T0, record

MESSAGE_CLASSES = ("MAVLink_message", "MAVLink_heartbeat_message")
WAIT, QUIET = 5.0, 0.01
EXPRESSIONS = (
    "degrees(ATTITUDE.roll)", "lowpass(VFR_HUD.alt,1,0.9)", "distance_home(GPS_RAW_INT)",
    "mag_heading(RAW_IMU,ATTITUDE)", "pitch_sim(RAW_IMU,GPS_RAW_INT)",
    "distance_two(GPS_RAW_INT,GPS_RAW_INT)", "kmh(3)", "wrap_180(200)", "sin(1)+1",
    "average(VFR_HUD.alt,1,5)", "earth_accel(RAW_IMU,ATTITUDE)", "rotation(ATTITUDE)",
)  # fmt: skip


# A log of which only the GPS messages have a time.
RATES = """FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns
FMT, 130, 50, GPS, BIHB, Status,TimeMS,Week,NSats
FMT, 131, 20, IMU, ff, AccX,AccY
GPS, 3, 100000, 1700, 9
IMU, 1, 2
GPS, 3, 101000, 1700, 9
IMU, 1, 2
GPS, 3, 102000, 1700, 9
"""


class Package:
    """One of the packages, and files to use it on."""

    def __init__(self, name: str, folder: Path) -> None:
        os.environ["MAVLINK20"] = "1"
        self.name, self.folder = name, folder
        self.frames = telemetry()
        records = (record(frame, T0 + at * 100_000) for at, frame in enumerate(self.frames))
        (folder / "flight.tlog").write_bytes(b"".join(records))
        flight(1).write(folder / "flight.bin")
        (folder / "flight.log").write_text(text_log(0), encoding="utf-8")
        (folder / "rates.log").write_text(RATES)
        (folder / "flight.csv").write_text("time;a\n1;2\n3;4\n")
        self.mavutil: Any = self.module("mavutil")

    def module(self, name: str) -> Any:
        return importlib.import_module(f"{self.name}.{name}")

    def file(self, name: str) -> str:
        return str(self.folder / name)

    def use(self, parts: Iterable[Callable[[Package], None]]) -> None:
        """Run the parts. A replacement may break one of them, which then ends early."""
        for part in parts:
            self.mavutil.set_dialect("all")
            with contextlib.suppress(Exception):
                part(self)


def drain(log: Any, **wanted: Any) -> None:
    while log.recv_match(**wanted) is not None:
        pass


def telemetry_logs(package: Package) -> None:
    mavutil = package.mavutil
    telemetry_log(package, lambda path: mavutil.mavlink_connection(path))
    telemetry_log(package, mavutil.mavlogfile)


def telemetry_log(package: Package, kind: Any) -> None:
    log = kind(package.file("flight.tlog"))
    log.recv_match(type="ATTITUDE")
    log.recv_match(type=["VFR_HUD"], condition="VFR_HUD.alt>=0")
    log.recv_msg()
    log.check_condition("ATTITUDE.roll>0")
    log.time_since("ATTITUDE")
    if hasattr(log, "rewind"):
        log.flightmode_list()
        log.rewind()
    else:
        log.location()
        log.wait_heartbeat()
        log.motors_disarmed_wait()
        log.waypoint_current()
    drain(log)
    log.mav.file = io.BytesIO()
    command(log)
    log.close()


def command(link: Any) -> None:
    """The calls of a program to a link, with sends."""
    link.mode_mapping(), link.param("P1"), link.field("ATTITUDE", "roll"), link.packet_loss()
    link.mav.heartbeat_send(1, 2, 3, 4, 5)
    link.param_fetch_all(), link.param_fetch_one("X"), link.param_set_send("X", 1)
    link.set_mode("RTL"), link.set_mode_apm(3), link.set_mode_px4("RTL", 0, 0)
    link.set_mode_flag(1, True), link.set_mode_auto(), link.set_mode_rtl(), link.set_mode_manual()
    link.set_mode_fbwa(), link.set_mode_loiter(), link.arducopter_arm(), link.arducopter_disarm()
    link.set_servo(1, 2), link.set_relay(), link.reboot_autopilot(), link.set_rtscts(True)
    link.calibrate_level(), link.calibrate_pressure(), link.waypoint_request_list_send()
    link.waypoint_clear_all_send(), link.waypoint_count_send(1), link.waypoint_request_send(1)
    link.waypoint_set_current_send(1), link.mavlink10(), link.mavlink20(), link.select(0.001)
    link.setup_logfile(os.devnull), link.setup_logfile_raw(os.devnull)
    link.setup_signing(bytes(32)), link.disable_signing()


def listen(link: Any, send: Callable[[bytes], object], frames: list[bytes]) -> None:
    """A vehicle speaks to a link."""
    for frame in frames[:40]:
        send(frame)
    link.recv_match(blocking=True, timeout=WAIT)
    link.wait_heartbeat(timeout=WAIT)
    link.recv_match(type="ATTITUDE", blocking=True, timeout=WAIT, condition="ATTITUDE.roll>0")
    link.location(), link.waypoint_current()
    drain(link, blocking=True, timeout=QUIET)
    for frame in frames[:24]:
        send(frame)
    link.recv_msg(), link.motors_disarmed_wait(), link.recv_match(blocking=True, timeout=QUIET)
    link.probably_vehicle_heartbeat(link.messages["HEARTBEAT"])
    link.check_condition("1"), link.time_since("X")
    command(link)
    link.setup_signing(bytes(32), allow_unsigned_callback=lambda mav, msgid: True)
    for frame in frames[:4]:
        send(frame)
    drain(link, blocking=True, timeout=QUIET)
    link.close()


def links(package: Package) -> None:
    for device in ("udpin", "udpout", "tcp", "tcpin"):
        kind = package.mavutil.mavtcp if device == "tcp" else None
        kind = kind or (package.mavutil.mavtcpin if device == "tcpin" else package.mavutil.mavudp)
        LINKS[device](package, kind)


def udpin(package: Package, kind: Any) -> None:
    link = kind("127.0.0.1:0")
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as vehicle:
        vehicle.connect(link.port.getsockname())
        listen(link, vehicle.send, package.frames)


def udpout(package: Package, kind: Any) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as vehicle:
        vehicle.bind(("127.0.0.1", 0))
        link = kind(f"127.0.0.1:{vehicle.getsockname()[1]}", input=False)
        link.write(b"here")
        vehicle.connect(vehicle.recvfrom(9)[1])
        listen(link, vehicle.send, package.frames)


def tcp(package: Package, kind: Any) -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:
        link = kind(f"127.0.0.1:{server.getsockname()[1]}")
        vehicle = server.accept()[0]
    with vehicle:
        listen(link, vehicle.send, package.frames)


def tcpin(package: Package, kind: Any) -> None:
    link = kind("127.0.0.1:0")
    with socket.create_connection(link.listen.getsockname()) as vehicle:
        link.recv_msg()
        listen(link, vehicle.send, package.frames)


def bare_link(package: Package, kind: Any) -> None:
    """A link of a program, derived from mavfile."""

    class Own(kind):
        def __init__(self) -> None:
            self.received = bytearray()
            super().__init__(None, "own")

        def recv(self, n: int | None = None) -> bytes:
            n = len(self.received) if n is None else n
            data = bytes(self.received[:n])
            del self.received[:n]
            return data

        def write(self, buf: bytes) -> None:
            pass

        def close(self) -> None:
            pass

    link = Own()
    listen(link, link.received.extend, package.frames)


def clock(package: Package, kind: Any) -> None:
    log = package.module("DFReader").DFReader_binary(package.file("flight.bin"))
    log.clock = kind()
    log.rewind()
    drain(log)
    log.flightmode_list()


def record_type(package: Package, kind: Any) -> None:
    made = kind(1, "ABC", 20, "QBf", "TimeUS,I,X")
    made.set_unit_ids("s#m", {"s": "s", "m": "m"}), made.set_mult_ids("F--", {"F": 1e-6, "-": 0})
    made.get_unit("X"), str(made), kind(1, "ABC", 20, "QBf", "TimeUS,I,X", made)


LINKS: dict[str, Callable[[Package, Any], None]] = {
    "udpin": udpin, "udpout": udpout, "tcp": tcp, "tcpin": tcpin,
}  # fmt: skip


def dataflash_log(log: Any) -> None:
    while (msg := log.recv_match(type=["IMU", "GPS"], condition="GPS.Status>2")) is not None:
        str(msg), msg.to_dict(), msg.get_msgbuf()
    log.recv_msg(), log.flightmode_list(), log.rewind()
    while (msg := log.recv_msg()) is not None:
        msg.get_fieldnames(), msg.get_type(), msg.dump_verbose(io.StringIO())
    log.last_timestamp(), log.param("FIRST"), log.check_condition("1")
    log.close()


def dataflash_logs(package: Package) -> None:
    for name in ("flight.bin", "flight.log", "rates.log"):
        dataflash_log(package.mavutil.mavlink_connection(package.file(name)))


def csv_rows(log: Any) -> None:
    log.count_lines(), log._count, log.name_to_id("CSV")
    drain(log, type="CSV", condition="1")
    log.rewind(), log.recv_msg(), log.flightmode_list()


def csv_log(package: Package) -> None:
    csv_rows(package.mavutil.mavlink_connection(f"csv:{package.file('flight.csv')}"))


def messages(package: Package) -> None:
    mavlink = package.mavutil.mavlink
    parser(package, mavlink.MAVLink)
    message(package, mavlink.MAVLink_heartbeat_message)


def parser(package: Package, kind: Any) -> None:
    mavlink = package.mavutil.mavlink
    sender, receiver = kind(io.BytesIO(), 1, 1), kind(None, 2, 2)
    receiver.robust_parsing = True
    for name in ("heartbeat", "attitude", "param_value", "statustext"):
        cls = getattr(mavlink, f"MAVLink_{name}_message")
        msg = cls(*(b"abc" if one == "char" else 1 for one in cls.fieldtypes))
        frame = msg.pack(sender)
        sender.send(msg)
        receiver.parse_buffer(frame)
        for byte in bytes(frame):
            receiver.parse_char(bytes([byte]))
        receiver.decode(bytearray(frame))
    sender.heartbeat_send(1, 2, 3, 4, 5), sender.heartbeat_encode(1, 2, 3, 4, 5)
    receiver.set_callback(len), receiver.set_send_callback(len)
    receiver.callback = receiver.send_callback = None
    damaged = bytearray(package.frames[0])
    damaged[-1] ^= 1
    unknown = bytes([0xFD, 0, 0, 0, 0, 1, 1, 0xFF, 0xFF, 0x7F, 0, 0])
    for data in (bytes(20), damaged, unknown):
        receiver.parse_char(data)
    receiver.robust_parsing = False
    with contextlib.suppress(mavlink.MAVError):
        receiver.parse_char(damaged)
    for one in (sender, receiver):
        one.signing.secret_key = bytes(32)
    sender.signing.sign_outgoing, sender.signing.timestamp = True, 1
    receiver.parse_char(msg.pack(sender))
    receiver.buf_len(), receiver.bytes_needed()


def message(package: Package, kind: Any) -> None:
    mavlink = package.mavutil.mavlink
    msg, mav = kind(2, 3, 81, 4, 4, 3), mavlink.MAVLink(io.BytesIO())
    str(msg), msg.pack(mav), msg.to_json(), msg.to_dict(), msg.get_msgbuf(), msg.get_header()
    msg.get_payload(), msg.get_crc(), msg.get_fieldnames(), msg.get_type(), msg.get_msgId()
    msg.get_srcSystem(), msg.get_srcComponent(), msg.get_seq(), msg.get_signed()
    msg.get_link_id(), msg == msg, msg.format_attr("type"), mav.send(msg)
    mav.signing.secret_key, mav.signing.sign_outgoing = bytes(32), True
    msg.pack(mav)


def missions(package: Package) -> None:
    mavwp = package.module("mavwp")
    path, items = package.file("mission.txt"), mavwp.MAVWPLoader()
    Path(path).write_text("QGC WPL 110\n0\t1\t0\t16\t0\t0\t0\t0\t1\t2\t3\t1\n")
    items.load(path), items.add_latlonalt(1, 2, 3), items.save(path)
    items.polygon_list(), items.view_list(), items.insert(1, items.wp(0)), items.remove(items.wp(1))
    fence, rally = mavwp.MAVFenceLoader(), mavwp.MAVRallyLoader()
    fence.add_latlon(1, 2), rally.create_and_append_rally_point(1, 2, 3, 4, 5, 0)
    for loader in (fence, rally):
        loader.save(path), loader.load(path)


def parameters(package: Package) -> None:
    table, path = package.module("mavparm").MAVParmDict(), package.file("some.parm")
    Path(path).write_text("A 1\nB 2.5\n")
    table.load(path), table.save(path), table.diff(path), table.show()
    sender = SimpleNamespace(param_set_send=lambda *args, **kwargs: None)
    sender.mav, sender.recv_match = sender, lambda **kwargs: None
    sender.target_system = sender.target_component = 1
    table.mavset(sender, "A", 4, retries=1)


def expressions(package: Package) -> None:
    mavlink = package.mavutil.mavlink
    known = {
        "ATTITUDE": mavlink.MAVLink_attitude_message(1, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6),
        "RAW_IMU": mavlink.MAVLink_raw_imu_message(1, 2, 3, 4, 5, 6, 7, 8, 9, 10),
        "GPS_RAW_INT": mavlink.MAVLink_gps_raw_int_message(
            1, 3, 473977418, 85455939, 488000, 1, 1, 1, 1, 9
        ),
        "VFR_HUD": mavlink.MAVLink_vfr_hud_message(1, 2, 3, 4, 5, 6),
    }
    for msg in known.values():
        msg._timestamp = 1.0
    for expression in EXPRESSIONS:
        with contextlib.suppress(Exception):
            package.module("mavexpression").evaluate_expression(expression, known)


def rotations(package: Package) -> None:
    rotmat, turn = package.module("rotmat"), package.module("quaternion").Quaternion([1, 0, 0, 0])
    vector, matrix = rotmat.Vector3(1, 2, 3), rotmat.Matrix3()
    turn.euler, turn.dcm, turn * turn, turn.normalize(), turn.transform(vector), turn.inversed
    matrix.from_euler(0.1, 0.2, 0.3), matrix.to_euler(), matrix * vector, matrix.transposed()
    matrix.rotate(vector), matrix.normalize(), matrix * matrix, str(matrix)
    vector % vector, vector.angle(vector), vector + vector
    rotmat.Line(vector, vector).plane_intersection(rotmat.Plane(vector, vector))


def flightgear(package: Package) -> None:
    packet = package.module("fgFDM").fgFDM()
    packet.set("longitude", 1, units="degrees"), packet.get("longitude", units="degrees")
    packet.parse(packet.pack())
