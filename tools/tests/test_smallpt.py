"""Holds scenes/smallpt.toml against the 99-line program: python -m pytest tools/tests/test_smallpt.py"""

import json
import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import smallpt_regions  # noqa: E402
from render import render  # noqa: E402

WIDTH, HEIGHT = smallpt_regions.SIZE
SAMPLES = 64
SEEDS = range(1, 9)
LARGEST_ERROR = 0.003
REFERENCE = json.loads(smallpt_regions.REFERENCE.read_text())["reference"]["regions"]


@pytest.fixture(scope="module")
def pictures():
    text = smallpt_regions.scene_text(WIDTH, HEIGHT)
    return [render(text, samples=SAMPLES, seed=seed).rgb for seed in SEEDS]


def specks(image, ignored):
    """Pixels darker than half the median of their 3 x 3 neighborhood, in the mean of the three bands."""
    brightness = image.mean(axis=2)
    padded = np.pad(brightness, 1, mode="edge")
    neighborhood = np.lib.stride_tricks.sliding_window_view(padded, (3, 3)).reshape(*brightness.shape, 9)
    return (brightness < np.median(neighborhood, axis=2) / 2) & ~ignored


def test_every_sample_is_finite(pictures):
    assert all(np.isfinite(picture).all() for picture in pictures)


def test_the_reference_is_known_to_a_third_of_a_percent():
    for values in REFERENCE.values():
        assert (np.array(values["error"]) < LARGEST_ERROR * np.array(values["mean"])).all()


@pytest.mark.parametrize("region", smallpt_regions.REGIONS)
def test_region_agrees_with_the_99_line_program_within_one_percent(pictures, region):
    runs = [smallpt_regions.region_means(picture) for picture in pictures]
    mean, error = smallpt_regions.mean_and_error(runs)[region]
    expected = np.array(REFERENCE[region]["mean"])
    message = f"{region}: {mean} +- {error}, expected {expected}, relative difference {mean / expected - 1}"
    assert (error <= LARGEST_ERROR * mean).all(), message
    assert (np.abs(mean - expected) <= 0.01 * expected + 3 * error).all(), message


def test_no_pixel_is_a_dark_speck(pictures):
    ignored = smallpt_regions.sees_glass(WIDTH, HEIGHT)
    found = np.argwhere(specks(np.mean(pictures, axis=0), ignored))
    assert not len(found), f"rows and columns {found[:10].tolist()}"


def test_only_the_mirrored_front_wall_is_black(pictures):
    black = (np.mean(pictures, axis=0) <= 0).any(axis=2) & ~smallpt_regions.sees_front_wall(WIDTH, HEIGHT)
    assert not black.any(), f"rows and columns {np.argwhere(black)[:10].tolist()}"


def test_a_planted_speck_is_found():
    image = np.ones((HEIGHT, WIDTH, 3))
    image[20, 30] = 0.4
    nothing = np.zeros((HEIGHT, WIDTH), bool)
    assert np.argwhere(specks(image, nothing)).tolist() == [[20, 30]]
    assert not specks(np.ones_like(image), nothing).any()
