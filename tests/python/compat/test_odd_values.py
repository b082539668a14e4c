"""Values that are no numbers, missing ones and wrong ones, beside pymavlink: the same answers."""

from __future__ import annotations

from pathlib import Path

import pytest
from beside import assert_same

pytest.importorskip("numpy")

SETUP = """
import warnings
warnings.simplefilter("ignore")
mavextra, rotmat, quaternion, mavwp, mavparm = map(
    load, ("mavextra", "rotmat", "quaternion", "mavwp", "mavparm"))
numpy = importlib.import_module("numpy")
nan, inf = float("nan"), float("inf")

class Message:
    def __init__(self, **fields):
        self.__dict__.update(fields)
"""

FILTERS = """
for first in (nan, inf, None, 5, "text"):
    key = str(first)
    for value in (first, first, 3.0, 3.0):
        for text in ("diff(value, key)", "lowpassHz(value, key, 100, 10)"):
            show(f"mavextra.{text}", globals())

class Link:
    timestamp = 0.0
load("mavutil").mavfile_global = link = Link()
for value in (numpy.array([1.0, 2.0]), numpy.float32(1.5)):
    for step in range(7):
        link.timestamp += 0.5 + step / 10
        value = value + step * step
        show("mavextra.second_derivative_5(value, str(type(value)))", globals())
"""

MOTORS = """
battery = Message(Volt=12.3)
for outputs in (Message(C1=1537, C2=900, C3=2111), Message(C2=1500, C3=1600),
                Message(C1=1500, C3=1600), Message(C1=None, C2=1500), Message(C1=nan), None):
    for motors in ((1000, 2000, 1, 1), (1000, 2000, 1, 2), (1000, 2000, 1, 3), (1013, 1987, 1, 1),
                   (1600, 1500, 1, 3), (1000, 1000, 1, 1), (1000, 2000, 2, 1)):
        print(outputs and vars(outputs), motors)
        show("mavextra.mm_curr(outputs, battery, *motors)", globals())
"""

ROTATIONS = """
for other in (rotmat.Vector3(nan, 0, 0), rotmat.Vector3(1, 2, 3), rotmat.Vector3(-1, -2, -3)):
    show("round(rotmat.Vector3(1, 2, 3).angle(other), 6)", globals())
for angle in (nan, inf, -inf):
    show("mavextra.rotate_quat((0.5, 0.5, 0.5, 0.5), angle, 1.0, 2.0)", globals())
    show("mavextra.euler_to_quat((0.1, angle, 0.2))", globals())
"""

FILES = """
for name in (None, 5.5, []):
    show("mavparm.MAVParmDict().load(name)", globals())
loader = mavwp.MAVRallyLoader(1, 2)
for point in ((1.7, 2.7, 3.7, 4.7, 5.7, 6), ("1", "2", "3", "4", "5", 6), (nan, 1, 1, 1, 1, 1),
              (1, inf, 1, 1, 1, 1), (1, 1, None, 1, 1, 1), (1, 1, 1, "x", 1, 1)):
    show("loader.create_and_append_rally_point(*point)", globals())
    print([str(p) for p in loader.rally_points])
"""

CSV = """
CSVReader = load("CSVReader")
for text in ("T;A\\n1;2\\n2;3\\n3;9\\n", "T;A\\n", "T;A\\nx;1\\n"):
    show("str(CSVReader.CSVReader(write('f.csv', text)).recv_msg())", globals())
    log = CSVReader.CSVReader(write("f.csv", text))
    messages = log.messages
    for step in ("log.rewind()", "log.recv_msg()", "log._count", "log.recv_msg()", "log.rewind()",
                 "log.recv_msg()", "log.count_lines()", "log.recv_msg()"):
        print(step, str(messages.get("CSV")))
        try:
            eval(step)
        except Exception as error:
            print(type(error).__name__)
    print(messages is log.messages)
"""

TRANSFERS = """
import logging
logging.basicConfig(level=0, format="%(message)s", stream=sys.stdout)
mavftp = load("mavftp")
entries = [mavftp.DirectoryEntry("a", False, 2048), mavftp.DirectoryEntry("d", True, 0)]
for listing in (None, [], entries):
    for code in (0, 10, 999):
        mavftp.MAVFTPReturn("ListDirectory", code, directory_listing=listing).display_message()
for order in ("missionplanner", "mavproxy", "none"):
    show("mavftp.MAVFTP.extract_params(None, order)", globals())
"""


@pytest.mark.parametrize("name", ["FILTERS", "MOTORS", "ROTATIONS", "FILES", "CSV", "TRANSFERS"])
def test_same_as_pymavlink(name: str, oracle: str, tmp_path: Path) -> None:
    assert_same(SETUP + globals()[name], tmp_path, oracle)
