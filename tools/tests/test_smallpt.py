"""Compares scenes/smallpt.toml with the 99-line program.

    python -m pytest tools/tests/test_smallpt.py

Half a minute of one core gives standard errors of at most LARGEST_ERROR; for a tenth of a percent run
python tools/smallpt_reference.py --compare
"""

import json

import numpy as np
import pytest
from render import render
from smallpt.reference import REFERENCE, SIZE
from smallpt.regions import REGIONS, mean_and_error, region_means, scene_text, sees_front_wall, sees_glass

WIDTH, HEIGHT = SIZE
SAMPLES = 8
SEEDS = range(1, 9)
LARGEST_ERROR = 0.004
EXPECTED = json.loads(REFERENCE.read_text())["reference"]["regions"]


@pytest.fixture(scope="module")
def pictures():
    text = scene_text(WIDTH, HEIGHT)
    return [render(text, samples=SAMPLES, seed=seed).rgb for seed in SEEDS]


@pytest.fixture(scope="module")
def centered():
    """Renders a picture in which all samples of a pixel hit the same point of a wall, so that a bad point shows."""
    text = scene_text(WIDTH // 2, HEIGHT // 2).replace("[film]", '[film]\nfilter = "center"')
    return render(text, samples=128).rgb


def specks(image, ignored):
    """Returns pixels darker than an eighth of the median of their 3 x 3 neighborhood, in the mean of the three bands.

    With noise, and in the shadows below the balls, pixels keep a fifth or more.
    """
    brightness = image.mean(axis=2)
    padded = np.pad(brightness, 1, mode="edge")
    neighborhood = np.lib.stride_tricks.sliding_window_view(padded, (3, 3)).reshape(*brightness.shape, 9)
    return (brightness < np.median(neighborhood, axis=2) / 8) & ~ignored


def test_every_sample_is_finite(pictures):
    assert all(np.isfinite(picture).all() for picture in pictures)


def test_the_reference_is_known_to_three_tenths_of_a_percent():
    for values in EXPECTED.values():
        assert (np.array(values["error"]) <= 0.003 * np.array(values["mean"])).all()


@pytest.mark.parametrize("region", REGIONS)
def test_region_agrees_with_the_99_line_program_within_one_percent(pictures, region):
    runs = [region_means(picture) for picture in pictures]
    mean, error = mean_and_error(runs)[region]
    expected = np.array(EXPECTED[region]["mean"])
    message = f"{region}: {mean} +- {error}, expected {expected}, relative difference {mean / expected - 1}"
    assert (error <= LARGEST_ERROR * mean).all(), message
    assert (np.abs(mean - expected) <= 0.01 * expected + 3 * error).all(), message


def test_no_pixel_is_a_dark_speck(centered):
    height, width = centered.shape[:2]
    found = np.argwhere(specks(centered, sees_glass(width, height) | sees_front_wall(width, height)))
    assert not len(found), f"rows and columns {found[:10].tolist()}"


def test_only_the_mirrored_front_wall_is_black(pictures, centered):
    for image in (np.mean(pictures, axis=0), centered):
        height, width = image.shape[:2]
        black = (image <= 0).any(axis=2) & ~sees_front_wall(width, height)
        assert not black.any(), f"rows and columns {np.argwhere(black)[:10].tolist()}"


def test_a_planted_speck_is_found():
    image = np.ones((HEIGHT, WIDTH, 3))
    image[20, 30] = 0.1
    nothing = np.zeros((HEIGHT, WIDTH), bool)
    assert np.argwhere(specks(image, nothing)).tolist() == [[20, 30]]
    assert not specks(np.ones_like(image), nothing).any()
