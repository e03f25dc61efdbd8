"""Puts the results of the tools into one self-contained HTML page: target/report/index.html.

    python tools/report.py                  # from what target/validate, target/chart and target/stability hold
    python tools/report.py --run            # runs the tools first: up to an hour
    python tools/report.py --run --quick    # runs them at a reduced size

Pictures are embedded in the page, and nothing is loaded from elsewhere. If a tool has not been run, its part is one
line with the command that makes it. Prints where the page is, and which parts are missing.
"""

import argparse
import datetime
import functools
import importlib.metadata
import json
import os
import platform
import string
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import render
from gallery import command as gallery

from . import parts

PAGE = Path(__file__).resolve().parent / "page"
TOOLS = {
    "validate": ("Validation", "The validation book has not been made"),
    "chart": ("Speed and accuracy", "The chart has not been drawn"),
    "stability": ("Stability", "The stability plots have not been drawn"),
}
FILES = {"validate": "validation.json", "chart": "chart.json", "stability": "stability.json"}


class Template(string.Template):
    """A template in which @@name@@ stands for a part."""

    pattern = r"@@(?:(?P<escaped>@@)|(?P<named>[a-z]+)@@|(?P<braced>(?!))|(?P<invalid>))"


def run_tools(quick: bool) -> list[str]:
    """Runs each tool, and returns those that failed."""
    failed = []
    for tool in TOOLS:
        command = [sys.executable, str(render.ROOT / f"tools/{tool}.py"), *(["--quick"] if quick else [])]
        print(f"$ python tools/{tool}.py{' --quick' if quick else ''}", flush=True)
        if subprocess.run(command, cwd=render.ROOT, check=False).returncode:
            failed.append(tool)
    return failed


@functools.cache
def plan(path: Path) -> list[str]:
    """Returns the words of the plan for a scene; none if there is no renderer, or a file of the scene is missing."""
    try:
        run = subprocess.run([render.binary(), "--plan", path], capture_output=True, text=True, check=False)
    except SystemExit:
        return []
    return run.stdout.strip().splitlines() if run.returncode == 0 else []


def find_scenes() -> list[dict]:
    """Returns all scenes of the gallery with picture, first line, command, time and plan."""
    measured = json.loads(gallery.MEASURED.read_text("utf-8")) if gallery.MEASURED.is_file() else {}
    names, found = gallery.scenes(), []
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        plans = list(pool.map(plan, [gallery.SCENES / f"{name}.toml" for name in names]))
    for name, words in zip(names, plans, strict=True):
        picture = gallery.SCENES / f"pictures/{Path(name).name}.png"
        figures = measured.get(name, {})
        found.append(
            {
                "name": name,
                "line": gallery.first_line(name),
                "picture": picture if picture.is_file() else None,
                "command": f"render --exr scenes/{name}.toml",
                "seconds": figures.get("seconds"),
                "plan": words or [figures[key] for key in ("plan",) if key in figures],
            }
        )
    return found


def read_result(folder: Path, tool: str) -> dict | None:
    """Returns the result of a tool, or None."""
    path = folder / tool / FILES[tool]
    if not path.is_file():
        return None
    try:
        return json.loads(path.read_text("utf-8"))
    except json.JSONDecodeError as mistake:
        raise SystemExit(f"{path} is not JSON ({mistake}): run `python tools/{tool}.py` again") from None


def made(folder: Path, tool: str, result: dict | None) -> tuple[str, str, str]:
    """Returns part, command and time of a tool's result."""
    title = TOOLS[tool][0]
    if result is None:
        return title, f"python tools/{tool}.py", "not yet"
    when = datetime.datetime.fromtimestamp((folder / tool / FILES[tool]).stat().st_mtime)
    return title, result.get("made_by") or f"python tools/{tool}.py", f"{when:%Y-%m-%d %H:%M}"


def output(command: list) -> str:
    """Returns the first line that a command prints, or an empty text."""
    try:
        run = subprocess.run(command, cwd=render.ROOT, capture_output=True, text=True, check=False)
    except (OSError, SystemExit):
        return ""
    return (run.stdout.splitlines() or [""])[0] if run.returncode == 0 else ""


