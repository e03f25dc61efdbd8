"""The validation book: renders scenes whose answer is known and judges the EXR files against closed formulas.

    python tools/validate.py                              # the whole book
    python tools/validate.py --quick                      # the same rows, smaller pictures and fewer samples
    python tools/validate.py --group optics               # one group of it
    python tools/validate.py --list                       # every row and its formula
    python tools/validate.py --row prism-N-BK7-rgb        # the rows whose name has these words
    python tools/validate.py --row NAME --scene           # that row's scene in words and as TOML
    python tools/validate.py --row NAME other.exr         # judges another renderer's picture of that scene
    python tools/validate.py --with-mitsuba               # the scenes that Mitsuba 3 can render as well, pixel by pixel

Prints expected and measured value, standard error and z of each row, and writes these and what each row guards against
to target/validate/validation.json. A row passes if no value is off by more than 4 standard errors, and if its standard
error is at most a quarter of what the mistake would change. Exit code 1 if a row fails.
"""

import argparse
import json
import math
import os
import re
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import render

from . import book
from .row import LIMIT, judge, numbers, unmeasured
from .scenes import toml_file

OUT = render.ROOT / "target/validate"


def key(row):
    """Returns a row's name as one word."""
    return re.sub(r"[^A-Za-z0-9.+]+", "-", f"{row.name}").strip("-")


def images(row, folder):
    """Yields the images of a row's scene, one for each seed."""
    book.write_assets(folder)
    scene = folder / f"{key(row)}.toml"
    scene.write_text(toml_file(row.scene), "utf-8")
    for seed in range(1, row.seeds + 1):
        exr = folder / f"{key(row)}-{seed}.exr"
        render.write(scene, exr, seed=seed)
        yield render.read(exr)


def measure(row, folder):
    try:
        return judge(row, list(images(row, folder)))
    except (ValueError, RuntimeError) as error:
        return unmeasured(row, str(error))


def show(judged):
    """Prints one line for a row: its value, or the one of many that is off the most."""
    worst = abs(judged.z).argmax()
    figures = [array[worst] for array in (judged.expected, judged.measured, judged.standard_error, judged.z)]
    expected, measured, error, z = figures
    verdict = "ok" if judged.passes else "FAIL"
    print(
        f"{judged.row.group:9} {judged.row.name[:72]:72} {expected:12.6g} {measured:12.6g} {error:8.1e} {z:6.2f}  "
        f"{verdict}"
    )
    for reason in judged.reasons:
        print(f"          {judged.row.name}: {reason}")


def finite(value):
    """Returns a finite number, or None, because JSON has no others."""
    return float(value) if math.isfinite(value) else None


def entry(judged):
    """Returns the row in the form of validation.json."""
    row = judged.row
    listed = [judged.expected, judged.measured, judged.standard_error, judged.z, judged.effect]
    expected, measured, error, z, effect = ([finite(x) for x in values] for values in listed)
    return {
        "group": row.group,
        "name": row.name,
        "formula": row.formula,
        "expected": expected,
        "measured": measured,
        "standard_error": error,
        "z": z,
        "guards_against": row.guards_against,
        "effect": effect,
        "verdict": "pass" if judged.passes else "fail: " + "; ".join(judged.reasons),
    }


def write_json(results, path):
    command = (
        " ".join(["python tools/validate.py", *sys.argv[1:]]) if "validate" in sys.argv[0] else "tools/validate.py"
    )
    content = {"version": render.said("--version").strip(), "made_by": command, "rows": [entry(judged) for judged in results]}
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(content, indent=1) + "\n")


def run(rows, out):
    """Judges the rows and returns the results in their order."""
    print(
        f"{'group':9} {'row':72} {'expected':>12} {'measured':>12} {'error':>8} {'z':>6}  verdict (|z| at most "
        f"{LIMIT:g})"
    )
    results = []
    # Most pictures are small, so several rows run at once to keep all processors busy.
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(os.cpu_count()) as pool:
        for judged in pool.map(measure, rows, [Path(folder) / key(row) for row in rows]):
            results.append(judged)
            show(judged)
            sys.stdout.flush()
    write_json(results, out / "validation.json")
    return results


