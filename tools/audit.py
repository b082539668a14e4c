#!/usr/bin/env python3
"""Licences, sources and known weaknesses of what mavwire is built of and tested with. `make audit`.

Licences and sources of all crates are judged by deny.toml, without any network. Advisories are looked up with cargo-audit
and pip-audit, where these are installed and reach their data; where not, that is said and nothing fails for it.
"""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Callable
from typing import Any

from dependencies import ROOT, Package, foreign, metadata

TOKEN = re.compile(r"\(|\)|/|AND\b|OR\b|[\w.+-]+(?: WITH [\w.+-]+)?")
SECONDS = 300


def is_allowed(licence: str, allowed: set[str]) -> bool:
    """Whether an SPDX expression can be satisfied; the older `/` means OR."""
    tokens = TOKEN.findall(licence)

    def any_of() -> bool:
        found = all_of()
        while tokens and tokens[0] in ("OR", "/"):
            tokens.pop(0)
            found = all_of() or found
        return found

    def all_of() -> bool:
        found = one()
        while tokens and tokens[0] == "AND":
            tokens.pop(0)
            found = one() and found
        return found

    def one() -> bool:
        token = tokens.pop(0) if tokens else ""
        if token != "(":
            return token in allowed
        found = any_of()
        return bool(tokens) and tokens.pop(0) == ")" and found

    return any_of() and not tokens


def wrong_licences(packages: list[Package], allowed: set[str]) -> list[str]:
    """Crates with no licence that is allowed."""
    return [
        f"{one['name']} {one['version']}: {one['license'] or 'no licence'} is not allowed by deny.toml"
        for one in packages
        if not is_allowed(one["license"] or "", allowed)
    ]


def wrong_sources(packages: list[Package]) -> list[str]:
    """Crates that come from elsewhere than the one registry."""
    registries = {one["source"] for one in packages if one["source"].startswith("registry+")}
    wrong = [one for one in packages if not one["source"].startswith("registry+")]
    said = [f"{one['name']} {one['version']}: comes from {one['source']}" for one in wrong]
    return said + ([f"several registries: {sorted(registries)}"] if len(registries) > 1 else [])


def answer_of(command: list[str]) -> Any:
    """The JSON that a program prints; None where it fails."""
    try:
        done = subprocess.run(
            command, cwd=ROOT, capture_output=True, text=True, check=False, timeout=SECONDS
        )
        return json.loads(done.stdout)
    except (OSError, ValueError, subprocess.TimeoutExpired):
        return None


def rust_advisories(answer: Any) -> tuple[list[str], str]:
    """Findings of cargo-audit, and the reason if it could not look."""
    try:
        found = answer["vulnerabilities"]["list"]
        return [f"{one['package']['name']}: {one['advisory']['id']}" for one in found], ""
    except (KeyError, TypeError):
        return [], "cargo-audit is not installed or does not reach its data"


def python_advisories(answer: Any) -> tuple[list[str], str]:
    """Findings of pip-audit, and the reason if it could not look."""
    try:
        packages = answer["dependencies"]
        found = [f"{one['name']}: {bug['id']}" for one in packages for bug in one.get("vulns", ())]
        skipped = sum("skip_reason" in one for one in packages)
    except (KeyError, TypeError):
        return [], "pip-audit is not installed or does not reach its data"
    return found, f"pip-audit knows nothing of {skipped} of {len(packages)}" if skipped else ""


def pip_audit() -> list[str]:
    command = [sys.executable, "-m", "pip_audit", "--format", "json", "--no-deps", "--disable-pip"]
    for file in sorted((ROOT / "requirements").glob("*.txt")):
        command += ["--requirement", str(file)]
    return command


def main() -> int:
    """1 if something is wrong; what could not be looked up is none."""
    allowed = set(tomllib.loads((ROOT / "deny.toml").read_text())["licenses"]["allow"])
    crates = foreign(metadata()["packages"])
    failed = 0
    cargo_audit = ["cargo", "audit", "--json"] if shutil.which("cargo-audit") else ["cargo-audit"]
    looked: list[tuple[str, Callable[[], tuple[list[str], str]]]] = [
        (f"licences of {len(crates)} crates", lambda: (wrong_licences(crates, allowed), "")),
        (f"sources of {len(crates)} crates", lambda: (wrong_sources(crates), "")),
        ("advisories, Rust", lambda: rust_advisories(answer_of(cargo_audit))),
        ("advisories, Python", lambda: python_advisories(answer_of(pip_audit()))),
    ]
    for title, look in looked:
        wrong, notice = look()
        failed += len(wrong)
        print(f"{title}: {'; '.join(wrong) or notice or 'nothing wrong'}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
