"""The renderer from Python: the same bits as the command, in arrays that are not copied.

pytest tools/tests/test_python.py
"""

import copy
import json
import os
import pickle
import shutil
import subprocess
import sys
import threading
import time
import tomllib
from datetime import date

import numpy as np
import pytest
import render

abbe = pytest.importorskip("abbe", reason="the package is not installed: python3 tools/test.py --only wheel")

TURNTABLE = render.ROOT / "examples/turntable.toml"
SMALL = {"film.width": 24, "film.height": 16}
# A sphere in front of a lamp: it has noise, layers and spectra.
SCENE = {
    "camera": {"position": (0, 0, 5), "look_at": np.zeros(3), "vertical_fov": np.float32(40)},
    "film": {"width": 20, "height": np.int64(12)},
    "render": {"samples": 4},
    "material": {"matte": {"diffuse": {"reflectance": {"rgb": [0.2, 0.5, 0.8]}}}},
    "object": [{"shape": {"sphere": {"center": [0, 0, 0], "radius": 1}}, "material": "matte"}],
    "light": [{"environment": {"radiance": 1}}, {"point": {"position": [3, 3, 3], "intensity": 20}}],
}


def with_(**sections):
    return {**SCENE, **sections}


def same(a, b):
    """Asserts that two files have the same channels, bit by bit, and returns the number of channels."""
    a, b = render.read(a), render.read(b)
    assert a.channels.keys() == b.channels.keys()
    for name, pixels in a.channels.items():
        assert pixels.dtype == b.channels[name].dtype and pixels.tobytes() == b.channels[name].tobytes(), name
    return len(a.channels)


# Random paths, dispersion with photons, and interference.
@pytest.mark.parametrize("name", ["cornell", "prism", "coatings"])
def test_a_file_has_the_bits_of_the_command(name, tmp_path):
    scene = render.SCENES / f"{name}.toml"
    by_command, by_python = tmp_path / "command.exr", tmp_path / "python.exr"
    sizes = ["--set", "film.width=40", "--set", "film.height=24"]
    command = [render.binary(), scene, "--exr", by_command, "--samples", "4", "--layers", "all", *sizes]
    subprocess.run(list(map(str, command)), check=True, capture_output=True)
    image = abbe.render(scene, samples=4, layers="all", set={"film.width": 40, "film.height": 24})
    image.write_exr(by_python)
    assert by_command.read_bytes() == by_python.read_bytes()
    assert same(by_command, by_python) > 60


# The scenes that are planned within seconds.
QUICK = sorted(path for path in render.SCENES.glob("*.toml") if path.stem not in ("bubble", "rainbow", "water"))


@pytest.mark.parametrize("path", QUICK, ids=lambda path: path.stem)
def test_a_dict_means_what_its_file_means(path, tmp_path):
    table = tomllib.loads(path.read_text("utf-8"))
    small = {"film.width": 16, "film.height": 9, "render.samples": 1}
    images = [
        abbe.render(path, set=small),
        abbe.render(table, folder=path.parent, set=small),
    ]
    for number, image in enumerate(images):
        image.write_exr(tmp_path / f"{number}.exr")
    assert same(tmp_path / "0.exr", tmp_path / "1.exr") >= 5


def test_arrays_are_those_of_the_file_and_not_copied(tmp_path):
    image = abbe.render(SCENE, layers=["albedo", "N", "UV", "samples", "CryptoObject", "lights"])
    image.write_exr(tmp_path / "a.exr")
    file = render.read(tmp_path / "a.exr").channels
    assert image.rgb.shape == (12, 20, 3) and image.rgb.dtype == np.float32
    assert (image.width, image.height, image.corner) == (20, 12, (0, 0))
    assert np.array_equal(image.rgb, np.stack([file[name] for name in "RGB"], axis=-1))
    for name in ("A", "Z", "R", "albedo.G", "N.X", "UV.V"):
        assert np.array_equal(image[name], file[name]), name
    assert np.array_equal(image["samples"], file["samples.V"]) and (image["samples"] == 4).all()
    assert np.array_equal(image["N"], np.stack([file[f"N.{axis}"] for axis in "XYZ"], axis=-1))
    assert image["CryptoObject00"].shape == (12, 20, 4)
    assert image.layers[:4] == ("beauty", "A", "Z", "albedo") and len(image) == len(list(image)) == len(image.layers)
    assert sum(image[name] for name in image.layers if name.startswith("light_")) == pytest.approx(image.rgb, rel=1e-5)
    address = lambda array: array.__array_interface__["data"][0]  # noqa: E731
    assert address(image.rgb) == address(image.rgb) == address(image["R"])
    assert address(image["N"]) == address(image["N.X"])
    with pytest.raises(ValueError, match="read-only"):
        image.rgb[0, 0] = 0
    assert np.array_equal(image, image.rgb) and np.asarray(image).base is not None


def test_arrays_live_longer_than_their_image():
    rgb = abbe.render(SCENE).rgb
    again = abbe.render(SCENE)
    for _ in range(20):
        abbe.render(SCENE, seed=1)
    assert np.array_equal(rgb, again.rgb) and rgb.any()


