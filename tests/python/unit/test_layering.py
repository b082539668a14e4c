"""The dependency rules of the architecture, read off the sources: what may import what, in Rust and
in Python.

docs/architecture.md states the rules and why; this file only enforces them.
"""

from __future__ import annotations

import ast
import re
import subprocess
import tomllib
from collections.abc import Iterator
from pathlib import Path

import house
import pytest

ROOT = Path(__file__).parents[3]
RUST = ROOT / "rust"
PYTHON = ROOT / "python" / "mavwire"
CRATES = sorted(path.parent.name for path in RUST.glob("*/Cargo.toml"))
MAX_LINES = 800

# Crate -> the crates of this workspace it may use.
ALLOWED_CRATES = {
    "schema": set(),
    "core": {"schema"},
    "columns": {"schema", "core"},
    "io": {"schema", "core"},
    "py": {"schema", "core", "columns", "io"},
    "fuzz": {"schema", "core", "columns", "io"},
}
# Foreign crate -> the crates that may use it.
RESERVED_CRATES = {
    "pyo3": {"py"},
    "pyo3-ffi": {"py"},
    "pyo3-build-config": {"py"},
    "socket2": {"io"},
    "mio": {"io"},
    "serialport": {"io"},
    "memmap2": {"io"},
    "libc": {"io"},
    "roxmltree": {"schema"},
    "quick-xml": {"schema"},
    "arrow": {"columns"},
    "parquet": {"columns", "fuzz"},
    "mcap": {"columns", "fuzz"},
    "prost": {"columns"},
    "prost-types": {"columns"},
    "rayon": {"columns", "io", "fuzz"},
}
# Folders of the extension module, lowest first: a module uses its own folder and lower ones.
EXTENSION_FOLDERS = (
    "python",
    "sync",
    "message",
    "dialect",
    "protocol",
    "port",
    "link",
    "tables",
    "dataflash",
    "dump",
    "bridge",
)
# Python layers, lowest first: a module imports only from its own layer and from lower ones.
LAYERS = (
    ("_native", "_version", "_data", "_sphere", "_hooks"),
    ("dialects",),
    ("expression", "mavexpression", "mavextra", "rotmat", "quaternion"),
    ("links",),
    ("mavutil",),
)
# Package above mavutil -> those of them that it imports, in functions too.
MAY_USE = {
    "logs": set(),
    "plots": {"logs"},
    "fleet": {"logs"},
    "lake": {"logs", "fleet"},
    "bridge": {"logs"},
    "aio": set(),
    "cli": {"logs", "plots", "fleet", "lake", "bridge", "sim"},
    "tools": {"cli"},
    "sim": set(),
    "traffic": set(),
    "shadow": set(),
}
HEAVY = set(
    "numpy pyarrow polars pandas matplotlib dask distributed fsspec deltalake serial rich wsproto".split()
)
# The only modules that name pymavlink: its descriptions are read as data, and the shadow runs it
# beside the parser.
NAMES_PYMAVLINK = re.compile(
    r"^(descriptions|shadow|_alias|alias)(\.|$)|(\.|^)(descriptions|shadow)$"
)


def rust_sources(crate: str) -> list[Path]:
    return sorted((RUST / crate / "src").rglob("*.rs"))


def code_of(path: Path) -> str:
    """Rust text without comments, so that prose does not count as use."""
    text = re.sub(r"/\*.*?\*/", "", path.read_text(encoding="utf-8"), flags=re.DOTALL)
    return re.sub(r"//[^\n]*", "", text)


def manifest(crate: str) -> dict[str, object]:
    return tomllib.loads((RUST / crate / "Cargo.toml").read_text(encoding="utf-8"))


def dependencies(crate: str, *tables: str) -> set[str]:
    names: set[str] = set()
    content = manifest(crate)
    targets = [content, *content.get("target", {}).values()]  # type: ignore[attr-defined]
    for one in targets:
        for table in tables:
            names |= set(one.get(table, {}))
    return names


def tracked(*patterns: str) -> list[Path]:
    """Files under version control, or every such file where this is no checkout."""
    run = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard", *patterns],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    if run.returncode:
        return [path for one in patterns for path in ROOT.rglob(one.lstrip("*/"))]
    return [ROOT / name for name in run.stdout.split("\0") if name and (ROOT / name).is_file()]


