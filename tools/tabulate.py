"""Writes the optical tables src/spectrum/data/glasses.rs and metals.rs from the refractiveindex.info database.

    pip install --require-hashes -r tools/tabulate-requirements.txt
    python tools/tabulate.py            # write the tables, print the indices of every glass
    python tools/tabulate.py --check    # compare with the committed tables; exit 1 on a difference

The database (CC0) is part of the package `refractiveindex`: nothing is downloaded. Needs rustfmt on the path.
To add a material, add its line to GLASSES or METALS.
"""

import argparse
import json
import re
import subprocess
import sys
from decimal import Decimal
from pathlib import Path
from typing import NamedTuple

import refractiveindex
import yaml

ROOT = Path(__file__).resolve().parent.parent
TABLES = ROOT / "src/spectrum/data"
DATABASE = Path(refractiveindex.__file__).parent / "database/data"

# Fraunhofer lines in nm, as glass catalogs use them for n_F, n_d, n_C.
LINES_NM = (486.1327, 587.5618, 656.2725)
METAL_RANGE_NM = (Decimal(340), Decimal(850))


class Entry(NamedTuple):
    """A material: its name in scenes, its page in the database, who measured it, other names."""

    name: str
    page: str
    source: str
    aliases: tuple[str, ...] = ()


def schott(name):
    return Entry(name, f"specs/schott/optical/{name}", "SCHOTT Zemax catalog 2017-01-20b")


NOBLE_METALS = "Johnson and Christy, Phys. Rev. B 6, 4370 (1972)"
TRANSITION_METALS = "Johnson and Christy, Phys. Rev. B 9, 5056 (1974)"

GLASSES = [
    schott("F2"),
    schott("N-BAF10"),
    schott("N-BK7"),
    schott("N-F2"),
    schott("N-K5"),
    schott("N-LAK22"),
    schott("N-LASF9"),
    schott("N-SF10"),
    schott("N-SF11"),
    schott("N-SF6"),
    schott("SF10"),
    Entry("CaF2", "main/CaF2/nk/Daimon-20", "Daimon and Masumura, Appl. Opt. 41, 5275 (2002), 20 °C", ("fluorite",)),
    Entry("diamond", "main/C/nk/Peter", "Peter, Zeitschrift für Physik 15, 358 (1923)"),
    Entry("fused silica", "main/SiO2/nk/Malitson", "Malitson, J. Opt. Soc. Am. 55, 1205 (1965)", ("silica", "SiO2")),
    Entry("sapphire", "main/Al2O3/nk/Malitson-o", "Dodge, Handbook of Laser Science IV (1986), ordinary ray"),
    Entry("water", "main/H2O/nk/Daimon-20.0C", "Daimon and Masumura, Appl. Opt. 46, 3811 (2007), 20 °C", ("H2O",)),
]

METALS = [
    Entry("Ag", "main/Ag/nk/Johnson", NOBLE_METALS, ("silver",)),
    Entry("Al", "main/Al/nk/Rakic", "Rakić, Appl. Opt. 34, 4755 (1995)", ("aluminum",)),
    Entry("Au", "main/Au/nk/Johnson", NOBLE_METALS, ("gold",)),
    Entry("Cr", "main/Cr/nk/Johnson", TRANSITION_METALS, ("chromium",)),
    Entry("Cu", "main/Cu/nk/Johnson", NOBLE_METALS, ("copper",)),
    Entry("Fe", "main/Fe/nk/Johnson", TRANSITION_METALS, ("iron",)),
    Entry("Ni", "main/Ni/nk/Johnson", TRANSITION_METALS, ("nickel",)),
    Entry("Ti", "main/Ti/nk/Johnson", TRANSITION_METALS, ("titanium",)),
]

LICENSE = (
    f"// Data: refractiveindex.info database {refractiveindex.DATABASE_VERSION}, CC0 1.0 (public domain)."
    " Regenerate: python tools/tabulate.py"
)

GLASS_HEADER = """
//! Dispersion formulas of glasses, crystals and water.

/// A clear material: n^2 = 1 + sum of b w^2 / (w^2 - c), w = wavelength in um (Sellmeier 1871).
#[derive(Clone, Copy, Debug)]
pub struct Glass {
    /// Its name in a scene.
    pub name: &'static str,
    /// Other names of the same data.
    pub aliases: &'static [&'static str],
    /// Who published the formula.
    pub source: &'static str,
    /// The wavelengths in nm between which the formula holds.
    pub range_nm: (f64, f64),
    /// The strengths b.
    pub b: &'static [f64],
    /// The squared resonance wavelengths c, in um^2.
    pub c: &'static [f64],
}

/// Every glass, in the order of the names' characters.
"""

METAL_HEADER = """
//! Measured complex indices of metals.

/// A metal: its index n + ik at the measured wavelengths.
#[derive(Clone, Copy, Debug)]
pub struct Metal {
    /// Its name in a scene.
    pub name: &'static str,
    /// Other names of the same data.
    pub aliases: &'static [&'static str],
    /// Who published the measurement.
    pub source: &'static str,
    /// (wavelength in nm, n, k), ascending.
    pub samples: &'static [(f64, f64, f64)],
}

/// Every metal, in the order of the names' characters.
#[allow(clippy::approx_constant, reason = "a measured 3.14 is not pi")]
"""


