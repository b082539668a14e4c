"""Print how large and how tangled the sources are, and fail where a figure is above its limit.

A limit is today's figure, rounded up. Lower it when a change makes the figure smaller, and raise
it only with a reason in the commit.
"""

from __future__ import annotations

import ast
import re
import sys
import tokenize
from collections.abc import Iterable, Iterator
from pathlib import Path

ROOT = Path(__file__).parents[1]
RUST = ROOT / "rust"
PYTHON = ROOT / "python" / "mavwire"
CRATES = ("schema", "core", "columns", "io", "py")
LONG_FILE = 400
LONG_FUNCTION = 40
AVOIDED = re.compile(
    r"\b(whatever|whoever|stands|stand\s+for|is\s+had|as\s+it\s+is\s+so|deals?\s+with|dealt\s+with|tends?|settle[sd]?)\b",
    re.IGNORECASE,
)
"""Words that the style of comments has a plainer one for."""
NO_NOUN = re.compile(r"(?:^|[.!?;:] )[ \t]*(?:What|Who)\b", re.MULTILINE)
"""The start of a sentence whose subject is not a noun. AVOIDED counts "Whatever"."""

Graph = dict[str, set[str]]


def without_comments(code: str) -> str:
    """Rust text without comments, so that prose does not count as use."""
    code = re.sub(r"/\*.*?\*/", "", code, flags=re.DOTALL)
    return re.sub(r"//[^\n]*", "", code)


def rust_files(crate: str) -> list[Path]:
    """The sources of a crate without those that hold only tests."""
    files = sorted((RUST / crate / "src").rglob("*.rs"))
    declared = re.compile(r"#\[cfg\([^\]]*\btest\b[^\]]*\]\n(?:pub\S* )?mod (\w+);")
    texts = (one.read_text(encoding="utf-8") for one in files)
    tests = {name for text in texts for name in declared.findall(text)}
    return [one for one in files if not tests & {one.stem, *one.parts}]


def rust_lines(path: Path) -> list[str]:
    """The lines of a source without the module of tests at its end."""
    return path.read_text(encoding="utf-8").split("\n#[cfg(test)]\nmod tests {")[0].splitlines()


def python_files() -> list[Path]:
    """The package without the generated modules of dialects."""
    return sorted(one for one in PYTHON.rglob("*.py") if one.parent.name not in ("v10", "v20"))


def rust_functions(lines: list[str]) -> Iterator[tuple[str, int]]:
    """Name and number of lines of each function of formatted code."""
    start = re.compile(r"^( *)(?:pub(?:\([\w: ]+\))? )?(?:const |unsafe |extern \"C\" )*fn (\w+)")
    for number, line in enumerate(lines):
        if (found := start.match(line)) is not None:
            end = next((i for i, one in enumerate(lines[number:]) if one == f"{found[1]}}}"), 0)
            yield found[2], end + 1


