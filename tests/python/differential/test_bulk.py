"""Every message of `all` with random values, both wire versions, crossed; FRAMES says how many
frames in all.
"""

from __future__ import annotations

import os

import pytest
from differential.bulk import SETTINGS, Setting, Share, compare_share

FRAMES = int(os.environ.get("FRAMES", "210000"))
SHARE = 10_000


@pytest.mark.timeout(0)
@pytest.mark.parametrize("setting", SETTINGS, ids=str)
def test_frames(setting: Setting, subject: str, oracle: str) -> None:
    wanted = FRAMES // len(SETTINGS)
    compared = 0
    while compared < wanted:
        share = Share(setting, 1000 + compared, min(SHARE, wanted - compared), subject, oracle)
        compared += compare_share(share)
    print(f"{compared:,} frames compared")
    assert compared == wanted > 0
