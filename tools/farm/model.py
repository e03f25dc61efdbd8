"""How time and overhead grow with the number of parts, from parts of the work that are measured.

All parts do some of the work alike: they start, read the scene, plan it, and send all photons. Only tiles are shared out.
With n parts, each on a machine of its own, and the seconds of `Work`:

    processor time = n repeated + tiles + merge + n merge_part
    time           = repeated + slowest(n) tiles / n + merge + n merge_part

`slowest(n)` is how much longer the slowest part takes for its tiles than the mean of them. Every n-th tile goes to a part,
so that costs which vary from tile to tile by chance even out by the root of how many tiles a part has. With u as the
largest deviation to be expected of n (the root of 2 ln n standard deviations) and v as the variation of single tiles,

    slowest(n) = 1 + v sqrt(2 ln n) sqrt(n / count)

for a `count` of tiles. Where a part has one tile or none, more parts change nothing but the overhead. What a scheduler takes
to start a task, and what files take on their way, come on top.
"""

import math
from typing import NamedTuple


class Work(NamedTuple):
    """Seconds of processor time, at so many threads as will be used."""

    start: float  # the command alone
    load: float  # the scene is read and checked
    plan: float  # and planned
    photons: float  # all that parts do alike beside, as sending photons
    tiles: float  # all tiles
    merge: float  # whatever their number
    merge_part: float  # for each part
    count: int  # tiles
    variation: float = 0.0  # standard deviation of the cost of a tile, in means

    @property
    def repeated(self):
        """What every part does."""
        return self.start + self.load + self.plan + self.photons


class Forecast(NamedTuple):
    parts: int
    processor: float  # seconds of all machines
    time: float  # seconds until the image is there
    overhead: float  # the share of processor time that is not spent on tiles


def slowest(work, parts):
    """How much longer the tiles of the slowest part take than the mean of them."""
    filled = min(parts, work.count)
    spread = work.variation * math.sqrt(2 * math.log(filled)) * math.sqrt(filled / work.count)
    return (1 + spread) * parts / filled


def forecast(work, parts):
    together = 0.0 if parts == 1 else work.merge + parts * work.merge_part
    processor = parts * work.repeated + work.tiles + together
    time = work.repeated + slowest(work, parts) * work.tiles / parts + together
    return Forecast(parts, processor, time, 1 - work.tiles / processor)


def most(work, overhead):
    """The largest number of parts with at most this share of overhead; 0 if one render has more."""
    budget = work.tiles / (1 - overhead) - work.tiles - work.merge
    parts = math.floor(budget / (work.repeated + work.merge_part))
    if parts > 1:
        return parts
    return 1 if forecast(work, 1).overhead <= overhead else 0


def fastest(work, limit):
    """The number of parts up to a limit that is done first."""
    return min(range(1, limit + 1), key=lambda parts: forecast(work, parts).time)
