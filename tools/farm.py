"""Forecasts how many parts of an image make sense on a farm: tools/farm/command.py."""

import sys

from farm.command import main

if __name__ == "__main__":
    sys.exit(main())
