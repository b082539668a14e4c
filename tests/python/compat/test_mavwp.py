"""Missions, fences and rally points beside pymavlink's: the same items, paths, files and texts."""

from __future__ import annotations

from pathlib import Path

import pytest
from beside import assert_same

SETUP = """
import copy, random
mavwp, mavutil = load("mavwp"), load("mavutil")
mavutil.set_dialect("ardupilotmega")
mavlink = mavutil.mavlink

def items(loader):
    points = getattr(loader, "wpoints", None)
    if points is None:
        points = getattr(loader, "points", None) or getattr(loader, "rally_points", None) or []
    for w in points:
        print("   ", w, repr(getattr(w, "comment", None)))

def wp(cmd=16, x=1.0, y=2.0, p1=0, seq=0):
    return mavlink.MAVLink_mission_item_message(9, 9, seq, 3, cmd, 0, 1, p1, 0, 0, 0, x, y, 3.0)

def views(l):
    for method in ("view_indexes", "view_list", "polygon", "polygon_list"):
        print(method, getattr(l, method)())
"""

WAYPOINT_FILES = """
line = "0 1 0 16 0 0 0 0 1 2 3 1\\n"
head = "QGC WPL 110\\n"
texts = ["", "\\n", "# x\\n" + head, "QGC WPL 100\\n", "QGC WPL 120\\n", "QGC WPL 110", "QGC WPL 110\\r\\n",
    " QGC WPL 110\\n", "QGC WPL 110 X\\n", "\\n" + head, head + "0 1 0 0 0 0 0 0 1 2 3 1\\n1 0 0 0 0 0 0 0 1 2 3 1\\n",
    head + "1 1 0 0 0 0 0 0 1 2 3 1\\n", head + "5 1 0 16 0 0 0 0 1 2 3 1\\n5 0 0 16 0 0 0 0 1 2 3 1\\n",
    head + "0 1 0 16 1e3 nan inf -0 1 2 3 0\\n", head + "0 1 0 70000 0 0 0 0 1 2 3 1\\n",
    head + "-1 1 256 16 0 0 0 0 1e40 2 3 1\\n", head + "#only comment", head + "  " + line + "\\n\\n",
    head + "# a\\n#b\\n#  c  d\\n" + line + "#e\\n\\n#f\\n\\n" + line + "#end\\n",
    head + "0\\t1\\t0\\t16\\t0\\t0\\t0\\t0\\t-35.363262\\t149.165237\\t584.090027\\t1\\n",
    "QGC WPL 100\\n# c\\n0 1 3 16 10 20 1 30 -35.1 149.2 100 1 9\\n",
    *(f"QGC WPL 100\\n0 1 {a} 1 2 3 4 5 6 7 8 9 10\\n" for a in range(-1, 40))]
for text in texts:
    l = mavwp.MAVWPLoader(5, 6)
    l.add_latlonalt(1, 2, 3)
    show("l.load(write('f', text))", globals())
    items(l)
    show("l.save('saved')", globals())
    print(repr(open("saved").read()), l.last_change > 0)
    show("mavwp.get_first_line_from_file('f')", globals())
show("mavwp.MAVWPLoader().load('missing')", globals())
show("mavwp.get_first_line_from_file(write('g', '#a\\\\n  b  \\\\n'))", globals())
"""

EDITING = """
l, w = mavwp.MAVWPLoader(5, 6), wp(seq=7)
print({k: v for k, v in vars(l).items()}, l.mav_mission_type())
l.add(w); l.add(w, "hello"); l.add([wp(x=5.0), wp(x=6.0)], "ignored")
items(l)
print(l.wpoints[0] is w, w.seq, hasattr(w, "comment"), l.count())
for text in ("l.wp(-1)", "l.wp(0)", "l.wp(9)", "l.wp('a')", "l.item(2)", "l.item(9)"):
    print(text, str(eval(text)))
l.insert(1, wp(x=50.0), "ins"); l.insert(100, wp(x=53.0)); l.insert(-1, wp(x=54.0))
items(l)
l.set(wp(x=60.0), 1); l.set(wp(x=61.0), l.count()); l.set(w, 0)
items(l)
print(l.wpoints[0] is w)
try:
    l.set(wp(), 99)
except mavwp.MAVWPError as error:
    print(error, error.message)
l.remove(l.wp(3)); l.remove([l.wp(0), l.wp(1)]); l.remove(copy.copy(l.wp(0)))
items(l)
show("l.remove(wp(x=1234.0))", globals())
l.reindex(); l.clear()
l.add_latlonalt(-35.5, 149.5, 100); l.add_latlonalt(-35.5, 149.5, 100, terrain_alt=True)
items(l)
for cls in (mavwp.MAVWPLoader, mavwp.MissionItemProtocol_Fence, mavwp.MissionItemProtocol_Rally):
    c = cls()
    print(c.mav_mission_type(), [n for n in (*mavlink.enums["MAV_CMD"], 12345) if c.is_location_command(n)])
c = mavwp.MAVWPLoader()
for n in sorted(mavlink.enums["MAV_CMD"]):
    c.clear(); c.add(wp(cmd=n))
    print(n, c.wp_is_loiter(0), c.is_location_wp(wp(n, 0, 0)), c.is_location_wp(wp(n)))
show("c.wp_is_loiter(5)", globals())
"""

