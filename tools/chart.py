"""Charts speed against accuracy: tools/chart/command.py."""

import sys

from chart.command import main

if __name__ == "__main__":
    sys.exit(main())
