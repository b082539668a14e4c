"""The crates that mavwire is made of, as Cargo tells them."""

from __future__ import annotations

import json
import os
import subprocess
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]
EXTENSION = "mavwire-py"
Package = dict[str, Any]


def metadata() -> dict[str, Any]:
    """Output of `cargo metadata` for the locked dependencies, from the crates on this machine if possible."""
    command = [os.environ.get("CARGO", "cargo"), "metadata", "--format-version", "1", "--locked"]
    for further in (["--offline"], []):
        done = subprocess.run(
            [*command, *further], cwd=ROOT, capture_output=True, text=True, check=False
        )
        if done.returncode == 0:
            found: dict[str, Any] = json.loads(done.stdout)
            return found
    raise SystemExit(f"cargo metadata fails: {done.stderr.strip()}")


def foreign(packages: list[Package]) -> list[Package]:
    """Those that others wrote."""
    return [one for one in packages if one["source"] is not None]


def shipped(data: dict[str, Any]) -> tuple[Package, list[Package], dict[str, list[str]]]:
    """The extension module, the crates that are compiled into it (for any system), and by id what each depends on.

    Crates that only build or test it are left out.
    """
    packages = {one["id"]: one for one in data["packages"]}
    nodes = {one["id"]: one for one in data["resolve"]["nodes"]}
    (root,) = (one for one in packages.values() if one["name"] == EXTENSION)
    needs: dict[str, list[str]] = {}
    todo = [root["id"]]
    while todo:
        if (current := todo.pop()) in needs:
            continue
        needs[current] = sorted(
            one["pkg"]
            for one in nodes[current]["deps"]
            if any(kind["kind"] is None for kind in one["dep_kinds"])
        )
        todo += needs[current]
    crates = [packages[one] for one in needs if one != root["id"]]
    return root, sorted(crates, key=lambda one: (one["name"], one["version"])), needs
