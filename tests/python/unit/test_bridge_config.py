"""What users write to say what a bridge shall do: endpoints, options, configuration files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from mavwire import Bridge
from mavwire.bridge import Config, ConfigError, Endpoint, load_config, parse_endpoint
from mavwire.bridge.sidecars import Listen


@pytest.mark.parametrize(
    ("text", "endpoint"),
    [
        ("udpin:0.0.0.0:14550", Endpoint("udpin", "0.0.0.0", 14550)),
        ("udp:127.0.0.1:14550", Endpoint("udpin", "127.0.0.1", 14550)),
        ("udps::5600", Endpoint("udpin", "0.0.0.0", 5600)),
        ("udpout:gcs.example:14550", Endpoint("udpout", "gcs.example", 14550)),
        ("udpc:1.2.3.4:5600", Endpoint("udpout", "1.2.3.4", 5600)),
        ("udpout:[::1]:14550", Endpoint("udpout", "::1", 14550)),
        ("udpbcast:10.0.0.255:14550", Endpoint("udpbcast", "10.0.0.255", 14550)),
        ("udpb:192.168.7.255:5601", Endpoint("udpbcast", "192.168.7.255", 5601)),
        ("tcp:10.0.0.2:5760", Endpoint("tcp", "10.0.0.2", 5760)),
        ("tcpc:example.com:5600", Endpoint("tcp", "example.com", 5600)),
        ("tcpin:0.0.0.0:0", Endpoint("tcpin", "0.0.0.0", 0)),
        ("tcps:[::]:5600", Endpoint("tcpin", "::", 5600)),
        ("/dev/ttyACM0", Endpoint("serial", "/dev/ttyACM0", baud=115200)),
        ("/dev/ttyACM0,57600", Endpoint("serial", "/dev/ttyACM0", baud=57600)),
        ("serial:/dev/ttyAMA0:57600", Endpoint("serial", "/dev/ttyAMA0", baud=57600)),
        ("serial:/dev/serial/by-id/a:b", Endpoint("serial", "/dev/serial/by-id/a:b")),
    ],
)
def test_endpoints(text: str, endpoint: Endpoint) -> None:
    assert parse_endpoint(text) == endpoint
    assert parse_endpoint(str(endpoint)) == endpoint


@pytest.mark.parametrize(
    ("text", "wrong"),
    [
        ("", "no endpoint"),
        ("14550", "no endpoint"),
        ("127.0.0.1:14550", "no endpoint"),
        ("udpx:1.2.3.4:5", "no endpoint"),
        ("udpin:14550", "lacks host or port"),
        ("udpout::14550", "lacks a host"),
        ("udpout:1.2.3.4:0", "from 1 to 65535"),
        ("udpin:1.2.3.4:70000", "from 0 to 65535"),
        ("udpin:::1:5", "lacks host or port"),
        ("serial:", "lacks a device"),
        ("serial:/dev/x:0", "the speed of"),
        (f"udpin:1.2.3.4:{'5' * 5000}", "from 0 to 65535"),
        (f"serial:/dev/x:{'5' * 5000}", "the speed of"),
        ("udpin:1.2.3.4:\u0665\u0667", "lacks host or port"),
    ],
)
def test_wrong_endpoints(text: str, wrong: str) -> None:
    with pytest.raises(ConfigError, match=wrong) as raised:
        parse_endpoint(text)
    assert repr(text) in str(raised.value)


@given(st.text(max_size=40))
def test_any_text_is_an_endpoint_or_a_clear_error(text: str) -> None:
    for prefix in ("", "udpin:", "tcp:", "serial:", "/"):
        try:
            endpoint = parse_endpoint(prefix + text)
        except ConfigError:
            continue
        assert 0 <= endpoint.port < 65536 and endpoint.address


@pytest.mark.parametrize(
    ("options", "wrong"),
    [
        ({"grop": "a"}, "unknown option 'grop'; did you mean 'group'"),
        ({"group": 3}, "group must be a text"),
        ({"private": 1}, "private must be true or false"),
        ({"block_messages_out": "ATTITUDE"}, "block_messages_out must be a list"),
        ({"block_messages_out": ["ATITUDE"]}, "block_messages_out: the dialect has no message"),
        ({"allow_messages_in": [-1]}, "a message id must be a number"),
        ({"allow_systems_in": [256]}, "allow_systems_in must be a number from 0 to 255"),
        ({"rate": 0}, "rate must be more than 0"),
        ({"rate": float("nan")}, "rate must be a finite number, not nan"),
        ({"bytes_per_second": 10**400}, "bytes_per_second must be a finite number"),
        ({"bytes_per_second": 10**5000}, "bytes_per_second must be a finite number"),
        ({"queue_bytes": 10**5000}, "not one of so many digits"),
        ({"rates": {"ATTITUDE": "fast"}}, "rates: ATTITUDE must be a number"),
        ({"rates": 5}, "rates must map"),
        ({"rates": {"ATTITUDE": 1, "30": 2}}, "rates: '30' is a message that was named before"),
        ({"bytes_per_second": True}, "bytes_per_second must be a number"),
        ({"queue_bytes": 1}, "queue_bytes must be a number from 1024"),
        ({"datagram_bytes": 70_000}, "datagram_bytes must be a number from 0"),
        ({"peer_timeout": -1}, "peer_timeout must be"),
        ({"retry": "soon"}, "retry must be a number"),
        ({"name": ""}, "name must not be empty"),
        ({"group": ""}, "group must not be empty"),
        ({"name": 5}, "name must be a text, not 5"),
    ],
)
def test_wrong_options(options: dict[str, Any], wrong: str) -> None:
    with pytest.raises(ConfigError, match=wrong):
        Bridge().add("udpin:127.0.0.1:0", **options)


@pytest.mark.parametrize(
    "settings",
    [{"dedup": -1}, {"dedup": "x"}, {"max_age": 0}, {"sniffer_sysid": 256}, {"source_system": 0}],
)
def test_wrong_settings(settings: dict[str, Any]) -> None:
    with pytest.raises(ConfigError, match=next(iter(settings))):
        Bridge(**settings)


def load(tmp_path: Path, name: str, text: str | bytes) -> Config:
    path = tmp_path / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return load_config(path)


MAIN_CONF = """
# a comment
[General]
TcpServerPort = 5790
DeduplicationPeriod = 250
SnifferSysid=254
Log = /var/log/flight
LogTelemetry = True
DebugLogLevel = info

