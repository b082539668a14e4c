"""Names that programs reach without an import of their own: ``import *``, and modules that came with
another one.
"""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from beside import assert_same, output

pytest.importorskip("numpy")

COMPANIONS = """
load("mavutil")
package = importlib.import_module(pkg)
for text in ("package.rotmat.Vector3(1, 2, 3)", "package.quaternion.Quaternion([1, 0, 0, 0]).norm",
             "package.mavextra.kmh(10)", "package.mavexpression.evaluate_expression('1 + 1', {})",
             "package.generator.mavparse.PROTOCOL_2_0", "package.generator.mavcrc.x25crc(b'1').crc",
             "package.generator.nothing", "package.nothing"):
    show(text, globals())
"""

STARS = """
import types
for name in ("mavextra", "mavexpression", "rotmat", "quaternion", "mavwp", "mavparm", "fgFDM",
             "DFReader", "CSVReader", "mavftp_op", "dialects.v20.common"):
    names = {}
    exec(f"from {pkg}.{name} import *", names)
    for found, value in names.items():
        own = getattr(value, "__module__", pkg).startswith(pkg)
        if own and not isinstance(value, types.ModuleType):
            print(name, found)
"""

# Replaces each name of a module, and notes which ones ordinary use calls.
HOOKED = f"""
sys.path.insert(0, {str(Path(__file__).parents[1])!r})
from differential import hooked
hooked.main([pkg, "."])
"""
PAGE = Path(__file__).parents[3] / "docs" / "compatibility.md"


def test_replaced_names_are_called_or_warn(oracle: str, tmp_path: Path) -> None:
    """A warning says so if the replacement of a name has no effect."""
    ours, theirs = (
        {
            tuple(line.split()[:2]): line.split()[2]
            for line in output(package, HOOKED, tmp_path / package)
        }
        for package in ("mavwire", oracle)
    )
    called = [name for name, outcome in theirs.items() if outcome == "called"]
    assert len(called) > 100 and ours.keys() == theirs.keys()
    assert not [name for name in called if ours[name] not in ("called", "warns", "raises")]
    page = PAGE.read_text(encoding="utf-8")
    listed = [f"`{module}.{name}`" for module, name in called if ours[module, name] != "called"]
    of_math = [f"`mavextra.{name}`" for name in vars(math)]
    assert not [name for name in listed if name not in page and name not in of_math]


def test_modules_that_come_with_mavutil(oracle: str, tmp_path: Path) -> None:
    assert_same(COMPANIONS, tmp_path, oracle)


def test_names_that_a_star_imports(oracle: str, tmp_path: Path) -> None:
    ours = set(output("mavwire", STARS, tmp_path / "ours"))
    theirs = set(output(oracle, STARS, tmp_path / "theirs"))
    assert len(theirs) > 2000
    missing = {name for name in theirs - ours if not name.endswith((" long", " object", " range"))}
    assert not missing


@pytest.mark.parametrize("module", ["mavextra", "mavexpression"])
def test_tables_and_the_evaluator_are_names(module: str) -> None:
    names: dict[str, object] = {}
    exec(f"from mavwire.{module} import *", names)
    assert isinstance(names["declination_table"], list)
    assert ("evaluate_expression" in names) == (module == "mavexpression")