def test_spectra_are_those_of_the_file(tmp_path):
    image = abbe.render(SCENE, spectral=True)
    spectrum = image.spectrum(10, 6)
    assert (np.diff(spectrum.wavelengths_nm) > 0).all() and spectrum.radiance.shape == spectrum.wavelengths_nm.shape
    assert image.spectra.radiance.shape == (12, 20, len(spectrum.wavelengths_nm))
    assert not spectrum.wavelengths_nm.flags.writeable
    image.write_spectral_exr(tmp_path / "a.exr")
    file = render.read(tmp_path / "a.exr").channels
    bands = sorted(
        (float(name.split(".")[1].removesuffix("nm").replace(",", ".")), name)
        for name in file
        if name.startswith("S0.")
    )
    assert [nm for nm, _ in bands] == pytest.approx(list(spectrum.wavelengths_nm))
    assert [file[name][6, 10] for _, name in bands] == list(spectrum.radiance)
    with pytest.raises(IndexError, match=r"no pixel \(20, 0\)"):
        image.spectrum(20, 0)
    with pytest.raises(ValueError, match="spectral=True"):
        abbe.render(SCENE).spectrum(0, 0)
    assert image.stokes_spectra is None and abbe.render(SCENE, layers=["S1", "S2", "S3"]).stokes_spectra is None
    # A single band keeps its axis.
    image = abbe.render(with_(film={**SCENE["film"], "spectral": {"from": 550, "to": 550, "step": 10}}))
    assert image.spectra.radiance.shape == (12, 20, 1) and image.spectrum(3, 3).radiance.shape == (1,)


def test_stokes_spectra_are_those_of_the_file(tmp_path):
    glass = with_(material={"matte": {"dielectric": {"index": "N-SF11"}}})
    image = abbe.render(glass, spectral=True, set={"film.stokes": True, "film.spectral": {"from": 400, "to": 700, "step": 100}})
    stokes = image.stokes_spectra
    assert stokes.shape == (12, 20, 3, 4) and np.abs(stokes[..., :2, :]).max() > 0.01 and not stokes.flags.writeable
    image.write_spectral_exr(tmp_path / "a.exr")
    file = render.read(tmp_path / "a.exr").channels
    for number in range(3):
        names = sorted(name for name in file if name.startswith(f"S{number + 1}."))
        assert np.array_equal(stokes[:, :, number], np.stack([file[name] for name in names], axis=-1))


def test_what_is_known_of_a_render_is_what_json_says(tmp_path):
    path = tmp_path / "report.json"
    command = [render.binary(), TURNTABLE, "--exr", tmp_path / "a.exr", "--report", path, "--samples", "2"]
    subprocess.run(
        [*map(str, command), "--set", "film.width=24", "--set", "film.height=16"], check=True, capture_output=True
    )
    account = json.loads(path.read_text("utf-8"))
    stats = abbe.render(TURNTABLE, samples=2, set=SMALL).stats
    plan = {key: value for key, value in account["plan"].items() if key != "kind"}
    assert {**stats["plan"], "processor_seconds": 0, "because": 0} == {**plan, "processor_seconds": 0, "because": 0}
    assert stats.keys() == account["report"].keys() - {"kind"} | {"plan", "warnings"}
    for key in ("samples", "rays", "photons", "dropped", "by_chance", "non_finite", "error"):
        assert stats[key] == account["report"][key], key
    assert stats["samples"] == 2 * 24 * 16 and stats["seconds"] > 0


def test_a_plan_renders_nothing_and_says_why():
    plan = abbe.plan(SCENE)
    assert plan.samples == 4 and plan.model and plan.transport and str(plan) == "\n".join(plan.words)
    assert 0 < plan.seconds <= plan.processor_seconds and plan.left_out == []
    assert abbe.plan(SCENE, threads=1).seconds > 0
    stops = abbe.plan(SCENE, error=0.01)
    assert stops.seconds is None and stops.samples == 65536


def test_an_error_that_is_asked_for_is_reached_and_told():
    image = abbe.render(SCENE, error=0.05, samples=4096)
    error = image.stats["error"]
    assert error["is_reached"] and error["stopped_by"] == "error" and error["at_most"] <= 0.05
    short = abbe.render(SCENE, error=1e-6, time=1)
    assert short.stats["error"]["stopped_by"] == "time"
    assert any("is not reached" in warning for warning in short.stats["warnings"])


def test_progress_is_told_to_the_end():
    told = []
    abbe.render(SCENE, time="1.2s", error=1e-6, progress=told.append)
    assert len(told) >= 2 and told[-1].share == 1 and told[0].share < 1
    assert [one.done for one in told] == sorted(one.done for one in told)
    assert [one.seconds for one in told] == sorted(one.seconds for one in told)
    assert str(told[-1]).startswith("100 %")


def test_what_progress_raises_stops_the_render():
    class Enough(Exception):
        pass

    def progress(so_far):
        raise Enough

    began = time.monotonic()
    with pytest.raises(Enough):
        abbe.render(SCENE, time=60, error=1e-6, progress=progress)
    assert time.monotonic() - began < 10


INTERRUPTED = """
import json, os, signal, sys
import abbe
# A shell that runs the tests in the background has it ignored.
signal.signal(signal.SIGINT, signal.default_int_handler)
interrupt = lambda progress: os.kill(os.getpid(), signal.SIGINT)
try:
    abbe.render(json.loads(sys.argv[1]), samples=1 << 20, checkpoint=sys.argv[2], progress=interrupt)
except KeyboardInterrupt:
    print("stopped")
"""


