"""The 99-line program smallpt, compared with Abbe in its scene: `python tools/smallpt_reference.py`."""
