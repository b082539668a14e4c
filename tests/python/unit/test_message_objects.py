"""Message objects come and go fast: what is reused must never show what it was before."""

from __future__ import annotations

import copy
import gc
import pickle
import sys
import threading
import weakref
from pathlib import Path
from typing import Any
from unittest import mock

import pytest
from mavwire.dialects import load
from mavwire.dialects.v20 import ardupilotmega as mavlink

DEFINITIONS = Path(__file__).parents[3] / "message_definitions" / "v1.0"


def frame(seconds: int = 1) -> bytes:
    mav = mavlink.MAVLink(None, 1, 1)
    return bytes(mavlink.MAVLink_attitude_message(seconds, 1, 2, 3, 4, 5, 6).pack(mav))


def received(count: int = 1) -> list[Any]:
    return mavlink.MAVLink(None).parse_buffer(b"".join(frame(n) for n in range(count)))


@pytest.fixture
def no_collections():
    """Nothing that earlier tests left behind is freed while objects are counted."""
    gc.collect()
    gc.disable()
    yield
    gc.enable()


def churn() -> None:
    """Make and drop more messages than are kept for reuse."""
    for _ in range(3):
        assert len(received(5000)) == 5000


def test_objects_used_again_hold_the_new_message_alone(no_collections):
    wire = frame()
    first = mavlink.MAVLink(None).parse_buffer(wire)[0]
    first._timestamp = 5.0
    first.pack(mavlink.MAVLink(None, 9, 9))
    address = id(first)
    del first
    again = mavlink.MAVLink(None).parse_buffer(wire)[0]
    assert id(again) == address, "no object was used again, so this test proves nothing"
    assert not hasattr(again, "_timestamp")
    assert again.get_srcSystem() == 1
    assert again.roll == 1.0
    assert not again.get_signed()
    assert "extra" not in vars(again)


@pytest.mark.parametrize("count", [1, 3])
def test_every_object_comes_back(no_collections, count):
    """That of the last frame too, behind which no bytes follow."""
    mav = mavlink.MAVLink(None)
    wire = frame() * count
    churn()
    addresses = set()
    for _ in range(1000):
        addresses.update(map(id, mav.parse_buffer(wire)))
    assert len(addresses) <= count + 1


def test_classes_are_counted_right(no_collections):
    churn()
    cls = mavlink.MAVLink_attitude_message
    before = sys.getrefcount(cls)
    kept = received(100)
    during = sys.getrefcount(cls)
    del kept
    churn()
    after = sys.getrefcount(cls)
    assert (during - before, after - before) == (100, 0)


def test_weak_references_die_with_the_message():
    died = []
    message = received()[0]
    reference = weakref.ref(message, died.append)
    assert reference() is message
    del message
    assert reference() is None
    assert len(died) == 1
    churn()
    assert reference() is None


@pytest.mark.parametrize("write", [setattr, lambda m, n, v: vars(m).__setitem__(n, v)])
def test_cycles_are_collected(write):
    message = received()[0]
    write(message, "me", message)
    reference = weakref.ref(message)
    del message
    gc.collect()
    assert reference() is None
    churn()


def test_messages_off_the_wire_are_untracked_until_written_to():
    message = received()[0]
    assert not gc.is_tracked(message)
    message.note = []
    assert gc.is_tracked(message)


class Plain(mavlink.MAVLink_attitude_message):
    """A subclass as users write it."""


class Slotted(mavlink.MAVLink_attitude_message):
    """A subclass whose instances are larger."""

    __slots__ = ("note",)


@pytest.mark.parametrize("cls", [Plain, Slotted])
def test_subclasses_live_and_die(cls):
    references = sys.getrefcount(cls)
    for number in range(6000):
        message = cls(number, 1, 2, 3, 4, 5, 6)
        message.note = [message]
        twin = copy.copy(message)
        assert twin.time_boot_ms == number
        assert type(twin) is cls
    del message, twin
    churn()
    gc.collect()
    assert sys.getrefcount(cls) <= references + 2