def test_ctrl_c_stops_a_render_and_leaves_a_checkpoint(tmp_path):
    kept = tmp_path / "a.checkpoint"
    scene = tomllib.loads(TURNTABLE.read_text("utf-8"))
    ask = [sys.executable, "-c", INTERRUPTED, json.dumps(scene), str(kept)]
    # All samples would take hours.
    run = subprocess.run(ask, capture_output=True, text=True, timeout=120, cwd=TURNTABLE.parent)
    assert run.stdout == "stopped\n", run.stderr
    assert kept.stat().st_size > 0
    with pytest.raises(abbe.OptionsError, match=r"already exists from an earlier run \(add resume=True"):
        abbe.render(scene, folder=TURNTABLE.parent, samples=1 << 20, checkpoint=kept)


def test_a_render_that_stopped_goes_on_to_the_same_bits(tmp_path):
    class Enough(Exception):
        pass

    def stop(so_far):
        raise Enough

    kept, scene = tmp_path / "a.checkpoint", with_(film={"width": 64, "height": 48})
    with pytest.raises(Enough):
        abbe.render(scene, samples=1024, checkpoint=kept, progress=stop)
    told = []
    image = abbe.render(scene, samples=1024, checkpoint=kept, resume=True, progress=told.append)
    assert told[-1].share == 1
    assert np.array_equal(image.rgb, abbe.render(scene, samples=1024).rgb)
    # All samples are already there, so nothing is rendered.
    assert np.array_equal(abbe.render(scene, samples=1024, checkpoint=kept, resume=True).rgb, image.rgb)
    with pytest.raises(abbe.OptionsError, match="1024 samples per pixel, more than asked for"):
        abbe.render(scene, samples=16, checkpoint=kept, resume=True)
    with pytest.raises(abbe.OptionsError, match="made from another scene"):
        abbe.render(with_(film={"width": 64, "height": 49}), samples=1024, checkpoint=kept, resume=True)
    with pytest.raises(abbe.OptionsError, match="no checkpoint to resume from"):
        abbe.render(scene, resume=True)


def test_a_finished_image_outlives_its_last_checkpoint(tmp_path):
    folder = tmp_path / "kept"
    folder.mkdir()

    def remove(so_far):
        shutil.rmtree(folder, ignore_errors=True)
        # A file in place of the folder, so that it is not created again.
        folder.touch()

    kept = folder / "a.checkpoint"
    image = abbe.render(SCENE, time="1.5s", error=1e-6, checkpoint=kept, every="1h", progress=remove)
    assert image.rgb.shape == (12, 20, 3)
    assert any("the render is finished, but" in said for said in image.stats["warnings"])


def test_threads_of_python_render_at_once_and_others_go_on():
    scenes = [abbe.Scene(SCENE, set={"render.seed": seed, "render.samples": 64}) for seed in range(4)]
    alone = [abbe.render(scene).rgb for scene in scenes]
    together = [None] * 4
    ticks, stop = [], threading.Event()

    def tick():
        while not stop.wait(0.001):
            ticks.append(None)

    def make(number):
        together[number] = abbe.render(scenes[number], threads=1 + number % 2).rgb

    threads = [threading.Thread(target=make, args=(number,)) for number in range(4)]
    counter = threading.Thread(target=tick)
    counter.start()
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    stop.set()
    counter.join()
    assert ticks and all(np.array_equal(a, b) for a, b in zip(alone, together, strict=True))


FORKED = """
import json, os, sys
import abbe
image = abbe.render(json.loads(sys.argv[1]))
image.write_exr("parent.exr")
child = os.fork()
if not child:
    abbe.render(json.loads(sys.argv[1])).write_exr("child.exr")
    os._exit(0)
print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
"""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="nothing forks here")
def test_a_forked_process_renders_and_writes_as_well(tmp_path):
    # A file of several blocks, which are compressed on several threads.
    scene = tomllib.loads(TURNTABLE.read_text("utf-8")) | {"film": {"width": 400, "height": 300}, "render": {"samples": 1}}
    ask = [sys.executable, "-c", FORKED, json.dumps(scene)]
    run = subprocess.run(ask, capture_output=True, text=True, timeout=60, cwd=tmp_path)
    assert run.stdout == "0\n", run.stderr
    assert (tmp_path / "parent.exr").read_bytes() == (tmp_path / "child.exr").read_bytes()


def test_pictures_show_in_notebooks(tmp_path):
    image = abbe.render(SCENE)
    image.to_png(tmp_path / "a.png")
    assert image._repr_png_() == (tmp_path / "a.png").read_bytes() and image._repr_png_().startswith(b"\x89PNG\r\n")
    image.to_png(tmp_path / "b.png", exposure=2)
    for exposure, said in [(float("nan"), "an exposure is a finite number of"), (True, "exposure is a number, not True")]:
        with pytest.raises(abbe.OptionsError, match=said):
            image.to_png(tmp_path / "c.png", exposure=exposure)
    matplotlib = pytest.importorskip("matplotlib.image")
    dark, bright = (matplotlib.imread(tmp_path / name) for name in ("a.png", "b.png"))
    assert dark.shape == (12, 20, 3) and (bright >= dark).all() and bright.mean() > dark.mean()


def test_words_name_arguments_and_no_flags_of_the_command(tmp_path):
    twins = with_(object=[{**SCENE["object"][0], "name": "twin"}] * 2)
    for told in (abbe.Scene(twins).warnings, abbe.render(twins).stats["warnings"]):
        assert "set cannot tell them apart" in told[0] and "--" not in told[0]
    kept = tmp_path / "a.checkpoint"
    gathered = with_(
        material=SCENE["material"] | {"glass": {"dielectric": {"index": 1.5}}},
        object=[
            SCENE["object"][0] | {"material": "glass"},
            {"shape": {"plane": {"point": [0, -1, 0], "normal": [0, 1, 0]}}, "material": "matte"},
        ],
    )
    abbe.render(gathered, samples=1, checkpoint=kept)
    with pytest.raises(abbe.OptionsError, match="other samples or another error may lead to one"):
        abbe.render(gathered, samples=2, checkpoint=kept, resume=True)


