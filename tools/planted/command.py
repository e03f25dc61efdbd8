"""Plants bugs into a copy of the renderer, one at a time, and shows that each is detected.

    python tools/planted.py                 # all of them: some minutes of building for each
    python tools/planted.py --only schlick  # one
    python tools/planted.py --check         # only whether every patch of tools/planted still applies

Copies the source to a folder below target/planted, applies a patch, builds, and runs tools/validate.py --quick. If the
book cannot see a bug, because no scene file reaches that code, runs the named Rust test instead. Prints each bug and
the rows and tests that turned red. Exit code 1 if a bug stays unseen or a patch does not apply.
"""

import argparse
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

import render

PATCHES = render.ROOT / "tools/planted"
WORK = render.ROOT / "target/planted"
# Settings for faster builds, whose results are the same.
QUICK_BUILD = [
    "--config=profile.release.package.abbe.codegen-units=16",
    "--config=profile.release.package.abbe.opt-level=1",
    "--config=profile.release.incremental=true",
    "--config=profile.release.debug=false",
]


class Bug(NamedTuple):
    words: str
    test: tuple[str, str] | None = None  # file and name of the Rust test that must fail if the book cannot see it


BUGS = {
    "schlick": Bug("Schlick's approximation for Fresnel's equations"),
    "s_for_p": Bug("s-polarized light counted twice, p not at all"),
    "no_eta_squared": Bug("radiance not scaled by n^2 at refraction"),
    "clamped_fireflies": Bug("samples clamped at 10"),
    "depth_limit_8": Bug("paths that end after 8 surfaces"),
    "spheres_in_32_bits": Bug("spheres met in 32 bits"),
    "roulette_without_compensation": Bug("roulette whose survivors do not carry the weight of the others"),
    "collapse_without_weight": Bug(
        "one of four wavelengths goes on, without four times the weight",
        ("lanes", "heroes_and_fixed_lanes_together_find_what_single_wavelengths_find"),
    ),
    "retardance_of_columns": Bug(
        "the phase between s and p with the sign that columns have, for rows",
        ("polarization", "metals_mirror_all_four_components"),
    ),
    "verdet_sign_of_r_p": Bug("p reflected by glass with the sign of other textbooks"),
    "frames_not_turned": Bug(
        "polarization not turned from one plane of incidence into the next",
        ("polarization", "two_reflections_depend_on_how_their_planes_lie"),
    ),
    "blur_is_no_error": Bug(
        "a stop rule that looks at noise, and not at how far gathered photons blur",
        ("caustics", "an_error_below_the_blur_is_not_reached_until_the_radius_has_shrunk"),
    ),
    "power_for_photons": Bug("a dye's quantum yield of power, and not of photons"),
    "ten_degree_observer": Bug("color matching functions of 1964 (10 degrees) for those of 1931"),
    "r_p_of_a_film": Bug("r_p of a film with the sign of r_s"),
    "srgb_in_the_exr": Bug("the sRGB curve in the EXR"),
}


def applies(patch, folder, *flags):
    """Applies a patch in a folder, as if it belonged to no repository; returns the error, or an empty text."""
    environment = {**os.environ, "GIT_CEILING_DIRECTORIES": str(folder.parent)}
    run = subprocess.run(["git", "apply", *flags, patch], cwd=folder, env=environment, capture_output=True, text=True)
    return run.stderr.strip() or (f"exit code {run.returncode}" if run.returncode else "")


def check():
    """Returns the problems: bugs without a patch, patches without a bug, and patches that do not apply to the tree."""
    found = {path.stem for path in PATCHES.glob("*.patch")}
    problems = [f"{name}: no patch" for name in BUGS.keys() - found]
    problems += [f"{name}.patch is in no table" for name in found - BUGS.keys()]
    for name in sorted(found & BUGS.keys()):
        complaint = applies(PATCHES / f"{name}.patch", render.ROOT, "--check")
        problems += [f"{name}: {complaint}"] if complaint else []
    return problems


