"""``import pymavlink`` gives mavwire. Each case runs in a process of its own: the import state is what is tested."""

from __future__ import annotations

import os
import subprocess
import sys
import textwrap
from pathlib import Path

import mavwire
import pytest

PACKAGE_FOLDER = str(Path(mavwire.__file__).parent.parent)

INSTALL = "import mavwire; mavwire.install_as_pymavlink()\n"


def run_python(code: str, *, cwd: Path | None = None) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "PYTHONPATH": PACKAGE_FOLDER}
    return subprocess.run(
        [sys.executable, "-c", textwrap.dedent(code)],
        capture_output=True, text=True, env=environment, cwd=cwd, timeout=60, check=False,
    )  # fmt: skip


def check(code: str, *, cwd: Path | None = None) -> None:
    """Run code that asserts; its output is the failure's text."""
    result = run_python(INSTALL + textwrap.dedent(code), cwd=cwd)
    assert result.returncode == 0, result.stderr


def test_modules_are_the_very_objects_of_mavwire() -> None:
    check("""
        import importlib, sys
        import pymavlink.dialects.v20.common as mavlink
        from pymavlink.generator import mavcrc
        from pymavlink.dialects.v10 import minimal
        import mavwire.dialects.v20.common, mavwire.generator.mavcrc, mavwire.dialects.v10.minimal
        assert mavlink is mavwire.dialects.v20.common
        assert mavcrc is mavwire.generator.mavcrc
        assert minimal is mavwire.dialects.v10.minimal
        assert importlib.import_module("pymavlink.dialects") is mavwire.dialects
        assert sys.modules["pymavlink.generator"] is sys.modules["mavwire.generator"]
    """)


def test_modules_keep_their_own_identity() -> None:
    check("""
        import pymavlink.generator.mavcrc as m
        assert m.__name__ == m.__spec__.name == "mavwire.generator.mavcrc"
        assert m.__package__ == "mavwire.generator"
        import importlib
        assert importlib.reload(m) is m
    """)


def test_package_version_and_contents() -> None:
    check("""
        import pymavlink, pkgutil
        assert pymavlink.__version__ == "2.4.50"
        assert mavwire.__version__ != "2.4.50"
        names = {module.name for module in pkgutil.iter_modules(pymavlink.__path__)}
        assert {"generator", "dialects"} <= names
        walked = {m.name for m in pkgutil.walk_packages(pymavlink.__path__, "pymavlink.")}
        assert "pymavlink.generator.mavparse" in walked
    """)


def test_metadata_version() -> None:
    check("""
        from importlib import metadata
        assert metadata.version("pymavlink") == metadata.version("PyMAVLink") == "2.4.50"
        assert metadata.metadata("pymavlink")["Name"] == "pymavlink"
        listed = [d for d in metadata.distributions() if type(d).__name__ == "AliasDistribution"]
        assert not listed
        mavwire.uninstall_as_pymavlink()
        records = [type(d).__name__ for d in metadata.distributions(name="pymavlink")]
        assert "AliasDistribution" not in records
    """)


@pytest.mark.parametrize(
    "statement",
    [
        "import pymavlink.nonsense",
        "import pymavlink.nonsense.deeper",
        "import pymavlink.generator.nope",
    ],
)
def test_missing_module_names_both(statement: str) -> None:
    check(f"""
        try:
            {statement}
        except ModuleNotFoundError as error:
            name = error.name
            assert repr(name) in str(error), error
            assert repr(name.replace("pymavlink", "mavwire", 1)) in str(error), error
        else:
            raise AssertionError("imported")
    """)


def test_missing_name_is_an_import_error() -> None:
    check("""
        try:
            from pymavlink import nonsense
        except ImportError as error:
            assert "cannot import name 'nonsense' from 'pymavlink'" in str(error), error
        else:
            raise AssertionError("imported")
    """)


def test_error_inside_a_module_passes_through() -> None:
    check("""
        import sys, types
        class Broken:
            def find_spec(self, name, path=None, target=None):
                if name == "mavwire.generator.mavtemplate":
                    raise ModuleNotFoundError("No module named 'lost'", name="lost")
        sys.meta_path.insert(1, Broken())
        try:
            import pymavlink.generator.mavtemplate
        except ModuleNotFoundError as error:
            assert error.name == "lost"
        else:
            raise AssertionError("imported")
    """)


def test_install_is_idempotent_and_can_be_undone() -> None:
    check("""
        import sys
        from mavwire._alias import is_installed
        before = len(sys.meta_path)
        mavwire.install_as_pymavlink()
        assert len(sys.meta_path) == before and is_installed()
        import pymavlink.generator.mavcrc
        mavwire.uninstall_as_pymavlink()
        mavwire.uninstall_as_pymavlink()
        assert not is_installed()
        assert not [name for name in sys.modules if name.startswith("pymavlink")]
        assert "mavwire.generator.mavcrc" in sys.modules
        mavwire.install_as_pymavlink()
        import pymavlink.generator.mavcrc as again
        assert again is sys.modules["mavwire.generator.mavcrc"]
    """)


