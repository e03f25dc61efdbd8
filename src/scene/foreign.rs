//! Files that are given as a scene but are something else.

use std::path::Path;

use crate::error::has_extension;

pub(super) const SCENE_HELP: &str = "a scene is a TOML file, such as scene.toml";
const EXPORT_HELP: &str = "export its meshes as PLY, OBJ or glTF, and write a scene in TOML around them";

/// What files with these extensions are, and what to do with one. `FILE` stands for its name.
const KINDS: [(&[&str], &str, &str); 11] = [
    (&["exr"], "an image", "`render view FILE` shows it; a scene is a TOML file"),
    (
        &["png", "jpg", "jpeg", "hdr"],
        "an image",
        "in a scene, which is a TOML file, write it as { image = \"FILE\" } in place of a color",
    ),
    (
        &["ply", "obj", "gltf", "glb"],
        "a mesh",
        "in a scene, which is a TOML file, write it as shape.mesh = { file = \"FILE\" }; README.md begins with an \
         example",
    ),
    (&["stl", "fbx", "dae", "3ds", "abc"], "a mesh or a scene from another program", EXPORT_HELP),
    (&["pbrt"], "a pbrt scene", EXPORT_HELP),
    (&["blend"], "a Blender file", EXPORT_HELP),
    (&["usd", "usda", "usdc", "usdz"], "a USD scene", EXPORT_HELP),
    (&["pov"], "a POV-Ray scene", EXPORT_HELP),
    (&["xml"], "XML, as Mitsuba scenes are", EXPORT_HELP),
    (
        &["json", "yaml", "yml"],
        "JSON or YAML",
        "a scene is a TOML file: key = value lines below headings such as [camera]",
    ),
    (&["py"], "a program", "`python3 FILE` runs it; a scene is a TOML file"),
];

/// Returns what a file that is not TOML is, judged by its extension, and what to do with it. `shown` is its name in the
/// help.
pub(super) fn foreign(path: &Path, shown: &str) -> Option<(&'static str, String)> {
    let (_, kind, help) = KINDS.iter().find(|(endings, ..)| has_extension(path, endings))?;
    Some((kind, help.replace("FILE", shown)))
}