def copy_source(folder):
    """Copies the files that cargo needs, with their times, so that only what a patch touches is built again."""
    folder.mkdir(parents=True, exist_ok=True)
    for name in ("src", "tests", "benches", "scenes", "Cargo.toml", "Cargo.lock", "README.md"):
        source, target = render.ROOT / name, folder / name
        if source.is_dir():
            shutil.rmtree(target, ignore_errors=True)
            shutil.copytree(source, target)
        else:
            shutil.copy2(source, target)


def cargo(folder, target, *words):
    environment = {**os.environ, "CARGO_TARGET_DIR": str(target)}
    return subprocess.run(["cargo", *words], cwd=folder, env=environment, capture_output=True, text=True)


def red_rows(binary, out):
    """Returns the rows of the book that fail with this renderer. If the book stops, that is the only row."""
    environment = {**os.environ, "RENDER": str(binary)}
    command = [sys.executable, str(render.ROOT / "tools/validate.py"), "--quick", "--out", str(out)]
    (out / "validation.json").unlink(missing_ok=True)
    run = subprocess.run(command, env=environment, capture_output=True, text=True)
    if not (out / "validation.json").is_file():
        return [f"the book stops: {run.stderr.strip().splitlines()[-1] if run.stderr.strip() else run.returncode}"]
    rows = json.loads((out / "validation.json").read_text())["rows"]
    return [f"{row['group']}: {row['name']}" for row in rows if row["verdict"] != "pass"]


def red_test(bug, folder, target):
    """Returns the named test, if it fails."""
    if bug.test is None:
        return []
    file, name = bug.test
    run = cargo(folder, target, "test", "--release", *QUICK_BUILD, "--test", "all", name)
    failed = run.returncode != 0 and f"{name} ... FAILED" in run.stdout
    return [f"tests/{file}.rs: {name}"] if failed else []


def plant(name, work):
    """Returns what turns red with the bug; raises RuntimeError if it cannot be built."""
    folder, target = work / "source", work / "target"
    copy_source(folder)
    if complaint := applies(PATCHES / f"{name}.patch", folder):
        raise RuntimeError(f"the patch does not apply: {complaint}")
    # Cargo may have built other content with the same time before, so the patched files are touched.
    for line in (PATCHES / f"{name}.patch").read_text().splitlines():
        if line.startswith("+++ b/"):
            os.utime(folder / line.removeprefix("+++ b/"))
    build = cargo(folder, target, "build", "--release", *QUICK_BUILD)
    if build.returncode:
        raise RuntimeError("it does not build:\n" + build.stderr[-2000:])
    out = work / name
    out.mkdir(exist_ok=True)
    return red_rows(target / "release/render", out) or red_test(BUGS[name], folder, target)


def main(words=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="only whether every patch applies")
    parser.add_argument("--only", choices=BUGS, action="append", help="this bug alone; may be repeated")
    parser.add_argument("--work", type=Path, default=WORK, help="folder for the copy and what is built")
    arguments = parser.parse_args(words)
    problems = check()
    if arguments.check or problems:
        print(f"{len(BUGS)} patches apply" if not problems else "", *problems, sep="\n  PROBLEM: ")
        return int(bool(problems))
    unseen = []
    for name in arguments.only or BUGS:
        try:
            red = plant(name, arguments.work.resolve())
        except RuntimeError as error:
            red, problems = [], [*problems, f"{name}: {error}"]
        unseen += [] if red else [name]
        told = red[:: -(-len(red) // 3)] if red else ["NOTHING"]  # three, spread over the book
        print(f"{name:30} {BUGS[name].words}\n{'':30}   {len(red)} red, such as {'; '.join(told)}", flush=True)
    print("every bug is seen" if not unseen else "", *problems, *unseen, sep="\n  UNSEEN: ")
    return int(bool(unseen or problems))
