"""What fgFDM does otherwise than pymavlink, on purpose."""

from __future__ import annotations

import pytest
from mavwire.fgFDM import fgFDM, fgFDMError


def test_a_packet_comes_back_as_it_was_sent() -> None:
    sent, received = fgFDM(), fgFDM()
    sent.set("latitude", -35.0, units="degrees")
    sent.set("rpm", 5000.0, idx=2)
    received.parse(sent.pack())
    assert received.get("latitude", units="degrees") == pytest.approx(-35.0)
    assert [received.get("rpm", i) for i in range(4)] == [0.0, 0.0, 5000.0, 0.0]


def test_numbers_of_things_may_be_floats() -> None:
    """pymavlink cannot pack them."""
    sent, received = fgFDM(), fgFDM()
    sent.set("num_engines", 2.0)
    received.parse(sent.pack())
    assert received.get("num_engines") == 2


def test_what_does_not_fit_is_an_error_of_the_module() -> None:
    packet = fgFDM()
    packet.set("num_engines", -1)
    with pytest.raises(fgFDMError, match="unable to pack"):
        packet.pack()


def test_an_index_below_0_is_no_index() -> None:
    """pymavlink takes the value of another variable."""
    with pytest.raises(fgFDMError, match="index of rpm"):
        fgFDM().get("rpm", -1)
    with pytest.raises(fgFDMError, match="index of rpm"):
        fgFDM().set("rpm", 1.0, -1)