def test_a_pymavlink_in_use_is_an_error_naming_it(tmp_path: Path) -> None:
    (tmp_path / "pymavlink").mkdir()
    (tmp_path / "pymavlink" / "__init__.py").write_text("")
    result = run_python(
        f"""
        import sys
        sys.path.insert(0, {str(tmp_path)!r})
        import pymavlink, mavwire
        from mavwire._alias import AliasError, is_installed
        try:
            mavwire.install_as_pymavlink()
        except AliasError as error:
            assert "pymavlink is already imported" in str(error) and {str(tmp_path)!r} in str(error)
        else:
            raise AssertionError("installed")
        assert not is_installed()
        """
    )
    assert result.returncode == 0, result.stderr


def test_an_installed_pymavlink_is_not_touched(tmp_path: Path) -> None:
    (tmp_path / "pymavlink").mkdir()
    (tmp_path / "pymavlink" / "__init__.py").write_text("raise RuntimeError('the other one')")
    (tmp_path / "pymavlink" / "mavtest.py").write_text("")
    check(f"""
        import sys
        sys.path.insert(0, {str(tmp_path)!r})
        import pymavlink.generator
        assert pymavlink.__version__ == "2.4.50"
        try:
            import pymavlink.mavtest
        except ModuleNotFoundError:
            pass
        else:
            raise AssertionError("the two packages are mixed")
    """)


def test_imports_from_many_threads_agree() -> None:
    check("""
        import importlib, sys, threading
        names = ["pymavlink.generator.mavparse", "pymavlink.dialects.v20.minimal",
                 "mavwire.generator.mavparse", "mavwire.dialects.v20.minimal"]
        start, seen = threading.Barrier(16), []
        def work(i):
            start.wait()
            mavwire.install_as_pymavlink()
            module = importlib.import_module(names[i % 4])
            seen.append((i % 2, module, hasattr(module, "MAVXML") or hasattr(module, "MAVLink")))
        threads = [threading.Thread(target=work, args=(i,)) for i in range(16)]
        [t.start() for t in threads]
        [t.join() for t in threads]
        assert len(seen) == 16 and all(complete for _, _, complete in seen)
        assert len({id(m) for k, m, _ in seen if k == 0}) == 1
        assert len({id(m) for k, m, _ in seen if k == 1}) == 1
    """)


def test_pickles_load_under_both_names() -> None:
    check("""
        import pickle
        from pymavlink.dialects.v20 import minimal
        message = minimal.MAVLink_heartbeat_message(1, 2, 3, 4, 5, 6)
        data = pickle.dumps(message, protocol=0)
        assert pickle.loads(data).to_dict() == message.to_dict()
        other = data.replace(b"cmavwire.dialects", b"cpymavlink.dialects")
        assert pickle.loads(other).to_dict() == message.to_dict()
        by_name = pickle.dumps(minimal.MAVLink, protocol=0).replace(b"mavwire", b"pymavlink")
        assert pickle.loads(by_name) is minimal.MAVLink
    """)


def test_module_made_at_run_time_is_found() -> None:
    check("""
        import sys, types
        sys.modules["mavwire.dialects.v20.homemade"] = module = types.ModuleType("homemade")
        import pymavlink.dialects.v20.homemade as found
        assert found is module and module.__spec__ is None
    """)


def test_importing_the_package_is_cheap() -> None:
    result = run_python("""
        import sys
        before = set(sys.modules)
        import mavwire, mavwire._alias
        mavwire.install_as_pymavlink()
        print(sorted(set(sys.modules) - before))
    """)
    assert result.stdout.strip() == "['__future__', 'mavwire', 'mavwire._alias']", result.stderr


def test_package_attributes() -> None:
    assert mavwire.__version__[0].isdigit()
    assert "install_as_pymavlink" in dir(mavwire)
    with pytest.raises(AttributeError, match="no attribute 'nonsense'"):
        mavwire.nonsense  # noqa: B018


def test_modules_that_ground_stations_import() -> None:
    check("""
        import mavwire.mavwp, mavwire.mavparm, mavwire.mavftp, mavwire.fgFDM
        from pymavlink import fgFDM, mavextra, mavftp, mavparm, mavtestgen, mavutil, mavwp
        from pymavlink.mavftp_op import FTP_OP, OP_OpenFileRO
        from pymavlink.dialects.v10 import ardupilotmega
        assert mavwp is mavwire.mavwp and mavparm is mavwire.mavparm
        assert mavftp is mavwire.mavftp and fgFDM is mavwire.fgFDM
        loader = mavwp.MAVWPLoader(target_system=1, target_component=1)
        loader.add_latlonalt(1.0, 2.0, 3.0)
        assert loader.wp(0).get_type() == "MISSION_ITEM"
        parameters = mavparm.MAVParmDict()
        parameters["A"] = 1.0
        assert mavftp.FTP_OP is FTP_OP and OP_OpenFileRO == 4
        assert mavutil.mavlink_connection and mavextra.kmh(1) == 3.6
        assert ardupilotmega.MAVLINK_MSG_ID_HEARTBEAT == 0
    """)