def summary(results):
    failed = [judged.row.name for judged in results if not judged.passes]
    values = sum(len(judged.z) for judged in results)
    print(f"{len(results) - len(failed)} of {len(results)} rows ({values} values) pass", *failed, sep="\n  FAILED: ")
    return int(bool(failed))


def chosen(rows, words):
    """Returns the row of that name, or all rows whose name contains the words."""
    exact = [row for row in rows if words in (key(row), row.name)]
    found = exact or [row for row in rows if words.lower() in key(row).lower() or words.lower() in row.name.lower()]
    if not found:
        raise SystemExit(f"no row is called {words}; --list names them all")
    return found


def describe(row, folder):
    """Prints everything that a user of another renderer needs to render the row's scene."""
    print(f"# {row.name}: {row.words}")
    print(f"# expected {numbers(row.expected)} by {row.formula}; guards against {row.guards_against}")
    print(toml_file(row.scene), end="")
    if "bench.exr" in toml_file(row.scene):
        book.write_assets(folder)
        print(f"# bench.exr, two pixels of 0.1 and 0.9 between which a screen rises linearly, is in {folder}")


def parser():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("exr", nargs="?", type=Path, help="another renderer's picture, judged as the row's")
    parser.add_argument("--quick", action="store_true", help="smaller pictures and fewer samples")
    parser.add_argument("--group", choices=book.GROUPS, help="the rows of one group")
    parser.add_argument("--row", metavar="NAME", help="the rows whose name is NAME, or else has NAME in it")
    parser.add_argument("--list", action="store_true", help="name every row, render nothing")
    parser.add_argument("--scene", action="store_true", help="with --row: print the scene, render nothing")
    parser.add_argument("--keep", type=Path, metavar="FOLDER", help="with --row: leave scene and images there")
    parser.add_argument("--with-mitsuba", action="store_true", help="compare with Mitsuba 3, which must be installed")
    parser.add_argument("--out", type=Path, default=OUT, help="folder for validation.json")
    return parser


def main(words=None):
    arguments = parser().parse_args(words)
    if arguments.with_mitsuba:
        from . import mitsuba_rows

        return mitsuba_rows.main(arguments.quick)
    rows = book.rows(arguments.quick, arguments.group)
    if arguments.row:
        rows = chosen(rows, arguments.row)
    if arguments.list:
        for row in rows:
            print(f"{row.group:9} {key(row):72} {row.formula}")
        print(f"{len(rows)} rows")
        return 0
    if (arguments.scene or arguments.exr) and (not arguments.row or len(rows) > 1):
        names = [key(row) for row in rows[:8]]
        raise SystemExit(f"one row is needed, --row {arguments.row or 'NAME'} means {len(rows)}: {', '.join(names)} ..")
    if arguments.scene:
        describe(rows[0], arguments.out)
        return 0
    if arguments.exr:
        return foreign(rows[0], arguments.exr)
    if arguments.keep:
        arguments.keep.mkdir(parents=True, exist_ok=True)
        for row in rows:
            show(measure(row, arguments.keep))
            print(f"          {arguments.keep / key(row)}.toml")
        return 0
    return summary(run(rows, arguments.out))


def foreign(row, exr):
    """Judges a picture from another renderer."""
    if not exr.is_file():
        raise SystemExit(f"{exr} does not exist")
    try:
        judged = judge(row, [render.read(exr)])
    except (ValueError, KeyError, RuntimeError) as error:
        raise SystemExit(f"{exr} cannot be judged as {row.name}: {error}") from error
    show(judged)
    if judged.estimates == 1:
        print("          this row reads single pixels: noise of the file, which it cannot know, counts as an error")
    return int(not judged.passes)
