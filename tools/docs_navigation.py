"""A hook of MkDocs: pages of docs/ that the navigation in mkdocs.yml does not name come last among the
guides, under their own headings, so that nobody looks for them in vain.
"""

from __future__ import annotations

from collections.abc import Iterator, MutableMapping
from pathlib import Path
from typing import Any

GUIDES = "Guides"


def on_config(config: MutableMapping[str, Any]) -> None:
    """Called by MkDocs once it has read mkdocs.yml."""
    known = set(named(config["nav"]))
    pages = sorted(path.name for path in Path(config["docs_dir"]).glob("*.md"))
    guides = next(section[GUIDES] for section in config["nav"] if GUIDES in section)
    guides.extend(page for page in pages if page not in known)


def named(entry: Any) -> Iterator[str]:
    """The pages that a part of the navigation names."""
    if isinstance(entry, str):
        yield entry
    else:
        for inner in entry.values() if isinstance(entry, dict) else entry:
            yield from named(inner)
