"""The committed optical tables agree with the database and with printed catalogs.

pytest tools/tests/test_tabulate.py
"""

import subprocess
import sys
from pathlib import Path

import pytest
from tabulate import pages

ROOT = Path(__file__).resolve().parents[2]
SCRIPT = ROOT / "tools/tabulate.py"
TABLES = ROOT / "src/spectrum/data"


def rows(name):
    lines = (TABLES / f"{name}.txt").read_text("utf-8").splitlines()
    return {line.split("|")[0]: line.split("|") for line in lines[1:]}


def committed_index(key, wavelength_nm):
    """Returns n of a glass by its committed line, formula 1 or 2 of refractiveindex.info."""
    _, _, formula, _, coefficients, *_ = rows("glasses")[key]
    constant, *rest = map(float, coefficients.split())
    b, c = rest[0::2], [value ** {"1": 2, "2": 1}[formula] for value in rest[1::2]]
    w2 = (wavelength_nm * 1e-3) ** 2
    return (1 + constant + sum(bi * w2 / (w2 - ci) for bi, ci in zip(b, c, strict=True))) ** 0.5


# Five decimals, from the makers' data sheets and the formula of Malitson (1965).
@pytest.mark.parametrize(
    ("key", "index_f", "index_d", "index_c"),
    [
        ("schott/N-BK7", 1.52238, 1.51680, 1.51432),
        ("schott/N-SF11", 1.80651, 1.78472, 1.77596),
        ("ohara/S-BSL7", 1.52191, 1.51633, 1.51386),
        ("glass/fused silica", 1.46313, 1.45846, 1.45637),
    ],
)
def test_committed_glasses_have_the_indices_of_their_catalogs(key, index_f, index_d, index_c):
    assert committed_index(key, 486.1327) == pytest.approx(index_f, abs=1e-5)
    assert committed_index(key, 587.5618) == pytest.approx(index_d, abs=1e-5)
    assert committed_index(key, 656.2725) == pytest.approx(index_c, abs=1e-5)


def test_committed_tables_are_in_order_and_complete():
    for name, fields, least in [("glasses", 9, 1700), ("metals", 4, 40), ("colors", 5, 76)]:
        keys = list(rows(name))
        assert keys == sorted(keys, key=str.lower)
        assert len({key.lower() for key in keys}) == len(keys) >= least
        assert {len(row) for row in rows(name).values()} == {fields}


def test_committed_metals_and_colors_are_those_of_their_sources():
    assert "582.1:0.29:2.863" in rows("metals")["Au"][2]
    # CIE 15:2004, tables T.1 and T.4: D65 is 100 at 560 nm, and the observer is most sensitive at 555 nm.
    d65 = list(map(float, rows("colors")["illuminant/D65"][4].split()))
    assert d65[(560 - 300) // 5] == 100
    y = list(map(float, rows("colors")["observer/y"][4].split()))
    assert len(y) == 471 and y[555 - 360] == max(y) == 1


def test_committed_tables_are_those_of_the_database():
    check = subprocess.run([sys.executable, SCRIPT, "--check"], capture_output=True, text=True)
    assert check.returncode == 0, check.stdout + check.stderr


def test_numbers_are_as_short_as_they_can_be():
    written = {"1e-05": "1e-5", "0.30": "0.3", "2.0": "2", "5896.0": "5896", "1.5E+10": "15000000000"}
    assert {text: pages.number(text) for text in written} == written
    assert pages.significant("9.57814E-09") == "9.578e-9"
