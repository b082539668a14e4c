"""The file server of a simulated vehicle: listing, reading, bursts, writing, refusals, repetition."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from typing import Any

import pytest
from mavwire._ftp import MAX_PAYLOAD
from mavwire._ftp.channel import padded, unpacked
from mavwire.dialects.v20 import all as mavlink
from mavwire.mavftp_op import FTP_OP
from mavwire.sim import Vehicle
from unit.sim_tools import Station

ACK, NAK = mavlink.MAV_FTP_OPCODE_ACK, mavlink.MAV_FTP_OPCODE_NAK
(OPEN, READ, LIST, BURST, CRC, END, RESET, CREATE, WRITE, REMOVE, MKDIR, RMDIR, CUT, RENAME) = (
    getattr(mavlink, f"MAV_FTP_OPCODE_{name}")
    for name in (
        "OPENFILERO", "READFILE", "LISTDIRECTORY", "BURSTREADFILE", "CALCFILECRC",
        "TERMINATESESSION", "RESETSESSION", "CREATEFILE", "WRITEFILE", "REMOVEFILE",
        "CREATEDIRECTORY", "REMOVEDIRECTORY", "TRUNCATEFILE", "RENAME",
    )
)  # fmt: skip
CONTENT = bytes(n * 7 & 255 for n in range(2000))


class Client(Station):
    """A station that speaks FTP."""

    def __init__(self, autopilot: str = "px4") -> None:
        self.sim = Vehicle(autopilot)
        super().__init__(self.sim)
        self.seq = 0
        self.sim.ftp.files.write("/data.bin", CONTENT)

    def ask(
        self, opcode: int, data: bytes = b"", size: int | None = None, offset: int = 0,
        session: int = 0, dt: float = 0.0,
    ) -> list[FTP_OP]:  # fmt: skip
        """A request; the packets that answer it."""
        length = len(data) if size is None else size
        packet = FTP_OP(self.seq, session, opcode, length, 0, 0, offset, data)
        self.seq += 2
        return self.transfer(packet, dt)

    def transfer(self, packet: FTP_OP, dt: float = 0.0) -> list[FTP_OP]:
        """The same with a packet of one's own."""
        msg = mavlink.MAVLink_file_transfer_protocol_message(0, 1, 1, padded(packet))
        found = [m for m in self.send(msg, dt) if m.get_type() == "FILE_TRANSFER_PROTOCOL"]
        return [unpacked(bytes(m.payload)) for m in found]

    def done(self, opcode: int, *args: Any, **kw: Any) -> FTP_OP:
        """A request that is answered once and well."""
        (answer,) = self.ask(opcode, *args, **kw)
        assert (answer.opcode, answer.req_opcode) == (ACK, opcode), answer.payload[:1]
        return answer

    def error(self, opcode: int, *args: Any, **kw: Any) -> int:
        """A request that is refused; why."""
        (answer,) = self.ask(opcode, *args, **kw)
        assert (answer.opcode, answer.req_opcode, answer.size) == (NAK, opcode, 1)
        return answer.payload[0]


@pytest.fixture
def client() -> Client:
    return Client()


def test_answers_have_the_next_number_and_name_the_request(client: Client) -> None:
    (answer,) = client.transfer(FTP_OP(65535, 0, LIST, 1, 0, 0, 0, b"/"))
    assert (answer.seq, answer.req_opcode) == (0, LIST)


def entries(client: Client, path: bytes) -> Iterator[bytes]:
    offset = 0
    while True:
        (answer,) = client.ask(LIST, path, offset=offset)
        if answer.opcode == NAK:
            assert answer.payload[0] == mavlink.MAV_FTP_ERR_EOF
            return
        found = answer.payload[: answer.size].split(b"\0")[:-1]
        offset += len(found)
        yield from found


def test_folders_are_listed_in_portions(client: Client) -> None:
    for number in range(30):
        client.sim.ftp.files.write(f"/fs/file{number:02}.txt", b"x" * number)
    found = list(entries(client, b"/fs"))
    assert found[0] == b"Dmicrosd"
    assert found[1:] == [b"Ffile%02d.txt\t%d" % (n, n) for n in range(30)]
    assert client.error(LIST, b"/nowhere") == mavlink.MAV_FTP_ERR_FILENOTFOUND


def test_a_file_is_read_in_any_order(client: Client) -> None:
    opened = client.done(OPEN, b"/data.bin")
    assert struct.unpack("<I", opened.payload[:4])[0] == len(CONTENT)
    for offset, size in ((1900, 239), (0, 100), (500, 239)):
        answer = client.done(READ, size=size, offset=offset, session=opened.session)
        assert answer.payload[: answer.size] == CONTENT[offset : offset + size]
    assert (
        client.error(READ, size=10, offset=2000, session=opened.session) == mavlink.MAV_FTP_ERR_EOF
    )
    client.done(END, session=opened.session)
    assert client.error(READ, size=10, session=opened.session) == mavlink.MAV_FTP_ERR_INVALIDSESSION