def test_subclass_destructors_run():
    gone = []

    class Mourned(mavlink.MAVLink_attitude_message):
        def __del__(self):
            gone.append(self.time_boot_ms)

    for number in range(3):
        Mourned(number, 1, 2, 3, 4, 5, 6)
    message = received()[0]
    message.__class__ = Mourned
    del message
    gc.collect()
    assert gone == [0, 1, 2, 0]
    churn()


def test_message_classes_look_like_class_statements():
    cls = mavlink.MAVLink_attitude_message
    assert cls.__name__ == cls.__qualname__ == "MAVLink_attitude_message"
    assert cls.__module__ == "mavwire.dialects.v20.ardupilotmega"
    assert cls.__bases__ == (mavlink.MAVLink_message,)
    assert type(cls) is type
    with pytest.raises(AttributeError, match=r"^'MAVLink_attitude_message' object has no"):
        received()[0].no_such_field  # noqa: B018


def test_equal_definitions_of_two_modules_stay_apart():
    from mavwire.dialects.v20 import common

    here, there = (m.MAVLink_attitude_message(1, 1, 2, 3, 4, 5, 6) for m in (mavlink, common))
    assert here != there
    assert type(here).mro()[1] is mavlink.MAVLink_message
    assert type(there).mro()[1] is common.MAVLink_message


def test_bad_data_that_is_packed_keeps_its_reason():
    mav = mavlink.MAVLink(None)
    mav.robust_parsing = True
    damaged = bytearray(frame())
    damaged[-1] ^= 1
    bad = mav.parse_buffer(bytes(damaged))[0]
    reason = bad.reason
    assert "invalid MAVLink CRC" in reason
    bad._header.msgId = 30
    bad._pack(mav, 39, b"abc")
    assert bad.reason == reason
    assert bad.get_msgbuf()[0] == 0xFD


def odd_messages() -> list[Any]:
    """BAD_DATA with and without a frame, and UNKNOWN."""
    mav = mavlink.MAVLink(None)
    mav.robust_parsing = True
    body = b"\x01\0\0\0\x01\x01\xef\xcd\xab\x07"
    unknown = b"\xfd" + body + mavlink.x25crc(body + b"\x55").crc.to_bytes(2, "little")
    return mav.parse_buffer(frame()[:-1] + b"!" + b"junk" + unknown)


def test_odd_messages_show_their_attributes_and_keep_them_in_copies():
    messages = odd_messages()
    assert [one.get_type() for one in messages] == ["BAD_DATA", "BAD_DATA", "UNKNOWN_11259375"]
    for one in messages:
        expected = {"data"} if one.get_msgId() == -2 else {"data", "reason"}
        for same in (one, copy.copy(one), copy.deepcopy(one), pickle.loads(pickle.dumps(one))):
            assert (str(same), same.to_dict()) == (str(one), one.to_dict())
            assert {name for name in vars(same) if not name.startswith("_")} == expected
            assert "_instance_offset" not in vars(same)
            assert same == one


@pytest.mark.parametrize("delete", [delattr, lambda message, name: vars(message).pop(name)])
@pytest.mark.parametrize("name", ["roll", "_header", "_timestamp"])
def test_what_was_deleted_is_gone(delete, name):
    for message in (received()[0], mavlink.MAVLink_attitude_message(0, 1, 2, 3, 4, 5, 6)):
        message._timestamp = 5.0
        delete(message, name)
        for same in (message, copy.copy(message), pickle.loads(pickle.dumps(message))):
            assert not hasattr(same, name)
            assert name not in vars(same)
            assert same.pitch == 2
            with pytest.raises(AttributeError):
                delattr(same, name)
        if name != "_timestamp":
            with pytest.raises(AttributeError, match=name):
                message.pack(mavlink.MAVLink(None))


def test_a_deleted_field_that_the_class_answers_to():
    message = mavlink.MAVLink_param_ext_value_message(b"a", b"b", 1, 2, 3)
    battery = mavlink.MAVLink_battery_status_message(7, 0, 0, 0, [7] * 10, 0, 0, 0, 50)
    assert battery.id == 7
    del battery.id, message.param_id
    assert battery.id == type(battery).id == 147
    assert not hasattr(message, "param_id")


