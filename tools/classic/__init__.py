"""An independent backward tracer without random numbers: `python tools/classic.py`."""
