"""The file transfer protocol, client side; `mavwire.mavftp` offers it under pymavlink's names.

The other end is not trusted: what it answers ends in no path, no unbounded memory and no endless loop.
"""

from __future__ import annotations

import logging

log = logging.getLogger("mavwire.mavftp")
