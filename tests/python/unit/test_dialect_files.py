"""`dialects.load`: what cannot be read as a definition file is refused at once, by name."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import mavwire
import pytest
from mavwire import dialects
from mavwire._native import DefinitionError
from mavwire.generator import mavgen


def test_dialect_files_that_cannot_be_read_are_named(tmp_path: Path) -> None:
    text = "<?xml version='1.0'?>\n<mavlink>\n<!-- \xe9 -->\n</mavlink>"
    latin = tmp_path / "latin.xml"
    latin.write_text(text, encoding="latin-1")
    with pytest.raises(DefinitionError, match=r"latin\.xml:3:1: .*: text not in UTF-8"):
        dialects.load(latin)
    latin.write_text(text.replace("?>", " encoding='klingon'?>"))
    with pytest.raises(DefinitionError, match=r"latin\.xml:1:1: .*: unknown encoding: klingon"):
        dialects.load(latin)
    os.mkfifo(tmp_path / "pipe.xml")
    for path in (tmp_path / "pipe.xml", "/dev/zero"):
        with pytest.raises(DefinitionError, match=rf"{path}: not a regular file"):
            dialects.load(path)
    large = tmp_path / "large.xml"
    with large.open("wb") as file:
        file.truncate(16 * 1024 * 1024 + 1)
    with pytest.raises(DefinitionError, match=r"large\.xml: definition file larger than"):
        dialects.load(large)


@pytest.mark.parametrize("encoding", ["latin-1", "utf-16"])
def test_a_dialect_file_is_read_in_the_encoding_that_it_declares(
    tmp_path: Path, encoding: str
) -> None:
    path = definitions(tmp_path)
    text = path.read_text().replace("<mavlink>", "<mavlink><!-- \xe9 -->", 1)
    text = text.split("?>", 1)[-1]
    path.write_text(f"<?xml version='1.0' encoding='{encoding}'?>{text}", encoding=encoding)
    assert round_trip(dialects.load(path), 1, 2).b == 2


def test_an_error_names_the_file_that_was_given(tmp_path: Path) -> None:
    path = tmp_path / "words.txt"
    path.write_text("root:x:0:0:root\n")
    for name in (None, "mine"):
        with pytest.raises(DefinitionError) as caught:
            dialects.load(path, name=name)
        assert str(caught.value).startswith(f"{path}:1:1: not well-formed XML")
    with pytest.raises(ValueError, match=f"^{path}:1:1: not well-formed XML"):
        mavwire.read(os.devnull, dialect=str(path))
    with pytest.raises(DefinitionError, match=r"^custom\.xml:1:"):
        dialects.load("<mavlink")
    (tmp_path / "inner.xml").write_text("<mavlink")
    path.write_text("<mavlink><include>inner.xml</include></mavlink>")
    with pytest.raises(DefinitionError, match=r"^inner\.xml:1:"):
        dialects.load(path)


def definitions(folder: Path, *, field: str = "a", entry: str = "MINE") -> Path:
    """A file with a message of two fields and an enum of one entry."""
    path = folder / "mine.xml"
    path.write_text(
        "<mavlink>\n"
        f'<enums><enum name="E">\n<entry name="{entry}" value="7"/></enum></enums>\n'
        f'<messages><message id="100" name="Q">\n<field type="uint8_t" name="{field}"/>'
        '<field type="uint8_t" name="b"/></message></messages></mavlink>'
    )
    return path


# What modules show of their imports: an entry of that name takes its place and nothing misses it.
LEAKED = {
    "Any", "BytesLike", "Callable", "Dict", "Iterable", "List", "MAVLinkV1Header",
    "MAVLinkV2Header", "Mapping", "Optional", "Sequence", "Tuple", "Type", "Union", "hashlib",
    "json", "logging", "os", "struct", "sys", "time",
}  # fmt: skip


def round_trip(module: Any, *values: int) -> Any:
    """A message Q of `values`, packed and parsed again."""
    frame = module.MAVLink_q_message(*values).pack(module.MAVLink(None, 1, 1))
    return module.MAVLink(None).parse_char(frame)


def test_entries_cannot_take_a_name_of_the_module(tmp_path: Path) -> None:
    module = dialects.load(definitions(tmp_path))
    own = {"MINE", "E_ENUM_END"}
    for name in sorted({*dir(module), "__name__", "MAVLink_foo_message"} - own - LEAKED):
        with pytest.raises(DefinitionError, match=rf"mine\.xml:3:\d+: enum E: '{name}' is a name"):
            dialects.load(definitions(tmp_path, entry=name))
    for name in LEAKED - {"MAVLinkV1Header", "MAVLinkV2Header"}:
        module = dialects.load(definitions(tmp_path, entry=name))
        assert getattr(module, name) == 7
        assert (module.enums["E"][7].name, round_trip(module, 1, 2).b) == (name, 2)


def test_fields_cannot_take_the_name_of_a_method(tmp_path: Path) -> None:
    """Any other name that message classes have works as a field's."""
    module = dialects.load(definitions(tmp_path))
    base = module.MAVLink_message
    for name in sorted(set(dir(base)) | {"_build", "_send", "_x"}):
        if name.startswith("_") or callable(getattr(base, name)):
            with pytest.raises(DefinitionError, match=rf"mine\.xml:5:\d+: message Q: '{name}' is"):
                dialects.load(definitions(tmp_path, field=name))
            continue
        message = round_trip(dialects.load(definitions(tmp_path, field=name)), 5, 6)
        assert (getattr(message, name), message.b) == (5, 6)
        assert str(message) == f"Q {{{name} : 5, b : 6}}"
        assert message.to_dict() == {"mavpackettype": "Q", name: 5, "b": 6}
        assert message.get_fieldnames() == [name, "b"]


def test_the_generator_names_the_line_of_a_name_it_refuses(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    options = mavgen.Opts(str(tmp_path / "made"), wire_protocol="2.0")
    for names, problem in (
        ({"field": "to_dict"}, "5:1: message Q: 'to_dict' is a method of messages"),
        ({"entry": "enums"}, "3:1: enum E: 'enums' is a name that dialect modules"),
    ):
        path = definitions(tmp_path, **names)
        assert not mavgen.mavgen(options, [str(path)])
        assert f"{path}:{problem}" in "".join(capsys.readouterr())


def test_a_message_of_extension_fields_alone(tmp_path: Path) -> None:
    """It cannot travel as MAVLink 1; the others can."""
    path = definitions(tmp_path)
    text = path.read_text().replace(
        "<messages>",
        '<messages><message id="101" name="X"><extensions/><field type="uint8_t" name="x"/></message>',
    )
    path.write_text(text)
    second = dialects.load(path, wire_protocol="2.0")
    assert second.mavlink_map.keys() == {100, 101}
    first = dialects.load(path, wire_protocol="1.0")
    assert (first.mavlink_map.keys(), round_trip(first, 1, 2).b) == ({100}, 2)
