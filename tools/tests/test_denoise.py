"""The denoiser adds a layer that is closer to the truth than the image, and leaves the rest of the file as it was.

pytest tools/tests/test_denoise.py
"""

import sys

import check_exr
import denoise
import numpy as np
import pytest
import render

# A red ball and a glass ball on a floor, under a small lamp and a dim sky.
SCENE = """
camera = {{ position = [0, 1.6, 6], look_at = [0, 0.7, 0], vertical_fov = 38 }}
film = {{ width = 128, height = 96, first = "visible"{film} }}
render = {{ seed = 5, model = "rgb" }}
[material]
floor.diffuse.reflectance = {{ rgb = [0.7, 0.5, 0.3] }}
red.plastic = {{ reflectance = {{ rgb = [0.8, 0.1, 0.1] }}, roughness = 0.2 }}
glass.dielectric.index = 1.5
lamp.emissive.radiance = 10
[[object]]
shape.quad = {{ center = [0, 0, 0], u = [4, 0, 0], v = [0, 0, -4] }}
material = "floor"
[[object]]
shape.sphere = {{ center = [-0.9, 0.6, 0.3], radius = 0.6 }}
material = "red"
[[object]]
shape.sphere = {{ center = [0.7, 0.7, 0.6], radius = 0.7 }}
material = "glass"
[[object]]
shape.sphere = {{ center = [-1, 3.5, 1], radius = 0.5 }}
material = "lamp"
[[light]]
environment.radiance = 0.2
"""
FORMS = {
    "plain": "",
    "half": ', precision = "half", compression = "piz"',
    "multipart": ", multipart = true",
    "cropped": ', multipart = true, precision = "half", crop = [20, 11, 61, 50]',
    "overscan": ', overscan = [20, 11, 1, 5]',
}


def noisy(path, film="", **flags):
    render.write(SCENE.format(film=film), path, **{"samples": 4, "layers": "albedo,N,variance", **flags})
    return path


def said(capsys, *arguments):
    """Returns the tool's message as it gives up without printing anything else."""
    with pytest.raises(SystemExit) as given_up:
        denoise.main([str(each) for each in arguments])
    assert capsys.readouterr() == ("", "")
    return given_up.value.code


def test_a_file_that_is_not_there(tmp_path, capsys):
    assert said(capsys, tmp_path / "none.exr").endswith("none.exr: no such file")


def test_a_file_that_is_no_exr(tmp_path, capsys):
    (tmp_path / "scene.exr").write_text(SCENE)
    assert said(capsys, tmp_path / "scene.exr").endswith("scene.exr: not an EXR file")


def test_a_file_that_is_cut_off(tmp_path):
    image = noisy(tmp_path / "image.exr")
    image.write_bytes(image.read_bytes()[:-1000])
    with pytest.raises(SystemExit, match=r"image\.exr: the pixels are damaged or cut off"):
        denoise.main([str(image)])


@pytest.mark.parametrize("layers", ["variance", "albedo", "N"])
def test_missing_layers_are_named_with_the_command_that_makes_them(tmp_path, capsys, layers):
    text = said(capsys, noisy(tmp_path / "image.exr", layers=layers))
    for layer in ("albedo", "N"):
        assert (f"no layer {layer}" in text) == (layer != layers)
    assert "`render SCENE.toml --exr image.exr --layers albedo,N`" in text


def test_colors_that_would_lose_once_more_are_refused(tmp_path, capsys):
    image = noisy(tmp_path / "image.exr", ', multipart = true, compression = "dwaa"')
    told = 'image.exr: colors under dwaa would lose once more: render it with compression = "zip"'
    assert said(capsys, image).endswith(told)


def test_a_missing_package_is_named(tmp_path, capsys, monkeypatch):
    monkeypatch.setitem(sys.modules, "pyoidn", None)
    image = noisy(tmp_path / "image.exr")
    before = image.read_bytes()
    assert denoise.main([str(image)]) == 2
    assert capsys.readouterr().err == "the denoiser is not installed: python -m pip install pyoidn\n"
    assert image.read_bytes() == before


def test_colors_below_zero_are_denoised_as_light_of_their_own():
    color = np.array([[[1, -0.5, 0]]], np.float32)
    assert np.array_equal(denoise.denoised(lambda light, *_, hdr: light * (light >= 0) * hdr, color, None, None), color)


@pytest.mark.parametrize("film", FORMS.values(), ids=FORMS)
def test_all_else_in_the_file_stays_as_it_was(tmp_path, film):
    pytest.importorskip("pyoidn", reason="pyoidn is not installed")
    image, out = noisy(tmp_path / "image.exr", film), tmp_path / "out.exr"
    assert denoise.main([str(image), str(out)]) == 0
    before, after = check_exr.read(image), check_exr.read(out)
    layer = {f"denoised.{name}" for name in "RGB"}
    assert set(after.channels) - set(before.channels) == layer
    for name, pixels in before.channels.items():
        assert (after.channels[name].dtype, after.channels[name].tobytes()) == (pixels.dtype, pixels.tobytes()), name
    for (old, _), (new, _) in zip(before.parts, after.parts, strict=False):
        assert set(old) == set(new)
        assert all(np.array_equal(old[name], new[name]) for name in old if name not in ("channels", "chunkCount"))
    for name in layer:
        assert after.channels[name].dtype == before.channels["R"].dtype
        assert np.isfinite(after.channels[name]).all()
    assert [header.get("name") for header, _ in after.parts[len(before.parts) :]] == ["denoised"] * ("multipart" in film)
    assert set(check_exr.violations(out)) <= {"layer 'denoised': not one that Abbe writes"}
    # A second run replaces the layer, in the file itself.
    once = out.read_bytes()
    assert denoise.main([str(out)]) == 0
    assert out.read_bytes() == once
    assert sorted(path.name for path in tmp_path.iterdir()) == ["image.exr", "image.toml", "out.exr"]


def test_the_denoised_image_is_nearer_to_the_truth(tmp_path):
    pytest.importorskip("pyoidn", reason="pyoidn is not installed")
    image = noisy(tmp_path / "image.exr")
    assert denoise.main([str(image)]) == 0
    truth = render.render(SCENE.format(film=""), samples=256, seed=6).rgb
    channels = render.read(image).channels

    def error(prefix):
        image = np.stack([channels[prefix + name] for name in "RGB"], axis=-1)
        return np.mean((image - truth) ** 2 / (truth**2 + 0.01))

    print(f"relative squared error {error(''):.5f} before, {error('denoised.'):.5f} after")
    assert error("denoised.") < error("") / 3
