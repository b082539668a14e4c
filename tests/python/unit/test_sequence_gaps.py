"""What `mavwire loss` counts: messages and the gaps before them."""

from __future__ import annotations

import pytest
from mavwire._native import SequenceGaps
from mavwire.dialects.v20 import ardupilotmega as apm


def received(*numbers: int, compid: int = 1, text: bool = False) -> list[object]:
    """Messages with these sequence numbers, off the wire."""
    sender = apm.MAVLink(None, 7, compid)
    receiver = apm.MAVLink(None)
    messages = []
    for seq in numbers:
        sender.seq = seq
        msg = (
            apm.MAVLink_statustext_message(6, b"x")
            if text
            else apm.MAVLink_system_time_message(1, 2)
        )
        messages += receiver.parse_buffer(msg.pack(sender))
    return messages


def test_gaps_count_for_the_type_behind_them() -> None:
    gaps = SequenceGaps(True)
    assert gaps.read(received(254, 255, 0, 3)) == []
    gaps.read(received(4, 9, text=True))
    gaps.read(received(8, 9, compid=2))
    assert gaps.rows() == [
        (7, 1, "SYSTEM_TIME", 4, 1, 2, 4),
        (7, 1, "STATUSTEXT", 2, 1, 4, 6),
        (7, 2, "SYSTEM_TIME", 2, 0, 0, 0),
    ]


def test_types_need_not_be_kept_apart() -> None:
    gaps = SequenceGaps(False)
    gaps.read([*received(1, 2), *received(5, text=True), *received(1, compid=2)])
    assert gaps.rows() == [(7, 1, None, 3, 1, 2, 3), (7, 2, None, 1, 0, 0, 0)]


def test_a_message_that_comes_again_counts_as_pymavlink_counts_it() -> None:
    gaps = SequenceGaps(True)
    gaps.read(received(5, 5))
    assert gaps.rows() == [(7, 1, "SYSTEM_TIME", 2, 1, 255, 2)]


def test_what_is_no_message_is_given_back() -> None:
    bad = apm.MAVLink_bad_data(b"x", "no reason")
    built = apm.MAVLink_system_time_message(1, 2)
    gaps = SequenceGaps(True)
    assert gaps.read([bad, *received(1), built, 5]) == [bad, built, 5]
    assert [row[3] for row in gaps.rows()] == [1]


def test_what_the_messages_raise_passes_through() -> None:
    def messages() -> object:
        yield from received(1, 2)
        raise KeyError("from within")

    gaps = SequenceGaps(True)
    with pytest.raises(KeyError, match="from within"):
        gaps.read(messages())  # type: ignore[arg-type]
    assert [row[3] for row in gaps.rows()] == [2]