def test_settings_replace_values_and_options_settings():
    image = abbe.render(SCENE, set={"film.width": 8, "object.1.shape.sphere.radius": 2.5, "film.layers": []})
    assert image.rgb.shape == (12, 8, 3) and image["A"].mean() > abbe.render(SCENE)["A"].mean()
    assert abbe.render(SCENE, crop=(4, 2, 6, 5)).rgb.shape == (5, 6, 3)
    whole, wide = abbe.render(SCENE), abbe.render(SCENE, overscan=(1, 2, 3, 4))
    assert wide.rgb.shape == (18, 24, 3) and wide.corner == (-1, -2)
    assert np.array_equal(wide.rgb[2:14, 1:21], whole.rgb)
    assert not np.array_equal(abbe.render(SCENE, seed=5).rgb, whole.rgb)
    scene = abbe.Scene(with_(set={"size": 4}), set={"film.width": "$size"} | {"size": 6})
    assert abbe.render(scene).width == 6
    with pytest.raises(TypeError, match="when it is made"):
        abbe.render(scene, set={"size": 3})
    with pytest.raises(TypeError, match="when it is made"):
        abbe.plan(scene, folder="elsewhere")


@pytest.mark.parametrize(
    "options, said",
    [
        ({"samples": 0}, "a pixel needs at least 1 sample"),
        ({"samples": 2.5}, "samples is a whole number from 1 to 2**32 - 1, not 2.5"),
        ({"samples": True}, "samples is a whole number from 1 to 2**32 - 1, not True"),
        ({"error": True}, "error is a number, not True"),
        ({"overscan": True}, "overscan is one or four whole numbers"),
        ({"overscan": (True, 0, 0, 0)}, "overscan is one or four whole numbers"),
        ({"crop": (0, 0, True, True)}, "crop is four whole numbers: first column, first row, width and height, not (0, 0, T"),
        ({"error": np.True_}, "error is a number, not "),
        ({"time": np.True_}, "time is a number of seconds above 0"),
        ({"set": {"": 1}}, '"" is not the path of a key'),
        ({"seed": -1}, "seed is a whole number from 0 to 2**64 - 1, not -1"),
        ({"crop": (1, 2)}, "crop is four whole numbers: first column, first row, width and height, not (1, 2)"),
        ({"layers": [3]}, "layers is a list of names, not [3]"),
        ({"samples": 2**32}, "samples is a whole number from 1 to 2**32 - 1, not 4294967296"),
        ({"time": [1]}, 'time is a number of seconds above 0 or a string such as "10m", not [1]'),
        ({"every": "x"}, "every is a number of seconds above 0 or a string such as \"10m\", not 'x'"),
        ({"resume": 1}, "resume is True or False, not 1"),
        ({"progress": 3}, "progress is a function, not 3"),
        ({"set": "film.width=16"}, "set is a dict, not 'film.width=16'"),
        ({"set": {1: 2}}, "a key of set is a string, not 1"),
        ({"error": 3}, "a relative error lies between 0.000001 and 1, not 3 (error 0.01 asks for one percent)"),
        ({"time": "soon"}, "time is a number of seconds above 0"),
        ({"time": -1}, "time is a number of seconds above 0"),
        ({"threads": 0}, "a render has 1 to 1024 threads"),
        ({"layers": ["albdo"]}, "there is no layer `albdo`: did you mean albedo?"),
        ({"layers": "albedo"}, 'layers is a list of names (write layers=["albedo"], or "all")'),
        ({"layers": "albedo,N"}, 'layers is a list of names (write layers=["albedo", "N"], or "all")'),
        ({"crop": (0, 0, 0, 0)}, "a crop has at least 1 pixel"),
        ({"overscan": (1, 2)}, "overscan is one or four whole numbers"),
    ],
)
def test_options_that_are_wrong_say_what_to_do(options, said):
    with pytest.raises(abbe.OptionsError) as caught:
        abbe.render(SCENE, **options)
    assert said in str(caught.value) and caught.value.help and isinstance(caught.value, ValueError)
    assert "--" not in str(caught.value)


@pytest.mark.parametrize(
    "ask, said",
    [
        (lambda: abbe.render(SCENE, folder=None), "folder is the path of a file or folder, not None"),
        (lambda: abbe.render(SCENE, checkpoint=3), "checkpoint is the path of a file or folder, not 3"),
        (lambda: abbe.render(SCENE).write_exr(None), "path is the path of a file or folder, not None"),
        (lambda: abbe.read_exr(None), "path is the path of a file or folder, not None"),
        (lambda: abbe.diff("a.exr", 3), "a.exr|an image is the path of a file or folder, not 3"),
        (lambda: abbe.diff(3, "a.exr"), "an image is an abbe.Image, an abbe.ExrImage or the path of a file, not 3"),
        (lambda: abbe.catalog.glass(3), "the name of a glass is a string, not 3"),
        (lambda: abbe.diff(abbe.render(SCENE), abbe.render(SCENE), layer=3), "layer is a string, not 3"),
        (lambda: abbe.render(SCENE)[0, 0], r"the name of a layer is a string, not \(0, 0\)"),
        (lambda: abbe.render(SCENE, spectral=True).spectrum(True, 0), "x is a whole number, not True"),
        (lambda: abbe.render(SCENE, spectral=True).spectrum(0, 1.5), "y is a whole number, not 1.5"),
        (lambda: abbe.render("[camera]\nposition = [0, 0, 5]"), "tomllib.loads makes a dict of its text"),
        (lambda: abbe.render('{"camera": {}}'), "json.loads makes a dict of its text"),
        (lambda: abbe.Scene(abbe.Scene(SCENE)), "this is a scene already"),
        (lambda: pickle.dumps(abbe.render(SCENE)), "an image cannot be pickled: send its arrays, such as image.rgb"),
        (lambda: pickle.dumps(abbe.Scene(SCENE)), "a scene cannot be pickled: send the path or the dict"),
    ],
)
def test_arguments_of_another_type_are_named(ask, said):
    with pytest.raises((TypeError, FileNotFoundError), match=said):
        ask()


