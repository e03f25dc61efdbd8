"""All tools have a help, and do nothing else when asked for it.

pytest tools/tests/test_commands.py
"""

import subprocess
import sys

import pytest
import render

MODULES = {"render.py"}  # shared by the others; not a command
COMMANDS = sorted(path.name for path in (render.ROOT / "tools").glob("*.py") if path.name not in MODULES)


@pytest.mark.parametrize("name", COMMANDS)
def test_each_command_says_how_it_is_used(name, tmp_path):
    command = [sys.executable, render.ROOT / "tools" / name, "--help"]
    done = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path, timeout=120)
    assert done.returncode == 0 and done.stdout.startswith(f"usage: {name} [-h]"), done.stdout + done.stderr
    assert not list(tmp_path.iterdir())
