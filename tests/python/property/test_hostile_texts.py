"""R69: any text as condition, mission, parameter file, device or answer is taken or refused in words."""

from __future__ import annotations

from pathlib import Path

import pytest
from encoder import attitude, frame, heartbeat
from hypothesis import given
from hypothesis import strategies as st
from mavwire import mavparm, mavwp
from mavwire._ftp import channel
from mavwire._ftp.params import ftp_param_decode
from mavwire.dialects.v20.common import MAVLink
from mavwire.expression import ExpressionError, evaluate_condition
from mavwire.links.waiting import split_host_port
from mavwire.mavftp import OP_Ack, OP_Nack
from property.hostile import PROFILE, ordinary
from unit.link_tools import Capture, drain

ATOMS = st.sampled_from(
    ["ATTITUDE", "ATTITUDE.roll", "HEARTBEAT.type", "MAV.flightmode", "x", "0", "1.5", "'a'", "[]",
     "9**9", "degrees", "sum", "None", "True", "[i for i in range(9)]", "''.join", "getattr",
     "ATTITUDE.__class__", "ATTITUDE._timestamp", "9**9**9"]
)  # fmt: skip
TEXTS = st.recursive(
    ATOMS,
    lambda inner: st.one_of(
        st.builds("({} {} {})".format, inner, st.sampled_from("+-*/%<>|&^"), inner),
        st.builds("{}({})".format, inner, inner),
        st.builds("{}[{}]".format, inner, inner),
        st.builds("({} if {} else {})".format, inner, inner, inner),
        st.builds("{} in [{}, {}]".format, inner, inner, inner),
        st.builds("not {}".format, inner),
    ),
    max_leaves=12,
)
LINES = st.one_of(
    st.text(max_size=40),
    st.lists(st.sampled_from(["0", "1", "-1", "3", "16", "1e9", "nan", "x", "0x10", "RALLY", "177"]),
             max_size=14).map("\t".join),
)  # fmt: skip
HEADS = st.sampled_from(["", "QGC WPL 110\n", "QGC WPL 120\n", "# c\n", "﻿", "\0"])
FILES = st.builds(lambda head, lines: head + "\n".join(lines), HEADS, st.lists(LINES, max_size=8))


@PROFILE
@given(text=TEXTS | st.text(max_size=60))
def test_any_condition(text: str) -> None:
    link = Capture()
    link.rx += heartbeat() + frame(30, attitude(1, 0.5, 0, 0, 0, 0, 0))
    drain(link)
    with ordinary(ExpressionError, ArithmeticError, SyntaxError):
        answer = evaluate_condition(text, link.messages)
        assert answer is not NotImplemented


@PROFILE
@given(
    content=FILES.map(lambda text: text.encode("utf-8", "surrogatepass")) | st.binary(max_size=99)
)
@pytest.mark.parametrize("loader", ["MAVWPLoader", "MAVFenceLoader", "MAVRallyLoader"])
def test_any_plan(loader: str, content: bytes, tmp_path: Path) -> None:
    path = tmp_path / "plan"
    path.write_bytes(content)
    plan = getattr(mavwp, loader)()
    try:
        plan.load(str(path))
    except ValueError as error:
        assert str(path) in str(error)


@PROFILE
@given(
    content=FILES.map(lambda text: text.encode("utf-8", "surrogatepass")) | st.binary(max_size=99)
)
def test_any_parameter_file(content: bytes, tmp_path: Path) -> None:
    path = tmp_path / "a.parm"
    path.write_bytes(content)
    parameters = mavparm.MAVParmDict()
    try:
        parameters.load(str(path))
    except mavparm.MAVParmFileError as error:
        assert str(path) in str(error)
        assert not parameters


HOSTS = st.text("0123456789.:[]ax%-\0", max_size=14)


@PROFILE
@given(text=st.builds("{}:{}".format, HOSTS, HOSTS) | HOSTS)
def test_any_address(text: str) -> None:
    try:
        host, port = split_host_port(text, "udpin")
    except ValueError as error:
        assert str(error)
    else:
        assert host in text
        assert 0 <= port < 65536


@PROFILE
@given(payload=st.binary(max_size=251), parameters=st.binary(max_size=300))
def test_any_ftp_answer(payload: bytes, parameters: bytes) -> None:
    (msg,) = MAVLink(None).parse_buffer(frame(110, b"\0\xff\0" + payload, crc_extra=84)) or []
    op = channel.parse(msg)
    if op is not None:
        assert len(op.payload or b"") <= 239
        for kind in (OP_Ack, OP_Nack):
            op.opcode = kind
            assert str(op)
            assert channel.decode_result(op, "list").operation_name == "list"
    head = b"\x1b\x67\x02\0\x02\0"
    for data in (parameters, head + parameters):
        found = ftp_param_decode(data)
        assert found is None or len(found.params) <= 65535
