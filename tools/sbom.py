#!/usr/bin/env python3
"""The bill of materials of a release, as CycloneDX 1.6 in JSON: `make sbom` writes dist/mavwire-VERSION.cdx.json.

The crates are those that are compiled into the extension module on any system, with the checksums of Cargo.lock; the Python
packages are those of the extras, of which the wheel itself needs none. The same sources give the same bytes.
"""

from __future__ import annotations

import argparse
import json
import re
import sys
import tomllib
import uuid
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from dependencies import ROOT, Package, metadata, shipped

REQUIREMENT = re.compile(r"([A-Za-z0-9._-]+)")
Component = dict[str, Any]


def crate(package: Package, checksums: dict[tuple[str, str], str]) -> Component:
    """A crate as a component."""
    name, version = package["name"], package["version"]
    found: Component = {
        "type": "library",
        "bom-ref": reference(package),
        "name": name,
        "version": version,
        "scope": "required",
        "purl": reference(package),
    }
    if package["license"]:
        # The older `/` of crates means OR.
        expression = re.sub(r"\s*/\s*", " OR ", package["license"])
        found["licenses"] = [{"expression": expression}]
    if checksum := checksums.get((name, version)):
        found["hashes"] = [{"alg": "SHA-256", "content": checksum}]
    return found


def reference(package: Package) -> str:
    """The name of a crate in the bill: its package URL."""
    return f"pkg:cargo/{package['name']}@{package['version']}"


def extras(project: dict[str, Any]) -> list[Component]:
    """The packages that extras ask for, once each."""
    asked = {one for some in project["optional-dependencies"].values() for one in some}
    found = {}
    for requirement in asked:
        name = REQUIREMENT.match(requirement)
        assert name is not None, requirement
        if name[0] == project["name"]:
            continue
        normal = re.sub(r"[-_.]+", "-", name[0]).lower()
        found[normal] = {
            "type": "library",
            "bom-ref": f"pkg:pypi/{normal}",
            "name": normal,
            "scope": "optional",
            "purl": f"pkg:pypi/{normal}",
            "properties": [{"name": "mavwire:requirement", "value": requirement}],
        }
    return [found[name] for name in sorted(found)]


def bill(
    data: dict[str, Any], lock: dict[str, Any], project: dict[str, Any], time: int
) -> Component:
    """The whole document; `time` is in seconds since 1970."""
    checksums = {
        (one["name"], one["version"]): one["checksum"]
        for one in lock["package"]
        if "checksum" in one
    }
    root, crates, needs = shipped(data)
    names = {one["id"]: reference(one) for one in data["packages"]}
    version, itself = root["version"], f"pkg:pypi/{project['name']}@{root['version']}"
    optional = extras(project)
    wheel = {
        "type": "library",
        "bom-ref": itself,
        "name": project["name"],
        "version": version,
        "purl": itself,
        "licenses": [{"expression": project["license"]}],
    }
    graph = [
        {"ref": names[one["id"]], "dependsOn": [names[need] for need in needs[one["id"]]]}
        for one in crates
    ]
    graph.append(
        {
            "ref": itself,
            "dependsOn": [names[need] for need in needs[root["id"]]]
            + [one["bom-ref"] for one in optional],
        }
    )
    return {
        "bomFormat": "CycloneDX",
        "specVersion": "1.6",
        "serialNumber": f"urn:uuid:{uuid.uuid5(uuid.NAMESPACE_URL, f'{itself} {json.dumps(graph)}')}",
        "version": 1,
        "metadata": {
            "timestamp": datetime.fromtimestamp(time, UTC).strftime("%Y-%m-%dT%H:%M:%SZ"),
            "component": wheel,
        },
        "components": [crate(one, checksums) for one in crates] + optional,
        "dependencies": sorted(graph, key=lambda one: str(one["ref"])),
    }


def main() -> int:
    """Write the bill of this checkout."""
    from reproducible import source_date

    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, help="default: dist/mavwire-VERSION.cdx.json")
    args = parser.parse_args()
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    lock = tomllib.loads((ROOT / "Cargo.lock").read_text())
    made = bill(metadata(), lock, project, source_date())
    version = made["metadata"]["component"]["version"]
    out = args.out or ROOT / "dist" / f"{project['name']}-{version}.cdx.json"
    out.parent.mkdir(parents=True, exist_ok=True)
    out.write_text(json.dumps(made, indent=2) + "\n")
    print(f"{out}: {len(made['components'])} components")
    return 0


if __name__ == "__main__":
    sys.exit(main())
