"""mavutil against golden cases observed on pymavlink 2.4.50.

`tests/vectors/mavutil_golden.json` holds expressions and the literal results. Where mavwire
differs on purpose, DIFFERENCES says what it gives instead and why; a case there that comes out
like pymavlink fails too, so that the table stays true.
"""

from __future__ import annotations

import ast
import contextlib
import importlib.util
import json
import os
import time
from pathlib import Path

import pytest
from compat.mavutil_cases import Cases

VECTORS = Path(__file__).parents[2] / "vectors" / "mavutil_golden.json"
CASES = {case["id"]: case for case in json.loads(VECTORS.read_text(encoding="utf-8"))}

NO_ENVIRONMENT = "no environment variable is written"
MISSING_LOG = "a missing log is named, not opened as a serial port"
NOT_EXECUTED = "no file is executed because of its path"

# id -> (result, what is printed or None for the same as pymavlink, reason)
DIFFERENCES = {
    "U01": (
        "(False, None, False, 'PACKAGE.dialects.v10.all', 'all', 'module')",
        None,
        NO_ENVIRONMENT,
    ),
    "M02": (
        CASES["M02"]["expected"].replace("'sysid_state': 'dict'", "'sysid_state': 'SystemStates'"),
        None,
        "sysid_state is a dict that tells its link about replaced states",
    ),
    "M03": (
        "(('PACKAGE.dialects.v10.all', '1.0', False), 'PACKAGE.dialects.v20.all', '2.0', None, "
        "'PACKAGE.dialects.v20.all', 255)",
        None,
        NO_ENVIRONMENT,
    ),
    "M04": (
        f"(False, {b'A' * 32!r}, 9, True, True)",
        "BAD_DATA {Invalid signature, data:['fd', '9', '0', '0', '0', '1', '1', '0', '0', '0', "
        "'4', '0', '0', '0', '2', '3', '51', '4', '3', '7b', 'ae']}\n",
        "the protocol switch keeps signing, seq and statistics",
    ),
    "M20": (
        "({'ABC': 1.5}, {'ABC': 1.5}, {}, (7, 0))",
        None,
        "params stays filled when only target_component is set",
    ),
    "V27": (
        "RAISES builtins.PermissionError: [Errno 13] is a program, not a log; use 'exec:a.elf' "
        "to run it and talk to it: 'a.elf'",
        "",
        NOT_EXECUTED,
    ),
    "V29": (
        "RAISES builtins.PermissionError: [Errno 13] is a program, not a log; use "
        "'exec:./bin/prog' to run it and talk to it: './bin/prog'",
        "",
        NOT_EXECUTED,
    ),
    "V30": (
        "RAISES builtins.FileNotFoundError: [Errno 2] no such log file: 'nonexist.tlog'",
        None,
        MISSING_LOG,
    ),
    "V31": (
        "RAISES builtins.FileNotFoundError: [Errno 2] no such log file: 'C:\\\\logs\\\\f.tlog'",
        None,
        MISSING_LOG,
    ),
    "V33": (
        "RAISES builtins.FileNotFoundError: [Errno 2] no such log file: 'X.LOG'",
        None,
        MISSING_LOG,
    ),
    "V42": (
        "('mavlogfile', ('new.tlog',), {'planner_format': None, 'write': True, 'append': False, "
        "'robust_parsing': True, 'notimestamps': False, 'source_system': 255, "
        "'source_component': 0, 'use_native': False})",
        None,
        "write=True creates a missing log",
    ),
    "L09": ("str: ATTITUDE", None, "a tuple of types works on logs"),
    "L10": ("('mavmmaplog', None, None, True, True)", None, "an empty log has an empty index"),
    "L11": ("(['HEARTBEAT'], {0: 1})", None, "a log cut in its last record is read"),
    "M51": (
        "RAISES builtins.FileNotFoundError: [Errno 2] no dialect 'nope'; name a built-in one, "
        "one in $MDEF/v1.0, or a path to XML",
        None,
        "an unknown dialect is answered with those that there are",
    ),
    "N03": ("(29, 21)", None, "setup_logfile records on UDP too"),
}
# Cases whose code makes what another one reads.
AFTER = {"L15": "L14", "L16": "L14"}
# Edits of the recorded code: (what, by what), so that it shows no address, and raises nowhere
# for want of an environment variable.
EDITS = {
    "L01": ("os.environ.get('MAVLINK20')", "'1'"),
    "L09": ("type=('ATTITUDE',))", "type=('ATTITUDE',))._type"),
    "U01": ("os.environ['MAVLINK_DIALECT']", "os.environ.get('MAVLINK_DIALECT')"),
}
NEEDS = {"V48": "wsproto", "N11": "wsproto", "V51": "serial"}