PATHS = """
R = random.Random(5)
for case in range(300):
    count = R.randint(0, 9)
    l = mavwp.MAVWPLoader(1, 1)
    for i in range(count):
        cmd = R.choice([16, 16, 16, 16, 177, 21, 189, 188, 20, 22, 85, 5001, 5002, 82])
        if cmd == 177:
            l.add(wp(177, 0, 0, p1=R.choice((R.randint(0, count - 1), R.random() * count))))
        else:
            l.add(wp(cmd, 0, 0) if R.random() < 0.3 else wp(cmd, float(i), i + 0.5))
    print([(w.command, w.x, w.param1) for w in l.wpoints])
    views(l)
for done in (set(), {0}, {0, 1, 2}, {1}, None):
    l = mavwp.MAVWPLoader()
    l.add([wp(), wp(), wp()])
    print(l.view_indexes(done), done)
"""

FENCES = """
points = "-35.0 149.0\\n-35.1 149.1\\n-35.2 149.2\\n-35.3 149.3\\n-35.1 149.1\\n"
head = "QGC WPL 110\\n"
for text in (points, "-35.0 149.0\\n" * 4, "1 2\\n", "", "hello\\n", points + "-1 -2\\n", "1 2 3\\n", points + "\\n\\n",
             points.replace(" ", "\\t"), head, head + "0 0 3 5001 3 0 0 0 1 2 3 1\\n",
             "-35.123456789 149.123456789\\n" * 6, "95 200\\n" * 6, points.replace("149.3", "149.3 5")):
    l = mavwp.MissionItemProtocol_Fence(3, 4)
    l.add(wp())
    show("l.load(write('f', text))", globals())
    items(l)
for text in (points, "#c\\n\\n" + points, "", "1 2\\n", points * 2, "1 2 3\\n", "1,2\\n", "1.5\\t2\\n\\n",
             points + "#x\\n"):
    l = mavwp.MAVFenceLoader(3, 4)
    show("l.load(write('f', text))", globals())
    items(l)
    l.save("saved"); print(repr(open("saved").read()))
l = mavwp.MAVFenceLoader(3, 4)
l.load(write("f", points))
for text in ("l.count()", "l.polygon()", "l.move(0, 9, 9)", "l.move(1, 8, 8)", "l.move(4, 7, 7)", "l.remove(2)",
             "l.polygon()", "l.remove(1)", "l.polygon()", "l.reindex()", "l.clear()", "l.polygon()"):
    show(text, globals())
    items(l)
p = mavlink.MAVLink_fence_point_message(1, 1, 7, 7, 1.0, 2.0)
l.add(p); l.add_latlon(5, 6); l.add_latlon(7, 8); l.add_latlon(9, 10)
items(l)
before = l.last_change
l.move(1, 1, 1, False); l.remove(1, False)
print(l.last_change == before, l.points[0] is p, str(l.point(0)))
"""

RALLY = """
line = "RALLY -35.1 149.2 100.5 40.0 90.0 1\\n"
for text in (line, "#c\\n\\n" + line * 2, "", "\\n" + line, line.replace(" ", "\\t"), line.lower(), line * 12,
             line + "X 1 2 3 4 5 6\\n", "X 1\\n" + line, "RALLY -35.123456789 149.1 -10 40 -90 255\\n", "hello\\n",
             "RALLY 1 2 3 4 5\\n", "RALLY 1 2 3 4 5 6 7\\n"):
    l = mavwp.MAVRallyLoader(3, 4)
    show("l.load(write('f', text))", globals())
    if not text.startswith("X"):
        items(l)
for text in ("", "hello\\n", "QGC WPL 110\\n0 0 3 5100 0 0 0 0 1 2 3 1\\n", "RALLY 1 2 3 4 5\\n"):
    l = mavwp.MissionItemProtocol_Rally(3, 4)
    l.add(wp())
    show("l.load(write('f', text))", globals())
    items(l)
l = mavwp.MissionItemProtocol_Rally(3, 4)
show("l.load(write('f', line * 2 + 'RALLY -35.1 149.2 0 40.0 90.0 1'))", globals())
for w in l.wpoints:
    w.z = 0
items(l)
l = mavwp.MAVRallyLoader(3, 4)
for i in range(12):
    l.create_and_append_rally_point(-350000000 + i, 1490000000, 100, 50, 90, i)
items(l)
p = mavlink.MAVLink_rally_point_message(1, 1, 5, 5, 1, 2, 3, 4, 5, 6)
for text in ("l.append_rally_point(p)", "l.clear()", "l.append_rally_point(p)", "l.move(1, -30.5, 140.5)",
             "l.set_alt(1, 77)", "l.set_alt(1, 78, 33)", "l.set_alt(1, -5, 0)", "l.reindex()", "l.rally_count()",
             "str(l.rally_point(0))", "l.rally_point(9)", "l.set_alt(9, 1)", "l.remove(1)", "l.rally_count()"):
    show(text, globals())
    items(l)
"""


@pytest.mark.parametrize("mavlink20", [True, False], ids=["v2", "v1"])
@pytest.mark.parametrize("name", ["WAYPOINT_FILES", "EDITING", "PATHS", "FENCES", "RALLY"])
def test_same_as_pymavlink(name: str, mavlink20: bool, oracle: str, tmp_path: Path) -> None:
    assert_same(SETUP + globals()[name], tmp_path, oracle, mavlink20)
