#!/usr/bin/env python3
"""Put the pages of the documentation site together, in target/docs, where mkdocs.yml expects them.

The site has the same pages as the repository: README.md is its first page, docs/, examples/,
CONTRIBUTING.md and CHANGELOG.md are pages of it. Links between them are written for the repository
and are turned here into links of the site; what a link leads to must be there. Beside these come
the reference of messages, of the Python modules (which mkdocstrings fills in) and of the commands.
"""

from __future__ import annotations

import os
import re
import shutil
import sys
from collections.abc import Callable
from pathlib import Path, PurePosixPath

import message_pages

ROOT = Path(__file__).resolve().parent.parent
OUT = ROOT / "target" / "docs"

# Page of the site -> file of the repository; all of docs/ and examples/ come to these.
SINGLE = {
    "index.md": "README.md",
    "contributing.md": "CONTRIBUTING.md",
    "changelog.md": "CHANGELOG.md",
    "examples/index.md": "examples/README.md",
}
# Page of the reference -> its title and the modules on it, within mavwire.
MODULES = {
    "package": ("mavwire: logs as messages and tables", "logs _alias"),
    "mavutil": ("mavutil: links and logs as pymavlink has them", "links.mavfile links.connection"),
    "dialects": ("dialects", "dialects"),
    "native": ("Messages, tables and parsers (native)", "_native"),
    "logs": ("logs: files made of logs", "logs.conversion logs.rewriting"),
    "aio": ("aio: links in asyncio", "aio"),
    "bridge": ("bridge", "bridge.bridge bridge.sinks bridge.errors"),
    "sim": ("sim: simulated vehicles", "sim"),
    "fleet": ("fleet: logs on many machines", "fleet"),
    "lake": ("lake: many logs as one table for each type", "lake"),
    "plots": ("plots and maps", "plots"),
    "mission-parameters-files": ("Missions, parameters, files", "mavwp mavparm mavftp"),
    "expressions": ("Expressions", "expression mavexpression"),
    "generator": ("generator", "generator.mavgen generator.mavparse"),
    "traffic": ("traffic: telemetry for tests", "traffic"),
    "shadow": ("shadow: compare with pymavlink", "shadow"),
}

FENCE = re.compile(r"^(`{3,}|~{3,})", re.MULTILINE)
LINK = re.compile(r"(?<!!)\[([^\]]*)\]\(([^)\s]+)\)")


def main() -> int:
    """Writes all pages; the exit code."""
    shutil.rmtree(OUT, ignore_errors=True)
    pages = page_sources()
    for page, source in pages.items():
        if source.suffix == ".md":
            write(page, relinked(source, page, pages))
        else:
            copy(page, source)
    for page, text in generated().items():
        write(page, text)
    return 0


def page_sources() -> dict[str, Path]:
    """Page -> the file of the repository that it is made of."""
    pages = {page: ROOT / name for page, name in SINGLE.items()}
    pages |= {path.name: path for path in sorted((ROOT / "docs").iterdir()) if path.is_file()}
    pages |= {
        f"decisions/{path.name}": path for path in sorted((ROOT / "docs" / "decisions").iterdir())
    }
    pages |= {f"examples/{path.name}": path for path in sorted((ROOT / "examples").glob("*.py"))}
    return pages


def generated() -> dict[str, str]:
    """Page -> text of what no file of the repository has."""
    pages = {f"messages/{name}": text for name, text in message_pages.pages().items()}
    rows = []
    for name, (title, modules) in MODULES.items():
        full = [f"mavwire.{module}" for module in modules.split()]
        blocks = "\n\n".join(f"::: {module}" for module in full)
        pages[f"api/{name}.md"] = f"# {title}\n\n{blocks}\n"
        rows.append((f"[{title}]({name}.md)", ", ".join(f"`{module}`" for module in full)))
    index = message_pages.table(("page", "modules"), rows)
    pages["api/index.md"] = "\n".join(["# Python modules\n", *index, ""])
    pages["commands.md"] = command_page()
    return pages


def command_page() -> str:
    """The output of `mavwire help COMMAND` for each command."""
    from mavwire import cli
    from mavwire.cli import _parsers

    os.environ["COLUMNS"] = "100"
    lines = ["# Commands\n", "What `mavwire help COMMAND` prints.\n"]
    for name, (_, _, summary) in cli.COMMANDS.items():
        text = _parsers.parser_of(name, cli.module_of(name)).format_help()
        lines += [f"## {name}\n", f"{summary[0].upper()}{summary[1:]}.\n", "```text", text.rstrip(), "```\n"]  # fmt: skip
    return "\n".join(lines)


def relinked(source: Path, page: str, pages: dict[str, Path]) -> str:
    """The text of a file with its links as the site has them."""
    text = source.read_text(encoding="utf-8")
    places = {path: name for name, path in pages.items()}

    def replace(match: re.Match[str]) -> str:
        label, target = match.groups()
        path, _, anchor = target.partition("#")
        if not path or "://" in path:
            return match[0]
        file = (source.parent / path).resolve()
        if not file.exists():
            raise SystemExit(f"{source.relative_to(ROOT)}: the link to {path} leads nowhere")
        if file not in places:  # a part of the repository that the site does not have
            return label
        relative = os.path.relpath(places[file], PurePosixPath(page).parent)
        return f"[{label}]({relative}{'#' if anchor else ''}{anchor})"

    return outside_fences(text, replace)


def outside_fences(text: str, replace: Callable[[re.Match[str]], str]) -> str:
    """`LINK.sub` on all but fenced code."""
    parts, fenced = [], False
    for line in text.splitlines(keepends=True):
        if FENCE.match(line):
            fenced = not fenced
        parts.append(line if fenced else LINK.sub(replace, line))
    return "".join(parts)


def write(page: str, text: str) -> None:
    """A page of the site."""
    path = OUT / page
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")


def copy(page: str, source: Path) -> None:
    """A file of the site that is no page."""
    path = OUT / page
    path.parent.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(source, path)


if __name__ == "__main__":
    sys.exit(main())
