"""The book's formulas give published numbers, its verdicts can fail and say why, and the renderer passes every row.

pytest tools/tests/test_validate.py
"""

import json
from functools import partial

import numpy as np
import OpenEXR
import pytest
import render
from validation import book, formulas, row
from validation import command as validate
from validation.row import Row, judge


def test_fresnel_gives_the_known_reflectances_of_glass():
    known = {0: 0.040000, 30: 0.041523, 45: 0.050240, 60: 0.089187, 75: 0.253061, 85: 0.612800}
    for degrees, reflectance in known.items():
        assert formulas.fresnel(1.5, degrees) == pytest.approx(reflectance, abs=5e-7)
    assert formulas.both_polarizations(1.5, 45) == pytest.approx((0.092013, 0.008466), abs=5e-7)


def test_a_metal_reflects_by_n_and_k():
    n, k = 0.43, 2.455
    assert formulas.fresnel(n + 1j * k, 0) == pytest.approx(((n - 1) ** 2 + k**2) / ((n + 1) ** 2 + k**2))


def test_plates_transmit_the_known_shares():
    known = {0: 0.918318, 30: 0.915446, 45: 0.899254, 60: 0.830693, 70: 0.702545}
    for degrees, transmittance in known.items():
        assert formulas.slab_of_averages(1.52, degrees)[1] == pytest.approx(transmittance, abs=5e-7)
        assert sum(formulas.slab(1.52, degrees)) == pytest.approx(1)
    for degrees, transmittance in {45: 0.907344, 60: 0.848128}.items():
        assert formulas.slab(1.5, degrees)[1] == pytest.approx(transmittance, abs=5e-7)
    assert formulas.slab(1.5, 0, optical_depth=1) == pytest.approx((0.044990, 0.339111), abs=5e-7)
    assert formulas.slab_of_averages(1.5, 60, optical_depth=1) == pytest.approx((0.095579, 0.243925), abs=5e-7)
    for degrees, plates, transmittance in [(45, 4, 0.735751), (56.603838, 4, 0.702374), (56.603838, 10, 0.606913)]:
        assert formulas.pile(1.5168, degrees, plates) == pytest.approx(transmittance, abs=5e-7)
    assert formulas.pile(1.5168, 45, 1) == pytest.approx(formulas.slab(1.5168, 45)[1])


def test_the_indices_are_those_of_the_data_sheets():
    known = {
        "N-BK7": (1.52238, 1.51680, 1.51432),
        "N-SF11": (1.80651, 1.78472, 1.77596),
        "fused silica": (1.46313, 1.45846, 1.45637),
    }
    known |= {
        "schott/F2": (1.63208, 1.62004, 1.61503),
        "N-FK51A": (1.49056, 1.48656, 1.48480),
        "N-LASF9": (1.86898, 1.85025, 1.84255),
    }
    for name, indices in known.items():
        lines = np.array([formulas.F_LINE, formulas.D_LINE, formulas.C_LINE])
        assert formulas.index(name, lines) == pytest.approx(indices, abs=1.5e-5), name


def test_prisms_and_drops_deviate_by_the_known_angles():
    lines = np.array([formulas.F_LINE, formulas.D_LINE, formulas.C_LINE])
    for name, angles in {"N-BK7": (39.1381, 38.6467, 38.4291), "N-SF11": (69.1789, 66.3426, 65.2404)}.items():
        n = formulas.index(name, lines)
        assert formulas.prism_deviation(n, 60, formulas.least_incidence(n, 60)) == pytest.approx(angles, abs=1e-3)
    for index, primary, secondary in ((1.331, 42.370, 50.365), (1.333, 42.078, 50.891), (1.3435, 40.575, 53.605)):
        turned = [formulas.drop_deviation(index, formulas.bow_incidence(index, k), k) for k in (1, 2)]
        assert (180 - turned[0], turned[1] - 180) == pytest.approx((primary, secondary), abs=6e-4)
    assert formulas.slab_shift(1.5168, 45, 10) == pytest.approx(3.34499, abs=1e-5)
    assert formulas.ball_focus(1.5168, 1e-6) == pytest.approx(1.46749, abs=1e-5)


