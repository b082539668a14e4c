"""mavgen: what it writes, what it refuses, and that no text from a file becomes code or hangs the reader."""

from __future__ import annotations

import ast
import errno
import importlib.util
import os
import pickle
import sys
from pathlib import Path
from types import ModuleType

import pytest
from mavwire._native import DefinitionFile
from mavwire.generator import _upstream, mavgen, mavgen_python
from mavwire.generator.mavparse import (
    MAVXML,
    MAVParseError,
    MAVSyntaxError,
    check_duplicates,
    merge_enums,
)
from watchdog import watched

FIELD = '<field type="uint8_t" name="a">a</field>'


def message(identifier: object = 1, name: str = "PROBE", fields: str = FIELD) -> str:
    return (
        f'<message id="{identifier}" name="{name}"><description>d</description>{fields}</message>'
    )


def document(messages: str = "", enums: str = "", head: str = "") -> str:
    return (
        f'<?xml version="1.0"?>\n<mavlink>\n{head}\n<enums>\n{enums}\n</enums>\n'
        f"<messages>\n{messages}\n</messages>\n</mavlink>\n"
    )


def enum(*entries: tuple[str, str], name: str = "KIND", attributes: str = "") -> str:
    body = "".join(f'<entry name="{n}" value="{v}"/>\n' for n, v in entries)
    return f'<enum name="{name}" {attributes}>{body}</enum>'


def write(folder: Path, name: str, text: str) -> str:
    path = folder / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")
    return str(path)


def generate(folder: Path, text: str, output: str = "made", **options: object) -> bool:
    options.setdefault("wire_protocol", "2.0")
    opts = mavgen.Opts(str(folder / output), **options)  # type: ignore[arg-type]
    return mavgen.mavgen(opts, [write(folder, "probe.xml", text)])


def load(path: Path) -> ModuleType:
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[path.stem] = module
    spec.loader.exec_module(module)
    return module


def parse(folder: Path, text: str, wire_protocol: str = "2.0") -> MAVXML:
    return MAVXML(write(folder, "probe.xml", text), wire_protocol)


# What is generated


def test_module_is_complete(tmp_path: Path) -> None:
    fields = FIELD + '<field type="float[3]" name="xyz" units="m">z</field><extensions/>'
    fields += '<field type="char[5]" name="text">t</field>'
    text = document(message(9000, fields=fields), enum(("KIND_A", "2**3"), ("KIND_B", "0x10")))
    assert generate(tmp_path, text, "made_whole")
    names: dict[str, object] = {}
    load(tmp_path / "made_whole.py")
    exec("from made_whole import *", names)
    assert (names["KIND_A"], names["KIND_B"], names["KIND_ENUM_END"]) == (8, 16, 17)
    assert names["DIALECT"] == "made_whole"
    assert names["WIRE_PROTOCOL_VERSION"] == "2.0"
    built = names["MAVLink_probe_message"](7, [1, 2, 3], b"hey")  # type: ignore[operator]
    assert str(built) == "PROBE {a : 7, xyz : [1, 2, 3], text : hey}"
    sender = names["MAVLink"](None, 1, 2)  # type: ignore[operator]
    again = names["MAVLink"](None).parse_char(built.pack(sender))  # type: ignore[operator]
    assert again.to_dict() == built.to_dict()
    assert pickle.loads(pickle.dumps(again)).to_dict() == built.to_dict()


def test_wire_protocol_1_leaves_out_what_it_cannot_carry(tmp_path: Path) -> None:
    fields = FIELD + '<extensions/><field type="uint8_t" name="b">b</field>'
    text = document(message(1, "SMALL", fields) + message(300, "HIGH"))
    assert generate(tmp_path, text, "made_v1", wire_protocol="1.0")
    module = load(tmp_path / "made_v1.py")
    assert list(module.mavlink_map) == [1]
    assert module.MAVLink_small_message.fieldnames == ["a"]
    assert module.WIRE_PROTOCOL_VERSION == "1.0"


def test_descriptions_are_kept(tmp_path: Path) -> None:
    written = 'Höhe & "Breite" <3 \U0001f681\n  second line \u2028 \u202e'
    text = document(message().replace("<description>d<", f"<description>{_escape(written)}<"))
    text = text.replace(">a</field>", f">{_escape(written)}</field>")
    assert generate(tmp_path, text, "made_texts")
    assert "\u202e" not in (tmp_path / "made_texts.py").read_text(encoding="utf-8")
    sources = load(tmp_path / "made_texts.py")._SOURCES
    again = parse(tmp_path, sources["probe"])
    assert again.message[0].description == written
    assert again.message[0].fields[0].description == written