def test_a_checkpoint_is_no_folder_and_no_other_file(tmp_path):
    with pytest.raises(abbe.OptionsError, match="the checkpoint .* is a folder"):
        abbe.render(SCENE, checkpoint=tmp_path)
    photo = tmp_path / "photo.jpg"
    photo.write_bytes(b"a photo")
    for resume in (False, True):
        refusal = r"photo.jpg would be overwritten, but it is not a checkpoint \(name an"
        with pytest.raises(abbe.OptionsError, match=refusal):
            abbe.render(SCENE, checkpoint=photo, resume=resume)
    assert photo.read_bytes() == b"a photo"


def test_folders_are_made_and_other_endings_refused(tmp_path):
    image = abbe.render(SCENE, spectral=True)
    image.write_exr(tmp_path / "new/folder/a.exr")
    image.write_spectral_exr(os.fsencode(tmp_path / "spectra/a.exr"))
    image.to_png(tmp_path / "pictures/a.png")
    abbe.read_exr(tmp_path / "new/folder/a.exr").to_png(tmp_path / "others/a.PNG")
    assert sorted(entry.name for entry in tmp_path.iterdir()) == ["new", "others", "pictures", "spectra"]
    for write, name, ending in [
        (image.write_exr, "o.png", "exr"),
        (image.write_spectral_exr, "o", "exr"),
        (image.to_png, "q.jpg", "png"),
        (abbe.read_exr(tmp_path / "new/folder/a.exr").to_png, "q.exr", "png"),
    ]:
        with pytest.raises(abbe.OptionsError, match=rf"the file to write ends in .{ending}, not .*{name}"):
            write(tmp_path / "no" / name)
    assert not (tmp_path / "no").exists()
    with pytest.raises(abbe.OptionsError, match="the file to write has no name"):
        image.write_exr("")


def test_what_an_image_gives_by_name_is_in_it(tmp_path):
    image = abbe.render(SCENE, layers=["albedo"])
    image.write_exr(tmp_path / "a.exr")
    for shown in (image, abbe.read_exr(tmp_path / "a.exr")):
        assert all(name in shown for name in ("beauty", "R", "A", "Z", "albedo", "albedo.R"))
        assert not any(name in shown for name in ("N", "albedo.Q", 3, None))


def test_mattes_of_a_file_have_four_channels(tmp_path):
    image = abbe.render(SCENE, layers=["CryptoObject"])
    image.write_exr(tmp_path / "a.exr")
    names = [name for name in image.layers if name.startswith("Crypto")]
    file = abbe.read_exr(tmp_path / "a.exr")
    assert names and all(np.array_equal(file[name], image[name], equal_nan=True) for name in names)
    assert file[names[0]].shape == (12, 20, 4) and file.rgb.shape == (12, 20, 3)


def test_images_of_two_sizes_are_told_apart():
    large, small = abbe.render(SCENE), abbe.render(SCENE, set={"film.width": 4, "film.height": 4})
    with pytest.raises(abbe.OptionsError, match="the first image has 20 x 12 .*, the second image 4 x 4"):
        abbe.diff(large, small)


def test_masked_arrays_are_refused_and_long_doubles_taken():
    points = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
    faces = np.array([[0, 1, 2]])
    mesh = {"points": points, "faces": faces}
    entry = {"shape": {"mesh": mesh}, "material": "matte"}
    for key, hidden in [("points", np.ma.masked_equal(points, 1)), ("faces", np.ma.masked_equal(faces, 2))]:
        scene = with_(object=[entry | {"shape": {"mesh": mesh | {key: hidden}}}])
        with pytest.raises(abbe.SceneError, match=f"{key}: a scene cannot hold masked values .fill them"):
            abbe.Scene(scene)
    whole = np.ma.masked_array(np.array(points, dtype=float))
    abbe.Scene(with_(object=[entry | {"shape": {"mesh": mesh | {"points": whole}}}]))
    long = np.array([0, 1, 6], dtype=np.longdouble)
    abbe.Scene(with_(object=[{"shape": {"sphere": {"center": [*long], "radius": long[1]}}, "material": "matte"}]))


def test_a_key_that_an_included_file_gives_as_well_is_told_without_a_file_that_is_not_there(tmp_path):
    (tmp_path / "more.toml").write_text("film.width = 3\n")
    with pytest.raises(abbe.SceneError, match="it is also given in the scene itself: keep one of them"):
        abbe.Scene(SCENE | {"include": ["more.toml"]}, folder=tmp_path)