def versions(results: dict) -> dict:
    """Returns the versions of the renderer, of the packages and renderers that the tools used, and of the machine."""
    found = {}
    try:
        found["Abbe"] = output([render.binary(), "--version"])
    except SystemExit:
        pass
    found["commit"] = output(["git", "rev-parse", "--short", "HEAD"])
    for package in ("numpy", "OpenEXR", "colour-science"):
        found[package] = importlib.metadata.version(package)
    found["Python"] = platform.python_version()
    found["machine"] = f"{platform.system()}, {platform.machine()}"
    for name, value in ((results["chart"] or {}).get("versions") or {}).items():
        found[f"charted: {name}"] = value
    return {name: value for name, value in found.items() if value}


def facts(scenes: list, results: dict) -> str:
    """Returns the page's summary: one line of numbers."""
    told = [f"<b>{len(scenes)}</b> scenes"]
    if book := results["validate"]:
        good = sum(map(parts.passes, book["rows"]))
        told.append(f"<b>{good} of {len(book['rows'])}</b> validation rows pass")
    if book := results["stability"]:
        told.append(f"<b>{len(book['plots'])}</b> stability plots")
        if book.get("rows"):
            told.append(f"<b>{len(book['rows'])}</b> rows of the stability catalog")
    return " · ".join(told)


def page(scenes: list, results: dict, folder: Path) -> str:
    """Returns the text of the whole page."""
    charts = {}
    if results["chart"]:
        charts |= {f"chart {scene['name']}": parts.speed_chart(scene) for scene in results["chart"]["scenes"]}
    if results["stability"]:
        plots = results["stability"]["plots"]
        charts |= {f"stability {plot['row']}": parts.stability_chart(plot, folder / "stability") for plot in plots}
    sections = {
        "validate": lambda: parts.validation(results["validate"]),
        "chart": lambda: parts.speed(results["chart"]["scenes"], charts),
        "stability": lambda: parts.stability(results["stability"], charts),
    }
    told = {
        tool: sections[tool]() if results[tool] else parts.missing(TOOLS[tool][1], f"python tools/{tool}.py")
        for tool in TOOLS
    }
    pictures = ("Pictures of the scenes", "python tools/gallery.py render", "kept in the repository")
    return Template((PAGE / "page.html").read_text("utf-8")).substitute(
        css=(PAGE / "page.css").read_text("utf-8"),
        script=(PAGE / "page.js").read_text("utf-8"),
        data=json.dumps(charts, allow_nan=False).replace("</", "<\\/"),
        facts=facts(scenes, results),
        scenes=parts.scenes(scenes),
        chart=told["chart"],
        validation=told["validate"],
        stability=told["stability"],
        making=parts.making(
            [
                pictures,
                *(made(folder, tool, results[tool]) for tool in TOOLS),
                ("This page", "python tools/report.py", f"{datetime.datetime.now():%Y-%m-%d %H:%M}"),
            ],
            versions(results),
        ),
    )


def write(folder: Path, out: Path) -> list[str]:
    """Writes the page from the results in `folder`, and returns the tools whose parts are missing."""
    results = {tool: read_result(folder, tool) for tool in TOOLS}
    out.parent.mkdir(parents=True, exist_ok=True)
    out.write_text(page(find_scenes(), results, folder), "utf-8")
    return [tool for tool, result in results.items() if result is None]


def main(arguments=None) -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--run", action="store_true", help="run validate, chart and stability first")
    parser.add_argument("--quick", action="store_true", help="run them at a reduced size")
    parser.add_argument(
        "--results", type=Path, default=render.ROOT / "target", help="folder that holds the tools' folders"
    )
    parser.add_argument("--out", type=Path, default=render.ROOT / "target/report/index.html", help="the page")
    given = parser.parse_args(arguments)
    failed = run_tools(given.quick) if given.run or given.quick else []
    absent = write(given.results, given.out)
    print(f"wrote {given.out} ({given.out.stat().st_size / 1e6:.1f} MB)")
    for tool in failed:
        print(f"failed: python tools/{tool}.py")
    for tool in absent:
        print(f"missing: {TOOLS[tool][1].lower()}: python tools/{tool}.py")
    return 1 if failed else 0
