"""Images in parts: a job for a farm, a task for Slurm, and `python tools/farm.py` to choose their number."""
