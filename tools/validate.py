"""Compares the renderer with closed forms: tools/validation/command.py."""

import sys

from validation.command import main

if __name__ == "__main__":
    sys.exit(main())
