"""Blender's compositor reads the files: the image by itself, every layer as a socket, every object by its matte.

    python3.11 -m venv ~/blender
    ~/blender/bin/pip install bpy==5.0.1 OpenEXR==3.5.3 numpy pytest
    RENDER=target/release/render ~/blender/bin/python -m pytest tools/tests/test_blender.py

The package bpy has some 370 MB and is for one version of Python; where it is not installed, these tests are skipped.
"""

import check_exr
import numpy as np
import pytest
from layered_scene import CROP, HEIGHT, LAYERS, WIDTH, Form, read, rendered

bpy = pytest.importorskip("bpy", reason="Blender is not installed as the package bpy")

ALONE = Form(layers=False)
TOGETHER = Form()
APART = Form(multipart=True)
SOCKETS = {"RGB": "RGBA", "rgba": "RGBA", "XYZ": "VECTOR", "UV": "VECTOR", "V": "VALUE"}
OBJECTS = ("floor", "ball", "стекло", "cubes [1]", "cubes [2]", "key lamp")


class Compositor:
    """An empty Blender scene that outputs a socket of one of two nodes that read a file."""

    def __init__(self, form, folder):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        self.scene, self.out = bpy.context.scene, folder / "out.exr"
        self.scene.render.engine, self.scene.cycles.samples = "CYCLES", 1
        self.scene.render.resolution_x, self.scene.render.resolution_y = WIDTH, HEIGHT
        self.scene.render.filepath = str(self.out)
        settings = self.scene.render.image_settings
        settings.file_format, settings.color_depth, settings.color_mode = "OPEN_EXR", "32", "RGBA"
        self.scene.camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
        self.scene.collection.objects.link(self.scene.camera)
        self.tree = bpy.data.node_groups.new("tree", "CompositorNodeTree")
        self.scene.compositing_node_group = self.tree
        self.tree.interface.new_socket(name="Image", in_out="OUTPUT", socket_type="NodeSocketColor")
        self.output = self.tree.nodes.new("NodeGroupOutput")
        self.file = bpy.data.images.load(str(rendered(form)))
        self.image = self.tree.nodes.new("CompositorNodeImage")
        self.image.image = self.file

    def sockets(self):
        """Returns the kind of each socket of the file, by name."""
        return {socket.name: socket.type for socket in self.image.outputs}

    def pixels(self, socket):
        """Returns what comes out of a socket: red, green, blue and alpha."""
        self.tree.links.clear()
        self.tree.links.new(socket, self.output.inputs[0])
        bpy.ops.render.render(write_still=True)
        channels = check_exr.read(self.out).channels
        return np.stack([channels[name] for name in "RGBA"])

    def matte(self, layer, name):
        """Returns the matte of a name, as the Cryptomatte node extracts it."""
        node = self.tree.nodes.new("CompositorNodeCryptomatteV2")
        node.source, node.image, node.layer_name, node.matte_id = "IMAGE", self.file, layer, name
        return self.pixels(node.outputs["Matte"])[0]


def test_a_plain_file_opens_as_an_image_of_its_size(tmp_path):
    image = Compositor(ALONE, tmp_path).file
    assert (image.type, image.channels, tuple(image.size)) == ("IMAGE", 4, (WIDTH, HEIGHT))
    assert image.is_float and image.colorspace_settings.name == "Linear Rec.709"
    # Blender's first row is the lowest.
    pixels = np.array(image.pixels[:], np.float32).reshape(HEIGHT, WIDTH, 4)[::-1]
    for i, name in enumerate("RGBA"):
        assert np.array_equal(pixels[..., i], read(ALONE).channels[name]), name


@pytest.mark.parametrize("precision", ["float", "half"])
@pytest.mark.parametrize("multipart", [False, True])
def test_every_layer_is_a_socket_of_its_kind(tmp_path, precision, multipart):
    sockets = Compositor(Form(precision=precision, multipart=multipart), tmp_path).sockets()
    for layer, (channels, _) in LAYERS.items():
        assert sockets[layer] == SOCKETS[channels], layer
    image, depth = ("image", "depth") if multipart else ("Combined", "Depth")
    assert (sockets.get(image), sockets.get(depth)) == ("RGBA", "VALUE")


@pytest.mark.parametrize("form", [TOGETHER, APART], ids=str)
def test_every_layer_has_its_numbers(tmp_path, form):
    compositor = Compositor(form, tmp_path)
    for layer, (channels, _) in LAYERS.items():
        seen = compositor.pixels(compositor.image.outputs[layer])
        for i, channel in enumerate(channels):
            assert np.array_equal(seen[i], read(form).channels[f"{layer}.{channel}"]), (layer, channel)


@pytest.mark.parametrize("form", [TOGETHER, APART], ids=str)
def test_the_image_and_its_depth_have_their_numbers(tmp_path, form):
    compositor = Compositor(form, tmp_path)
    image, depth = ("image", "depth") if form.multipart else ("Combined", "Depth")
    seen = compositor.pixels(compositor.image.outputs[image])
    for i, name in enumerate("RGBA"):
        assert np.array_equal(seen[i], read(form).channels[name]), name
    assert np.array_equal(compositor.pixels(compositor.image.outputs[depth])[0], read(form).channels["Z"])


@pytest.mark.parametrize("form", [TOGETHER, APART, Form(precision="half", compression="piz", multipart=True)], ids=str)
def test_the_cryptomatte_node_cuts_out_every_object(tmp_path, form):
    compositor = Compositor(form, tmp_path)
    numbers, shares = check_exr.matte(read(form), "CryptoObject")
    for name in OBJECTS:
        own = np.where(numbers == check_exr.matte_number(name), shares, 0).sum(axis=0)
        assert own.any(), name
        assert np.abs(compositor.matte("CryptoObject", name) - own).max() <= 1e-6, name
    for layer, name in (("CryptoMaterial", "red"), ("CryptoAsset", "cubes")):
        numbers, shares = check_exr.matte(read(form), layer)
        own = np.where(numbers == check_exr.matte_number(name), shares, 0).sum(axis=0)
        assert own.any(), name
        assert np.abs(compositor.matte(layer, name) - own).max() <= 1e-6, name


def test_a_crop_opens_as_an_image_of_its_pixels_alone(tmp_path):
    """Blender ignores the display window, so the position of the crop in the image is lost."""
    form = Form(layers=False, crop=True)
    image = Compositor(form, tmp_path).file
    assert tuple(image.size) == CROP[2:]
    pixels = np.array(image.pixels[:], np.float32).reshape(CROP[3], CROP[2], 4)[::-1]
    assert np.array_equal(pixels[..., 0], read(form).channels["R"])
