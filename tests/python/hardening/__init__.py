"""The hardening table: what hostile input and faults do to mavwire, and to pymavlink beside it.

`make hardening` prints it. Each figure is measured in a process of its own, over frames that
`encoder` makes; a figure is a function of the package's name and of whether the short form is
wanted, and gives an answer for each of its rows.
"""
