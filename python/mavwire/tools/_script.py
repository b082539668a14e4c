"""A command under the name of pymavlink's script, by which it is run."""

if __name__ == "__main__":
    import sys

    from mavwire.cli import COMMANDS, main

    script = __spec__.name.rpartition(".")[2]
    name = next(name for name, (_, other, _) in COMMANDS.items() if other == script)
    sys.exit(main([name, *sys.argv[1:]]))
