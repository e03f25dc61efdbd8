"""Compares Abbe with the 99-line program: tools/smallpt/reference.py."""

import sys

from smallpt.reference import main

if __name__ == "__main__":
    sys.exit(main())
