"""Renders a scene with an independent program, and compares: tools/classic/command.py."""

import sys

from classic.command import main

if __name__ == "__main__":
    sys.exit(main())
