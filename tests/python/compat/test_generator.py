"""The generator beside pymavlink's: the same definitions, attributes, names and values.

pymavlink runs in processes of its own and is only ever asked for results.
"""

from __future__ import annotations

import importlib.util
import json
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import mavwire
import pytest
from mavwire.dialects import load

pytestmark = pytest.mark.skipif(
    importlib.util.find_spec("pymavlink") is None, reason="needs pymavlink to compare with"
)

ROOT = Path(__file__).parents[3]
DEFINITIONS = ROOT / "message_definitions" / "v1.0"
DIALECTS = sorted(path.stem for path in DEFINITIONS.glob("*.xml"))
PACKAGE_FOLDER = str(Path(mavwire.__file__).parent.parent)

# Names that exist in pymavlink's modules only because of how these are written.
ACCIDENTAL = {"fastcrc", "mcrf4xx", "object", "range"}


def run(program: str, *arguments: str, cwd: Path | None = None) -> str:
    environment = {**os.environ, "PYTHONPATH": PACKAGE_FOLDER, "PYTHONHASHSEED": "0"}
    result = subprocess.run(
        [sys.executable, "-c", program, *arguments],
        capture_output=True, text=True, env=environment, cwd=cwd, timeout=300, check=False,
    )  # fmt: skip
    assert result.returncode == 0, result.stderr[-2000:]
    return result.stdout


DUMP = """
import contextlib, importlib, io, json, sys
parse = importlib.import_module(sys.argv[1] + ".generator.mavparse")
files, said = json.loads(sys.argv[2]), io.StringIO()

def plain(value):
    if isinstance(value, dict):
        return {str(k): plain(v) for k, v in value.items()}
    if isinstance(value, (list, tuple, type({}.values()))):
        return [plain(v) for v in value]
    if hasattr(value, "__dict__"):
        names = sorted(set(vars(value)) - {"parse_time", "text"})
        return [type(value).__name__, {n: plain(vars(value)[n]) for n in names}]
    return value

out = []
with contextlib.redirect_stdout(said):
    for protocol in ("1.0", "2.0"):
        xml = [parse.MAVXML(file, protocol) for file in files]
        out += [plain(xml), [str(x) for x in xml], parse.total_msgs(xml)]
        out += [[[parse.message_checksum(m), m.base_fields()] for m in x.message] for x in xml]
        out += [parse.check_duplicates(xml), parse.check_missing_enum(xml)]
        out += [plain([x.enum for x in xml])]
json.dump([out, said.getvalue()], sys.stdout)
"""


def dump(package: str, files: list[Path]) -> Any:
    return json.loads(run(DUMP, package, json.dumps([str(file) for file in files])))


