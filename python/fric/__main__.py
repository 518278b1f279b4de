"""`python -m fric` is the command line, as `fric-cli`."""

import sys

from ._fric import _command_line


def main() -> int:
    """Runs the command line on the arguments of this process and gives its exit code."""
    return _command_line(["fric-cli", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