def _escape(text: str) -> str:
    return text.replace("&", "&amp;").replace("<", "&lt;")


def test_files_of_the_same_name_and_own_includes(tmp_path: Path) -> None:
    write(tmp_path, "sub/probe.xml", document(message(3, "INNER")))
    write(
        tmp_path,
        "other.xml",
        document(message(2, "OTHER"), head="<include>sub/probe.xml</include>"),
    )
    head = "<include> other.xml </include><include>./sub/../other.xml</include>"
    assert generate(tmp_path, document(message(1, "OUTER"), head=head), "made_of_three")
    module = load(tmp_path / "made_of_three.py")
    assert list(module.mavlink_map) == [1, 2, 3]


def test_several_files_on_the_command_line(tmp_path: Path) -> None:
    files = [
        write(tmp_path, "one.xml", document(message(1, "ONE"))),
        write(tmp_path, "two.xml", document(message(2, "TWO"))),
    ]
    assert mavgen.mavgen(mavgen.Opts(str(tmp_path / "made_of_two.py"), "2.0"), files)
    assert list(load(tmp_path / "made_of_two.py").mavlink_map) == [1, 2]


def test_built_in_dialects_can_be_included_without_their_files(tmp_path: Path) -> None:
    field = '<field type="uint8_t" name="kind" enum="MAV_TYPE">k</field>'
    head = "<include>minimal.xml</include>"
    assert generate(tmp_path, document(message(9000, fields=field), head=head), "made_on_minimal")
    module = load(tmp_path / "made_on_minimal.py")
    assert set(module.mavlink_map) == {0, 9000}
    assert module.MAV_TYPE_QUADROTOR == 2
    misspelt = field.replace("MAV_TYPE", "MAV_TIPE")
    assert not generate(tmp_path, document(message(9000, fields=misspelt), head=head))


def test_output_appears_whole_or_not_at_all(tmp_path: Path) -> None:
    (tmp_path / "made.py").write_text("# the one before")
    overlong = '<field type="uint64_t[40]" name="a">a</field>'
    assert not generate(tmp_path, document(message(fields=overlong)))
    assert (tmp_path / "made.py").read_text() == "# the one before"
    assert generate(tmp_path, document(message()), "made.py")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["made.py", "probe.xml"]
    with pytest.raises(FileNotFoundError, match="No such folder"):
        generate(tmp_path, document(message()), "no/such/folder/made")


def test_generating_twice_gives_the_same_bytes(tmp_path: Path) -> None:
    text = document(message(), enum(("KIND_A", "1")))
    assert generate(tmp_path, text)
    first = (tmp_path / "made.py").read_bytes()
    assert generate(tmp_path, text)
    assert (tmp_path / "made.py").read_bytes() == first


# No text becomes code

INJECTION = "\"\"\"\n'''\nimport os; os.abort()\n{0} {name} \\x22 \\"


def test_module_holds_literals_and_one_call(tmp_path: Path) -> None:
    """R69."""
    described = document(message(), enum(("KIND_A", "1"))).replace(">d<", f">{INJECTION}<")
    evil = tmp_path / "a'\"\\\n{x}"
    path = write(evil, 'it\'s\n"import os".xml', described)
    output = evil / "o'\"+__import__('os').abort()+'.py"
    assert mavgen.mavgen(mavgen.Opts(str(output), "2.0"), [path])
    tree = ast.parse(output.read_text(encoding="utf-8"))
    kinds = [type(node) for node in tree.body]
    assert kinds == [ast.Expr, ast.ImportFrom, *[ast.Assign] * 4, ast.Expr]
    for node in tree.body[2:6]:
        ast.literal_eval(node.value)  # type: ignore[attr-defined]
    calls = [node for node in ast.walk(tree) if isinstance(node, ast.Call)]
    assert [ast.unparse(call.func) for call in calls] == ["_populate", "globals"]
    exec(compile(tree, "module", "exec"), {"__name__": "probe"})


