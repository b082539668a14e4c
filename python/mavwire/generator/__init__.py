"""Definitions in, Python out: the part of mavwire that reads dialect XML for people who generate
modules.

Message objects never need this package: the native core reads definitions itself. It exists for
``mavgen`` and for the tools that look into definitions through ``mavparse.MAVXML``.
"""
