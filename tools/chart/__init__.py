"""Error against processor time: `python tools/chart.py`."""