@pytest.mark.parametrize("crate", CRATES)
def test_crates_depend_downwards(crate: str) -> None:
    used = dependencies(crate, "dependencies", "build-dependencies", "dev-dependencies")
    ours = {name.removeprefix("mavwire-") for name in used if name.startswith("mavwire-")}
    assert ours <= ALLOWED_CRATES[crate]
    for name in used & RESERVED_CRATES.keys():
        assert crate in RESERVED_CRATES[name], f"{name} is used by {crate}"


def test_a_list_of_allowed_crates_is_complete() -> None:
    assert {"schema", "core", "io", "py"} <= set(CRATES) <= ALLOWED_CRATES.keys()


def test_pure_crates_have_no_unsafe_code() -> None:
    """But for one call, of a safe function for processors that can multiply without carries."""
    assert "#![forbid(unsafe_code)]" in (RUST / "schema" / "src" / "lib.rs").read_text()
    assert "#![deny(unsafe_code)]" in (RUST / "core" / "src" / "lib.rs").read_text()
    paths = {
        path.relative_to(RUST / "core" / "src").as_posix(): path for path in rust_sources("core")
    }
    words = {
        name: re.findall(r"\bunsafe(?:_code)?\b", code_of(path)) for name, path in paths.items()
    }
    words = {name: found for name, found in words.items() if found}
    assert words == {"lib.rs": ["unsafe_code"], "x25/multiply.rs": ["unsafe_code", "unsafe"]}


@pytest.mark.parametrize(
    "path", [*rust_sources("core"), *rust_sources("schema")], ids=lambda p: p.name
)
def test_pure_crates_touch_no_system(path: Path) -> None:
    """No I/O, no clock, no threads: time and randomness are arguments."""
    found = re.findall(r"\bstd::(net|fs|time|thread|process|env|io|os)\b", code_of(path))
    assert not found, f"{path.name} uses std::{found[0]}"


@pytest.mark.parametrize("crate", [one for one in CRATES if one not in ("io", "fuzz")])
def test_only_io_opens_sockets_and_files(crate: str) -> None:
    for path in rust_sources(crate):
        found = re.findall(r"\bstd::(net|fs)\b", code_of(path))
        assert not found, f"{path} uses std::{found[0]}"


def test_unsafe_blocks_say_why_they_are_sound() -> None:
    """Every `unsafe` block or impl has a SAFETY comment close above it."""
    for crate in CRATES:
        for path in rust_sources(crate):
            lines = path.read_text(encoding="utf-8").splitlines()
            for number, line in enumerate(lines):
                code = line.split("//")[0]
                if re.search(r"\bunsafe\s*(\{|impl\b)", code):
                    above = "\n".join(lines[max(0, number - 8) : number + 1])
                    assert "SAFETY:" in above, f"{path}:{number + 1}"


def test_every_pyclass_is_frozen() -> None:
    """No borrow flags, no interior surprises: state that changes sits in a lock or an atomic."""
    for path in rust_sources("py"):
        for options in re.findall(r"#\[pyclass(\b[^\]]*)\]", code_of(path)):
            assert "frozen" in options, f"{path}: #[pyclass{options}]"


def test_modules_of_the_extension_use_lower_folders_and_no_cycles() -> None:
    uses = house.extension_uses()
    assert {name.split("::")[0] for name in uses} == {*EXTENSION_FOLDERS}
    rank = {name: EXTENSION_FOLDERS.index(name.split("::")[0]) for name in uses}
    upwards = [
        f"{one} uses {other}"
        for one, others in uses.items()
        for other in others
        if rank[other] > rank[one]
    ]
    assert not upwards, upwards
    assert not house.cycles(uses)


def test_modules_that_the_extension_imports_exist() -> None:
    names = {f"mavwire.{name}" for name in house.python_uses()} | {"mavwire._native"}
    for path in rust_sources("py"):
        imported = re.findall(r'intern!\(py, "(mavwire\.[\w.]+)"\)', code_of(path))
        assert {*imported} <= names, path


def test_python_modules_form_no_cycles() -> None:
    """Imports within functions count, as do names given to `import_module`."""
    assert not house.cycles(house.python_uses())


