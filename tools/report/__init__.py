"""One page of what the tools found: `python tools/report.py`."""
