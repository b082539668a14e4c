"""`mavwire dump` under the name of pymavlink's script, mavlogdump.py."""

from __future__ import annotations

if __name__ == "__main__":
    from mavwire.tools._script import run

    run(__file__)