RICH = """<?xml version="1.0"?>
<mavlink>
  <include>extra.xml</include>
  <version>7</version>
  <dialect>9</dialect>
  <enums>
    <enum name="FOO_KIND" bitmask="true">
      <description>Kinds &amp; more.</description>
      <entry value="1" name="FOO_KIND_A"><wip/><description>A thing</description></entry>
      <entry value="2**3" name="FOO_KIND_B"/>
      <entry name="FOO_KIND_C"/>
      <entry value="0x40" name="FOO_KIND_D"><deprecated since="2020-01" replaced_by="X"/></entry>
    </enum>
    <enum name="MAV_CMD">
      <entry value="5" name="MAV_CMD_FOO" hasLocation="true" isDestination="true">
        <description>cmd</description>
        <param index="1" label="Radius" units="m" minValue="0" maxValue="10" increment="1">Turn</param>
        <param index="3" reserved="true" default="NaN"/>
        <param index="3" multiplier="1E-2" enum="FOO_KIND"/>
      </entry>
    </enum>
    <enum name="X_MAV_CMD_Y"><entry name="X_Y" value="0"/></enum>
    <enum name="PLAIN"><entry name="PLAIN_A"><param index="2">x</param></entry></enum>
    <enum name="PLAIN"><entry name="PLAIN_B" value="0"/></enum>
  </enums>
  <messages>
    <message id="200" name="FOO">
      <deprecated since="2020-01" replaced_by="BAR">old one</deprecated>
      <description>  A foo
        message </description>
      <field type="uint8_t" name="a" enum="FOO_KIND" display="bitmask">first</field>
      <field type="uint32_t" name="b" units="m/s" multiplier="1E-2" invalid="0"
        print_format="0x%x" instance="true">second</field>
      <field type="char[10]" name="c">third</field>
      <field type="float[4]" name="d">fourth</field>
      <field type="uint8_t" name="target_system">ts</field>
      <field type="uint8_t[2]" name="target_component">tc</field>
      <field type="array[3]" name="old">old array</field>
      <field type="char" name="one"/>
      <field type="uint8_t_mavlink_version" name="v">ver</field>
      <extensions/>
      <field type="double" name="e">ext</field>
      <field type="int64_t[3]" name="f">ext</field>
    </message>
    <message id="70000" name="BAR"><wip/><description>bar</description>
      <field type="int64_t" name="x" minValue="1" default="3">xx</field>
    </message>
    <message id="7" name="MANUAL_CONTROL"><description>sticks</description><field type="int16_t" name="x"/>
      <field type="uint8_t" name="target"/></message>
    <message id="8" name="EMPTY"><description>nothing</description></message>
    <message id="9" name="ONLY_EXTENSIONS"><extensions/><field type="int16_t" name="x"/></message>
  </messages>
</mavlink>
"""

EXTRA = """<mavlink>
  <version>3</version>
  <enums>
    <enum name="MAV_CMD"><entry value="2" name="MAV_CMD_BAR"><description>b</description></entry></enum>
    <enum name="EXTRA"><entry value="-1" name="EXTRA_A"/><entry name="EXTRA_B"/></enum>
  </enums>
  <messages>
    <message id="0" name="HEARTBEAT"><description>alive</description>
      <field type="uint32_t" name="custom_mode"/><field type="uint8_t" name="type"/>
      <field type="uint8_t_mavlink_version" name="mavlink_version"/></message>
  </messages>
</mavlink>
"""


@pytest.fixture
def rich(tmp_path: Path) -> list[Path]:
    (tmp_path / "rich.xml").write_text(RICH)
    (tmp_path / "extra.xml").write_text(EXTRA)
    return [tmp_path / "rich.xml", tmp_path / "extra.xml"]


def test_objects_of_a_rich_file(rich: list[Path]) -> None:
    assert dump("mavwire", rich) == dump("pymavlink", rich)


def test_objects_of_every_dialect() -> None:
    files = [DEFINITIONS / f"{name}.xml" for name in DIALECTS]
    ours, theirs = dump("mavwire", files), dump("pymavlink", files)
    assert ours[1] == theirs[1]
    for mine, other in zip(ours[0], theirs[0], strict=True):
        assert mine == other


N = None
# The values of an enum's entries in three files, each of which includes the next one; N: the entry has none.
EXTENDED_ENUMS = (
    [[N, N]], [[N, 5, N]], [[N, N], [0, 1]], [[N], [N]], [[N, 4], [10]], [[N, 5, N], [6]], [[N, 5, N], [7]],
    [[N, 5, N], [1, 9]], [[10, N], [N, N]], [[N, 6], [N, 12], [8]], [[N], [10], [1]], [[N], [1], [10]],
    [[N], [-1]], [[-5, N], [-4]], [[], [N], [N]], [[7], [], [N, N]],
)  # fmt: skip
# Neither generator makes these: the third file takes a value that an entry has moved to.
COLLIDING_ENUMS = ([[N], [1], [2]], [[N], [2], [N]], [[N, N, N], [N, N], [N]], [[1], [1]])