@pytest.mark.parametrize(
    "text",
    [
        document(message(name="A;import os")),
        document(message(name="A B")),
        document(message(name="9A")),
        document(message(fields='<field type="uint8_t" name="a=os.abort()">d</field>')),
        document(message(fields='<field type="uint8_t" name="lambda">d</field>')),
        document(enums=enum(("A-B", "1"))),
        document(enums=enum(("None", "1"))),
        document(enums=enum(("A", "1"), name="E()")),
    ],
)
def test_names_must_be_names(tmp_path: Path, text: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert not generate(tmp_path, text, validate=False)
    said = capsys.readouterr().out
    assert "probe.xml:" in said
    assert "is not a name" in said or "is a reserved word" in said
    assert not (tmp_path / "made.py").exists()


@pytest.mark.parametrize(
    "value",
    ["__import__('os').abort()", "1 and 2", "9**9**9", "2**99", "1<<64", "", "1e3", "0x", "²"],
)
def test_enum_values_are_numbers(tmp_path: Path, value: str) -> None:
    text = document(enums=enum(("A", _escape(value))))
    with pytest.raises(
        MAVParseError, match=r"probe\.xml:5:\d+: enum KIND: entry A: value .* 64 bits"
    ):
        parse(tmp_path, text)


@pytest.mark.parametrize(
    ("value", "number"),
    [("12", 12), ("0x1F", 31), ("0b101", 5), ("2**4", 16), ("1<<4", 16), (" -3 ", -3), ("007", 7)],
)
def test_forms_of_enum_values(tmp_path: Path, value: str, number: int) -> None:
    xml = parse(tmp_path, document(enums=enum(("A", _escape(value)))))
    assert xml.enum[0].entry[0].value == number


# Hostile files


def refused(folder: Path, text: str, match: str) -> None:
    with watched(), pytest.raises(MAVParseError, match=match):
        parse(folder, text)


@pytest.mark.parametrize("version", ["1.0", "2.0"])
def test_types_of_extension_fields_are_checked(version: str, tmp_path: Path) -> None:
    """Of MAVLink 1 too, which leaves the fields out."""
    fields = FIELD + '<extensions/><field type="bool" name="b"/>'
    path = write(tmp_path, "probe.xml", document(message(fields=fields)))
    with pytest.raises(MAVParseError, match="unknown type 'bool'"):
        MAVXML(path, version)


def test_entities_and_document_types_are_refused(tmp_path: Path) -> None:
    laughs = "".join(f'<!ENTITY l{i + 1} "{f"&l{i};" * 10}">' for i in range(9))
    text = f'<!DOCTYPE m [<!ENTITY l0 "ha">{laughs}]><mavlink>&l9;</mavlink>'
    refused(tmp_path, text, r"probe\.xml:1:\d+: a document type declaration")
    refused(tmp_path, '<!DOCTYPE m SYSTEM "file:///etc/passwd"><mavlink/>', "DOCTYPE")
    refused(tmp_path, "<mavlink>&unknown;</mavlink>", r"probe\.xml:1:\d+: not well-formed")


def test_depth_size_and_numbers_are_capped(tmp_path: Path) -> None:
    refused(tmp_path, "<mavlink>" * 200_000, "nested deeper than 16")
    refused(tmp_path, "<mavlink>" + "<a/>" * 600_000 + "</mavlink>", "more than 500000 XML nodes")
    refused(tmp_path, " " * (16 * 1024 * 1024 + 1), "larger than")
    huge = "9" * 100_000
    refused(tmp_path, document(message(huge)), r"id '9+\.\.\.' is not a number from 0 to 16777215")
    array = f'<field type="uint8_t[{huge}]" name="a">a</field>'
    refused(
        tmp_path, document(message(fields=array)), r"array length '9+\.\.\.' is not from 1 to 255"
    )
    refused(
        tmp_path, document(enums=enum(("A", huge))), "is not a number of 64 bits: write it as 10,"
    )
    refused(tmp_path, document(head=f"<version>{huge}</version>"), "from 0 to 255")


def test_many_entries_and_messages_take_linear_time(tmp_path: Path) -> None:
    entries = [(f"KIND_{i}", str(i)) for i in range(20_000)]
    messages = "".join(message(i, f"M{i}") for i in range(5_000))
    with watched():
        xml = parse(tmp_path, document(messages, enum(*entries)))
        assert not check_duplicates([xml])


@pytest.mark.parametrize("text", ["1" * 200_000, "0" * 200_000, " " * 200_000, "1." * 100_000])
def test_checking_an_attribute_takes_linear_time(text: str) -> None:
    names = "type name multiplier instance increment default".split()
    attributes = [f'{name}="{text}!"' for name in names]
    field = f"<field {' '.join(attributes)}/>"
    with watched():
        problems = DefinitionFile("a", document(message(f"{text}!", fields=field)))
        assert len(problems.schema_problems(False)) == 1 + len(names)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("", r"probe\.xml:1:1: the file is empty"),
        ("\x00\x01\x02", r"probe\.xml:1:1: not well-formed XML"),
        (
            "<mavlink><messages></mavlink>",
            r"probe\.xml:1:20: not well-formed XML: expected 'messages'",
        ),
        ("<html/>", r"probe\.xml:1:1: the root element is <html>, not <mavlink>"),
        ('<?xml version="1.0" encoding="nonsense"?><mavlink/>', r"probe\.xml:1:"),
        (document(message("x")), "message PROBE: id 'x' is not a number"),
        (document(message(2**24)), "id '16777216' is not a number from 0 to 16777215"),
        (document('<message id="1"/>'), "attribute 'name' is missing"),
        (document(message(fields='<field type="uint9_t" name="q"/>')), "unknown type 'uint9_t'"),
        (document(message(fields='<field type="uint8_t[x]" name="q"/>')), "array length 'x'"),
        (document(message(fields='<field type="uint8_t[256]" name="q"/>')), "from 1 to 255"),
        (
            document(
                message(fields="".join(f'<field type="char" name="f{i}"/>' for i in range(65)))
            ),
            "message PROBE: more than 64 fields",
        ),
    ],
)
def test_wrong_files_say_where_and_why(tmp_path: Path, text: str, reason: str) -> None:
    with pytest.raises(MAVParseError, match=reason) as error:
        parse(tmp_path, text)
    assert "probe.xml:" in str(error.value)
    assert pickle.loads(pickle.dumps(error.value)).message == str(error.value)


