"""What dialect paparazzi itself defines. Written by tools/generate_stubs.py."""


class _Methods:
    pass
