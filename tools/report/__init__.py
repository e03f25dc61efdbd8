"""One page with the results of the tools: `python tools/report.py`."""