def test_syntax_errors_are_expat_errors_too(tmp_path: Path) -> None:
    from xml.parsers.expat import ExpatError

    with pytest.raises(ExpatError) as error:
        parse(tmp_path, "<mavlink>\n<")
    assert isinstance(error.value, MAVSyntaxError)
    assert error.value.lineno == 2


# Schema


@pytest.mark.parametrize(
    ("old", "new", "reason"),
    [
        ("<messages>", "<mesages>", "not well-formed"),
        ("<message ", "<foo/><message ", "<foo> is not expected here"),
        ('name="PROBE"', 'name="PROBE" colour="red"', "<message> has no attribute 'colour'"),
        ('id="1"', "", "<message> needs the attribute 'id'"),
        ('type="uint8_t"', 'type="uint8"', "'uint8' is not a type such as"),
        ('name="PROBE"', 'name="A B"', "'A B' is not a name of"),
        (FIELD, "", "<message> needs <field>"),
        (FIELD, FIELD + "<extensions/>", "needs at least one <field> after it"),
        ("<description>", f"{FIELD}<description>", "<description> is not expected here"),
        ("<message ", "loose words <message ", "<messages> holds text: 'loose words'"),
        ('name="a"', 'name="a" minValue="low"', "'low' is not a number"),
        ('name="a"', 'name="class"', "is a reserved word"),
        ("<mavlink>", "<mavlink><version>999</version>", "'999' is not a number from 0 to 255"),
    ],
)
def test_schema_violations_end_with_file_line_and_reason(
    tmp_path: Path, old: str, new: str, reason: str
) -> None:
    text = document(message()).replace(old, new)
    if reason == "not well-formed":
        with pytest.raises(MAVParseError, match=reason):
            generate(tmp_path, text)
        return
    with pytest.raises(SystemExit) as error:
        generate(tmp_path, text)
    assert str(error.value).startswith(f"ERROR: {tmp_path}/probe.xml:")
    assert reason in str(error.value)


def test_units_are_checked_on_demand(tmp_path: Path) -> None:
    text = document(message(fields=FIELD.replace(">", ' units="parsec">', 1)))
    assert generate(tmp_path, text)
    with pytest.raises(SystemExit, match="'parsec' is not a unit"):
        generate(tmp_path, text, strict_units=True)
    assert generate(tmp_path, text.replace("parsec", "m/s/s"), strict_units=True)


def test_own_definitions_pass_the_checks() -> None:
    folder = Path(__file__).parents[3] / "message_definitions" / "v1.0"
    files = sorted(folder.glob("*.xml"))
    assert len(files) >= 19
    for file in files:
        assert DefinitionFile(file.name, file.read_text()).schema_problems(True) == []


