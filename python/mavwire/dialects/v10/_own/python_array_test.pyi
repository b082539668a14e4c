"""What dialect python_array_test itself defines. Written by tools/generate_stubs.py."""


class _Methods:
    pass
