"""The golden cases of pymavlink 2.4.50's dialect modules, run on mavwire.

tests/vectors/golden_dialect.json holds what pymavlink was observed to answer. Where mavwire answers
differently on purpose the case stands in DELIBERATE with the reason and mavwire's own answer, so a
silent change of either is noticed.
"""

from __future__ import annotations

import json
import re
import sys
from pathlib import Path
from typing import Any

import pytest
from compat.golden_setup import module_logs, namespace, outcome

VECTORS = Path(__file__).parents[2] / "vectors" / "golden_dialect.json"
CASES: list[dict[str, Any]] = json.loads(VECTORS.read_text(encoding="utf-8"))

# id -> (reason, regular expression for the whole outcome of mavwire, log lines)
DELIBERATE: dict[str, tuple[str, str, list[str]]] = {
    "S03": (
        "a stream's timestamp is stored only after its signature verified",
        re.escape("{'sig': 1, 'good': 0, 'bad': 1, 'unsigned': 0, 'rej': 0, 'ts': 0, 'st': {}}"),
        ["new stream", "sig mismatch"],
    ),
    "S10": (
        "a frame let in by the callback has not verified and moves no timestamp",
        re.escape(
            "(False, None, {'sig': 1, 'good': 0, 'bad': 1, 'unsigned': 1, 'rej': 0,"
            " 'ts': 0, 'st': {}})"
        ),
        ["new stream", "sig mismatch"],
    ),
    "S11": (
        "the signing policy holds for unknown message ids too",
        r"RAISES SUBJECT\.dialects\.v20\.common\.MAVError: Invalid signature",
        [],
    ),
    "S15": ("a secret key has 32 bytes", r"RAISES builtins\.ValueError: .*32.*", []),
    "E09": (
        "MAVLink 1 frames carry no extension fields",
        "bytes:fe33000101fd0668656c6c6f" + "00" * 45 + "[0-9a-f]{4}",
        [],
    ),
    "E15": (
        "MAVLink 1 frames have no room for a signature",
        "bytes:fe0900010100040000000203510403e16d",
        [],
    ),
}

# Texts that come from CPython and not from the package, recorded with CPython 3.11.
CPYTHON_ERRORS = re.compile(r"RAISES (struct\.error|builtins\.\w+):")


def comparable(text: str) -> str:
    """On another CPython only the type of the interpreter's own exceptions is compared."""
    found = CPYTHON_ERRORS.match(text)
    return found[0] if found and sys.version_info[:2] != (3, 11) else text


def test_the_vectors_are_complete() -> None:
    assert len(CASES) == 142
    assert len({case["id"] for case in CASES}) == 142
    assert DELIBERATE.keys() <= {case["id"] for case in CASES}


@pytest.mark.parametrize("case", CASES, ids=lambda case: case["id"])
def test_golden(case: dict[str, Any], subject: str) -> None:
    names = namespace(subject)
    with module_logs(subject) as logged:
        got = outcome(case["code"], names)
    if subject != "pymavlink" and case["id"] in DELIBERATE:
        reason, pattern, log = DELIBERATE[case["id"]]
        pattern = pattern.replace("SUBJECT", subject)
        assert re.fullmatch(pattern, got), f"{reason}: {got}"
        assert logged == log, reason
        return
    expected = case["expected"].replace("pymavlink.", f"{subject}.")
    assert comparable(got) == comparable(expected)
    assert logged == case["log"]
