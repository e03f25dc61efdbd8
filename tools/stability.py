"""Draws where methods fail: tools/stability/command.py."""

import sys

from stability.command import main

if __name__ == "__main__":
    sys.exit(main())
