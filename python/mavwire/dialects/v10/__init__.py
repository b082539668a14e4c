"""Dialects laid out for MAVLink 1."""