@pytest.fixture(scope="session")
def cases(tmp_path_factory):
    """The namespace of the cases, with its files made in a directory of their own."""
    saved = dict(os.environ)
    os.environ["TZ"] = "UTC"
    time.tzset()
    space = Cases("mavwire")
    space.logs = tmp_path_factory.mktemp("logs")
    space.files = tmp_path_factory.mktemp("files")
    for directory, make in (
        (space.logs, space.make_files),
        (space.files, space.make_dispatch_files),
    ):
        with contextlib.chdir(directory):
            make()
    yield space
    os.environ.clear()
    os.environ.update(saved)
    time.tzset()
    space.reset20(False)


def starts_with_mavlink20(case: str) -> bool:
    """Whether a case was observed with MAVLINK20 in the environment."""
    if case[0] == "M":
        return int(case[1:]) >= 7
    return case[0] in "LN" and case not in ("L01", "L23", "L24")


def expected(case: str) -> tuple[str, str]:
    """What a case gives and prints on mavwire."""
    text, printed = CASES[case]["expected"], CASES[case]["stdout"]
    if case in DIFFERENCES:
        text, own_print, _ = DIFFERENCES[case]
        printed = printed if own_print is None else own_print
    return text, printed


def same(text: str, wanted: str) -> bool:
    """Equal texts, or equal values: dictionaries have no order."""
    if text == wanted:
        return True
    try:
        return ast.literal_eval(text) == ast.literal_eval(wanted)
    except (ValueError, SyntaxError):
        return False


@pytest.mark.parametrize("case", CASES)
@pytest.mark.timeout(30)
def test_golden_case(cases, case, monkeypatch):
    if case in NEEDS and importlib.util.find_spec(NEEDS[case]) is None:
        pytest.skip(f"{NEEDS[case]} is not installed")
    monkeypatch.chdir(cases.files if case[0] == "V" else cases.logs)
    cases.reset20(starts_with_mavlink20(case))
    if case in AFTER:
        cases.run(CASES[AFTER[case]]["code"])
    text, printed = cases.run(CASES[case]["code"].replace(*EDITS.get(case, ("", ""))))
    if case == "M51":  # the list of dialects grows
        text = text.partition("; built in are ")[0]
    wanted, wanted_print = expected(case)
    assert same(text, wanted), f"{CASES[case]['title']}: {text} instead of {wanted}"
    assert printed == wanted_print
    if case in DIFFERENCES:
        assert not same(text, CASES[case]["expected"])


def test_import_prints_nothing_and_writes_no_environment():
    import subprocess
    import sys

    code = (
        "import os; before = dict(os.environ); import mavwire.mavutil as m; m.mavlink;"
        "assert dict(os.environ) == before"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


def test_names_of_pymavlink_exist(cases):
    """Every public name of pymavlink's mavutil is there, and `dir` shows it."""
    pymavlink = pytest.importorskip("pymavlink.mavutil")
    names = {name for name in vars(pymavlink) if not name.startswith("_")} - {"annotations"}
    missing = {name for name in names if not hasattr(cases.mavutil, name)}
    assert not missing
    assert names <= set(dir(cases.mavutil)) | {"annotations"}
    for kind in ("mavfile", "mavlogfile", "mavmmaplog", "mavudp", "mavtcp", "mavtcpin",
                 "mavuds", "mavmcast", "mavserial", "mavchildexec", "mavwebsocket",
                 "mavwebsocket_client"):  # fmt: skip
        theirs = {n for n in vars(getattr(pymavlink, kind)) if not n.startswith("_")}
        ours = set(dir(getattr(cases.mavutil, kind)))
        assert theirs <= ours, kind
