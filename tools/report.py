"""Puts the results of the tools into one page: tools/report/command.py."""

import sys

from report.command import main

if __name__ == "__main__":
    sys.exit(main())