def extended(folder: Path, enums: tuple[list[list[int | None]], ...]) -> list[Path]:
    """The files, the one that includes first."""
    paths = [folder / f"file{depth}.xml" for depth in range(3)]
    for depth, path in enumerate(paths):
        include = f"<include>{paths[depth + 1].name}</include>" if depth < 2 else ""
        definitions = ""
        for number, parts in enumerate(enums):
            values = parts[depth] if depth < len(parts) else []
            given = ["" if value is None else f"value='{value}'" for value in values]
            entries = "".join(
                f'<entry name="E{number}_{depth}_{i}" {value}/>' for i, value in enumerate(given)
            )
            definitions += f'<enum name="E{number}">{entries}</enum>' if entries else ""
        path.write_text(
            f"<mavlink>{include}<enums>{definitions}</enums><messages>"
            f'<message id="{depth}" name="M{depth}"><description>d</description>'
            f'<field type="uint8_t" name="x">x</field></message></messages></mavlink>'
        )
    return paths


def test_entries_without_a_value(tmp_path: Path) -> None:
    files = extended(tmp_path, EXTENDED_ENUMS)
    assert dump("mavwire", files) == dump("pymavlink", files)
    compare(tmp_path, files[:1], "2.0", documented=False)


@pytest.mark.parametrize("enum", COLLIDING_ENUMS)
def test_entries_without_a_value_that_collide(enum: list[list[int | None]], tmp_path: Path) -> None:
    files = extended(tmp_path, (enum,))
    assert dump("mavwire", files) == dump("pymavlink", files)
    with pytest.raises(ValueError, match=r"enum E0: entry E0_\d_\d: value \d is already used by"):
        load(files[0])


GENERATE = """
import json, sys
package, protocol, output, *files = sys.argv[1:]
mavgen = __import__(package + ".generator.mavgen", fromlist=["mavgen"])
opts = mavgen.Opts(output, wire_protocol=protocol, validate=False)
assert mavgen.mavgen(opts, files)
"""

NAMES = """
import importlib, json, sys
sys.path.insert(0, sys.argv[1])
found = {}
for name in sys.argv[2:]:
    module, star = importlib.import_module(name), {}
    exec(f"from {name} import *", star)
    del star["__builtins__"]
    found[name] = {
        "names": {k: v if isinstance(v, (int, str)) else None for k, v in sorted(star.items())},
        "messages": [[i, c.__name__, c.msgname, c.crc_extra, c.fieldnames, c.unpacker.format,
                      " ".join(c.__doc__.split())]
                     for i, c in module.mavlink_map.items()],
        "enums": {e: [[v, x.name, x.description, x.param, x.has_location] for v, x in entries.items()]
                  for e, entries in module.enums.items()},
    }
json.dump(found, sys.stdout)
"""


def generated(package: str, folder: Path, sources: list[Path], protocol: str) -> Any:
    folder.mkdir()
    for source in sources:
        run(GENERATE, package, protocol, str(folder / f"made_{source.stem}"), str(source))
    return json.loads(run(NAMES, str(folder), *[f"made_{source.stem}" for source in sources]))


def compare(tmp_path: Path, sources: list[Path], protocol: str, *, documented: bool) -> None:
    theirs = generated("pymavlink", tmp_path / "theirs", sources, protocol)
    ours = generated("mavwire", tmp_path / "ours", sources, protocol)
    for source in sources:
        mine, other = ours[f"made_{source.stem}"], theirs[f"made_{source.stem}"]
        for module in (mine, other):
            for name in ACCIDENTAL:
                module["names"].pop(name, None)
            if not documented:
                module["messages"] = [message[:-1] for message in module["messages"]]
                for entries in module["enums"].values():
                    entries[:] = [[value, name, found] for value, name, _, _, found in entries]
        assert mine["names"] == other["names"]
        assert mine["messages"] == other["messages"]
        assert mine["enums"] == other["enums"]