def test_files_that_fail_raise_what_python_raises(tmp_path):
    with pytest.raises(
        FileNotFoundError, match="there is no scene file .*turntabel.toml .did you mean .*turntable.toml"
    ):
        abbe.render(TURNTABLE.with_name("turntabel.toml"))
    with pytest.raises(FileNotFoundError, match="there is no image file"):
        abbe.read_exr(tmp_path / "a.exr")
    (tmp_path / "a.exr").write_text("no image")
    with pytest.raises(abbe.RenderError, match="not a complete OpenEXR image"):
        abbe.read_exr(tmp_path / "a.exr")
    with pytest.raises(abbe.OptionsError, match="turntable.toml is a scene, not an image .*render --plan"):
        abbe.read_exr(TURNTABLE)
    (tmp_path / "file").write_text("")
    with pytest.raises(OSError, match=r"^\[Errno 20\] Not a directory: '.*/file/a.exr'$"):
        abbe.render(SCENE).write_exr(tmp_path / "file/a.exr")


def test_files_are_read_as_others_read_them(tmp_path):
    path = tmp_path / "a.exr"
    image = abbe.render(SCENE, layers=["albedo", "variance"], crop=(2, 3, 10, 6))
    image.write_exr(path)
    file, channels = abbe.read_exr(path), render.read(path).channels
    assert np.array_equal(file.rgb, image.rgb) and np.array_equal(file["Z"], channels["Z"])
    assert set(file.layers) >= {"beauty", "Z", "albedo", "variance"} and "albedo" in file
    assert np.array_equal(file["albedo"], image["albedo"]) and np.array_equal(file["albedo.G"], channels["albedo.G"])
    assert (file.corner, file.format) == ((2, 3), (20, 12))
    assert file.attributes["render/samples"] == "4"
    written = render.read(path).header["worldToCamera"]
    told = np.float32(file.attributes["worldToCamera"].split())
    assert np.array_equal(told, np.ravel(written))
    several = tmp_path / "several.exr"
    abbe.render(with_(film={**SCENE["film"], "multipart": True}), layers=["albedo", "N"]).write_exr(several)
    for name in ("colorInteropID", "render/samples", "screenWindowWidth"):
        assert abbe.read_exr(several).attributes.get(name) == file.attributes.get(name), name
    assert np.array(image, np.float64).dtype == np.float64
    with pytest.raises(ValueError, match="copy"):
        np.array(image, np.float64, copy=False)
    assert repr(file) == "<abbe.ExrImage of 10 x 6 pixels: " + ", ".join(file.layers) + ">"
    file.to_png(tmp_path / "file.png", exposure=1)
    image.to_png(tmp_path / "image.png", exposure=1)
    assert (tmp_path / "file.png").read_bytes() == (tmp_path / "image.png").read_bytes()
    assert file._repr_png_() == image._repr_png_()
    with pytest.raises(KeyError, match="has no layer albdo: did you mean albedo. it has beauty"):
        file["albdo"]


@pytest.mark.parametrize(
    "name, said",
    [
        ("albdo", 'no layer "albdo": did you mean "albedo"? it has beauty, A, Z, albedo'),
        ("albedo.Q", 'did you mean "albedo"?'),
        ("N", 'ask for it with layers=["N"]; it has'),
        ("variance.R", 'ask for it with layers=["variance"]'),
        ("what", 'no layer "what": it has'),
    ],
)
def test_a_layer_that_is_not_there_is_told_with_what_to_do(name, said):
    image = abbe.render(SCENE, layers=["albedo"])
    assert name not in image
    with pytest.raises(KeyError) as caught:
        image[name]
    assert said in caught.value.args[0]


def test_values_too_large_for_16_bits_are_warned_of(tmp_path):
    bright = {"film.precision": "half", "light.1.environment.radiance": 1e5}
    image = abbe.render(SCENE, set=bright)
    with pytest.warns(UserWarning, match="values were too large for 16 bits and became 65504"):
        image.write_exr(tmp_path / "a.exr")


def test_everything_shows_what_it_is():
    image, plan = abbe.render(SCENE, layers=["N"]), abbe.plan(SCENE)
    assert repr(image) == "<abbe.Image of 20 x 12 pixels: beauty, A, Z, N>"
    assert repr(abbe.Scene(SCENE)) == "<abbe.Scene of 1 object, 20 x 12 pixels>"
    assert repr(plan) == f"<abbe.Plan: model {plan.model}, transport random, 4 samples per pixel>"
    assert repr(abbe.catalog.glass("N-BK7")) == "<abbe.catalog.Glass schott/N-BK7>"
    assert "absolute" not in repr(abbe.diff(image, image))
    assert image._ipython_key_completions_() == list(image.layers)
    assert f"{abbe.SceneError.__module__}.{abbe.SceneError.__qualname__}" == "abbe.SceneError"
    assert dir(abbe.catalog) == sorted(abbe.catalog.__all__)
    with pytest.raises(TypeError, match="a scene is a dict, the path of a file or an abbe.Scene, not int"):
        abbe.render(3)


