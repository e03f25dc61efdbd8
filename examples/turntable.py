"""Renders a turntable of 8 frames: python3 examples/turntable.py FOLDER [arguments of render]"""

import json
import os
import subprocess
import sys
from pathlib import Path

images = Path(sys.argv[1] if sys.argv[1:] else sys.exit(__doc__)) / "turntable.%04d.exr"
for frame in range(1, 9):
    command = [os.environ.get("RENDER", "render"), Path(__file__).with_name("turntable.toml"), "--json", *sys.argv[2:]]
    command += ["--exr", images, "--frame", str(frame), "--set", f"angle={45 * (frame - 1)}"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as run:
        for event in map(json.loads, run.stdout):
            if event["kind"] == "progress":
                print(f"frame {frame}: {event['done'] / event['total']:.0%}", end="\r")
            elif event["kind"] in ("written", "warning", "error"):
                print(f"frame {frame}: {event['kind']} {event.get('path') or event['message']}")
    if run.returncode:
        sys.exit(run.returncode)
