"""The file transfer client beside pymavlink's: packets, results, texts, parameter files and the
options of the command line. How the two talk to a vehicle is compared in requests and results.
"""

from __future__ import annotations

from pathlib import Path

import pytest
from beside import assert_same

SETUP = """
import io, logging, os, random, re, struct
logging.basicConfig(level=logging.DEBUG, format="%(levelname)s|%(message)s", stream=sys.stdout)
m, ops = load("mavftp"), load("mavftp_op")

def said(result):
    print(result.operation_name, *(int(v) for k, v in sorted(vars(result).items()) if isinstance(v, int)))
"""

PACKETS = """
print({n: v for n, v in vars(ops).items() if n.startswith("OP_")})
print({n: getattr(m, n) for n in ("HDR_Len", "MAX_Payload", "BURST_REPLY_SEQUENCE_WINDOW", "MAX_READ_GAPS")})
for a in ((1, 2, 3, 4, 5, 0, 7), (65535, 255, 255, 0, 0, True, 2**32 - 1, b"abc"), (0, 0, 0, 0, 0, 0, 0, b""),
          (1, 2, 3, 3, 0, 0, 0, bytearray(b"hello world")), (70000, 0, 0, 0, 0, 0, 0), (0, 0, 0, 0, 0, 0, -1)):
    op = ops.FTP_OP(*a)
    print(vars(op), str(op), list(op.items()))
    show("op.pack()", globals())
"""

RESULTS = """
for code in [*m.FtpError, 99, -1]:
    r = m.MAVFTPReturn("Op", code, 2, 77, 88, 99)
    r.display_message()
    print(int(r.return_code), r.operation_name)
r = m.MAVFTPReturn("op", 0, directory_listing=[m.DirectoryEntry("a", True, 0), m.DirectoryEntry("b", False, 12)])
r.display_message()
print(vars(r)["directory_listing"], m.DirectoryEntry("a", True, 0) == m.DirectoryEntry("a", True, 0))
print([(e.name, e.value) for e in m.FtpError], vars(m.WriteQueue(1, 2)))
s = m.MAVFTPSettings([("debug", int, 0), ("rate", float, 1.5)])
for n, v in (("debug", "3"), ("debug", 2.7), ("rate", "2"), ("debug", True)):
    setattr(s, n, v)
    print(s.debug, s.rate)
for n, v in (("debug", "x"), ("rate", None), ("nix", 3)):
    show("setattr(s, n, v)", globals())
show("s.nix", globals())
print(vars(m.MAVFTPSetting("x", int, 3)))
"""

PARAMETERS = """
def ent(name, t, v, common=0, default=None, flags=0):
    form = {1: "<b", 2: "<h", 3: "<i", 4: "<f"}[t]
    flags |= default is not None
    tail = name[common:]
    data = bytes([t | flags << 4, common | (len(tail) - 1) << 4]) + tail + struct.pack(form, v)
    return data + (b"" if default is None else struct.pack(form, default))

def head(n, total=None, magic=0x671B):
    return struct.pack("<HHH", magic, n, n if total is None else total)

A = ent(b"ABC", 4, 1.5) + ent(b"ABD", 1, -5, 2) + ent(b"XYZ_LONGNAMEHERE", 2, 300) + ent(b"XYZ_LONGNAMEHERF", 3, -70000, 15)
B = ent(b"ABC", 4, 1.5, default=2.5) + ent(b"ABD", 1, -5, 2) + ent(b"ABE", 2, 3, 2, default=4)
files = [head(4) + A, head(4) + b"\\0\\0" + A + b"\\0", head(3, 3, 0x671C) + B, head(3) + B, head(3) + A, head(5) + A,
    head(4, 9) + A, head(4, 2) + A, b"", b"\\x1b\\x67\\0", head(4, 4, 0x1234) + A, head(0), head(4), head(4) + A[:-2],
    head(1) + A[:4], head(1) + A[:1], head(1) + b"\\x05\\x20ABC" + bytes(8), head(1) + b"\\x04\\x23ABC" + bytes(4),
    head(1) + ent(b"A\\xffC", 4, 1.5), head(1) + ent(b"NAN", 4, float("nan")), head(2) + A[:9] + A[:9],
    head(1) + ent(b"ABC", 4, 1.5, flags=2), head(1) + A[:9] + b"xyz", head(1, 1, 0x671C) + A[:9],
    head(1) + b"\\x04\\xf0" + b"A" * 16 + bytes(4), head(2) + ent(b"A" * 16, 4, 1) + b"\\x04\\x1fBB" + bytes(4)]
R = random.Random(2)
for _ in range(300):
    data = bytearray(R.choice((head(4) + A, head(3, 3, 0x671C) + B)))
    for _ in range(R.randint(1, 3)):
        data[R.randrange(len(data))] = R.randrange(256)
    files.append(bytes(data[: R.choice((len(data), R.randrange(len(data))))]))
for data in files:
    found = m.MAVFTP.ftp_param_decode(data)
    print(data.hex(), found and (found.params, found.defaults))
p = m.ParamData()
p.add_param(b"A", 1.0, 4); p.add_default(b"A", 2.0, 4)
print(vars(p))
P = [(b"RC1_MIN", 1100.0, 4), (b"ABC", 1.5, 4), (b"A_B", 2, 1), (b"RC10_MAX", -3.25, 2), (b"ABC", 7.0, 3)]
for kind in ("missionplanner", "mavproxy", "none", "foo"):
    print(list(m.MAVFTP.extract_params(P, kind).items()))
D = {"RC1_MIN": (1100.0, 4), "A_B": (2, 1), "LONGNAMELONGNAMELONG": (-3.25, 2), "Z": (0.1234567, 4), "I": (-70000, 3),
     "N": (float("nan"), 4), "INF": (float("inf"), 4), "BIG": (1e10, 4), "S": (1e-9, 4), "NZ": (-0.0, 4)}
for kind in ("missionplanner", "mavproxy", "none"):
    for comments in (False, True):
        m.MAVFTP.save_params(D, "s", kind, comments, comments)
        print(re.sub(r"saved at [-0-9: ]+", "saved at", open("s").read()))
m.MAVFTP.save_params({}, "t", "none", False, True)
print(os.path.exists("t"))
show("m.MAVFTP.save_params(D, '/nowhere/s', 'none', False, False)", globals())
for name in ("A", "AB_C", "RC10_MIN", "_X", ""):
    print(m.MAVFTP.missionplanner_sort(name))
"""