def test_two_images_are_told_apart_by_more_than_their_noise(tmp_path):
    a, b = (abbe.render(SCENE, samples=256, layers=["variance"], seed=seed) for seed in (1, 2))
    brighter = abbe.render(SCENE, samples=256, layers=["variance"], set={"light.2.point.intensity": 24})
    same = abbe.diff(a, a)
    assert same.is_equal and same.agrees and same.layers_apart == []
    noise = abbe.diff(a, b)
    assert noise.agrees and not noise.is_equal and noise.relative_mse > 0 and noise.absolute.shape == (12, 20)
    assert noise.absolute.max() == pytest.approx(np.abs(a.rgb.astype(float) - b.rgb).max())
    apart = abbe.diff(a, brighter)
    assert not apart.agrees and apart.brightness < 1 and max(map(abs, apart.z_of_means)) > 5
    assert abbe.diff(a, brighter, tolerance=10).agrees
    path = tmp_path / "b.exr"
    b.write_exr(path)
    assert abbe.diff(a, path).relative_mse == noise.relative_mse == abbe.diff(a, abbe.read_exr(path)).relative_mse
    for tolerance, said in [(-1, "a tolerance is a finite number, 0 or more"), (True, "tolerance is a number, not True")]:
        with pytest.raises(abbe.OptionsError, match=said):
            abbe.diff(a, b, tolerance=tolerance)
    part = abbe.diff(a, abbe.render(SCENE, samples=256, layers=["variance"], seed=1, crop=(3, 2, 5, 4)))
    assert part.is_part and part.is_equal and part.absolute.shape == (4, 5) and not noise.is_part
    with pytest.raises(abbe.OptionsError, match="images of the same full size can be compared where both have pixels"):
        abbe.diff(a, abbe.render(SCENE, set={"film.width": 8}))


def test_the_catalog_answers_arrays():
    glass = abbe.catalog.glass("N-SF11")
    nm = np.array([[486.1327, 587.5618], [656.2725, 1000.0]])
    n = glass.index(nm)
    assert n.shape == nm.shape and n.dtype == np.float64
    # Schott's data sheet of N-SF11.
    assert n[0, 1] == pytest.approx(1.78472, abs=5e-6) and (n[0, 1] - 1) / (n[0, 0] - n[1, 0]) == pytest.approx(
        25.68, abs=0.005
    )
    assert glass.index(587.5618) == n[0, 1] and isinstance(glass.index(587.5618), float)
    hidden = glass.index(np.ma.array(nm, mask=[[False, True], [False, False]]))
    assert hidden.mask.tolist() == [[False, True], [False, False]] and hidden[0, 0] == n[0, 0]
    assert glass.v_d == pytest.approx(25.68, abs=0.005) and glass.name == "schott/N-SF11" and glass.source
    # CIE 015:2018, table 1: D65 is 100 at 560 nm, and 117.812 at 460 nm.
    light = abbe.catalog.illuminant("D65")
    assert light.power([460, 560, 100]) == pytest.approx([117.8118, 100.0, 0.0], abs=1)
    gold = abbe.catalog.metal("gold")
    assert gold.index([600]).imag[0] > 2 and gold.index(600).real < 1
    patch = abbe.catalog.reflectance("dark skin")
    assert 0 < patch.reflectance(600) < 1 and patch.range_nm[0] < 400
    assert len(abbe.catalog.glasses()) > 1000 and "D65" in abbe.catalog.illuminants() and abbe.catalog.metals()
    with pytest.raises(KeyError, match="there is no glass named .*N-SF111.*did you mean"):
        abbe.catalog.glass("N-SF111")


def test_an_entry_of_the_catalog_stands_for_its_name():
    entries = abbe.catalog.glass("N-BK7"), abbe.catalog.illuminant("FL11"), abbe.catalog.reflectance("dark skin")

    def scene(glass, light, patch):
        return with_(
            material={"matte": {"dielectric": {"index": glass}}, "wall": {"diffuse": {"reflectance": patch}}},
            object=[*SCENE["object"], {"shape": {"disc": {"center": [0, 0, -2], "normal": [0, 0, 1], "radius": 3}}, "material": "wall"}],
            light=[{"environment": {"radiance": {"illuminant": light}}}],
        )

    by_name = abbe.render(scene(*(entry.name for entry in entries))).rgb
    assert np.array_equal(abbe.render(scene(*entries)).rgb, by_name)
    gold = abbe.catalog.metal("gold")
    abbe.Scene(SCENE, set={"material.matte": {"conductor": {"metal": gold}}})
    for entry in (*entries, gold):
        again = pickle.loads(pickle.dumps(entry))
        assert (type(again), again.name, again.range_nm) == (type(entry), entry.name, entry.range_nm)
        assert again == entry and hash(again) == hash(entry) and entry != entry.name
    assert abbe.catalog.glass("schott/N-BK7") == entries[0] != abbe.catalog.glass("N-SF11")


def test_images_and_scenes_are_copied_by_copy():
    image, scene = abbe.render(SCENE), abbe.Scene(SCENE)
    one, other = copy.deepcopy((image, scene))
    assert np.array_equal(one.rgb, image.rgb) and repr(other) == repr(scene) and one.stats == image.stats


def test_errors_can_be_sent_to_other_processes():
    with pytest.raises(abbe.SceneError) as caught:
        abbe.Scene({"camera": {}})
    for error in (caught.value, abbe.OptionsError("no", "do")):
        again = pickle.loads(pickle.dumps(error))
        assert (str(again), type(again), vars(again)) == (str(error), type(error), vars(error))


def test_the_package_imports_nothing_but_numpy():
    code = (
        "import sys, numpy; before = set(sys.modules); import abbe; print(*(m for m in sys.modules if m not in before))"
    )
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split()
    standard = sys.stdlib_module_names
    assert [name for name in said if name.split(".")[0] not in standard | {"abbe", "numpy"}] == []


def test_dates_are_told_of_as_in_a_file():
    with pytest.raises(abbe.SceneError, match="film.width: `width` is a whole number from 1 to 65536, not a date"):
        abbe.Scene(with_(film={"width": date(2024, 1, 1), "height": 3}))


