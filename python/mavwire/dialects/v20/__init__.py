"""Dialects laid out for MAVLink 2."""