# Contradictions, options, the command line


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (document(message(1, "A") + message(1, "B")), "Duplicate message id 1 for B"),
        (document(message(1, "A") + message(2, "A")), "Duplicate message name A for id:2"),
        (document(message(fields=FIELD + FIELD)), "Duplicate field a in message PROBE"),
        (document(enums=enum(("A", "1"), ("A", "2"))), "Duplicate enum names:"),
        (document(enums=enum(("A", "1"), ("B", "1"))), "Duplicate enum values:"),
        (
            document(message(fields='<field type="uint8_t" name="a" enum="NOPE">d</field>')),
            "Enum NOPE in PROBE.a does not exist",
        ),
    ],
)
def test_contradictions_give_false(
    tmp_path: Path, text: str, said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert not generate(tmp_path, text)
    assert said in capsys.readouterr().out
    assert not (tmp_path / "made.py").exists()


def test_merging_enums_over_files(tmp_path: Path) -> None:
    first = MAVXML(write(tmp_path, "a.xml", document(enums=enum(("B", "4")))), "2.0")
    second = MAVXML(write(tmp_path, "b.xml", document(enums=enum(("A", "1")))), "2.0")
    merge_enums([first, second])
    assert [(e.name, e.value) for e in first.enum[0].entry] == [
        ("A", 1),
        ("B", 4),
        ("KIND_ENUM_END", 5),
    ]
    assert second.enum == []


def test_paths_in_place_of_names(tmp_path: Path) -> None:
    path = write(tmp_path, "a.xml", document(message()))
    assert mavgen.mavgen(mavgen.Opts(tmp_path / "made", "2.0"), [Path(path)])
    assert (tmp_path / "made.py").exists()


def test_other_languages_without_an_installed_pymavlink(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(_upstream, "installed_folder", lambda: None)
    assert not generate(tmp_path, document(message()), language="C++11")
    last = capsys.readouterr().out.splitlines()[-1]
    assert last.startswith(
        "ERROR: C++11 is generated by pymavlink, which is not installed: pip ins"
    )
    assert list(tmp_path.glob("made*")) == []


def test_includes_nest_five_levels(tmp_path: Path) -> None:
    def chain(depth: int) -> str:
        for level in range(depth + 1):
            head = f"<include>d{level + 1}.xml</include>" if level < depth else ""
            write(tmp_path, f"d{level}.xml", document(message(level, f"M{level}"), head=head))
        return str(tmp_path / "d0.xml")

    opts = mavgen.Opts(str(tmp_path / "made"), "2.0")
    assert mavgen.mavgen(opts, [chain(5)])
    with pytest.raises(SystemExit, match="nested deeper than 5 levels"):
        mavgen.mavgen(opts, [chain(6)])


def test_include_cycle_is_refused(tmp_path: Path) -> None:
    write(tmp_path, "other.xml", document(message(2, "B"), head="<include>probe.xml</include>"))
    with pytest.raises(MAVParseError, match="do not make a module"):
        generate(tmp_path, document(message(1, "A"), head="<include>other.xml</include>"))


def test_missing_files_are_named(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError) as error:
        mavgen.mavgen(mavgen.Opts("made"), [str(tmp_path / "nope.xml")])
    assert error.value.filename == str(tmp_path / "nope.xml")
    with pytest.raises(FileNotFoundError, match=r"probe\.xml includes it") as error:
        generate(tmp_path, document(message(), head="<include>nope.xml</include>"))
    assert error.value.filename == str(tmp_path / "nope.xml")
    with pytest.raises(IsADirectoryError) as error:  # type: ignore[assignment]
        mavgen.mavgen(mavgen.Opts("made"), [str(tmp_path)])
    assert error.value.filename == str(tmp_path)


def test_what_is_no_file_is_said(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """As other commands do; an include too."""
    from mavwire import cli

    around, pipe = tmp_path / "around.xml", tmp_path / "pipe.xml"
    around.symlink_to(around)
    os.mkfifo(pipe)
    includes = document(message(), head="<include>around.xml</include>")
    path, too_many = write(tmp_path, "probe.xml", includes), os.strerror(errno.ELOOP)
    for name, said in (
        (around, too_many),
        (path, f"{too_many}; {path} includes it"),
        (pipe, "not a regular file"),
    ):
        assert cli.main(["gen", "-o", str(tmp_path / "made"), str(name)]) == 1
        wrong = around if name == path else name
        assert capsys.readouterr().err == f"ERROR: {wrong}: {said}\n"


@pytest.mark.parametrize(
    ("name", "said"),
    [("around.xml", os.strerror(errno.ELOOP)), ("folder.xml", os.strerror(errno.EISDIR))],
)
def test_what_is_no_dialect_is_said(
    name: str, said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    from mavwire import cli

    (tmp_path / "around.xml").symlink_to("around.xml")
    (tmp_path / "folder.xml").mkdir()
    path = str(tmp_path / name)
    assert cli.main(["definitions", "show", "--dialect", path, "ATTITUDE"]) == 1
    assert capsys.readouterr().err == f"mavwire definitions: error: --dialect {path}: {said}\n"


@pytest.mark.parametrize("output", [".", "folder/", "folder/.."])
def test_output_that_is_a_folder_is_refused(
    tmp_path: Path, output: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "folder").mkdir()
    monkeypatch.chdir(tmp_path)
    path = write(tmp_path, "probe.xml", document(message()))
    before = sorted(tmp_path.rglob("*"))
    with pytest.raises(IsADirectoryError) as error:
        mavgen.mavgen(mavgen.Opts(output), [path])
    assert error.value.filename == output
    assert sorted(tmp_path.rglob("*")) == before


def test_a_write_that_fails_names_the_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr("os.replace", full)
    path = write(tmp_path, "probe.xml", document(message()))
    with pytest.raises(OSError, match="No space left") as error:
        mavgen.mavgen(mavgen.Opts(str(tmp_path / "made")), [path])
    assert error.value.filename == str(tmp_path / "made.py")
    assert [one.name for one in tmp_path.iterdir()] == ["probe.xml"]


def test_command_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    from mavwire import cli

    path = write(tmp_path, "probe.xml", document(message(300)))
    arguments = ["gen", "--wire-protocol=2.0", "-o", str(tmp_path / "by_cli"), path]
    assert cli.main(arguments) == 0
    assert list(load(tmp_path / "by_cli.py").mavlink_map) == [300]
    assert capsys.readouterr().out.splitlines() == [
        f"Validating {path}",
        f"Parsing {path}",
        "Found 1 MAVLink message types in 1 XML files",
        f"Generating {tmp_path}/by_cli.py",
        f"Generated {tmp_path}/by_cli.py OK",
    ]
    assert cli.main(["gen", str(tmp_path / "nope.xml")]) == 1
    assert capsys.readouterr().err == f"ERROR: {tmp_path}/nope.xml: No such file or directory\n"
    write(tmp_path, "probe.xml", "<mavlink>")
    assert cli.main(["gen", "--no-validate", path]) == 1
    assert f"ERROR: {path}:1:1: not well-formed XML: the root node was" in capsys.readouterr().err


def test_dialect_by_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import importlib

    assert mavgen.mavgen_python_dialect("minimal", "2.0")
    monkeypatch.setenv("MDEF", str(tmp_path))
    write(tmp_path, "v1.0/homemade.xml", document(message(77, "HOMEMADE")))
    assert mavgen.mavgen_python_dialect("homemade", "2.0")
    module = importlib.import_module("mavwire.dialects.v20.homemade")
    try:
        assert list(module.mavlink_map) == [77]
        assert sys.modules["mavwire.dialects.v20"].homemade is module  # type: ignore[attr-defined]
    finally:
        del sys.modules["mavwire.dialects.v20.homemade"]
        del sys.modules["mavwire.dialects.v20"].homemade  # type: ignore[attr-defined]
    with pytest.raises(FileNotFoundError, match=r"nonsense\.xml"):
        mavgen.mavgen_python_dialect("nonsense", "1.0")
    with pytest.raises(MAVParseError, match=r"3\.0"):
        mavgen.mavgen_python_dialect("minimal", "3.0")


def test_generate_without_files_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(MAVParseError, match="no definition files"):
        mavgen_python.generate(str(tmp_path / "made"), [])
    with pytest.raises(SystemExit, match="no definition files"):
        mavgen.mavgen(mavgen.Opts("made"), [])


@pytest.mark.parametrize("name", ["class", "class.py"])
def test_a_module_is_not_named_like_a_keyword(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    definitions = tmp_path / "own.xml"
    definitions.write_text('<mavlink><messages><message id="1" name="A">'
                           '<field type="uint8_t" name="b">b</field></message></messages></mavlink>')  # fmt: skip
    assert not mavgen.mavgen(mavgen.Opts(str(tmp_path / name)), [str(definitions)])
    assert "'class' is a keyword of Python" in capsys.readouterr().out
    assert not (tmp_path / "class.py").exists()
