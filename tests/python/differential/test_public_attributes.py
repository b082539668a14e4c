"""Formats, messages, rows, classes, enums and `MAVLink` have pymavlink's public attributes: types and values."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path

DIALECT = r"v[12]0\.\w+"
# Differences that docs/compatibility.md lists, and the modules and names that pymavlink's files import.
LISTED = re.compile(
    "|".join(
        (
            r". (format with units\.(units|instance_(field|len|ofs))|unit)",
            r"csv\.close",
            r"csv message\.to_dict",
            rf"{DIALECT} MAVLink( that parsed)?\.(resync|send_many)",
            rf"{DIALECT} bad data\.fieldnames",
            rf"{DIALECT}\.(annotations|fastcrc|object|range|populate_builtin)",
        )
    )
)


def attributes(package: str, folder: Path) -> dict[str, str]:
    """Those of one package, in a process of its own."""
    folder.mkdir()
    path = os.pathsep.join(
        filter(None, [str(Path(__file__).parents[1]), os.environ.get("PYTHONPATH")])
    )
    command = [
        sys.executable,
        "-W",
        "ignore",
        "-m",
        "differential.public_attributes",
        package,
    ]
    run = subprocess.run(
        command,
        capture_output=True,
        cwd=folder,
        env=os.environ | {"PYTHONPATH": path},
        timeout=250,
        check=False,
    )
    assert run.returncode == 0, run.stderr.decode()[-500:]
    found = json.loads(run.stdout)
    assert isinstance(found, dict)
    return found


def test_public_attributes(tmp_path: Path, subject: str, oracle: str) -> None:
    ours, theirs = (attributes(one, tmp_path / one) for one in (subject, oracle))
    assert len(theirs) > 20_000
    different = {
        name: (ours.get(name, "missing"), theirs.get(name, "missing"))
        for name in {**ours, **theirs}
        if ours.get(name) != theirs.get(name) and not LISTED.fullmatch(name)
    }
    assert not different, "\n".join(f"{name}: {both}" for name, both in different.items())[:4000]
