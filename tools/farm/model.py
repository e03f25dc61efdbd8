"""How time and overhead grow with the number of parts, from measured parts of the work.

All parts repeat some of the work: they start, read the scene, plan it, and send all photons. Only tiles are shared out.
With n parts, each on a machine of its own, and the seconds of `Work`:

    processor time = n repeated + tiles + merge + n merge_part
    time           = repeated + slowest(n) tiles / n + merge + n merge_part

`slowest(n)` is the ratio of the time that the slowest part takes for its tiles to the mean. A part gets every n-th
tile, so costs that vary randomly from tile to tile average out by the square root of a part's number of tiles. With u
as the expected largest deviation of n (the root of 2 ln n standard deviations) and v as the variation of single tiles,

    slowest(n) = 1 + v sqrt(2 ln n) sqrt(n / count)

for `count` tiles. Once parts have one tile or none, more parts only add overhead. The time that a scheduler takes to
start a task, and that files take to be copied, come on top.
"""

import math
from typing import NamedTuple


class Work(NamedTuple):
    """Seconds of processor time, with the number of threads that will be used."""

    start: float  # starting the command
    load: float  # reading and checking the scene
    plan: float  # planning it
    photons: float  # all else that every part repeats, such as sending photons
    tiles: float  # all tiles
    merge: float  # merging, whatever the number of parts
    merge_part: float  # merging, for each part
    count: int  # number of tiles
    variation: float = 0.0  # standard deviation of the cost of a tile, relative to the mean

    @property
    def repeated(self):
        """Seconds that every part repeats."""
        return self.start + self.load + self.plan + self.photons


class Forecast(NamedTuple):
    parts: int
    processor: float  # seconds of all machines
    time: float  # seconds until the image is complete
    overhead: float  # the share of processor time that is not spent on tiles


def slowest(work, parts):
    """Returns the ratio of the time that the slowest part takes for its tiles to the mean over parts."""
    filled = min(parts, work.count)
    spread = work.variation * math.sqrt(2 * math.log(filled)) * math.sqrt(filled / work.count)
    return (1 + spread) * parts / filled


def forecast(work, parts):
    together = 0.0 if parts == 1 else work.merge + parts * work.merge_part
    processor = parts * work.repeated + work.tiles + together
    time = work.repeated + slowest(work, parts) * work.tiles / parts + together
    return Forecast(parts, processor, time, 1 - work.tiles / processor)


def most(work, overhead):
    """Returns the largest number of parts with at most this share of overhead; 0 if even one render has more."""
    budget = work.tiles / (1 - overhead) - work.tiles - work.merge
    parts = math.floor(budget / (work.repeated + work.merge_part))
    if parts > 1:
        return parts
    return 1 if forecast(work, 1).overhead <= overhead else 0


def fastest(work, limit):
    """Returns the number of parts, up to a limit, with which the image is complete first."""
    return min(range(1, limit + 1), key=lambda parts: forecast(work, parts).time)
