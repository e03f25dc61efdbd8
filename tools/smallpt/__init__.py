"""The 99-line program and what Abbe makes of its scene: `python tools/smallpt_reference.py`."""