def test_definitions_are_valid_for_pymavlink(tmp_path: Path) -> None:
    program = """
import sys
from pymavlink.generator import mavgen
for file in sys.argv[1:]:
    assert mavgen.mavgen(mavgen.Opts("made", wire_protocol="2.0", validate=True), [file]), file
"""
    files = sorted(map(str, DEFINITIONS.glob("*.xml")))
    assert f"Validating {files[0]}" in run(program, *files, cwd=tmp_path)


@pytest.mark.parametrize("protocol", ["1.0", "2.0"])
def test_generated_module_of_a_rich_file(rich: list[Path], tmp_path: Path, protocol: str) -> None:
    # pymavlink's generated code is no Python where a message has no fields, and parameters mean
    # something only in commands.
    text = re.sub(r'<message id="(8|9)".*?</message>', "", RICH)
    text = text.replace('<param index="2">x</param>', "")
    rich[0].write_text(text)
    compare(tmp_path, rich[:1], protocol, documented=True)


@pytest.mark.parametrize("protocol", ["1.0", "2.0"])
def test_generated_modules_of_dialects(tmp_path: Path, protocol: str) -> None:
    # mavwire's own definitions hold no descriptions, and its modules look for them elsewhere.
    sources = [DEFINITIONS / f"{name}.xml" for name in ("ardupilotmega", "test")]
    compare(tmp_path, sources, protocol, documented=False)


FIELD_FUNCTIONS = """
import importlib, json, sys
parse = importlib.import_module(sys.argv[1] + ".generator.mavparse")
made = importlib.import_module(sys.argv[1] + ".generator.mavgen_python")
class Xml:
    version = 3
names = ["mavfmt", "native_mavfmt", "mavpytype", "mavdefault"]
types = ["char", "uint8_t", "int8_t", "uint16_t", "int16_t", "uint32_t", "int32_t", "uint64_t",
         "int64_t", "float", "double"]
out = []
for written in [*types, *[t + "[3]" for t in types], "array[4]", "uint8_t_mavlink_version"]:
    field = parse.MAVField("a", written, None, Xml())
    out.append([getattr(made, name)(field) for name in names])
message = parse.MAVXML(sys.argv[2], "2.0").message[0]
for attribute in ["units", "enum", "display", "print_format", "type", "instance", "array_length"]:
    out.append(made.byname_hash_from_field_attribute(message, attribute))
print(json.dumps(out))
"""


def test_functions_on_fields(rich: list[Path]) -> None:
    ours = run(FIELD_FUNCTIONS, "mavwire", str(rich[0]))
    assert ours == run(FIELD_FUNCTIONS, "pymavlink", str(rich[0]))


INTERFACE = """
import importlib, inspect, json, sys
found = {}
for name in ["mavgen", "mavparse", "mavcrc", "mavtemplate", "mavgen_python"]:
    module = importlib.import_module(sys.argv[1] + ".generator." + name)
    for key, value in vars(module).items():
        if key.startswith("_") or inspect.ismodule(value):
            continue
        if inspect.isfunction(value) or inspect.isclass(value):
            parameters = inspect.signature(value).parameters.values()
            found[name + "." + key] = [[p.name, repr(p.default)] for p in parameters]
            if inspect.isclass(value):
                found[name + "." + key + "()"] = sorted(m for m in dir(value) if m[0] != "_")
        elif isinstance(value, (int, str, list, bool)):
            found[name + "." + key] = value
print(json.dumps(found))
"""

# Parts of a text that mavwire does not write, and a file it does not have (docs/compatibility.md).
NOT_OFFERED = {
    "mavgen.schemaFile",
    "mavgen_python.generate_classes",
    "mavgen_python.generate_enums",
    "mavgen_python.generate_mavlink_class",
    "mavgen_python.generate_message_ids",
    "mavgen_python.generate_methods",
    "mavgen_python.generate_preamble",
    "mavcrc.mcrf4xx",
}


def test_public_names_signatures_and_constants() -> None:
    ours = json.loads(run(INTERFACE, "mavwire"))
    for name, theirs in json.loads(run(INTERFACE, "pymavlink")).items():
        if name in NOT_OFFERED:
            continue
        if name.endswith("()"):
            assert set(theirs) <= set(ours[name]), name
        else:
            assert ours[name] == theirs, name


