"""Puts what the tools found into one page: tools/report/command.py."""

import sys

from report.command import main

if __name__ == "__main__":
    sys.exit(main())