@pytest.mark.parametrize("package", MAY_USE)
def test_packages_above_mavutil_have_an_order(package: str) -> None:
    uses = {
        (name, other)
        for name, others in house.python_uses().items()
        for other in others
        if name.split(".")[0] == package
        and other.split(".")[0] in MAY_USE.keys() - {package} - MAY_USE[package]
    }
    assert not uses


def test_commands_use_their_own_folder_and_what_all_share() -> None:
    folders = {path.parent.name for path in (PYTHON / "cli").glob("*/__init__.py")}
    across = {
        (name, other)
        for name, others in house.python_uses().items()
        for other in others
        if re.match(r"cli\.\w+", name)
        and other.startswith("cli.")
        and other.split(".")[1] in folders - {name.split(".")[1]}
    }
    assert not across


@pytest.mark.parametrize("pattern", ["*.rs", "*.py", "*.pyi"])
def test_files_are_short(pattern: str) -> None:
    generated = ROOT / "python" / "mavwire" / "dialects"
    for path in tracked(pattern):
        if path.suffix == ".pyi" and generated in path.parents:
            continue
        lines = len(path.read_text(encoding="utf-8").splitlines())
        assert lines <= MAX_LINES, f"{path.relative_to(ROOT)} has {lines} lines"


def python_modules() -> list[Path]:
    return sorted(PYTHON.rglob("*.py"))


def dotted(path: Path) -> str:
    parts = path.relative_to(PYTHON).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def imports(path: Path) -> Iterator[tuple[str, bool]]:
    """Absolute names of imported modules, and whether they are imported with this module."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    package = ["mavwire", *path.relative_to(PYTHON).parts[:-1]]

    def walk(node: ast.AST, at_import: bool) -> Iterator[tuple[str, bool]]:
        for child in ast.iter_child_nodes(node):
            if isinstance(child, ast.Import):
                yield from ((alias.name, at_import) for alias in child.names)
            elif isinstance(child, ast.ImportFrom):
                base = package[: len(package) - child.level + 1] if child.level else []
                stem = ".".join([*base, *(child.module or "").split(".")]).strip(".")
                yield from ((f"{stem}.{alias.name}", at_import) for alias in child.names)
            else:
                function = isinstance(child, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda)
                checking = isinstance(child, ast.If) and "TYPE_CHECKING" in ast.unparse(child.test)
                yield from walk(child, at_import and not function and not checking)

    yield from walk(tree, True)


def layer(name: str) -> int:
    """Layer of a module of the package; those that are not listed stand on top."""
    head = name.split(".", maxsplit=1)[0]
    return next((n for n, heads in enumerate(LAYERS) if head in heads), len(LAYERS))


@pytest.mark.parametrize("path", python_modules(), ids=dotted)
def test_python_modules_import_downwards(path: Path) -> None:
    """Imports that run at import time go down; a function may reach up where the compatible API
    demands it.
    """
    name = dotted(path)
    if not name:  # the package itself offers everything lazily
        return
    for target, at_import in imports(path):
        inner = target.removeprefix("mavwire.")
        if at_import and inner != target and inner:
            assert layer(inner) <= layer(name), f"{name} imports {target}"


@pytest.mark.parametrize("path", python_modules(), ids=dotted)
def test_heavy_imports_happen_inside_functions(path: Path) -> None:
    for target, at_import in imports(path):
        assert not (at_import and target.split(".")[0] in HEAVY), f"{dotted(path)} imports {target}"


@pytest.mark.parametrize("path", python_modules(), ids=dotted)
def test_pymavlink_is_not_imported(path: Path) -> None:
    name = dotted(path)
    for target, at_import in imports(path):
        if target.split(".")[0] == "pymavlink":
            assert not at_import, f"{name} imports {target} when it is imported"
            assert NAMES_PYMAVLINK.search(name), f"{name} imports {target}"


def test_import_walker_sees_what_runs_and_what_waits(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    sample = tmp_path / "links" / "sample.py"
    sample.parent.mkdir()
    sample.write_text("import numpy\nfrom ..mavutil import x\ndef f():\n    import serial\n")
    monkeypatch.setitem(globals(), "PYTHON", tmp_path)
    assert list(imports(sample)) == [
        ("numpy", True),
        ("mavwire.mavutil.x", True),
        ("serial", False),
    ]
    assert layer("mavutil.x") > layer(dotted(sample))
