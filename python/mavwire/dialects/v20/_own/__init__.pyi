"""What each dialect itself defines. Written by tools/generate_stubs.py."""
