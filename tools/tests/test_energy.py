"""The energy table's formulas give the known numbers, its verdicts can fail, and the renderer passes its quick part.

    pytest tools/tests/test_energy.py
"""

import energy
import energy_rows
import numpy as np
import optics
import pytest
import render


def test_fresnel_gives_the_known_reflectances_of_glass():
    known = {0: 0.040000, 30: 0.041523, 45: 0.050240, 60: 0.089187, 75: 0.253061, 85: 0.612800}
    for degrees, reflectance in known.items():
        assert optics.fresnel(1.5, degrees) == pytest.approx(reflectance, abs=5e-7)


def test_a_metal_reflects_by_n_and_k():
    n, k = 0.43, 2.455
    assert optics.fresnel(n + 1j * k, 0) == pytest.approx(((n - 1) ** 2 + k**2) / ((n + 1) ** 2 + k**2))


def test_a_plate_transmits_the_known_shares_without_polarization():
    known = {0: 0.918318, 30: 0.915446, 45: 0.899254, 60: 0.830693, 70: 0.702545}
    for degrees, transmittance in known.items():
        assert optics.slab(1.52, degrees)[1] == pytest.approx(transmittance, abs=5e-7)
        assert sum(optics.slab(1.52, degrees)) == pytest.approx(1)


def test_an_absorbing_plate_gives_the_known_shares():
    assert optics.slab(1.5, 0, optical_depth=1) == pytest.approx((0.044990, 0.339111), abs=5e-7)
    assert optics.slab(1.5, 60, optical_depth=1) == pytest.approx((0.095579, 0.243925), abs=5e-7)


def test_lamps_give_the_known_irradiances():
    assert optics.irradiance_under_disc(1, 2) == pytest.approx(0.628319, abs=5e-7)
    assert optics.irradiance_under_square(1, 1) == pytest.approx(1.740840, abs=5e-7)


def test_a_closed_box_of_four_meters_has_the_known_irradiances():
    known = {0: 104.167, 0.2: 130.208, 0.5: 208.333, 0.8: 520.833, 0.9: 1041.667}
    for reflectance, irradiance in known.items():
        assert optics.irradiance_in_box(10000, 6 * 16, reflectance) == pytest.approx(irradiance, abs=5e-4)


def test_three_sigma_of_one_value_stays_three_sigma():
    assert energy.z_limit(1) == pytest.approx(3, abs=1e-3)
    assert energy.z_limit(100) > 4


def image(values):
    channels = dict(zip("RGB", np.moveaxis(values, -1, 0), strict=True), A=np.ones(values.shape[:2]))
    return render.Image({}, channels)


@pytest.fixture
def verdict(monkeypatch, capsys):
    """Judges a row that expects 1 everywhere, on two made-up images of 32 x 32 pixels."""

    def judged(bias=0.0, noise=0.0, speck=0.0):
        random = np.random.default_rng(7)
        pair = [1 + bias + noise * random.standard_normal((32, 32, 3)) for _ in range(2)]
        for values in pair:
            values[5, 5] += speck
        answers = iter(pair)
        monkeypatch.setattr(render, "render", lambda text, seed: image(next(answers)))
        return energy.judge(energy_rows.Row("made up", [energy_rows.sky([1, 1, 1])], 1.0), energy.z_limit(3))

    return judged


def test_exact_and_evenly_noisy_images_pass(verdict):
    assert verdict()
    assert verdict(noise=0.02)


def test_a_bias_beyond_rounding_or_beyond_the_noise_fails(verdict):
    assert not verdict(bias=1e-5)
    assert not verdict(bias=0.004, noise=0.02)


def test_too_much_noise_to_tell_fails(verdict):
    assert not verdict(noise=0.2)


def test_a_single_speck_fails(verdict):
    assert not verdict(noise=0.02, speck=0.8)


def test_the_renderer_keeps_energy_in_every_quick_row(capsys):
    code = energy.main(["--quick"])
    assert code == 0, capsys.readouterr().out