def test_lamps_and_view_factors_are_the_tabulated_ones():
    assert formulas.irradiance_under_disc(1, 2) == pytest.approx(0.628319, abs=5e-7)
    assert formulas.irradiance_under_square(1, 1) == pytest.approx(1.740840, abs=5e-7)
    assert formulas.parallel_squares(1, 1) == pytest.approx(0.199825, abs=1e-6)
    assert formulas.perpendicular_rectangles(1, 1, 1) == pytest.approx(0.200044, abs=1e-6)
    # A face of a closed cube sees nothing of itself, one face opposite and four beside it.
    assert formulas.parallel_squares(1, 1) + 4 * formulas.perpendicular_rectangles(1, 1, 1) == pytest.approx(1)
    assert formulas.coaxial_discs(1, 1, 1) == pytest.approx(0.381966, abs=1e-6)
    known = {0: 104.167, 0.2: 130.208, 0.5: 208.333, 0.8: 520.833, 0.9: 1041.667}
    for reflectance, irradiance in known.items():
        assert formulas.irradiance_in_box(10000, 6 * 16, reflectance) == pytest.approx(irradiance, abs=5e-4)


def test_a_ball_throws_the_light_that_the_literature_says():
    # Row T1: a lamp of power pi, so intensity 1/4.
    assert formulas.through_ball(1.5, 1.5, 7, 0.8, averaged=True) / 4 == pytest.approx(0.0084, abs=5e-5)
    # Transmitting both polarizations separately passes more light than applying their mean twice.
    assert 1.005 < formulas.through_ball(1.5, 1.5, 7, 0.8) / formulas.through_ball(1.5, 1.5, 7, 0.8, averaged=True) < 1.007


def picture(values):
    return render.Image({}, dict(zip("RGB", np.moveaxis(values, -1, 0), strict=True), A=np.ones(values.shape[:2])))


def judged(bias=0.0, noise=0.0, speck=0.0, effect=0.01, draw=np.random.Generator.standard_normal):
    """Judges a row that expects 1 everywhere, on two made-up images of 32 x 32 pixels."""
    random = np.random.default_rng(7)
    pair = [1 + bias + noise * draw(random, size=(32, 32, 3)) for _ in range(2)]
    for values in pair:
        values[5, 5] += speck
    made_up = Row(
        "energy",
        "made up",
        "1",
        {},
        lambda image: image.rgb.reshape(-1, 3),
        1.0,
        "a mistake",
        1 + effect,
        "",
        2,
        every_pixel=True,
    )
    return judge(made_up, [picture(values) for values in pair])


def test_exact_and_evenly_noisy_images_pass():
    assert judged().passes
    assert judged(noise=0.02).passes


def test_noise_that_a_few_pixels_carry_is_said_to_be_of_unknown_size():
    # Skewed, but every pixel shows it.
    assert judged(bias=-0.02, noise=0.02, draw=np.random.Generator.standard_exponential).passes
    # As if each pixel were a product of many factors of mean 1: the mean comes from a tail that few pixels sample.
    tail = judged(bias=-1.0, noise=1.0, effect=10.0, draw=partial(np.random.Generator.lognormal, mean=-8.0, sigma=4.0))
    assert any("a heavy tail: about" in reason for reason in tail.reasons), tail.reasons


def test_a_bias_beyond_rounding_or_beyond_the_noise_fails():
    assert not judged(bias=1e-5).passes
    assert not judged(bias=0.004, noise=0.02).passes


def test_a_value_as_the_mistake_would_make_it_fails_with_its_name():
    (reason,) = judged(bias=0.01).reasons
    assert reason.endswith("expected 1: as if by a mistake")


def test_too_much_noise_to_tell_the_mistake_fails():
    assert judged(noise=0.02, effect=0.01).passes
    (reason,) = judged(noise=0.02, effect=0.001).reasons
    assert reason.startswith("too noisy to tell")


def test_a_single_speck_fails():
    assert not judged(noise=0.02, speck=1.0).passes


def test_an_image_of_nothing_but_infinities_fails_and_stays_json(tmp_path, monkeypatch):
    monkeypatch.setattr(render, "write", lambda *arguments, **flags: None)
    monkeypatch.setattr(render, "read", lambda path: picture(np.full((66, 33, 3), np.inf)))
    (judged_row,) = validate.run([find("prism N-BK7 rgb")], tmp_path)
    assert not judged_row.passes
    (entry,) = json.loads((tmp_path / "validation.json").read_text(), parse_constant=pytest.fail)["rows"]
    assert entry["verdict"].startswith("fail: ")


def find(name):
    (found,) = validate.chosen(book.rows(True), name)
    return found


