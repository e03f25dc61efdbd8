"""A furnace test: under uniform light, a perfectly reflecting surface looks the same as the sky. Run it with pytest.

pytest examples/python/furnace.py
"""

import abbe
import numpy as np
import pytest


def scene(material):
    return {
        "camera": {"position": [0, 0, 4], "look_at": [0, 0, 0], "vertical_fov": 40},
        "film": {"width": 32, "height": 32},
        "material": {"white": material},
        "object": [{"shape": {"sphere": {"center": [0, 0, 0], "radius": 1}}, "material": "white"}],
        "light": [{"environment": {"radiance": 1}}],
    }


@pytest.mark.parametrize(
    "material",
    [
        {"diffuse": {"reflectance": 1}},
        {"mirror": {"reflectance": 1}},
        {"dielectric": {"index": 1.5}},
        {"dielectric": {"index": 1.5, "roughness": 0.3}},
    ],
    ids=["matte", "mirror", "glass", "rough glass"],
)
def test_nothing_is_lost_and_nothing_won(material):
    image = abbe.render(scene(material), samples=256)
    # Rough glass conserves energy to 0.1 %, besides its noise; the others conserve it except for rounding.
    assert np.mean(image.rgb) == pytest.approx(1, abs=2e-3)
