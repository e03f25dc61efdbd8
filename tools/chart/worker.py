"""Runs one renderer that is a Python module, in a process of its own: tools/chart/renderers.py starts it.

    python -m chart.worker mitsuba llvm_ad_rgb scene.toml     # then lines `SAMPLES SEED OUT.npy` on its input

Answers each line with the processor seconds that rendering took, user and system, of all threads; loading the scene
does not count. The renderer's own output goes to standard error. The renderers' packages contain libraries that cannot
share a process, so each gets its own.
"""

import importlib
import os
import resource
import sys
from pathlib import Path

import numpy as np


def seconds_used() -> float:
    usage = resource.getrusage(resource.RUSAGE_SELF)
    return usage.ru_utime + usage.ru_stime


def main() -> None:
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    module, variant, scene, *flags = sys.argv[1:]
    renderer = importlib.import_module(f"peers.{module}").Renderer(variant, Path(scene), "flat-lamp" in flags)
    print("ready", file=answers, flush=True)
    for line in sys.stdin:
        samples, seed, out = line.rstrip("\n").split(" ", 2)
        before = seconds_used()
        picture = renderer.picture(int(samples), int(seed))
        seconds = seconds_used() - before
        np.save(out, picture)
        print(seconds, file=answers, flush=True)


if __name__ == "__main__":
    main()