def write(path, values):
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    channels = {
        name: np.ascontiguousarray(values[..., i], np.float32) for i, name in enumerate("RGBA"[: values.shape[-1]])
    }
    with OpenEXR.File(header, channels) as file:
        file.write(str(path))
    return path


def seen_through_a_prism(angles):
    """Returns the image of a renderer whose rays leave the prism at these angles: 0.6 of red, green and blue."""
    from validation import angles as rows
    from validation.bench import EVEN, HIGH, LOW

    screen = rows.window(np.asarray(find("prism N-BK7 rgb").expected))
    place = screen.distance * np.tan(np.radians(np.asarray(angles) - screen.degrees))
    rising = LOW + (HIGH - LOW) * (place / screen.half_width + 0.5)
    pixels = np.empty((66, 33, 3))
    pixels[:33], pixels[33:] = 0.6 * rising, 0.6 * EVEN
    return pixels


def test_another_renderers_furnace_cube_passes(tmp_path, capsys):
    random = np.random.default_rng(1)
    values = np.array([0.5, 0.2, 0.9, 1.0]) * np.ones((32, 32, 4))
    values[..., :3] *= 1 + 0.01 * random.standard_normal((32, 32, 1))
    values[:4] = (1, 1, 1, 0)
    assert validate.main(["--row", "diffuse cube in an even sky", str(write(tmp_path / "cube.exr", values))]) == 0
    values[..., :3] *= 1.02
    assert validate.main(["--row", "diffuse cube in an even sky", str(write(tmp_path / "bright.exr", values))]) == 1
    assert "as if by" in capsys.readouterr().out


def test_another_renderers_prism_passes_if_it_disperses_and_fails_in_words_if_not(tmp_path, capsys):
    expected = find("prism N-BK7 rgb").expected
    exr = write(tmp_path / "prism.exr", seen_through_a_prism(expected))
    assert validate.main(["--row", "prism-N-BK7-rgb", str(exr)]) == 0
    exr = write(tmp_path / "white.exr", seen_through_a_prism([38.6467] * 3))
    assert validate.main(["--row", "prism-N-BK7-rgb", str(exr)]) == 1
    words = "all three lanes leave at the same angle 38.6; expected 38.43, 38.82, 39.14: no dispersion"
    assert words in capsys.readouterr().out


def test_a_file_that_cannot_be_judged_is_answered_in_a_sentence(tmp_path):
    exr = write(tmp_path / "no_alpha.exr", np.ones((4, 4, 3)))
    with pytest.raises(SystemExit, match="has no channel A"):
        validate.main(["--row", "diffuse cube in an even sky", str(exr)])
    with pytest.raises(SystemExit, match="does not exist"):
        validate.main(["--row", "diffuse cube in an even sky", str(tmp_path / "none.exr")])
    with pytest.raises(SystemExit, match="no row is called nonsense"):
        validate.main(["--row", "nonsense"])
    with pytest.raises(SystemExit, match="one row is needed"):
        validate.main(["--row", "prism", str(exr)])


def test_a_row_says_how_to_build_its_scene(tmp_path, capsys):
    assert validate.main(["--row", "prism-N-BK7-rgb", "--scene", "--out", str(tmp_path)]) == 0
    told = capsys.readouterr().out
    assert "1.51432, 1.51872, 1.52238" in told and "[" in told and (tmp_path / "bench.exr").is_file()


def test_there_are_120_rows_at_least_each_with_a_name_of_its_own():
    for quick in (False, True):
        rows = book.rows(quick)
        assert len(rows) >= 120
        assert len({validate.key(one) for one in rows}) == len(rows)
        assert {one.group for one in rows} == set(book.GROUPS)
        assert all(one.guards_against and one.words and one.formula for one in rows)
    assert row.LIMIT <= 4


def test_the_renderer_passes_every_row_of_the_quick_book(tmp_path, capsys):
    code = validate.main(["--quick", "--out", str(tmp_path)])
    assert code == 0, "\n".join(line for line in capsys.readouterr().out.splitlines() if not line.endswith("ok"))
    content = json.loads((tmp_path / "validation.json").read_text())
    assert set(content) == {"version", "made_by", "rows"} and len(content["rows"]) == len(book.rows(True))
    keys = {
        "group",
        "name",
        "formula",
        "expected",
        "measured",
        "standard_error",
        "z",
        "guards_against",
        "effect",
        "verdict",
    }
    assert all(set(entry) == keys and entry["verdict"] == "pass" for entry in content["rows"])