def python_functions(path: Path) -> Iterator[tuple[str, int]]:
    """Name and number of lines of each function."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            yield node.name, (node.end_lineno or 0) - node.lineno + 1


def rust_comments(lines: list[str]) -> str:
    """The comments of a source as one text. The `//` of an address starts none."""
    found = (re.search(r"(?<!:)//[/!]?(.*)", line) for line in lines)
    return "\n".join(one[1] for one in found if one is not None)


def python_comments(path: Path) -> str:
    """The comments and docstrings of a module as one text."""
    with tokenize.open(path) as source:
        tokens = [*tokenize.generate_tokens(source.readline)]
    found = [one.string.lstrip("#") for one in tokens if one.type == tokenize.COMMENT]
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
            found.append(str(node.value.value))
    return "\n".join(found)


def extension_uses() -> Graph:
    """The modules of rust/py as "folder::file", each with those that it names."""
    paths = {f"{path.parent.name}::{path.stem}": path for path in (RUST / "py/src").glob("*/*.rs")}
    uses = {}
    for name, path in paths.items():
        code = without_comments(path.read_text(encoding="utf-8"))
        named = {"::".join(both) for both in re.findall(r"\bcrate::(\w+)::(\w+)", code)}
        for names in re.findall(r"\bsuper::(\w+|\{[^}]*\})", code):
            named |= {f"{path.parent.name}::{one}" for one in re.findall(r"\w+", names)}
        uses[name] = named & paths.keys() - {name}
    return uses


def python_uses() -> Graph:
    """The modules of the package, each with those that it imports at any time. Imports for type checkers do not count."""
    names = {dotted(path): path for path in PYTHON.rglob("*.py")}
    return {name: set(_imported(path, names)) - {name} for name, path in names.items()}


def dotted(path: Path) -> str:
    """The name of a module below the package."""
    parts = path.relative_to(PYTHON).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def _imported(path: Path, names: Iterable[str]) -> Iterator[str]:
    package = ["mavwire", *path.relative_to(PYTHON).parts[:-1]]
    for node in _running(ast.parse(path.read_text(encoding="utf-8"))):
        targets: list[str] = []
        if isinstance(node, ast.Import):
            targets = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            base = package[: len(package) - node.level + 1] if node.level else []
            stem = ".".join([*base, *(node.module or "").split(".")]).strip(".")
            targets = [f"{stem}.{alias.name}" for alias in node.names]
        elif isinstance(node, ast.Call) and ast.unparse(node.func).endswith("import_module"):
            texts = [one.value for one in node.args if isinstance(one, ast.Constant)]
            targets = [one for one in texts if isinstance(one, str)]
        for target in targets:
            if target.split(".")[0] == "mavwire":
                yield _module(target, names)


def _running(node: ast.AST) -> Iterator[ast.AST]:
    """All nodes but those below `if TYPE_CHECKING`."""
    for child in ast.iter_child_nodes(node):
        if not (isinstance(child, ast.If) and "TYPE_CHECKING" in ast.unparse(child.test)):
            yield child
            yield from _running(child)


def _module(target: str, names: Iterable[str]) -> str:
    """The module that holds a name such as mavwire.logs.table.Table."""
    name = target.removeprefix("mavwire").lstrip(".")
    while name and name not in names:
        name = name.rpartition(".")[0]
    return name


def cycles(uses: Graph) -> list[list[str]]:
    """Groups of modules that use each other, directly or through others."""
    reached = {one: _reachable(uses, one) for one in uses}
    groups = {
        tuple(sorted(other for other in reached[one] if one in reached[other]))
        for one in uses
        if one in reached[one]
    }
    return sorted([*group] for group in groups)


def _reachable(uses: Graph, start: str) -> set[str]:
    found: set[str] = set()
    waiting = [*uses[start]]
    while waiting:
        one = waiting.pop()
        if one not in found:
            found.add(one)
            waiting += uses.get(one, ())
    return found


def measures() -> dict[str, int]:
    """Every figure by its name."""
    sources = {crate: [rust_lines(path) for path in rust_files(crate)] for crate in CRATES}
    modules = python_files()
    texts = [path.read_text(encoding="utf-8").splitlines() for path in modules]
    every = [lines for files in sources.values() for lines in files]
    found = {f"lines of rust/{crate}": sum(map(len, files)) for crate, files in sources.items()}
    found["lines of Rust without tests"] = sum(map(len, every))
    found["lines of Python without stubs"] = sum(map(len, texts))
    found[f"files over {LONG_FILE} lines"] = sum(len(one) > LONG_FILE for one in [*every, *texts])
    lengths = [size for lines in every for _, size in rust_functions(lines)]
    lengths += [size for path in modules for _, size in python_functions(path)]
    found[f"functions over {LONG_FUNCTION} lines"] = sum(one > LONG_FUNCTION for one in lengths)
    comments = [*map(rust_comments, every), *map(python_comments, modules)]
    rules = (AVOIDED, NO_NOUN)
    found["comments against the style"] = sum(
        len(rule.findall(one)) for rule in rules for one in comments
    )
    found["modules of the extension in cycles"] = sum(map(len, cycles(extension_uses())))
    found["Python modules in cycles"] = sum(map(len, cycles(python_uses())))
    return found


LIMITS = {
    "lines of rust/schema": 2740,
    "lines of rust/core": 8490,
    "lines of rust/columns": 7560,
    "lines of rust/io": 6590,
    "lines of rust/py": 12_900,
    "lines of Rust without tests": 38_270,
    "lines of Python without stubs": 46_960,
    "files over 400 lines": 4,
    "functions over 40 lines": 25,
    "comments against the style": 0,
    "modules of the extension in cycles": 0,
    "Python modules in cycles": 0,
}


def main() -> int:
    """Print the table; 1 if a figure is above its limit."""
    found = measures()
    print(f"{'measure':<40} {'now':>7} {'limit':>7}")
    for name, value in found.items():
        print(f"{name:<40} {value:>7,} {LIMITS[name]:>7,}")
    worse = [name for name, value in found.items() if value > LIMITS[name]]
    for name in worse:
        print(f"{name}: {found[name]:,} is above the limit of {LIMITS[name]:,}", file=sys.stderr)
    return 1 if worse else 0


if __name__ == "__main__":
    sys.exit(main())