def test_field_names_may_be_any_iterable():
    message = received()[0]
    message._fieldnames = ("roll", "pitch")
    assert str(message) == "ATTITUDE {roll : 1.0, pitch : 2.0}"
    assert message.to_dict() == {"mavpackettype": "ATTITUDE", "roll": 1.0, "pitch": 2.0}


def test_threads_do_not_mix_up_messages():
    failures = []

    def work(number: int) -> None:
        mav = mavlink.MAVLink(None)
        wire = frame(number)
        for _ in range(300):
            for message in mav.parse_buffer(wire * 20):
                if message.time_boot_ms != number:
                    failures.append(message)

    threads = [threading.Thread(target=work, args=(number,)) for number in range(1, 5)]
    interval = sys.getswitchinterval()
    sys.setswitchinterval(1e-5)
    try:
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
    finally:
        sys.setswitchinterval(interval)
    assert not failures


class SlowFile:
    """A transport whose write lets other threads run, and which sends once more from within."""

    def __init__(self) -> None:
        self.frames: list[bytes] = []
        self.mav: Any = None

    def write(self, data: bytes) -> None:
        threading.Event().wait(0.0001)
        self.frames.append(data)


def test_frames_of_many_threads_leave_in_sequence():
    file = SlowFile()
    mav = mavlink.MAVLink(file, 1, 1)
    mav.signing.secret_key = bytes(32)
    mav.signing.sign_outgoing = True

    def work() -> None:
        for _ in range(40):
            mav.heartbeat_send(1, 2, 3, 4, 5)

    threads = [threading.Thread(target=work) for _ in range(6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert [data[4] for data in file.frames] == [n % 256 for n in range(240)]
    stamps = [int.from_bytes(data[-12:-6], "little") for data in file.frames]
    assert stamps == sorted(set(stamps))


def test_raw_functions_refuse_wrong_arguments():
    from mavwire import _native

    with pytest.raises(TypeError):
        _native.send_values()
    with pytest.raises(TypeError):
        _native.send_values(1, 2, 3)
    with pytest.raises(TypeError):
        _native.build()
    with pytest.raises(TypeError):
        _native.build("no message", 1)


def test_classes_of_something_else_are_refused():
    from mavwire import _native

    class Impostor:
        _info = None

    with pytest.raises(TypeError, match="Impostor is no message class"):
        _native.restore(Impostor, None, 0, None, 0)
    with pytest.raises(TypeError, match="int is no message class"):
        _native.message_class("module", "name", int, {})


def test_a_value_that_changes_the_message_while_it_is_packed():
    class Meddler(int):
        def __float__(self) -> float:
            vars(message).clear()
            return 1.0

    message = mavlink.MAVLink_attitude_message(1, Meddler(7), 2, 3, 4, 5, 6)
    with pytest.raises(AttributeError, match="_header"):  # all fields were read before that
        message.pack(mavlink.MAVLink(None, 1, 1))


XML = """<mavlink><version>3</version><messages><message id="150" name="PROBE">
<field type="uint8_t" name="a">-</field><field type="char[4]" name="name">-</field>
</message></messages></mavlink>"""


def test_classes_of_a_dialect_that_was_let_go_are_collected():
    from mavwire import dialects

    module = dialects.load(XML, name="probe")
    mav = module.MAVLink(None)
    message = mav.parse_buffer(module.MAVLink_probe_message(1, b"ab").pack(mav))[0]
    assert (message.a, message.name) == (1, "ab")
    getter = vars(type(message))["a"]
    with pytest.raises(AttributeError):
        getter.__get__(object(), object)
    reference = weakref.ref(type(message))
    del sys.modules[module.__name__], module, mav, message, getter
    gc.collect()
    assert reference() is None


@pytest.mark.parametrize("arguments", [(1, b"text"), (1, b"text", 7), (1, b"text", 7, 8)])
def test_the_first_message_of_a_class_is_as_the_next_ones(arguments: tuple[object, ...]) -> None:
    """Its constructor is not compiled yet."""
    module = load("<mavlink><messages><message id='253' name='STATUSTEXT'><description/>"
                  "<field type='uint8_t' name='severity'/><field type='char[50]' name='text'/><extensions/>"
                  "<field type='uint16_t' name='id'/><field type='uint8_t[2]' name='part'/>"
                  "</message></messages></mavlink>", name="first")  # fmt: skip
    cls = module.MAVLink_statustext_message
    messages = [cls(*arguments) for _ in range(3)]
    assert len({str(message) for message in messages}) == 1
    assert len({repr(message.to_dict()) for message in messages}) == 1
    with pytest.raises(TypeError, match="takes from 3 to 5 positional arguments but 6"):
        cls(1, b"", 1, 1, 1)


@pytest.mark.parametrize("arguments", [(), (1,), (1, b"text", 7, (8, 8), 9)])
def test_a_first_message_with_wrong_arguments(arguments: tuple[object, ...]) -> None:
    module = load("<mavlink><messages><message id='1' name='A'><description/>"
                  "<field type='uint8_t' name='a'/><field type='char[5]' name='b'/><extensions/>"
                  "<field type='uint16_t' name='c'/></message></messages></mavlink>", name="wrong")  # fmt: skip
    texts = []
    for _ in range(2):
        with pytest.raises(TypeError) as raised:
            module.MAVLink_a_message(*arguments)
        texts.append(str(raised.value))
    assert texts[0] == texts[1]
    assert texts[0].startswith("MAVLink_a_message.__init__() ")


def test_an_array_of_one_element_is_an_array() -> None:
    """In pymavlink a decoded one is a number, which the message cannot be packed with again."""
    module = load("<mavlink><messages><message id='1' name='A'><description/><field type='uint8_t[1]' name='a'/>"
                  "<extensions/><field type='float[1]' name='b'/></message></messages></mavlink>", name="one")  # fmt: skip
    frame = module.MAVLink_a_message([7]).pack(module.MAVLink(None))
    decoded = module.MAVLink(None).decode(bytearray(frame))
    assert (decoded.a, decoded.b) == ([7], [0.0])
    assert decoded.pack(module.MAVLink(None)) == frame


# -- methods and constructors that are made when they are used


def fresh(name: str) -> Any:
    """A dialect whose classes nobody has used."""
    return load(DEFINITIONS / f"{name}.xml")


def test_a_class_of_two_dialects_has_the_methods_of_both() -> None:
    one, other = fresh("minimal"), fresh("common")

    class Both(one.MAVLink, other.MAVLink):  # type: ignore[misc, name-defined]
        pass

    assert Both(None).ping_encode(1, 2, 3, 4).get_type() == "PING"
    assert Both(None).heartbeat_encode(1, 2, 3, 4, 5).get_type() == "HEARTBEAT"


def test_methods_that_stand_in_the_class_s_dictionary() -> None:
    dialect = fresh("common")
    methods = dict(vars(dialect.MAVLink))
    assert all(callable(method) for name, method in methods.items() if name.endswith("_send"))
    assert methods["ping_encode"](dialect.MAVLink(None), 1, 2, 3, 4).seq == 2
    with mock.patch.object(dialect.MAVLink, "heartbeat_send", autospec=True) as replaced:
        dialect.MAVLink(None).heartbeat_send(1, 2, 3, 4, 5)
    assert replaced.called

    class Other:
        timesync = methods["timesync_encode"]

    assert Other().timesync(1, 2).ts1 == 2
    dialect.MAVLink.system_time_encode = replacement = lambda self: 7
    held = methods["system_time_encode"].__get__(dialect.MAVLink(None))
    assert held(1, 2).get_type() == "SYSTEM_TIME"
    assert dialect.MAVLink.system_time_encode is replacement


def test_a_constructor_that_was_replaced_stays() -> None:
    made = fresh("common").MAVLink_attitude_message
    before, calls = made.__init__, []

    def init(self: Any, *args: Any, **kwargs: Any) -> None:
        calls.append(1)
        before(self, *args, **kwargs)

    made.__init__ = init
    messages = [made(1, 2, 3, 4, 5, 6, 7) for _ in range(3)]
    messages.append(made(**dict(zip(made.fieldnames, range(1, 8), strict=True))))
    assert len(calls) == 4
    assert {str(message) for message in messages} == {str(messages[0])}