[UartEndpoint alpha]
Device = /dev/ttyS0
Baud = 52000,9600
FlowControl = 1
Group = radio

[udpendpoint bravo]
mode = Server
ADDRESS = 0.0.0.0
port = 10000
AllowMsgIdOut = 0, 30,
BlockSrcSysIn = 7

[UdpEndpoint charlie]
Mode = Normal
Address = 127.0.0.1

[UdpEndpoint]
Mode = Eavesdropping
Address = [::1]
Port = 11000
Filter = 33

[TcpEndpoint delta]
Address = 127.0.0.1
Port = 25760
RetryTimeout = 0
"""


def test_the_format_of_mavlink_router(tmp_path: Path) -> None:
    config = load(tmp_path, "main.conf", MAIN_CONF)
    assert config.settings == {"dedup": 0.25, "sniffer_sysid": 254}
    assert config.recording is not None and config.recording.directory == "/var/log/flight"
    assert [endpoint for _, endpoint, _ in config.links] == [
        Endpoint("tcpin", "0.0.0.0", 5790),
        Endpoint("serial", "/dev/ttyS0", baud=52000, flow_control=True),
        Endpoint("udpin", "0.0.0.0", 10000),
        Endpoint("udpout", "127.0.0.1", 14550),
        Endpoint("udpin", "::1", 11000),
        Endpoint("tcp", "127.0.0.1", 25760),
    ]
    assert [options for _, _, options in config.links] == [
        {},
        {"name": "alpha", "group": "radio"},
        {"name": "bravo", "allow_messages_out": [0, 30], "block_systems_in": [7]},
        {"name": "charlie"},
        {"name": "UdpEndpoint", "allow_messages_out": [33]},
        {"name": "delta", "retry": 0},
    ]
    assert [line.split(":")[1] for line in config.warnings] == ["9", "13"]
    assert repr(Bridge.from_options(config)) == "<Bridge of 6 links, stopped>"


@pytest.mark.parametrize(
    ("text", "warning"),
    [
        ("[General]\nLogTelemetry = true", ":2: no effect without Log"),
        ("[General]\nLog = a\nLogTelemetry=true\nlog = b", ":2: no effect: Log is given again at"),
        (
            "[UdpEndpoint a]\nMode=normal\nAddress=h\nPort=1\nFilter=3\nAllowMsgIdOut=4",
            ":5: no effect beside AllowMsgIdOut",
        ),
    ],
)
def test_keys_without_effect_are_told_of(tmp_path: Path, text: str, warning: str) -> None:
    (told,) = load(tmp_path, "main.conf", text).warnings
    assert f"main.conf{warning}" in told


def test_without_a_word_mavlink_router_listens_on_5760(tmp_path: Path) -> None:
    assert load(tmp_path, "main.conf", "").links[0][1] == Endpoint("tcpin", "0.0.0.0", 5760)
    assert load(tmp_path, "main.conf", "[General]\nTcpServerPort=0").links == []


@pytest.mark.parametrize(
    ("text", "wrong"),
    [
        ("x = 1", ":1: stands before the first"),
        ("[General]\n\nnonsense", ":3: neither"),
        ("[Genral]", r":1: unknown section \[Genral\]"),
        (
            "[General]\nTcpServerPrt = 1",
            ":2: unknown option 'TcpServerPrt'; did you mean 'TcpServerP",
        ),
        ("[General]\nTcpServerPort = 99999", ":2: TcpServerPort must be a number from 0 to 65535"),
        ("[General]\nTcpServerPort = " + "9" * 10_000, ":2: TcpServerPort must be a number"),
        ("[General]\nLogTelemetry = maybe", ":2: LogTelemetry must be true or false"),
        ("[UdpEndpoint a]\nMode = Normal", r":1: \[a\] lacks Address"),
        ("[UdpEndpoint a]\nAddress = ::1\nMode = x", ":3: Mode must be Normal or Server"),
        ("[UdpEndpoint a]\nAddress = h\nMode = server", r":1: \[a\] lacks Port"),
        ("[UartEndpoint a]\nBaud = fast", ":2: Baud must be a number from 1 to"),
        (
            "[General]\nDeduplicationPeriod = -5",
            ":2: DeduplicationPeriod must be a number from 0 to",
        ),
        ("[UartEndpoint a]", r":1: \[a\] lacks Device"),
        ("[TcpEndpoint a]\nAddress = h", r":1: \[a\] lacks Port"),
        (
            "[TcpEndpoint a]\nAddress = h\nPort = 1\nAllowSrcSysIn = 1,-2",
            ":4: AllowSrcSysIn must be",
        ),
        (
            "[TcpEndpoint a]\nAddress = h\nPort = 1\nBlockSrcCompIn = 256",
            ":4: BlockSrcCompIn must be",
        ),
        ("[TcpEndpoint a]\nAddress = h\nPort = 0", ":3: Port must be a number from 1"),
        ("[UdpEndpoint a]\nMode = server\nPort = 1\nAddress =", r":4: \[a\] lacks Address"),
        ("[UartEndpoint a]\nDevice = /dev/null\nBaud = 0", ":3: Baud must be a number from 1"),
        ("[UartEndpoint a]\nDevice = b\n" * 2, ":3: another link is called 'a'"),
        (b"\xff\xfe", "not text, at byte 0"),
        ("#" * 2_000_000, "longer than"),
    ],
)
def test_wrong_lines_are_named(tmp_path: Path, text: str, wrong: str) -> None:
    with pytest.raises(ConfigError, match=r"main\.conf" + wrong if wrong[0] == ":" else wrong):
        Bridge.from_options(load(tmp_path, "main.conf", text))


def test_editors_may_mark_a_file_as_utf_8(tmp_path: Path) -> None:
    assert not load(tmp_path, "main.conf", "\ufeff[General]\nTcpServerPort = 0").links
    assert load(tmp_path, "bridge.toml", "\ufeffmax_age = 3").settings == {"max_age": 3}


TOML = """
dedup = 0.25
max_age = 30

