"""Installs a headless Chromium for the report's tests: tools/browser/command.py."""

import sys

from browser.command import main

if __name__ == "__main__":
    sys.exit(main())
