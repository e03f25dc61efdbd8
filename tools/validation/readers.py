"""Readers of measurements from an image: estimates, each of all values of a row."""

import numpy as np


def colors(image):
    """Returns red, green and blue of every pixel."""
    return image.rgb.reshape(-1, 3)


def gray(image):
    """Returns green of every pixel, for images whose channels are equal."""
    return image.rgb[..., 1].reshape(-1, 1)


def need(image, name):
    """Returns a channel other than color, or raises a clear error if another renderer's file has none."""
    if name not in image.channels:
        raise ValueError(f"the file has no channel {name}, by which this row tells the pixels that the body covers")
    return image.channels[name]


def covered(image):
    """Returns red, green and blue of the pixels that a body covers completely; the others are NaN and do not count."""
    return np.where((need(image, "A") == 1)[..., None], image.rgb, np.nan).reshape(-1, 3)


def touched(image):
    """Returns red, green and blue of the pixels that a body covers at least in part; the others are NaN."""
    return np.where((need(image, "A") > 0)[..., None], image.rgb, np.nan).reshape(-1, 3)


def per_coverage(image):
    """Returns the mean of green over all pixels divided by their mean coverage."""
    green, alpha = image.rgb[..., 1], need(image, "A").astype(float)
    return np.array([[green.mean() / alpha.mean()]])


def columns(image):
    """Returns red, green and blue of every pixel of the first row: one estimate."""
    return image.rgb[:1].reshape(1, -1)
