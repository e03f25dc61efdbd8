"""Renders a scene file of Abbe in Blender's Cycles (the package bpy), on one thread of the processor.

    picture = cycles.Renderer("CPU", Path("scene.toml")).picture(samples=64, seed=1)

Without denoising, clamping, blurring or adaptive sampling; paths of up to 1024 surfaces. Cycles has no dispersion.
"""

import tempfile
from pathlib import Path

import numpy as np
from .scene import lights, parts, read, rgb, shapes, triangles

DEPTH = 1024


class Renderer:
    """A scene in bpy, whose state is global."""

    def __init__(self, device: str, path: Path, flat_lamp: bool = False):
        import bpy

        self.bpy = bpy
        bpy.ops.wm.read_factory_settings(use_empty=True)
        scene = read(path)
        self.scene = bpy.context.scene
        set_up(self.scene, scene["film"])
        set_camera(bpy, self.scene, scene["camera"], scene["film"])
        set_sky(bpy, self.scene, lights(scene, "environment"))
        for sun in lights(scene, "sun"):
            add_sun(bpy, self.scene, sun)
        materials = {name: material(bpy, name, entry) for name, entry in scene["material"].items()}
        for kind, values, name in shapes(scene, flat_lamp):
            add(bpy, self.scene, triangles(kind, values, path.parent), materials[name])

    def picture(self, samples: int, seed: int) -> np.ndarray:
        import render

        self.scene.cycles.samples, self.scene.cycles.seed = samples, seed
        with tempfile.TemporaryDirectory() as folder:
            self.scene.render.filepath = f"{folder}/picture.exr"
            self.bpy.ops.render.render(write_still=True)
            return render.read(self.scene.render.filepath).rgb


def set_up(scene, film: dict) -> None:
    """Sets up Cycles without anything that trades correctness for a smoother picture."""
    scene.render.engine = "CYCLES"
    settings = {
        "device": "CPU",
        "use_adaptive_sampling": False,
        "use_denoising": False,
        "sample_clamp_direct": 0.0,
        "sample_clamp_indirect": 0.0,
        "blur_glossy": 0.0,
        "caustics_reflective": True,
        "caustics_refractive": True,
        "pixel_filter_type": "BOX",
        "light_sampling_threshold": 0.0,
        "transparent_max_bounces": DEPTH,
        "max_bounces": DEPTH,
        **{f"{kind}_bounces": DEPTH for kind in ("diffuse", "glossy", "transmission")},
    }
    for name, value in settings.items():
        setattr(scene.cycles, name, value)
    render = scene.render
    render.resolution_x, render.resolution_y, render.resolution_percentage = film["width"], film["height"], 100
    render.threads_mode, render.threads = "FIXED", 1
    render.image_settings.file_format, render.image_settings.color_depth = "OPEN_EXR", "32"
    render.use_persistent_data = True


def set_camera(bpy, scene, values: dict, film: dict) -> None:
    camera = bpy.data.cameras.new("camera")
    camera.sensor_fit, camera.angle = "VERTICAL", np.radians(values["vertical_fov"])
    camera.clip_start, camera.clip_end = values.get("near", 1e-2), 1e6
    position = np.array(values["position"], float)
    backward = position - np.array(values["look_at"], float)
    backward /= np.linalg.norm(backward)
    right = np.cross(values.get("up", [0, 1, 0]), backward)
    right /= np.linalg.norm(right)
    matrix = np.eye(4)
    matrix[:3] = np.stack([right, np.cross(backward, right), backward, position], axis=1)
    scene.camera = bpy.data.objects.new("camera", camera)
    scene.camera.matrix_world = matrix.T.tolist()
    scene.collection.objects.link(scene.camera)


def set_sky(bpy, scene, skies: list) -> None:
    scene.world = bpy.data.worlds.new("sky")
    scene.world.use_nodes = True
    background = scene.world.node_tree.nodes["Background"]
    color = rgb(skies[0]["radiance"]) if skies else [0.0] * 3
    background.inputs["Color"].default_value = [*color, 1]


def add_sun(bpy, scene, values: dict) -> None:
    sun = bpy.data.lights.new("sun", "SUN")
    sun.energy, sun.color = 1.0, rgb(values["irradiance"])
    sun.angle = np.radians(values.get("angular_diameter", 0.533))
    light = bpy.data.objects.new("sun", sun)
    backward = np.array(values["toward"], float) / np.linalg.norm(values["toward"])
    right = np.cross(np.roll(backward, 1), backward)
    right /= np.linalg.norm(right)
    matrix = np.eye(4)
    matrix[:3, :3] = np.stack([right, np.cross(backward, right), backward], axis=1)
    light.matrix_world = matrix.T.tolist()
    scene.collection.objects.link(light)


