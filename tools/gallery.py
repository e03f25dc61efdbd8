"""Makes and renders the gallery: tools/gallery/command.py."""

import sys

from gallery.command import main

if __name__ == "__main__":
    sys.exit(main())
