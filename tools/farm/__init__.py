"""Images in parts: a job for a farm, a task for Slurm, and `python tools/farm.py`, which says how many parts make
sense.
"""