COMMAND_LINE = """
import argparse
p = m.create_argument_parser()
p.error = lambda text: (_ for _ in ()).throw(ValueError(text))
for a in p._actions:
    print(a.option_strings, a.dest, a.default, a.type)
commands = next(a for a in p._actions if isinstance(a, argparse._SubParsersAction)).choices
for name, command in commands.items():
    print(name, [(a.option_strings, a.dest, a.nargs, a.default, a.type, a.choices) for a in command._actions[1:]])
print(vars(p.parse_args(["--device", "x", "getparams", "v", "-s", "none", "-t"])))
"""

# A vehicle's answers are written out here, so that both clients get the very same ones.
TALK = """
H = struct.Struct("<HBBBBBBI")
FILES = {b"/a.txt": b"hello", b"/big.bin": bytes(range(256)) * 8, b"/empty": b"", b"up": b""}

class Answer:
    def __init__(self, payload):
        self.payload, self.target_system, self.target_component = list(payload.ljust(251, b"\\0")), 255, 0
    def get_type(self): return "FILE_TRANSFER_PROTOCOL"
    def get_srcSystem(self): return 1
    def get_srcComponent(self): return 1

class Vehicle:
    source_system, source_component, target_system, target_component = 255, 0, 1, 1
    def __init__(self):
        self.queue, self.sent, self.open, self.quiet = [], [], {}, False
        self.mav = self
        self.srcSystem, self.srcComponent = 255, 0
    def recv_match(self, **kw):
        return self.queue.pop(0) if self.queue else None
    def reply(self, r, opcode, data=b"", seq=None, offset=None, complete=0):
        seq = r[0] + 1 if seq is None else seq
        offset = r[7] if offset is None else offset
        self.queue.append(Answer(H.pack(seq & 65535, r[1], opcode, len(data), r[2], complete, 0, offset) + data))
    def file_transfer_protocol_send(self, network, system, component, payload):
        payload = bytes(payload)
        r = H.unpack_from(payload)
        data = payload[12:12 + r[3]]
        if r[2] not in (7, 1) or not self.quiet:
            shown = data if r[2] not in (5, 15) else ""
            print("   >", network, system, component, *r[1:4], r[4:6], r[7], shown, len(payload))
        file = self.open.get(r[1], b"")
        if r[2] == 4:
            if data not in FILES: return self.reply(r, 129, b"\\x0a")
            self.open[r[1]] = FILES[data]
            self.reply(r, 128, struct.pack("<I", len(FILES[data])))
        elif r[2] == 15:
            for i, at in enumerate(range(r[7], len(file), r[3])):
                self.reply(r, 128, file[at:at + r[3]], r[0] + 1 + i, at, at + r[3] >= len(file))
            if r[7] >= len(file): self.reply(r, 129, b"\\x06")
        elif r[2] == 3:
            names = [b"Fb\\t1", b"Fa\\t22", b"Dz", b"S", b"Fbad\\txx"] if data == b"/" else []
            page = names[r[7]:r[7] + 3]
            self.reply(r, 128, b"\\0".join(page) + b"\\0") if page else self.reply(r, 129, b"\\x06")
        elif r[2] == 14: self.reply(r, 128, struct.pack("<I", 0x1234abcd))
        elif r[2] in (8, 10, 9, 13) and b"no" in data: self.reply(r, 129, b"\\x02\\x0d")
        else: self.reply(r, 128)

vehicle = Vehicle()
client = m.MAVFTP(vehicle, 1, 1)
client.ftp_settings.read_retry_time, client.ftp_settings.idle_detection_time = 0.1, 0.2
logging.disable(logging.INFO)

def call(text):
    result = eval(text)
    print(text, "->", end=" ")
    said(result) if hasattr(result, "error_code") else print(result)

call("client.cmd_list(['/'])"); print(client.list_result)
call("client.cmd_list(['/none'])"); print(client.list_result)
call("client.cmd_list([])")
call("client.cmd_list(['a', 'b'])")
for name in ("/a.txt", "/empty", "/big.bin"):
    call(f"client.cmd_get([{name!r}, 'local'])")
    call("client.process_ftp_reply('get')")
    print(open("local", "rb").read() == FILES[name.encode()] == client.get_result, client.remote_file_size, client.done)
got = []
call("client.cmd_get(['/big.bin'], callback=lambda f: got.append(f.read()), progress_callback=got.append)")
call("client.process_ftp_reply('get')")
print(got[-2] == FILES[b"/big.bin"], got[:5], got[-1], len(got))
for text in ("client.cmd_get([])", "client.cmd_get(['a', 'b', 'c'])", "client.cmd_put([])", "client.cmd_put(['missing'])",
             "client.cmd_rm([])", "client.cmd_rmdir([])", "client.cmd_mkdir([])", "client.cmd_rename(['a'])",
             "client.cmd_crc([])", "client.cmd_set([])", "client.cmd_set(['debug', '0'])", "client.cmd_set(['nix', '1'])",
             "client.cmd_set(['retry_time', 'x'])", "client.cmd_ftp([])", "client.cmd_ftp(['nix'])", "client.cmd_status()",
             "client.cmd_rm(['/x'])", "client.cmd_rm(['/no'])", "client.cmd_rmdir(['/x'])", "client.cmd_mkdir(['/no'])",
             "client.cmd_mkdir(['/x'])", "client.cmd_rename(['/x', '/y'])", "client.cmd_rename(['/no', '/y'])",
             "client.cmd_crc(['/x'])", "client.cmd_ftp(['rm', '/x'])", "client.cmd_ftp(['list', '/'])",
             "client.cmd_cancel()", "client.read('/big.bin', 10)", "client.read('/big.bin', 300, 100)",
             "client.read('/big.bin', 8, 2040)", "client.read_sector('/a.txt', 1, 3)", "client.read('/a.txt', 0)"):
    call(text)
codes = [bytes([c]) for c in range(13)]
for payload in (None, b"", *codes, b"\\x02\\x0d", b"\\x02\\x0d\\1", b"\\1\\2", b"\\xff"):
    for opcode in (128, 129, 3):
        op = ops.FTP_OP(1, 0, opcode, len(payload or b""), 3, 0, 0, payload)
        said(client._MAVFTP__decode_ftp_ack_and_nack(op, "Name"))
for request in range(17):
    said(client._MAVFTP__decode_ftp_ack_and_nack(ops.FTP_OP(1, 0, 128, 0, request, 0, 0, b"")))
vehicle.quiet = True
for data in (b"x" * 360, b""):
    got = []
    call("client.cmd_put(['name', 'up'], fh=io.BytesIO(data), callback=got.append, progress_callback=got.append)")
    call("client.cmd_put(['again', 'up'], fh=io.BytesIO(data))")
    call("client.process_ftp_reply('put')")
    print(got)
"""


@pytest.mark.parametrize("name", ["PACKETS", "RESULTS", "PARAMETERS", "COMMAND_LINE", "TALK"])
def test_same_as_pymavlink(name: str, oracle: str, tmp_path: Path) -> None:
    assert_same(SETUP + globals()[name], tmp_path, oracle)
