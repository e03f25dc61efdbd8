"""Optical data of the catalog: `python tools/tabulate.py`."""