def ball(rings=24):
    """Returns points and faces of a triangulated ball."""
    around, up = np.meshgrid(np.linspace(0, 2 * np.pi, rings, endpoint=False), np.linspace(0, np.pi, rings)[1:-1])
    points = np.stack([np.sin(up) * np.cos(around), np.cos(up), np.sin(up) * np.sin(around)], axis=-1).reshape(-1, 3)
    row, column = map(np.ravel, np.mgrid[: rings - 3, :rings])
    corner = lambda down, right: (row + down) * rings + (column + right) % rings  # noqa: E731
    first = np.stack([corner(0, 0), corner(0, 1), corner(1, 0)], axis=-1)
    return points, np.concatenate([first, np.stack([corner(0, 1), corner(1, 1), corner(1, 0)], axis=-1)])


def mesh_scene(**mesh):
    return with_(object=[{"shape": {"mesh": mesh}, "material": "matte"}])


@pytest.mark.parametrize("kind", [np.float64, np.float32, np.int64])
def test_arrays_of_a_mesh_are_its_lists(kind):
    points, faces = ball()
    points = (1000 * points).astype(kind) if kind == np.int64 else points.astype(kind)
    mesh = {"points": points, "faces": faces.astype(np.uint32), "normals": points, "uv": points[:, :2]}
    lists = {name: array.tolist() for name, array in mesh.items()}
    scenes = [
        abbe.Scene(mesh_scene(**one), set={"camera.position": [0, 0, 5.0 * np.abs(points).max()]})
        for one in (mesh, lists)
    ]
    by_arrays, by_lists = (abbe.render(scene, layers=["N", "UV", "P"]) for scene in scenes)
    assert by_arrays["A"].mean() > 0.1 and len(by_arrays.layers) == 6
    for name in by_arrays:
        assert np.array_equal(by_arrays[name], by_lists[name]), name


def test_faces_of_four_corners_are_two_triangles_each():
    points, rings = ball()[0], 24
    row, column = map(np.ravel, np.mgrid[: rings - 3, :rings])
    first, second = row * rings + column, row * rings + (column + 1) % rings
    corners = np.stack([first, second, second + rings, first + rings], axis=-1)
    triangles = corners[:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3)
    by_quads, by_lists, by_triangles = (
        abbe.render(mesh_scene(points=points, faces=faces)).rgb for faces in (corners, corners.tolist(), triangles)
    )
    assert by_quads.mean() > 0
    assert np.array_equal(by_quads, by_triangles) and np.array_equal(by_quads, by_lists)


def test_arrays_in_a_setting_are_those_of_the_setting():
    points, faces = ball()
    other = mesh_scene(points=points[:3] + 9, faces=np.array([[0, 1, 2]]))
    setting = {"object": mesh_scene(points=points, faces=faces)["object"]}
    plain = abbe.render(mesh_scene(points=points, faces=faces)).rgb
    assert np.array_equal(abbe.render(abbe.Scene(other, set=setting)).rgb, plain)


def test_views_and_other_orders_of_arrays_are_the_same():
    points, faces = ball()
    plain = abbe.render(mesh_scene(points=points, faces=faces)).rgb
    wide = np.repeat(points, 2, axis=1)[:, ::2]
    assert np.array_equal(abbe.render(mesh_scene(points=wide, faces=np.asfortranarray(faces))).rgb, plain)
    assert np.array_equal(abbe.render(mesh_scene(points=points.astype(">f8"), faces=faces.astype(np.int16))).rgb, plain)


@pytest.mark.parametrize(
    "change, said",
    [
        ({"points": np.zeros((5, 2))}, "points: `points` has rows of 3 numbers, not 2"),
        ({"points": np.full((600, 3), np.nan)}, "points: row 0: a coordinate is a finite number, not NaN"),
        ({"points": np.full((600, 3), 1e31)}, "points: row 0: a coordinate lies between -1e30 and 1e30"),
        (
            {"faces": np.array([[0, 1, 2], [0, 9999, 1]])},
            "faces: row 1: there is no point 9999: the 528 points are numbered from 0",
        ),
        ({"faces": np.array([[0, 1, -2]])}, "faces[0][2]: an entry of `faces` is a whole number of 0 or more, not -2"),
        ({"faces": np.array([[0.0, 1.0, 2.0]])}, "faces[0][0]: an entry of `faces` is a whole number"),
        ({"faces": np.array([[0, 1]])}, "faces: each row of `faces` has 3 or more whole numbers"),
        ({"normals": np.zeros((528, 3))}, "normals: row 0: a direction needs a length above 0"),
        ({"uv": np.zeros((3, 2))}, "uv: 528 points need 528 entries of `uv`, not 3"),
        ({"points": np.zeros(9)}, "points[0]"),
        ({"points": np.zeros((0, 3))}, "mesh"),
    ],
)
def test_arrays_of_a_mesh_that_are_wrong_are_told(change, said):
    points, faces = ball()
    with pytest.raises(abbe.SceneError) as caught:
        abbe.Scene(mesh_scene(**{"points": points, "faces": faces, **change}))
    assert f"object[0].shape.mesh.{said}" in str(caught.value) or said == "mesh"


def test_a_checkpoint_knows_the_arrays_of_its_scene(tmp_path):
    points, faces = ball()
    kept = tmp_path / "a.checkpoint"
    abbe.render(mesh_scene(points=points, faces=faces), checkpoint=kept)
    points[0, 0] += 1e-6
    with pytest.raises(abbe.OptionsError, match="made from another scene"):
        abbe.render(mesh_scene(points=points, faces=faces), checkpoint=kept, resume=True)