@pytest.mark.parametrize("size", [0, 80, 239])
def test_a_burst_brings_the_file(client: Client, size: int) -> None:
    session = client.done(OPEN, b"/data.bin").session
    packets = client.ask(BURST, size=size, session=session, dt=0.5)
    step = size or MAX_PAYLOAD
    assert [p.offset for p in packets] == list(range(0, len(CONTENT), step))
    assert b"".join(p.payload[: p.size] for p in packets) == CONTENT
    assert [p.burst_complete for p in packets] == [0] * (len(packets) - 1) + [1]
    assert [p.seq for p in packets] == list(range(packets[0].seq, packets[0].seq + len(packets)))
    assert client.error(BURST, session=session, offset=2000) == mavlink.MAV_FTP_ERR_EOF


def test_a_burst_goes_on_where_it_is_asked_to(client: Client) -> None:
    session = client.done(OPEN, b"/data.bin").session
    client.ask(BURST, session=session)
    (last,) = client.ask(BURST, session=session, offset=1912, dt=0.2)
    assert (last.payload[: last.size], last.burst_complete) == (CONTENT[1912:], 1)


def test_a_session_has_one_burst_whoever_asks(client: Client) -> None:
    """Senders are as many as addresses are made up; what they get a tick must not be."""
    client.sim.ftp.files.write("/data.bin", CONTENT * 100)
    opened = client.done(OPEN, b"/data.bin")
    ask = padded(FTP_OP(9, opened.session, BURST, 10, 0, 0, 0, b""))
    frames = b""
    for number in range(200):
        strange = mavlink.MAVLink(None, srcSystem=1 + number, srcComponent=7)
        frames += mavlink.MAVLink_file_transfer_protocol_message(0, 1, 1, ask).pack(strange)
    client.sim.step(0, frames)
    sent = mavlink.MAVLink(None).parse_buffer(client.sim.step(0.01)) or ()
    assert 0 < len([m for m in sent if m.get_type() == "FILE_TRANSFER_PROTOCOL"]) <= 4


def test_a_burst_that_is_closed_stops(client: Client) -> None:
    session = client.done(OPEN, b"/data.bin").session
    client.ask(BURST, size=4, session=session, dt=0.02)
    client.done(END, session=session)
    assert not [m for m in client.step(1) if m.get_type() == "FILE_TRANSFER_PROTOCOL"]


def test_the_checksum_is_that_of_the_protocol(client: Client) -> None:
    answer = client.done(CRC, b"/data.bin")
    expected = zlib.crc32(CONTENT, 0xFFFFFFFF) ^ 0xFFFFFFFF
    assert struct.unpack("<I", answer.payload[:4])[0] == expected
    assert client.error(CRC, b"/missing") == mavlink.MAV_FTP_ERR_FILENOTFOUND


def test_a_repeated_request_gets_the_same_answer(client: Client) -> None:
    request = FTP_OP(10, 0, OPEN, 9, 0, 0, 0, b"/data.bin")
    first, second = client.transfer(request), client.transfer(request)
    assert list(map(vars, first)) == list(map(vars, second))
    assert client.done(OPEN, b"/data.bin").session != first[0].session


def test_sessions_run_out_and_come_back(client: Client) -> None:
    sessions = {client.done(OPEN, b"/data.bin").session for _ in range(4)}
    assert len(sessions) == 4
    assert client.error(OPEN, b"/data.bin") == mavlink.MAV_FTP_ERR_NOSESSIONSAVAILABLE
    client.done(RESET)
    client.done(OPEN, b"/data.bin")


def test_an_ardupilot_takes_the_client_s_session() -> None:
    client = Client("ardupilot")
    assert client.done(OPEN, b"/data.bin", session=77).session == 77
    assert client.done(OPEN, b"/APM/scripts/readme.txt", session=77).session == 77
    answer = client.done(READ, size=7, session=77)
    assert answer.payload[: answer.size] == b"Scripts"


def test_files_are_written_cut_renamed_and_removed(client: Client) -> None:
    session = client.done(CREATE, b"/new.txt").session
    client.done(WRITE, b"world", offset=6, session=session)
    client.done(WRITE, b"hello ", session=session)
    client.done(END, session=session)
    assert client.sim.ftp.files.read("/new.txt", 0) == b"hello world"
    client.done(CUT, b"/new.txt", offset=5)
    client.done(RENAME, b"/new.txt\0/old.txt")
    assert client.sim.ftp.files.read("/old.txt", 0) == b"hello"
    client.done(REMOVE, b"/old.txt")
    assert client.error(REMOVE, b"/old.txt") == mavlink.MAV_FTP_ERR_FILENOTFOUND
    client.done(MKDIR, b"/box")
    assert client.error(MKDIR, b"/box") == mavlink.MAV_FTP_ERR_FILEEXISTS
    client.done(RMDIR, b"/box")
    assert client.error(RMDIR, b"/fs") == mavlink.MAV_FTP_ERR_FAIL


