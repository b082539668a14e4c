"""pymavlink's command-line tools, as subcommands of `mavwire`.

A module has the name of pymavlink's script, and is that script when it is run (`python -m
mavwire.tools.mavparms`); `mavwire.cli.COMMANDS` tells its verb. Each prints what the script prints,
for the same options; docs/tools.md says what differs.
"""
