"""Runs the command line as `python -m fric`, like `fric-cli`."""

import sys

from ._fric import _command_line


def main() -> int:
    """Runs the command line with the arguments of this process and returns its exit code."""
    return _command_line(["fric-cli", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
