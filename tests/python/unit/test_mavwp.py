"""What mavwp does otherwise than pymavlink, on purpose."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from mavwire import mavutil, mavwp
from mavwire.links import state

HEAD = "QGC WPL 110\n"
LINE = "0 1 3 16 0 0 0 0 1 2 3 1\n"


@pytest.fixture(autouse=True)
def mavlink2(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.setenv("MAVLINK20", "1")
    before = state.current_dialect
    mavutil.set_dialect("ardupilotmega")
    yield
    monkeypatch.undo()
    mavutil.set_dialect(before)


def file(folder: Path, text: str | bytes) -> str:
    path = folder / "plan"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return str(path)


def waypoint(**fields: Any) -> Any:
    values = {
        "target_system": 1, "target_component": 1, "seq": 0, "frame": 3, "command": 16, "current": 0,
        "autocontinue": 1, "param1": 0, "param2": 0, "param3": 0, "param4": 0, "x": 1.0, "y": 2.0, "z": 3.0,
    } | fields  # fmt: skip
    name = "MAVLink_mission_item_int_message" if isinstance(values["x"], int) else None
    return getattr(mavutil.mavlink, name or "MAVLink_mission_item_message")(**values)


@pytest.mark.parametrize(
    ("bad", "message"),
    [
        ("0 1 3 16 0 0 0 0 1 2 3", "invalid waypoint line with 11 values"),
        ("0 1 3 x 0 0 0 0 1 2 3 1", "invalid literal for int() with base 10: 'x'"),
        ("0 1 3 16 0 0 0 0 1 b 3 1", "could not convert string to float: 'b'"),
    ],
)
def test_errors_name_file_and_line_and_leave_no_half_mission(
    bad: str, message: str, tmp_path: Path
) -> None:
    loader = mavwp.MAVWPLoader()
    name = file(tmp_path, f"{HEAD}# first\n{LINE}{bad}\n")
    with pytest.raises(mavwp.MAVWPError) as caught:
        loader.load(name)
    assert (caught.value.message, str(caught.value)) == (message, f"{message} ({name}:4)")
    assert isinstance(caught.value, ValueError)
    assert loader.count() == 0


@pytest.mark.parametrize(
    ("loader", "text", "error"),
    [
        (mavwp.MAVRallyLoader, "RALLY 1 2\n", mavwp.MAVRallyError),
        (mavwp.MAVRallyLoader, "RALLY a 2 3 4 5 6\n", mavwp.MAVRallyError),
        (mavwp.MAVRallyLoader, "RALLY 1 2 3 4 5 1.9\n", mavwp.MAVRallyError),
        (mavwp.MAVFenceLoader, "1 2 3\n", mavwp.MAVFenceError),
        (mavwp.MAVFenceLoader, "1 b\n", mavwp.MAVFenceError),
        (mavwp.MissionItemProtocol_Fence, "1 2\n1 b\n", mavwp.MAVFenceError),
        (mavwp.MissionItemProtocol_Rally, "RALLY 1 2 3 4 5 nan\n", mavwp.MAVRallyError),
        (mavwp.MissionItemProtocol_Rally, "QGC WPL 100\n", mavwp.MAVWPError),
        (mavwp.MAVWPLoader, "QGC WPL PB 110\n", mavwp.MAVWPError),
        (mavwp.MAVWPLoader, b"\xff\xfeQ\0G\0C\0", mavwp.MAVWPError),
    ],
)
def test_other_files_have_errors_of_their_own(
    loader: Any, text: str, error: type[Exception], tmp_path: Path
) -> None:
    with pytest.raises(error, match="plan|protobuf"):
        loader().load(file(tmp_path, text))


def test_indented_comments_and_a_byte_order_mark_are_read(tmp_path: Path) -> None:
    loader = mavwp.MAVWPLoader()
    assert loader.load(file(tmp_path, "\ufeff" + HEAD + "  # note\n" + LINE)) == 1
    assert loader.wp(0).comment == "note\n"


def test_comments_of_several_lines_stay_comments(tmp_path: Path) -> None:
    loader, name = mavwp.MAVWPLoader(), str(tmp_path / "saved")
    loader.add(waypoint(), "one\ntwo")
    loader.save(name)
    assert loader.load(name) == 1


def test_integer_items_are_saved_in_degrees_with_all_their_digits(tmp_path: Path) -> None:
    """pymavlink writes the integers, which no program can read back."""
    loader, name = mavwp.MAVWPLoader(), str(tmp_path / "saved")
    loader.add(waypoint(frame=6, x=-353632621, y=1491652374))
    loader.add(waypoint(frame=1, x=-123456, y=50000))
    loader.add(waypoint(frame=2, x=7, y=8))
    loader.save(name)
    places = [tuple(line.split("\t")[8:10]) for line in Path(name).read_text().splitlines()[1:]]
    assert places == [
        ("-35.3632621", "149.1652374"),
        ("-12.345600", "5.000000"),
        ("7.000000", "8.000000"),
    ]
    loader.load(name)
    assert (loader.wp(0).x, loader.wp(0).y) == (-35.3632621, 149.1652374)


def test_rally_points_have_their_altitude_in_metres(tmp_path: Path) -> None:
    loader = mavwp.MissionItemProtocol_Rally()
    loader.load(file(tmp_path, "# home\nRALLY -35.1 149.2 100.5 40 90 1\n"))
    assert loader.wp(0).z == 100.5


def test_rally_points_come_back_as_they_were_saved(tmp_path: Path) -> None:
    """pymavlink multiplies the direction by 100 with every round."""
    loader, name = mavwp.MAVRallyLoader(1, 1), str(tmp_path / "saved")
    loader.create_and_append_rally_point(-350000000, 1490000000, 100, 40, 9000, 1)
    before = str(loader.rally_point(0))
    loader.save(name)
    loader.load(name)
    assert str(loader.rally_point(0)) == before


def test_numbers_that_are_no_point_change_nothing(capsys: pytest.CaptureFixture[str]) -> None:
    rally, fence = mavwp.MAVRallyLoader(), mavwp.MAVFenceLoader()
    rally.create_and_append_rally_point(1, 2, 3, 4, 5, 6)
    for lat in range(5):
        fence.add_latlon(lat, lat)
    before = [str(one) for one in (*rally.rally_points, *fence.points)]
    rally.remove(0), rally.remove(2), rally.move(0, 9, 9), rally.set_alt(0, 9)
    fence.remove(-1), fence.remove(5), fence.move(5, 9, 9), fence.move(-1, 9, 9)
    assert [str(one) for one in (*rally.rally_points, *fence.points)] == before
    said = capsys.readouterr().out.splitlines()
    assert said[:2] == ["Invalid rally point number 0", "Invalid rally point number 2"]
    assert len(said) == 8


@pytest.mark.parametrize("target", [99.0, -1.0, float("nan"), float("inf")])
def test_a_jump_to_nowhere_ends_a_path(target: float) -> None:
    """pymavlink raises AttributeError, or goes round to the last item."""
    loader = mavwp.MAVWPLoader()
    loader.add([waypoint(), waypoint(command=177, x=0.0, y=0.0, param1=target), waypoint()])
    assert loader.view_list() == [[0], [2]]


def test_lists_are_inserted_and_fences_are_drawn() -> None:
    loader = mavwp.MissionItemProtocol_Fence()
    loader.add(waypoint())
    loader.insert(0, [waypoint(x=5.0), waypoint(x=6.0)])
    assert [w.seq for w in loader.wpoints] == [0, 1, 2]
    assert loader.polygon() == [(5.0, 2.0), (6.0, 2.0), (1.0, 2.0)]
    with pytest.raises(mavwp.MAVWPError, match="protobuf"):
        loader.save_as_pb("x")


def test_a_large_mission_takes_linear_time(tmp_path: Path) -> None:
    """Ten thousand landings are ten thousand paths; with quadratic work this never ends."""
    loader = mavwp.MAVWPLoader()
    count = 20_000
    lines = "".join(f"{i} 0 3 21 0 0 0 0 1 2 3 1\n" for i in range(count))
    assert loader.load(file(tmp_path, HEAD + lines)) == count
    assert len(loader.polygon_list()) == count
    loader.remove(list(loader.wpoints))
    assert loader.count() == 0


def test_many_ways_into_a_landing_take_a_walk_over_the_items(monkeypatch: Any) -> None:
    """Each item is looked at some times, not once for each way."""
    looks = 0

    class Counted(list[Any]):
        """Counts the looks at items."""

        def __getitem__(self, index: Any) -> Any:
            nonlocal looks
            looks += 1
            return super().__getitem__(index)

    count = 2000
    loader = mavwp.MAVWPLoader()
    for command in [189] * count + [16]:
        loader.add(mavutil.mavlink.MAVLink_mission_item_message(
            1, 1, 0, 3, command, 0, 1, 0, 0, 0, 0, 1.0, 2.0, 3.0
        ))  # fmt: skip
    loader.wpoints = Counted(loader.wpoints)
    assert loader.view_list() == [[start, count] for start in range(count)]
    assert looks < 20 * count


@pytest.mark.parametrize("kind", ["mission", "rally", "fence"])
def test_a_list_that_cannot_be_written_leaves_the_old_file(kind: str, tmp_path: Path) -> None:
    path = tmp_path / "plan.txt"
    loader: Any
    if kind == "mission":
        loader = mavwp.MAVWPLoader()
        loader.add_latlonalt(1, 2, 3)
        loader.add_latlonalt(1, 2, 3)
        wrong = loader.wpoints
    elif kind == "rally":
        loader = mavwp.MAVRallyLoader()
        loader.create_and_append_rally_point(1, 2, 3, 4, 5, 6)
        loader.create_and_append_rally_point(1, 2, 3, 4, 5, 6)
        wrong = loader.rally_points
    else:
        loader = mavwp.MAVFenceLoader()
        loader.add_latlon(1, 2)
        loader.add_latlon(1, 2)
        wrong = loader.points
    loader.save(str(path))
    before = path.read_bytes()
    wrong[1] = None
    with pytest.raises(AttributeError):
        loader.save(str(path))
    assert path.read_bytes() == before


@pytest.mark.parametrize("word", ["nan", "1e999"])
def test_a_rally_point_at_no_height_names_its_line(word: str, tmp_path: Path) -> None:
    path = tmp_path / "rally.txt"
    path.write_text(f"RALLY 1 2 3 4 5 6\nRALLY 1 2 {word} 4 5 6\n")
    loader = mavwp.MAVRallyLoader()
    loader.create_and_append_rally_point(1, 2, 3, 4, 5, 6)
    with pytest.raises(mavwp.MAVRallyError, match=r"rally\.txt:2"):
        loader.load(str(path))
    assert loader.rally_count() == 1


@pytest.mark.parametrize("loader", [mavwp.MissionItemProtocol_Fence, mavwp.MAVFenceLoader])
@pytest.mark.parametrize("word", ["nan", "1e999", "inf", "-214.8", "1e300"])
def test_a_fence_point_at_no_place_names_its_line(word: str, loader: Any, tmp_path: Path) -> None:
    path = tmp_path / "fence.txt"
    path.write_text(f"1 {word}\n" + "1 2\n" * 5)
    with pytest.raises(mavwp.MAVFenceError, match=r"no place: .*fence\.txt:1"):
        loader().load(str(path))


@pytest.mark.parametrize("loader", [mavwp.MissionItemProtocol_Rally, mavwp.MAVRallyLoader])
@pytest.mark.parametrize("start", ["214.8 2 3", "1 -1e300 3", "nan 2 3", "1 2 nan", "1 2 1e999"])
def test_a_rally_point_at_no_place_names_its_line(start: str, loader: Any, tmp_path: Path) -> None:
    path = tmp_path / "rally.txt"
    path.write_text(f"RALLY 1 2 3 4 5 6\nRALLY {start} 4 5 6\n")
    with pytest.raises(mavwp.MAVRallyError, match=r"no (place|altitude): .*rally\.txt:2"):
        loader().load(str(path))


def test_a_file_in_the_format_without_a_definition_is_named(tmp_path: Path) -> None:
    path = tmp_path / "mission.txt"
    path.write_text("QGC WPL PB 110\n")
    with pytest.raises(mavwp.MAVWPError, match=r"mission\.txt"):
        mavwp.MAVWPLoader().load(str(path))


class _Counted:
    """A fence point that counts what is written to it."""

    writes = 0

    def __setattr__(self, name: str, value: int) -> None:
        type(self).writes += 1
        super().__setattr__(name, value)


def test_fence_points_are_added_in_linear_time() -> None:
    loader = mavwp.MAVFenceLoader(1, 2)
    points = [_Counted() for _ in range(500)]
    for number, point in enumerate(points):
        loader.add(point)
        assert (point.idx, point.count, point.target_system) == (number, number + 1, 1)
    assert [vars(point) for point in loader.points] == [
        {"target_system": 1, "target_component": 2, "idx": number, "count": 500}
        for number in range(500)
    ]
    assert _Counted.writes <= 8 * 500


def test_a_fence_that_grew_keeps_its_numbers_when_points_go() -> None:
    """As after a renumbering at each `add`: `remove` leaves numbers and counts alone."""
    loader = mavwp.MAVFenceLoader()
    for lat in range(5):
        loader.add_latlon(lat, lat)
    loader.remove(2)
    assert [(one.idx, one.count) for one in loader.points] == [(0, 5), (1, 5), (3, 5), (4, 5)]
    loader.points = loader.points[:2]
    assert loader.count() == 2 and loader.point(1).count == 5
    loader.reindex()
    assert [(one.idx, one.count) for one in loader.points] == [(0, 2), (1, 2)]
