"""Tutorial and guides: what they show is run as it stands, each page from its top to its end.

`doc_page.py` says how; a page that is not here shows commands for the reader's own machine only.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from integration import doc_page

ROOT = Path(__file__).parents[3]
PAGES = (
    "tutorial", "porting", "signing", "dialects", "vehicles", "faq", "links", "aio", "bridge", "sim",
    "logs", "columns", "dataflash", "plots", "fleet", "lake",
)  # fmt: skip
TIMEOUT = 280


@pytest.mark.parametrize("name", PAGES)
def test_page(name: str, tmp_path: Path) -> None:
    made = subprocess.run(
        [sys.executable, doc_page.__file__, ROOT / "docs" / f"{name}.md"],
        cwd=tmp_path, capture_output=True, text=True, timeout=TIMEOUT, check=False,
        env={**os.environ, "PYTHONPATH": str(ROOT / "tests" / "python")},
    )  # fmt: skip
    assert made.returncode == 0, made.stdout[-1000:] + made.stderr[-2000:]


@pytest.mark.parametrize("name", PAGES)
def test_every_snippet_is_run_or_says_why_not(name: str) -> None:
    """A fence without a language, or with directions that nobody knows, would go unnoticed."""
    text = (ROOT / "docs" / f"{name}.md").read_text(encoding="utf-8")
    found = list(doc_page.blocks(text))
    fences = text.count("\n```") // 2
    setups = text.count("<!-- setup\n")
    assert len(found) == fences + setups
    assert any(block.language in doc_page.LANGUAGES for block in found)
    for block in found:
        assert block.how in ("", "background", "until output") or block.how.startswith("not, ")
    assert text.count("<!-- run: ") == sum(bool(block.how) for block in found)


def test_output_that_differs_is_noticed(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    for shown, code in (("ab cd", 0), ("a...d", 0), ("ab", 1)):
        page.write_text(f"```console\n$ echo ab cd\n{shown}\n```\n")
        made = subprocess.run(
            [sys.executable, doc_page.__file__, page], capture_output=True, check=False
        )
        assert made.returncode == code, shown
