"""``python -m mavwire`` is the ``mavwire`` command."""

import sys

from mavwire.cli import main

if __name__ == "__main__":
    sys.exit(main())