def pane(tree, node, index: float):
    """Returns a shader for a pane with a transparent shadow. Its two surfaces together reflect 2 R / (1 + R)."""
    made = lambda kind, operation: setattr(one := tree.nodes.new(kind), "operation", operation) or one  # noqa: E731
    # The Fresnel node inverts the index on the back. Inverting it here as well makes a pane the same from both sides.
    back, inverse, fresnel = tree.nodes.new("ShaderNodeNewGeometry"), made("ShaderNodeMath", "POWER"), node("ShaderNodeFresnel")
    sign = made("ShaderNodeMath", "MULTIPLY_ADD")
    tree.links.new(back.outputs["Backfacing"], sign.inputs[0])
    sign.inputs[1].default_value, sign.inputs[2].default_value = -2.0, 1.0
    inverse.inputs[0].default_value = index
    tree.links.new(sign.outputs[0], inverse.inputs[1])
    tree.links.new(inverse.outputs[0], fresnel.inputs["IOR"])
    twice, more, share = (made("ShaderNodeMath", operation) for operation in ("MULTIPLY", "ADD", "DIVIDE"))
    twice.inputs[1].default_value, more.inputs[1].default_value = 2.0, 1.0
    for sum_ in (twice, more):
        tree.links.new(fresnel.outputs[0], sum_.inputs[0])
    tree.links.new(twice.outputs[0], share.inputs[0])
    tree.links.new(more.outputs[0], share.inputs[1])
    mix, through = tree.nodes.new("ShaderNodeMixShader"), tree.nodes.new("ShaderNodeBsdfTransparent")
    mirror = node("ShaderNodeBsdfAnisotropic", Roughness=0.0)
    mirror.inputs["Color"].default_value = [1, 1, 1, 1]
    tree.links.new(share.outputs[0], mix.inputs[0])
    tree.links.new(through.outputs[0], mix.inputs[1])
    tree.links.new(mirror.outputs[0], mix.inputs[2])
    return mix


def material(bpy, name: str, entry: dict):
    """Returns the material as a tree of shader nodes."""
    kind, values = parts(entry)
    result = bpy.data.materials.new(name)
    result.use_nodes = True
    tree = result.node_tree
    tree.nodes.clear()
    out = tree.nodes.new("ShaderNodeOutputMaterial")

    def node(kind: str, **inputs):
        made = tree.nodes.new(kind)
        for key, value in inputs.items():
            made.inputs[key].default_value = value
        return made

    if kind == "diffuse":
        shader = node("ShaderNodeBsdfDiffuse", Color=[*rgb(values["reflectance"]), 1], Roughness=0.0)
    elif kind == "mirror":
        shader = node("ShaderNodeBsdfAnisotropic", Color=[*rgb(values["reflectance"]), 1], Roughness=0.0)
    elif kind == "dielectric":
        color = [*rgb(values.get("transmittance", 1.0)), 1]
        shader = node("ShaderNodeBsdfGlass", Color=color, Roughness=0.0, IOR=float(values["index"]))
    elif kind == "thin":
        shader = pane(tree, node, float(values["index"]))
    else:
        shader = node("ShaderNodeEmission", Color=[*rgb(values["radiance"]), 1], Strength=1.0)
        if values.get("sides") == "front":
            mix, back = tree.nodes.new("ShaderNodeMixShader"), tree.nodes.new("ShaderNodeNewGeometry")
            black = node("ShaderNodeBsdfDiffuse", Color=[0, 0, 0, 1])
            tree.links.new(back.outputs["Backfacing"], mix.inputs[0])
            tree.links.new(shader.outputs[0], mix.inputs[1])
            tree.links.new(black.outputs[0], mix.inputs[2])
            shader = mix
    tree.links.new(shader.outputs[0], out.inputs["Surface"])
    return result


def add(bpy, scene, mesh: tuple, of) -> None:
    points, faces, normals = mesh
    data = bpy.data.meshes.new("mesh")
    data.vertices.add(len(points))
    data.vertices.foreach_set("co", np.asarray(points, np.float32).ravel())
    data.loops.add(3 * len(faces))
    data.loops.foreach_set("vertex_index", np.asarray(faces, np.int32).ravel())
    data.polygons.add(len(faces))
    data.polygons.foreach_set("loop_start", np.arange(0, 3 * len(faces), 3, dtype=np.int32))
    data.update(calc_edges=True)
    data.polygons.foreach_set("use_smooth", np.full(len(faces), normals is not None))
    data.materials.append(of)
    scene.collection.objects.link(bpy.data.objects.new("object", data))