def read(entry, kind):
    """The first data block of an entry, which must be of that kind, with its numbers still as text.

    The words and years of the entry's source must stand among the references of the page.
    """
    page = yaml.load((DATABASE / f"{entry.page}.yml").read_text(encoding="utf-8"), Loader=yaml.BaseLoader)
    credits = (page["REFERENCES"] + page.get("COMMENTS", "")).lower()
    unknown = [word for word in re.findall(r"\w{4,}", entry.source.lower()) if word not in credits]
    if unknown:
        sys.exit(f"{entry.name}: the references of {entry.page} do not mention {unknown}")
    block = page["DATA"][0]
    if not re.fullmatch(kind, block["type"]):
        sys.exit(f"{entry.name}: the data of {entry.page} are of type '{block['type']}', not '{kind}'")
    return block


def sellmeier(formula, coefficients):
    """The lists b and c of a database formula.

    refractiveindex.info, "Dispersion formulas" (Polyanskiy): formula 1 is n^2 - 1 = C1 + sum of C2 w^2 / (w^2 - C3^2),
    formula 2 the same with C3 in place of its square. The constant C1 is a term with c = 0.
    """
    constant, *rest = (Decimal(text) for text in coefficients.split())
    b, c = rest[0::2], rest[1::2]
    if formula == "formula 1":
        c = [resonance * resonance for resonance in c]
    return ([constant, *b], [Decimal(0), *c]) if constant else (b, c)


def number(value):
    """A Rust literal: the shortest decimal that reads back as the same f64."""
    return repr(float(value))


def numbers(values):
    return ", ".join(number(value) for value in values)


def described(entry):
    aliases = ", ".join(json.dumps(alias) for alias in entry.aliases)
    source = json.dumps(entry.source, ensure_ascii=False)
    return f"name: {json.dumps(entry.name)}, aliases: &[{aliases}], source: {source},"


def glass_row(entry):
    block = read(entry, "formula [12]")
    b, c = sellmeier(block["type"], block["coefficients"])
    range_nm = numbers(Decimal(text) * 1000 for text in block["wavelength_range"].split())
    return f"Glass {{ {described(entry)} range_nm: ({range_nm}), b: &[{numbers(b)}], c: &[{numbers(c)}] }},"


def metal_row(entry):
    lines = read(entry, "tabulated nk")["data"].strip().splitlines()
    samples = sorted((Decimal(um) * 1000, Decimal(n), Decimal(k)) for um, n, k in map(str.split, lines))
    low, high = METAL_RANGE_NM
    inside = [i for i, sample in enumerate(samples) if low <= sample[0] <= high]
    kept = samples[inside[0] - 1 : inside[-1] + 2]
    rows = ", ".join(f"({numbers(sample)})" for sample in kept)
    return f"Metal {{ {described(entry)} samples: &[{rows}] }},"


def in_order(entries):
    """The entries by name; refuses a name that stands for two of them."""
    names = [name.lower() for entry in entries for name in (entry.name, *entry.aliases)]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        sys.exit(f"these names stand for more than one material: {twice}")
    return sorted(entries)


def rust(header, declaration, rows):
    """The text of a table as rustfmt leaves it, under the settings of the repository."""
    text = "\n".join([LICENSE + header + declaration + " = &[", *rows, "];\n"])
    command = ["rustfmt", "--edition", "2024"]
    return subprocess.run(command, input=text, cwd=ROOT, capture_output=True, encoding="utf-8", check=True).stdout


def tables():
    glasses = [glass_row(entry) for entry in in_order(GLASSES)]
    metals = [metal_row(entry) for entry in in_order(METALS)]
    return {
        TABLES / "glasses.rs": rust(GLASS_HEADER, "pub const GLASSES: &[Glass]", glasses),
        TABLES / "metals.rs": rust(METAL_HEADER, "pub const METALS: &[Metal]", metals),
    }


def index(b, c, wavelength_nm):
    w2 = (wavelength_nm * 1e-3) ** 2
    return (1 + sum(float(bi) * w2 / (w2 - float(ci)) for bi, ci in zip(b, c))) ** 0.5


def print_indices():
    """One line per glass, with the Abbe number V_d = (n_d - 1) / (n_F - n_C) (SCHOTT TIE-29)."""
    print(f"{'glass':14}{'n_F':>10}{'n_d':>10}{'n_C':>10}{'V_d':>8}")
    for entry in in_order(GLASSES):
        block = read(entry, "formula [12]")
        b, c = sellmeier(block["type"], block["coefficients"])
        n_f, n_d, n_c = (index(b, c, line) for line in LINES_NM)
        print(f"{entry.name:14}{n_f:10.6f}{n_d:10.6f}{n_c:10.6f}{(n_d - 1) / (n_f - n_c):8.2f}")


def main():
    parser = argparse.ArgumentParser(description="Write the optical tables of src/spectrum/data.")
    parser.add_argument("--check", action="store_true", help="only compare with the committed tables")
    if not parser.parse_args().check:
        for path, text in tables().items():
            path.write_text(text, encoding="utf-8")
        return print_indices()
    stale = [path for path, text in tables().items() if not path.exists() or path.read_text(encoding="utf-8") != text]
    for path in stale:
        print(f"{path.relative_to(ROOT)} differs from the database: run python tools/tabulate.py")
    return 1 if stale else 0


if __name__ == "__main__":
    sys.exit(main())
