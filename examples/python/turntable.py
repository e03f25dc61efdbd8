"""A turntable to EXRs: python examples/python/turntable.py FOLDER [FRAMES]"""

import sys
from pathlib import Path

import abbe

SCENE = Path(__file__).parent.with_name("turntable.toml")


def main(folder, frames=8, **options):
    Path(folder).mkdir(parents=True, exist_ok=True)
    for frame in range(frames):
        image = abbe.render(SCENE, set={"angle": 360 * frame / frames}, layers=["albedo", "N"], **options)
        path = Path(folder) / f"turntable.{frame + 1:04}.exr"
        image.write_exr(path)
        print(f"{path}: {image.stats['seconds']:.1f} s", *image.stats["warnings"], sep="\n")


if __name__ == "__main__":
    if not sys.argv[1:]:
        sys.exit(__doc__)
    main(sys.argv[1], *map(int, sys.argv[2:3]))
