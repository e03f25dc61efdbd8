"""Patches look as colour-science says under every illuminant, directly and in colored mirrors; white is white.

pytest tools/tests/test_colors.py
"""

import colors
import numpy as np
import pytest
import render
from validation.scenes import SKY, toml_file, view

MODELS = ["auto", "rgb", *({"bands": bands} for bands in (8, 12, 16, 32)), "hero"]
SPACES = [f"lin_{name}_scene" for name in ("rec709", "ap1", "ap0", "rec2020", "p3d65", "ciexyzd65")]
D65 = np.array([0.3127, 0.3290, 1 - 0.3127 - 0.3290]) / 0.3290


def test_the_reference_gives_the_published_chromaticities_of_smooth_lights():
    # CIE 15:2004, table T.3, to four decimals.
    published = {"A": (0.4476, 0.4074), "C": (0.3101, 0.3162), "D65": (0.3127, 0.3290), "D50": (0.3457, 0.3585)}
    for name, xy in published.items():
        xyz = colors.illuminant(name).xyz()
        assert xyz[1] == pytest.approx(1)
        assert xyz[:2] / xyz.sum() == pytest.approx(xy, abs=1e-4)


def test_the_reference_gives_the_patches_about_the_colors_of_the_first_chart():
    # McCamy, Marcus and Davidson (1976), x, y and Y under C. Ohta measured another copy of the chart.
    published = colors.colour.CCS_COLOURCHECKERS["ColorChecker 1976"].data
    light = colors.illuminant("C")
    for patch in colors.PATCHES:
        xyz = light.xyz(patch)
        assert [*xyz[:2] / xyz.sum(), xyz[1]] == pytest.approx(published[patch], abs=0.015)


def test_lightness_is_that_of_cie_1976():
    white = colors.illuminant("D50").xyz()
    assert colors.lab(0.5 * white, white) == pytest.approx([76.069, 0, 0], abs=1e-3)
    assert colors.lab(0.005 * white, white) == pytest.approx([0.005 * (29 / 3) ** 3, 0, 0], abs=1e-9)


def test_the_catalog_lists_every_kind_of_illuminant():
    names = set(colors.catalog())
    fluorescent = {f"FL{i}" for i in range(1, 13)} | {f"FL3.{i}" for i in range(1, 16)}
    assert {"A", "C", "D50", "D55", "D60", "D65", "D75", "E"} | fluorescent | {f"HP{i}" for i in range(1, 6)} <= names
    assert sum(name.startswith("LED-") for name in names) == 9


def test_a_bar_that_is_missed_fails(capsys):
    assert colors.verdict("made up", np.linspace(0, 1, 101), 0.96)
    assert not colors.verdict("made up", np.linspace(0, 1, 101), 0.94)
    assert "FAIL" in capsys.readouterr().out


def test_every_sample_of_a_lone_patch_is_its_reflectance_times_the_sky():
    text = toml_file(colors.chart_scene({"illuminant": "FL11"}, {"bands": 12}))
    one, many = (render.render(text, samples=samples, seed=samples).rgb for samples in (1, 64))
    assert np.max(np.abs(one / many - 1)) < 1e-6


def test_the_chart_has_its_colors_and_white_is_exact_under_every_illuminant(capsys):
    failed = colors.judge_charts()
    assert not failed, capsys.readouterr().out


def test_patches_in_colored_mirrors_have_their_colors_under_spikes_and_ideal_lines(capsys):
    failed = colors.judge_mirrors()
    assert not failed, capsys.readouterr().out


@pytest.mark.parametrize("space", SPACES)
@pytest.mark.parametrize("model", MODELS, ids=str)
def test_a_radiance_of_1_is_the_white_of_the_film_in_every_model(model, space):
    scene = view({}, [], [SKY], eye=(0, 0, 1), samples=4, model=model, space=space)
    expected = D65 if "xyz" in space else 1
    assert render.render(toml_file(scene)).rgb[0, 0] == pytest.approx(expected * np.ones(3), rel=1e-6)
