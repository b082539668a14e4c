"""What is checked of a release: licences and sources of its parts, its bill of materials, that it can be built again."""

from __future__ import annotations

import json
import tomllib
import zipfile
from pathlib import Path
from typing import Any

import audit
import pytest
import reproducible
import sbom

ROOT = Path(__file__).parents[3]
ALLOWED = set(tomllib.loads((ROOT / "deny.toml").read_text())["licenses"]["allow"])
REGISTRY = "registry+the one"


@pytest.mark.parametrize(
    ("licence", "allowed"),
    [
        ("MIT", True), ("GPL-3.0-only", False), ("", False), ("MIT OR GPL-3.0-only", True),
        ("MIT AND GPL-3.0-only", False), ("MIT/Apache-2.0", True), ("Apache-2.0 / MIT", True),
        ("Apache-2.0 WITH LLVM-exception OR GPL-2.0", True), ("GPL-2.0 WITH LLVM-exception", False),
        ("(MIT OR Apache-2.0) AND Unicode-3.0", True), ("(MIT OR Apache-2.0) AND GPL-2.0", False),
        ("MIT AND (GPL-2.0 OR Zlib)", True), ("(MIT", False), ("MIT)", False), ("MIT AND", False),
        ("MIT GPL-2.0", False),
    ],
)  # fmt: skip
def test_licences(licence: str, allowed: bool) -> None:
    assert audit.is_allowed(licence, ALLOWED) is allowed


def package(name: str, **other: Any) -> dict[str, Any]:
    found = {
        "id": f"{name} 1",
        "name": name,
        "version": "1.0.0",
        "license": "MIT",
        "source": REGISTRY,
    }
    return {**found, **other}


def test_crates_of_other_licences_and_sources_are_named() -> None:
    crates = [
        package("good"),
        package("none", license=None),
        package("odd", source="git+https://x"),
    ]
    assert audit.wrong_licences(crates, ALLOWED) == [
        "none 1.0.0: no licence is not allowed by deny.toml"
    ]
    assert audit.wrong_sources(crates) == ["odd 1.0.0: comes from git+https://x"]
    assert audit.wrong_sources(crates[:2]) == []
    two = [package("good"), package("other", source="registry+another one")]
    assert audit.wrong_sources(two) == [
        f"several registries: {[*sorted(('registry+another one', REGISTRY))]}"
    ]


def test_advisories_fail_and_their_absence_does_not() -> None:
    bug = {"package": {"name": "a"}, "advisory": {"id": "RUSTSEC-1"}}
    assert audit.rust_advisories({"vulnerabilities": {"list": [bug]}}) == (["a: RUSTSEC-1"], "")
    assert audit.rust_advisories({"vulnerabilities": {"list": []}}) == ([], "")
    assert audit.rust_advisories(None)[0] == [] and audit.rust_advisories(None)[1]
    some = [{"name": "a", "vulns": [{"id": "X-1"}]}, {"name": "b", "skip_reason": "not there"}]
    assert audit.python_advisories({"dependencies": some}) == (
        ["a: X-1"], "pip-audit knows nothing of 1 of 2",
    )  # fmt: skip
    assert audit.python_advisories({"dependencies": some[:0]}) == ([], "")
    assert audit.python_advisories(None)[0] == [] and audit.python_advisories(None)[1]
    assert audit.answer_of(["no such program"]) is None


def needs(name: str, *others: str, kind: str | None = None) -> dict[str, Any]:
    deps = [{"pkg": f"{one} 1", "dep_kinds": [{"kind": kind}]} for one in others]
    return {"id": f"{name} 1", "deps": deps}


def test_the_bill_has_what_is_shipped_and_nothing_else() -> None:
    built = needs("mavwire-py", "core", "pyo3")
    built["deps"] += needs("mavwire-py", "builder", kind="build")["deps"]
    nodes = [
        built,
        needs("core", "memchr"),
        needs("pyo3"),
        needs("memchr"),
        needs("builder", "tool"),
        needs("tool"),
    ]
    names = ("mavwire-py", "core", "pyo3", "memchr", "builder", "tool")
    data = {"packages": [package(name) for name in names], "resolve": {"nodes": nodes}}
    lock = {
        "package": [
            {"name": "memchr", "version": "1.0.0", "checksum": "ab" * 32},
            {"name": "core", "version": "1.0.0"},
        ]
    }
    project = {
        "name": "mavwire", "license": "MIT",
        "optional-dependencies": {"a": ["Num_py>=1", "mavwire[b]"], "b": ["rich>=13", "Num_py>=1"]},
    }  # fmt: skip
    made = sbom.bill(data, lock, project, 1_700_000_000)
    assert [one["name"] for one in made["components"]] == [
        "core",
        "memchr",
        "pyo3",
        "num-py",
        "rich",
    ]
    assert [one["scope"] for one in made["components"]] == ["required"] * 3 + ["optional"] * 2
    assert made["components"][1]["hashes"] == [{"alg": "SHA-256", "content": "ab" * 32}]
    assert made["metadata"]["timestamp"] == "2023-11-14T22:13:20Z"
    known = {one["bom-ref"] for one in made["components"]} | {"pkg:pypi/mavwire@1.0.0"}
    graph = {one["ref"]: one["dependsOn"] for one in made["dependencies"]}
    assert graph["pkg:pypi/mavwire@1.0.0"] == [
        "pkg:cargo/core@1.0.0", "pkg:cargo/pyo3@1.0.0", "pkg:pypi/num-py", "pkg:pypi/rich",
    ]  # fmt: skip
    assert all(set(some) <= known for some in graph.values())
    again = sbom.bill(data, lock, project, 1_700_000_000)
    assert json.dumps(again) == json.dumps(made)


def test_every_extra_is_in_the_bill() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    names = {one["name"] for one in sbom.extras(project)}
    assert {"numpy", "pyserial", "wsproto", "eclipse-zenoh"} <= names and "mavwire" not in names


def wheel(path: Path, **files: str) -> Path:
    with zipfile.ZipFile(path, "w") as archive:
        for name, content in files.items():
            archive.writestr(zipfile.ZipInfo(name), content)
    return path


def test_wheels_are_compared_byte_by_byte(tmp_path: Path) -> None:
    one = wheel(tmp_path / "one.whl", a="1", b="2")
    assert reproducible.differences(one, wheel(tmp_path / "same.whl", a="1", b="2")) == []
    other = wheel(tmp_path / "other.whl", a="3", c="2")
    assert reproducible.differences(one, other) == [
        "b: only in one",
        "c: only in one",
        "a: other content",
    ]
    order = wheel(tmp_path / "order.whl", b="2", a="1")
    assert reproducible.differences(one, order) == ["the same files, packed otherwise"]


def test_builds_know_neither_place_nor_time(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1700000000")
    found = reproducible.environment(tmp_path, Path("/home/me/.cargo"))
    assert found["SOURCE_DATE_EPOCH"] == "1700000000"
    assert f"--remap-path-prefix={tmp_path}=/mavwire" in found["RUSTFLAGS"].split()
