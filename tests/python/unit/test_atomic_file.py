"""A file that is written anew is complete or as it was, whatever stands in its place."""

from __future__ import annotations

import errno
import os
import stat
import threading
from pathlib import Path
from typing import Any

import pytest
from mavwire._atomic_file import Replacement, replace_text, replacing


def test_a_file_is_replaced_and_keeps_its_permissions(tmp_path: Path) -> None:
    path = tmp_path / "file"
    path.write_text("old")
    path.chmod(0o640)
    replace_text(str(path), "new\n")
    assert path.read_text() == "new\n"
    assert stat.S_IMODE(path.stat().st_mode) == 0o640
    assert os.listdir(tmp_path) == ["file"]


def test_a_new_file_has_the_permissions_of_any_other(tmp_path: Path) -> None:
    replace_text(str(tmp_path / "new"), "")
    (tmp_path / "other").touch()
    assert (tmp_path / "new").stat().st_mode == (tmp_path / "other").stat().st_mode


def test_what_cannot_be_written_leaves_what_was_there(tmp_path: Path) -> None:
    path = tmp_path / "file"
    path.write_text("old")
    with pytest.raises(UnicodeEncodeError):
        replace_text(str(path), "half\ud800")
    file = Replacement(str(path))
    file.file.write(b"half")
    file.discard()
    assert path.read_text() == "old"
    assert os.listdir(tmp_path) == ["file"]


def test_what_comes_as_it_is_opened_leaves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def open_and_interrupt(path: str, mode: str) -> None:
        open(path, mode).close()
        raise KeyboardInterrupt

    monkeypatch.setattr("mavwire._atomic_file.open", open_and_interrupt, raising=False)
    with pytest.raises(KeyboardInterrupt):
        Replacement(str(tmp_path / "file"))
    assert not os.listdir(tmp_path)


def test_what_comes_before_it_is_moved_leaves_what_was_there(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupt(self: Replacement, permissions: int | None = None) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(Replacement, "finish", interrupt)
    with pytest.raises(KeyboardInterrupt):
        replace_text(str(tmp_path / "file"), "half")
    assert not os.listdir(tmp_path)


def test_what_comes_as_it_is_given_up_leaves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Interrupted:
        def close(self) -> None:
            raise KeyboardInterrupt

    file = Replacement(str(tmp_path / "file"))
    file.file.close()
    file.file = Interrupted()  # type: ignore[assignment]
    with pytest.raises(KeyboardInterrupt):
        file.discard()
    assert not os.listdir(tmp_path)


def test_errors_name_the_file(tmp_path: Path) -> None:
    missing = str(tmp_path / "missing" / "file")
    with pytest.raises(FileNotFoundError) as caught:
        replace_text(missing, "")
    assert caught.value.filename == missing
    (tmp_path / "taken").touch()
    with pytest.raises(NotADirectoryError) as no_folder:
        replace_text(str(tmp_path / "taken" / "file"), "")
    assert no_folder.value.filename == str(tmp_path / "taken" / "file")
    with pytest.raises(IsADirectoryError) as refused:
        replace_text(str(tmp_path), "")
    assert refused.value.filename == str(tmp_path)
    with pytest.raises(FileNotFoundError):
        replace_text("", "")


def test_errors_of_the_move_name_the_file_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(source: str, place: str) -> None:
        raise OSError(5, "Input/output error", source, None, place)

    monkeypatch.setattr("os.replace", refuse)
    with pytest.raises(OSError) as caught:
        replace_text(str(tmp_path / "file"), "")
    assert str(caught.value) == f"[Errno 5] Input/output error: '{tmp_path / 'file'}'"
    assert not os.listdir(tmp_path)


def test_an_error_of_writing_names_the_file(tmp_path: Path) -> None:
    path = tmp_path / "file"
    path.write_text("old")
    with pytest.raises(OSError) as caught, replacing(str(path)):
        raise OSError(errno.ENOSPC, "No space left on device")
    assert caught.value.filename == str(path)
    assert path.read_text() == "old"
    assert os.listdir(tmp_path) == ["file"]


@pytest.mark.parametrize("kind", [str, os.fsencode, Path])
def test_names_of_every_kind(kind: Any, tmp_path: Path) -> None:
    replace_text(kind(tmp_path / "file"), "new")
    assert (tmp_path / "file").read_text() == "new"


def test_links_are_followed(tmp_path: Path) -> None:
    path, link = tmp_path / "file", tmp_path / "link"
    path.write_text("old")
    link.symlink_to("file")
    replace_text(str(link), "new")
    assert link.is_symlink()
    assert path.read_text() == "new"


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no named pipes here")
def test_a_pipe_stays_a_pipe(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    read: list[bytes] = []
    reader = threading.Thread(target=lambda: read.append(pipe.read_bytes()), daemon=True)
    reader.start()
    replace_text(str(pipe), "text")
    reader.join(30)
    assert read == [b"text"]
    assert stat.S_ISFIFO(pipe.stat().st_mode)
