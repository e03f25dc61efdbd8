"""Failing methods beside Abbe's images: `python tools/stability.py`."""
