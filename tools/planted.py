"""Plants bugs and shows that each is detected: tools/planted/command.py."""

import sys

from planted.command import main

if __name__ == "__main__":
    sys.exit(main())
