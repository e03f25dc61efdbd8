"""Writes the optical tables: tools/tabulate/command.py."""

import sys

from tabulate.command import main

if __name__ == "__main__":
    sys.exit(main())
