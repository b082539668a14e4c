"""Parameter dictionaries beside pymavlink's: the same files, texts and requests."""

from __future__ import annotations

from pathlib import Path

import pytest
from beside import assert_same

SETUP = """
mavparm, mavutil = load("mavparm"), load("mavutil")

class Link:
    def __init__(self, *answers):
        self.answers, self.sent = list(answers), []
    def param_set_send(self, name, value, parm_type=None):
        self.sent.append((name, float(value), parm_type))
    def recv_match(self, **kw):
        return self.answers.pop(0) if self.answers else None

def value(name, number):
    return mavutil.mavlink.MAVLink_param_value_message(name.encode(), number, 9, 1, 0)
"""

LINES = [
    "V 0X1F", "W 1_0", "Q nan", "R inf", "lower 1", "VERYLONGNAMEOFPARAMETER 4", "A  ,  3", "A,,3",
    "A ,\\t3", "A  ", " ,A,", "A 3 ", "A 3 extra", "A 3 extra # c", "A #3", "A 3 # 4", "A 3#4",
    "#A 3", " #A 3", "A", "A,", ",3", "A;3", "A=3",
    "A 3\\x0c", "A 0x10 #c", "A 0x10,", "A 10,", ",A 3", "A 1e400", "A +3", "FORMAT_VERSION", "//x 3",
    "FORMAT_VERSION 3", "U -0x10", "X 0x", "Y 0x1p", "A 0b1", "A 1.5;", "", "A 1\\nA 2\\nB 3",
]  # fmt: skip

FILES = """
d = mavparm.MAVParmDict(("A", 1.5), ("BB", -2.0), ("C", 3), ("D", "txt"), ("aa", 0.1234567),
                        ("LONGNAME_MORE_THAN_SIXTEEN", 1e10), ("N", float("nan")), ("X", 1e-9))
print(vars(d))
for arguments in ("'o'", "'o', 'A*', True", "'o', 'a?', False", "'o', 'none', True"):
    show(f"d.save({arguments})", globals())
    print(repr(open("o").read()))
for arguments in ("'A*'", "'[abc]'", "'none'"):
    show(f"d.show({arguments})", globals())
d.show_param_value("ABCDEFGHIJKLMNOPQRSTUVWX", "x")
d.show_param_value("A", 5)
show("d.load('missing')", globals())
show("d.load('.')", globals())
show("d.load('o')", globals())
"""

DIFF = """
write("d", "A 1\\nB 2\\nC 3\\nD 0x10\\nF 5\\nLONGLONGLONGLONGNAME 3\\nBAD\\nFORMAT_VERSION 4\\nX 1e10\\nN nan\\n")
d = mavparm.MAVParmDict(("A", 1.0), ("B", 2.5), ("D", 16.0), ("E", 7.5), ("FORMAT_VERSION", 5.0),
                        ("LONGLONGLONGLONGNAME", 3.5), ("X", 1e10 + 1), ("G", 1.0), ("N", float("nan")))
for k in ({}, dict(wildcard="a*"), dict(wildcard="[BC]"), dict(use_excludes=False), dict(use_tabs=True),
          dict(show_only1=False), dict(show_only2=False), dict(header=True),
          dict(header=True, use_tabs=True), dict(value_info=lambda name, value: (name, value)),
          dict(value_info=lambda *a: "x", use_tabs=True), dict(value_info=lambda *a: None),
          dict(value_info=lambda name, value: "" if value > 3 else None)):
    print(sorted(k))
    d.diff("d", **k)
d.diff("missing")
"""

VEHICLE = """
def load_to(text, have, *answers, **options):
    d, link = mavparm.MAVParmDict(*have), Link(*answers)
    print(text, have, options)
    print(d.load(write("v", text), mav=link, **options), link.sent, dict(d))

load_to("A 1\\nB 2\\n", [])
load_to("A 1\\nB 2\\n", [("A", 1.0), ("B", 2.00000001)])
load_to("A 1\\nB 2\\nC 5\\n", [("A", 2.0), ("B", 1.5)], value("A", 1), value("B", 2))
load_to("A 1\\nB 2\\n", [("A", 2.0)], value("A", 1), value("B", 2), check=False)
load_to("A 1\\nA 2\\n", [("A", 0.0)], value("A", 1), value("A", 2))
load_to("A 0x11\\n", [("A", 0.0)], value("A", 17))
load_to("A nan\\n", [("A", 1.0)], value("A", 1))
load_to("A 1.0000005\\n", [("A", 1.0)])
load_to("A 1.0000015\\n", [("A", 1.0)], value("A", 1))
load_to("FORMAT_VERSION 4\\nA 1\\n", [("A", 1.0)])

for number, kind in ((1.5, None), (3, None), ("0x10", None), ("2.5", None), (3, 2), (-3, 2), (200, 1),
                     (300, 3), (-3, 4), (70000, 5), (-70000, 6), (1.5, 9), ("7", 6), (2.7, 6), (2, 7),
                     (2, 8), (2, 10), (True, None), (float("inf"), None)):
    d, link = mavparm.MAVParmDict(), Link(value("OTHER", 1), value("ABC", 1))
    print(number, kind, d.mavset(link, "abc", number, parm_type=kind), link.sent, dict(d))
for number, kind in ((-3, 1), (300, 1), ("abc", None), (None, None), ("0xzz", None)):
    try:
        mavparm.MAVParmDict().mavset(Link(), "abc", number, parm_type=kind)
    except Exception:
        print("refused", number, kind)
print(mavparm.MAVParmDict().mavset(Link(), "ABC", 5, retries=0))
"""


def test_lines_of_a_file(oracle: str, tmp_path: Path) -> None:
    program = "\n".join(
        f"d = mavparm.MAVParmDict()\nshow(\"d.load(write('f', {line!r}))\", globals()); print(dict(d))"
        for line in (one.encode().decode("unicode_escape") for one in LINES)
        if line not in {"U -0x10", "X 0x", "Y 0x1p", "A 0b1", "A 1.5;"}
    )
    assert_same(SETUP + program, tmp_path, oracle)


@pytest.mark.parametrize("program", [FILES, DIFF, VEHICLE], ids=["files", "diff", "vehicle"])
def test_same_as_pymavlink(program: str, oracle: str, tmp_path: Path) -> None:
    assert_same(SETUP + program, tmp_path, oracle)


def test_a_silent_vehicle(oracle: str, tmp_path: Path) -> None:
    program = """
d, link = mavparm.MAVParmDict(), Link()
link.recv_match = lambda **kw: __import__("time").sleep(0.05)
print(d.mavset(link, "abc", 5, retries=2), link.sent, dict(d))
"""
    assert_same(SETUP + program, tmp_path, oracle)