[record]
directory = "logs"
max_bytes = 100_000_000

[[link]]
endpoint = "serial:/dev/ttyAMA0:57600"
name = "vehicle"

[[link]]
endpoint = "udpout:10.0.0.2:14550"
name = "satellite"
group = "uplink"
bytes_per_second = 200
rates = { ATTITUDE = 1, "29" = 2 }
block_messages_out = ["RAW_IMU", 29]
"""


def test_toml(tmp_path: Path) -> None:
    config = load(tmp_path, "bridge.toml", TOML)
    assert config.settings == {"dedup": 0.25, "max_age": 30}
    assert config.recording is not None and config.recording.max_bytes == 100_000_000
    link = Bridge.from_options(config)._links[1]
    assert (link.name, link.group, link.group_number) == ("satellite", "uplink", 0)
    assert (link.bytes_per_second, link.message_rates) == (200.0, [(30, 1.0), (29, 2.0)])
    assert (link.outbound, link.inbound) == ([(False, "messages", [27, 29])], [])


def test_what_runs_beside_the_bridge(tmp_path: Path) -> None:
    (tmp_path / "password").write_text("s3cret\n")
    text = f"""
json = 10
http = {{ listen = ":8080", names = ["rover.example"] }}
[metrics]
listen = "[::1]:9090"
[[sink]]
address = "mqtts://me@broker/field"
password_file = '{tmp_path / "password"}'
[[sink]]
address = "ws://:8765"
"""
    config = load(tmp_path, "bridge.toml", text)
    assert (config.json, config.http) == (10.0, Listen("127.0.0.1", 8080, ("rover.example",)))
    assert config.metrics == Listen("::1", 9090)
    first, second = config.sinks
    assert (first.address, first.password, second.password) == (
        "mqtts://me@broker/field",
        "s3cret",
        None,
    )
    assert second.place.endswith("bridge.toml: sink 2") and "s3cret" not in repr(config)


@pytest.mark.parametrize(
    ("text", "wrong"),
    [
        ("json = 0", ": json must be 0.001 seconds or more"),
        ("[http]\nlisten = '8080x'", r": http: not \[HOST\]:PORT: '8080x'"),
        ("[http]\nport = 1", ": http: it needs listen, such as ':8080'"),
        ("metrics = ':1'", ": metrics: it needs listen"),
        (
            "[metrics]\nlisten = ':1'\nname = 'a'",
            ": metrics: unknown option 'name'; did you mean",
        ),
        ("[metrics]\nlisten = ':1'\nnames = 'a'", ": metrics: names must be a list"),
        ("[sink]", r": say \[\[sink\]\]"),
        ("[[sink]]", ": sink 1: it needs address"),
        ("sink = [1]", ": sink 1: it needs address"),
        (
            "[[sink]]\naddress = 'x'\npassword_file = '/no/such'",
            ": sink 1: password_file: /no/such: No such file",
        ),
        (
            "[[sink]]\naddress = 'x'\npassword_file = '/dev/null'",
            ": sink 1: password_file: /dev/null: its first line is empty",
        ),
        (
            "[[sink]]\naddress = 'x'\npassword_file = '/dev/zero'",
            ": sink 1: password_file: /dev/zero: longer than 4,096 bytes",
        ),
        (
            '[[sink]]\naddress = "x"\npassword_file = "a\\u0000b"',
            ": sink 1: password_file must be a path, not 'a.x00b'",
        ),
        (
            '[[link]]\nendpoint = "udpin:127.0.0.1:0"\nsign_out = true\nsigning_key_file = "a\\u0000b"',
            ": link 1: signing_key_file must be a path, not 'a.x00b'",
        ),
        ("\ndedup = x = 1", r":2: Invalid value \(at line 2"),
        ("dedup = 1\n\nx\n\n", ":3: Expected '=' after a key"),
        ("dedup = [1,\n", ":1: "),
        ("# a\n\ndedop = 1", ": unknown option 'dedop'; did you mean 'dedup'"),
        ("dedup = -1", ": dedup must be 0 seconds or more"),
        ("dedup = 1e300", ": dedup must be 10000000000 seconds or less, not 1e.300"),
        ("dialect = 3", ": dialect must be a text"),
        ("max_age = 1\ndialect = 'nope'", ": dialect: no dialect 'nope'; name a built-in one"),
        ("dedup = " + "9" * 5000, ": a number has thousands of digits"),
        ("record = 3", ": record: it needs a directory"),
        ("[record]\ndirectory = 5", ": record: the directory to record to must be a path, not 5"),
        ("[record]\ndirectory = 'x'\nmax_byte = 1", ": record: unknown option 'max_byte'"),
        ("[record]\ndirectory = 'x'\nmax_bytes = 0", ": record: max_bytes must be"),
        ("\n[link]\nendpoint = 'udpin::1'", r": say \[\[link\]\]"),
        ("[[link]]\nname = 'a'", ": link 1: it needs an endpoint"),
        ("[[link]]\nendpoint = 5", ": link 1: endpoint must be a text, not 5"),
        ("[[link]]\nendpoint = 'udpin'", ": link 1: 'udpin' is no endpoint"),
        (
            "[[link]]\nendpoint = 'udpin::1'\nname='a'\nrat = 1",
            r": link 1 \('a'\): unknown option",
        ),
        (
            "[[link]]\nendpoint = 'udpin::1'\n[[link]]\nendpoint = 'udpin::2'\n\n[link.rates]\nX=1",
            ": link 2: rates: the dialect has no message 'X'",
        ),
        (
            "[[link]]\nendpoint = 'udpin::1'\nrates.ATTITUDE = 0",
            ": link 1: rates: ATTITUDE must be more than 0",
        ),
        (
            "[[link]]\nendpoint = 'udpin::1'\n  verify_in = true",
            ": link 1: verify_in needs signing_key",
        ),
        (
            "[[link]]\nendpoint = 'udpin::1'\nname = 'a'\n[[link]]\nendpoint = 'tcp:h:1'\nname = 'a'",
            r": link 2 \('a'\): another link is called 'a' too",
        ),
        (
            "link = [{endpoint='udpin::1'},\n{endpoint='udpin::1', rate=0}]",
            ": link 2: rate must be",
        ),
        ("a = " + "[" * 100_000, ": nested too deeply"),
    ],
)
def test_wrong_toml_is_named(tmp_path: Path, text: str, wrong: str) -> None:
    with pytest.raises(ConfigError, match=wrong) as raised:
        Bridge.from_options(load(tmp_path, "bridge.toml", text))
    assert "bridge.toml" in str(raised.value)


def test_several_dialects_are_a_list(tmp_path: Path) -> None:
    bridge = Bridge.from_options(load(tmp_path, "bridge.toml", "dialect = ['common', 'ASLUAV']"))
    assert bridge._message_id("SENS_POWER") == 8002
    for text in ("dialect = []", "dialect = [5]", "dialect = ['nope']", "dialect = 5"):
        with pytest.raises(ConfigError, match=r"bridge\.toml: dialect"):
            Bridge.from_options(load(tmp_path, "bridge.toml", text))


@given(st.text(max_size=200))
def test_any_text_is_a_configuration_or_a_clear_error(text: str) -> None:
    from mavwire.bridge.config_file import _Toml
    from mavwire.bridge.main_conf import parse_main_conf

    for parse in (lambda *given: _Toml(*given).config(), parse_main_conf):
        for body in (text, f"[General]\n{text}", f"[[link]]\n{text}", f"[UdpEndpoint a]\n{text}"):
            try:
                parse("file", body)
            except ConfigError as error:
                assert str(error).startswith("file")