@pytest.mark.parametrize(
    ("opcode", "data", "error"),
    [
        (OPEN, b"/missing", mavlink.MAV_FTP_ERR_FILENOTFOUND),
        (OPEN, b"\xff\xfe", mavlink.MAV_FTP_ERR_FILENOTFOUND),
        (CREATE, b"/no/such/folder", mavlink.MAV_FTP_ERR_FILEPROTECTED),
        (WRITE, b"x", mavlink.MAV_FTP_ERR_INVALIDSESSION),
        (RENAME, b"/missing\0/x", mavlink.MAV_FTP_ERR_FILENOTFOUND),
        (RENAME, b"/data.bin\0/fs", mavlink.MAV_FTP_ERR_FILEEXISTS),
        (99, b"", mavlink.MAV_FTP_ERR_UNKNOWNCOMMAND),
    ],
)
def test_refusals(client: Client, opcode: int, data: bytes, error: int) -> None:
    assert client.error(opcode, data) == error


def test_a_size_beyond_the_packet_is_refused(client: Client) -> None:
    assert client.error(LIST, b"/", size=240) == mavlink.MAV_FTP_ERR_INVALIDDATASIZE


def test_files_have_a_limit(client: Client) -> None:
    session = client.done(CREATE, b"/big").session
    assert client.error(WRITE, b"x", offset=2**31, session=session) == mavlink.MAV_FTP_ERR_FAIL
    assert client.error(CUT, b"/data.bin", offset=2**31) == mavlink.MAV_FTP_ERR_FAIL


# -- @PARAM/param.pck


def unpack(data: bytes) -> dict[str, tuple[int, float, float | None]]:
    """Read the parameter file as its format says: name -> type, value, default."""
    forms = {1: "<b", 2: "<h", 3: "<i", 4: "<f"}
    magic, count, _ = struct.unpack_from("<3H", data)
    at, name, found = 6, b"", {}
    while len(found) < count:
        while data[at] == 0:
            at += 1
        kind, flags = data[at] & 15, data[at] >> 4
        common, fresh = data[at + 1] & 15, (data[at + 1] >> 4) + 1
        name = name[:common] + data[at + 2 : at + 2 + fresh]
        at += 2 + fresh
        size = struct.calcsize(forms[kind])
        value = struct.unpack_from(forms[kind], data, at)[0]
        at += size
        default = None
        if flags & 1:
            assert magic == 0x671C
            default = struct.unpack_from(forms[kind], data, at)[0]
            at += size
        found[name.decode()] = (kind, value, default)
    assert data[at:].strip(b"\0") == b""
    return found


def fetch(client: Client, path: bytes, size: int) -> bytes:
    session = client.done(OPEN, path, session=3).session
    packets = client.ask(BURST, size=size, session=session, dt=1.0)
    return b"".join(p.payload[: p.size] for p in packets)


@pytest.mark.parametrize("size", [80, 110, 239])
def test_all_parameters_come_in_one_file(size: int) -> None:
    client = Client("ardupilot")
    data = fetch(client, b"@PARAM/param.pck", size)
    found = unpack(data)
    assert {name: value for name, (_, value, _) in found.items()} == dict(client.sim.params)
    # No entry crosses the border of two blocks, so a lost block can be fetched alone.
    for begin, end in spans(data):
        assert begin // size == (end - 1) // size


def spans(data: bytes) -> Iterator[tuple[int, int]]:
    """Where each entry of the parameter file begins and ends."""
    sizes = {1: 1, 2: 2, 3: 4, 4: 4}
    at = 6
    while at < len(data):
        if data[at] == 0:
            at += 1
            continue
        end = at + 3 + (data[at + 1] >> 4) + sizes[data[at] & 15]
        yield at, end
        at = end


def test_parts_and_defaults_can_be_asked_for() -> None:
    client = Client("ardupilot")
    client.sim.params["WPNAV_SPEED"] = 700
    names = list(client.sim.params)
    part = unpack(fetch(client, b"@PARAM/param.pck?start=5&count=3", 239))
    assert list(part) == names[5:8]
    found = unpack(fetch(client, b"@PARAM/param.pck?withdefaults=1", 239))
    changed = {name: entry for name, entry in found.items() if entry[2] is not None}
    assert changed["WPNAV_SPEED"] == (4, 700, 1000)
    assert changed.keys() <= {"WPNAV_SPEED", "SYSID_THISMAV"}


def test_px4_has_no_such_file() -> None:
    assert Client("px4").error(OPEN, b"@PARAM/param.pck") == mavlink.MAV_FTP_ERR_FILENOTFOUND
