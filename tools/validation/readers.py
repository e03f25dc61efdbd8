"""What is measured in an image: estimates, each of all values of a row."""

import numpy as np


def colors(image):
    """Red, green and blue of every pixel."""
    return image.rgb.reshape(-1, 3)


def gray(image):
    """Green of every pixel, where all channels are alike."""
    return image.rgb[..., 1].reshape(-1, 1)


def need(image, name):
    """A channel other than color; a clear word where another renderer's file has none."""
    if name not in image.channels:
        raise ValueError(f"the file has no channel {name}, by which this row tells the pixels that the body covers")
    return image.channels[name]


def covered(image):
    """Red, green and blue of the pixels that a body covers wholly; the others are no numbers and do not count."""
    return np.where((need(image, "A") == 1)[..., None], image.rgb, np.nan).reshape(-1, 3)


def touched(image):
    """Red, green and blue of the pixels that a body covers at least in part."""
    return np.where((need(image, "A") > 0)[..., None], image.rgb, np.nan).reshape(-1, 3)


def per_coverage(image):
    """Green of what is covered: its mean over all pixels by their mean coverage,"""
    green, alpha = image.rgb[..., 1], need(image, "A").astype(float)
    return np.array([[green.mean() / alpha.mean()]])


def columns(image):
    """Red, green and blue of every pixel of the first row: one estimate."""
    return image.rgb[:1].reshape(1, -1)
