"""Draws where methods fail: the failing method beside Abbe, as a scene gets harder.

    python tools/stability.py               # all rows, two minutes: target/stability/*.svg, *.csv, stability.json
    python tools/stability.py --quick       # fewer points and samples: about 20 seconds
    python tools/stability.py --row S1      # one row
    python tools/stability.py --list        # which rows there are

The failing methods are small numpy programs in f32 and f64, after the sources named beside them, or closed forms where
a label says so. "Abbe, rendered" is measured on images: a scene is written, rendered by `render`, and its EXR is read.
Prints a sentence with its numbers for each row.
"""

import argparse
import json
import time
from pathlib import Path

import render

from . import geometry, lights, optics, transport
from .plot import Plot, draw, write_csv

TABLE = render.ROOT / "tests/STABILITY.md"
ROWS = {
    "S1": geometry.s1,
    "S6": geometry.s6,
    "T1": geometry.t1,
    "D5": optics.d5,
    "D13": optics.d13,
    "M3": optics.m3,
    "W2": transport.w2,
    "W4": transport.w4,
    "W6": transport.w6,
    "A1": transport.a1,
    "A6": lights.a6,
    "L1": lights.l1,
    "L3": lights.l3,
    "L4": lights.l4,
    "G4": optics.g4,
    "G6": optics.g6,
}


def catalog(text: str) -> list[dict]:
    """Returns the rows of a Markdown table `| row | what fails | what Abbe does | test |`, and ignores all other lines.

    Each of several tests of a row is on a line of its own."""
    rows = []
    for line in text.splitlines():
        cells = [cell.strip().replace("\\|", "|") for cell in line.strip().strip("|").replace("\\|", "\0").split("|")]
        cells = [cell.replace("\0", "|") for cell in cells]
        if (
            not line.lstrip().startswith("|")
            or len(cells) != 4
            or cells[0] in ("row", "")
            or set(cells[0]) <= set("-: ")
        ):
            continue
        row, name, remedy, test = cells
        rows.append({"row": row, "name": name, "remedy": remedy, "test": test.replace("`", "").replace("<br>", "\n")})
    return rows


def keep(plot: Plot, folder: Path) -> dict:
    """Writes a plot's SVG and CSV and returns its entry in stability.json."""
    names = {"svg": f"{plot.row}.svg", "csv": f"{plot.row}.csv"}
    draw(plot, folder / names["svg"])
    write_csv(plot, folder / names["csv"])
    axes = {"xlabel": plot.xlabel, "ylabel": plot.ylabel, "linear": plot.linear, "least": plot.least}
    return {"row": plot.row, "title": plot.title, "words": plot.words, "source": plot.source, **names, **axes}


def merge(folder: Path, entries: list[dict], made_by: str) -> None:
    """Writes stability.json: new entries replace old ones of the same rows, in the order of ROWS."""
    path = folder / "stability.json"
    old = json.loads(path.read_text("utf-8"))["plots"] if path.is_file() else []
    plots = {entry["row"]: entry for entry in [*old, *entries] if entry["row"] in ROWS}
    version = render.said("--version").strip()
    rows = catalog(TABLE.read_text("utf-8")) if TABLE.is_file() else []
    book = {"version": version, "made_by": made_by, "plots": [plots[row] for row in ROWS if row in plots], "rows": rows}
    path.write_text(json.dumps(book, indent=1) + "\n", "utf-8")


def main(arguments=None) -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--row", action="append", choices=ROWS, metavar="ROW", help="this row alone; may be repeated")
    parser.add_argument("--quick", action="store_true", help="fewer points and samples")
    parser.add_argument("--list", action="store_true", help="say which rows there are and draw nothing")
    parser.add_argument(
        "--out", type=Path, default=render.ROOT / "target/stability", help="folder for SVG, CSV and JSON"
    )
    given = parser.parse_args(arguments)
    if given.list:
        for row, function in ROWS.items():
            print(f"{row:4} {function.__doc__.splitlines()[0]}")
        return
    given.out.mkdir(parents=True, exist_ok=True)
    entries = []
    for row in given.row or ROWS:
        start = time.monotonic()
        plot = ROWS[row](given.quick)
        entries.append(keep(plot, given.out))
        print(f"{row}  {plot.title} ({time.monotonic() - start:.1f} s)\n    {plot.words}", flush=True)
    words = [
        "python tools/stability.py",
        *(f"--row {row}" for row in given.row or []),
        *(["--quick"] if given.quick else []),
    ]
    merge(given.out, entries, " ".join(words))
    print(f"wrote {len(entries)} plots and stability.json into {given.out}")
