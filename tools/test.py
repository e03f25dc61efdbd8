"""The test command: installs what the tests need and runs all of them, Rust and Python, until the first failure.

    python3 tools/test.py                # everything
    python3 tools/test.py --only pytest  # one step

Needs cargo and Python 3.11 or newer. The Python packages are installed into .venv, by the hashes of
tools/requirements.txt, and so is the Chromium that opens the report.
"""

import argparse
import hashlib
import importlib.util
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
REQUIREMENTS = ROOT / "tools/requirements.txt"
ENVIRONMENT = ROOT / ".venv"
PYTHON = ENVIRONMENT / "bin/python"
# Everything is tested in a profile with overflow and debug checks; its pictures are identical to those of a release.
RENDER = ROOT / "target/debug/render"
WHEELS = ROOT / "target/wheels"


class Failure(Exception):
    """Says what went wrong, in words for the person at the terminal."""


def run(*command, **environment):
    print("$ " + " ".join(map(str, command)), flush=True)
    try:
        code = subprocess.run(list(map(str, command)), cwd=ROOT, env={**os.environ, **environment}).returncode
    except FileNotFoundError:
        raise Failure(f"{command[0]} is not installed") from None
    if code:
        raise Failure(f"exit code {code}: {' '.join(map(str, command))}")


def create_environment():
    if sys.version_info < (3, 11):
        raise Failure(f"the Python tools need Python 3.11 or newer, this is {sys.version.split()[0]}")
    if importlib.util.find_spec("ensurepip") is None:
        raise Failure("Python has no ensurepip to make .venv with: install the package python3-venv (Debian, Ubuntu)")
    run(sys.executable, "-m", "venv", "--clear", ENVIRONMENT)


def packages():
    """Installs the locked packages, unless the environment's stamp shows that it already has them."""
    stamp = ENVIRONMENT / "requirements.sha256"
    wanted = hashlib.sha256(REQUIREMENTS.read_bytes()).hexdigest()
    if stamp.is_file() and stamp.read_text() == wanted and PYTHON.exists():
        print("already installed", flush=True)
        return
    create_environment()
    run(PYTHON, "-m", "pip", "install", "--quiet", "--require-hashes", "-r", REQUIREMENTS)
    stamp.write_text(wanted)


def packages_and_browser():
    """Installs packages and browser. If no browser can be installed, the tests that need it are skipped and say why."""
    packages()
    run(PYTHON, "tools/browser.py")


def wheel():
    """Builds the package for Python, in the profile of the tests, and installs it into the environment."""
    shutil.rmtree(WHEELS, ignore_errors=True)
    run(PYTHON, "-m", "maturin", "build", "--profile", "dev", "--out", WHEELS)
    run(PYTHON, "-m", "pip", "install", "--quiet", "--no-index", "--no-deps", "--force-reinstall", *WHEELS.glob("*.whl"))


# All commands use the whole workspace, so that the wheel reuses the library that the tests have built.
STEPS = {
    "format": lambda: run("cargo", "fmt", "--all", "--check"),
    "clippy": lambda: run("cargo", "clippy", "--workspace", "--all-targets", "--", "-D", "warnings"),
    "doc": lambda: run("cargo", "doc", "--no-deps", RUSTDOCFLAGS="-D warnings"),
    "build": lambda: run("cargo", "test", "--workspace", "--no-run"),
    "test": lambda: run("cargo", "test", "--workspace"),
    "packages": packages_and_browser,
    "wheel": wheel,
    # Two files at a time, because half of them keep only one processor busy.
    "pytest": lambda: run(
        PYTHON, "-m", "pytest", "tools/tests", "-n", "2", "--dist", "loadfile", "--no-loadscope-reorder",
        RENDER=str(RENDER),
    ),
}


def main():
    parser = argparse.ArgumentParser(description="Runs every test of the project.")
    parser.add_argument("--only", choices=STEPS, help="run this step alone")
    only = parser.parse_args().only
    if only:
        run_steps({only: STEPS[only]})
        return
    # The packages are downloaded while cargo keeps the processors busy.
    with subprocess.Popen(
        [sys.executable, __file__, "--only", "packages"], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    ) as installing:
        try:
            times = run_steps({**STEPS, "packages": lambda: finish(installing)})
        finally:
            installing.terminate()
    print("\nall passed: " + ", ".join(f"{name} {seconds:.0f} s" for name, seconds in times.items()))


def finish(installing):
    """Waits for the installation that began before the other steps, and prints its output."""
    print(installing.communicate()[0], flush=True)
    if installing.returncode:
        raise Failure("the Python packages could not be installed")


def run_steps(steps):
    times = {}
    for name, step in steps.items():
        print(f"\n== {name}", flush=True)
        start = time.monotonic()
        try:
            step()
        except Failure as failure:
            sys.exit(f"\nFAILED at {name}: {failure}")
        times[name] = time.monotonic() - start
        print(f"== {name} passed in {times[name]:.1f} s", flush=True)
    return times


if __name__ == "__main__":
    main()
