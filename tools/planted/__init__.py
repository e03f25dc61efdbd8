"""Classic bugs, planted one at a time: `python tools/planted.py`."""