CRC = """
import importlib, sys
crc = importlib.import_module(sys.argv[1] + ".generator.mavcrc")
for kind in (crc.x25crc, crc.x25crc_fast, crc.x25crc_slow):
    for data in [b"123456789", "123456789", "h\\u00e9\\u1234", [1, 2, 255], bytearray(b"ab"),
                 memoryview(b"abc"), b"", None, 5, [300], ["a"], object()]:
        for how in ("accumulate", "accumulate_str"):
            try:
                sum = kind(b"start")
                result = getattr(sum, how)(data)
                print(kind.__name__, repr(data)[:12], how, result, sum.crc)
            except (TypeError, ValueError) as error:
                # An element that is no byte: the reference's slow variant takes 300 for a byte.
                print(kind.__name__ if data != [300] else "", repr(data)[:12], how, "error")
    print(kind(None).crc, kind("abc").crc)
"""


def test_checksums() -> None:
    ours = [line for line in run(CRC, "mavwire").splitlines() if "[300]" not in line]
    theirs = [line for line in run(CRC, "pymavlink").splitlines() if "[300]" not in line]
    assert ours == theirs
    assert "x25crc_fast b'123456789' accumulate None" in "\n".join(ours)


TEMPLATE = """
import importlib, json, random, sys
template = importlib.import_module(sys.argv[1] + ".generator.mavtemplate").MAVTemplate
rng = random.Random(7)
pieces = ["}", "l:", "x", "${x}", "${y}", "${{l:a}}", "${{l:${z}}}", "${{m:${{l:${z}}}-}}", "\\n", " "]
values = {"x": 1, "y": "why", "l": [{"z": 1}, {"z": "q"}], "m": [{"l": [{"z": 5}]}], "z": 0}
out = []
for _ in range(3000):
    text = "".join(rng.choice(pieces) for _ in range(rng.randrange(1, 9)))
    try:
        out.append(template().substitute(text, values))
    except Exception as error:
        out.append([type(error).__name__, str(error)])
print(json.dumps(out))
"""


def test_templates() -> None:
    ours = json.loads(run(TEMPLATE, "mavwire"))
    theirs = json.loads(run(TEMPLATE, "pymavlink"))
    # An empty text before an empty repetition makes the reference fail with an IndexError.
    pairs = [(a, b) for a, b in zip(ours, theirs, strict=True) if b[:1] != ["IndexError"]]
    assert len(pairs) > 2900
    assert [a for a, _ in pairs] == [b for _, b in pairs]


@pytest.mark.parametrize("language", ["C", "C++11", "Java", "WLua"])
def test_other_languages(language: str, tmp_path: Path) -> None:
    """An installed pymavlink generates them, in a process of its own."""
    (tmp_path / "a.xml").write_text(
        '<mavlink><enums></enums><messages><message id="1" name="A"><description>d</description>'
        '<field type="uint8_t" name="x">x</field></message></messages></mavlink>'
    )
    program = f"""
import pathlib, sys
mavgen = __import__(sys.argv[1] + ".generator.mavgen", fromlist=["mavgen"])
opts = mavgen.Opts("out", wire_protocol="2.0", language={language!r})
print(mavgen.mavgen(opts, [pathlib.Path("../a.xml")]))
assert "pymavlink" not in sys.modules or sys.argv[1] == "pymavlink"
"""
    printed = {}
    for package in ("mavwire", "pymavlink"):
        (tmp_path / package).mkdir()
        printed[package] = run(program, package, cwd=tmp_path / package)
    assert printed["mavwire"] == printed["pymavlink"]
    ours, theirs = (
        {
            path.relative_to(tmp_path / package): path.read_bytes()
            for path in (tmp_path / package).rglob("*")
            if path.is_file()
        }
        for package in printed
    )
    assert ours == theirs
    assert ours
