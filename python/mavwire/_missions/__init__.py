"""Missions, fences and rally points on the ground: lists of them and the files they are kept in.

`mavwire.mavwp` offers all of it under pymavlink's names.
"""
