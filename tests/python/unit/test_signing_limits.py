"""What does not fit a signature block is refused before anything is sent or counted."""

from __future__ import annotations

import io

import pytest
from mavwire.dialects.v20 import common as mavlink


@pytest.mark.parametrize(
    ("name", "value"), [("timestamp", 1 << 48), ("timestamp", -1), ("link_id", 256)]
)
def test_values_that_do_not_fit_are_refused(name: str, value: int) -> None:
    file = io.BytesIO()
    mav = mavlink.MAVLink(file, 1, 1)
    mav.signing.secret_key = b"k" * 32
    mav.signing.sign_outgoing = True
    mav.signing.timestamp = 1000
    mav.heartbeat_send(1, 2, 3, 4, 5)
    sent = file.getvalue()
    with pytest.raises(OverflowError):
        setattr(mav.signing, name, value)
        mav.heartbeat_send(1, 2, 3, 4, 5)
    assert file.getvalue() == sent
    assert (mav.seq, mav.total_packets_sent) == (1, 1)


def test_the_largest_timestamp_is_sent() -> None:
    file = io.BytesIO()
    mav = mavlink.MAVLink(file, 1, 1)
    mav.signing.secret_key = b"k" * 32
    mav.signing.sign_outgoing = True
    mav.signing.timestamp = (1 << 48) - 1
    mav.heartbeat_send(1, 2, 3, 4, 5)
    assert file.getvalue()[-12:-6] == b"\xff" * 6
