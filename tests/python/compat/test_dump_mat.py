"""MATLAB files of mavlogdump and of `mavwire dump`: the same variables with the same values."""

from __future__ import annotations

from pathlib import Path

import pytest
from dataflash_writer import sample
from tool_runs import program, random_log, run


@pytest.mark.parametrize("compress", [False, True])
@pytest.mark.parametrize("kind", ["telemetry", "dataflash"])
def test_the_same_variables(kind: str, compress: bool, tmp_path: Path, oracle: str) -> None:
    matlab = pytest.importorskip("scipy.io")
    numpy = pytest.importorskip("numpy")
    if kind == "telemetry":
        log = random_log(tmp_path / "log.tlog", 3)
        types = "HEARTBEAT,ATTITUDE,STATUSTEXT,GPS_RAW_INT,PARAM_VALUE,GPS_STATUS"
    else:
        log = tmp_path / "log.bin"
        sample().write(log)
        types = "PARM,GPS,IMU,MODE"
    options = ["--format", "mat", "--types", types, *(["-c"] if compress else [])]
    loaded = []
    for name, command in (("their", program("mavlogdump")), ("our", ["-m", "mavwire", "dump"])):
        path = f"{name}.mat"
        assert run([*command, *options, "--mat_file", path, str(log)], tmp_path) == ([""], 0)
        loaded.append(matlab.loadmat(tmp_path / path))
    theirs, ours = ({k: v for k, v in one.items() if k[0] != "_"} for one in loaded)
    assert list(ours) == list(theirs) != []
    for name, table in theirs.items():
        assert ours[name].dtype.names == table.dtype.names, name
        for field in table.dtype.names:
            their, our = table[field][0, 0], ours[name][field][0, 0]
            assert our.dtype == their.dtype, (name, field)
            numpy.testing.assert_array_equal(our, their, f"{name}.{field}")
