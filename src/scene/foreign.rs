//! Files that are given as a scene and are none.

use std::path::Path;

use crate::error::ends_in;

pub(super) const A_SCENE: &str = "a scene is a TOML file, such as scene.toml";
const EXPORT: &str = "export its meshes as PLY, OBJ or glTF, and write a scene in TOML around them";

/// What files of some endings are, and what to do with one; `FILE` is its name.
const KINDS: [(&[&str], &str, &str); 11] = [
    (&["exr"], "an image", "`render view FILE` shows it; a scene is a TOML file"),
    (
        &["png", "jpg", "jpeg", "hdr"],
        "an image",
        "in a scene, which is a TOML file, it stands as { image = \"FILE\" } in place of a color",
    ),
    (
        &["ply", "obj", "gltf", "glb"],
        "a mesh",
        "in a scene, which is a TOML file, it stands as shape.mesh = { file = \"FILE\" }; README.md begins with one",
    ),
    (&["stl", "fbx", "dae", "3ds", "abc"], "a mesh or a scene of another program", EXPORT),
    (&["pbrt"], "a scene of pbrt", EXPORT),
    (&["blend"], "a file of Blender", EXPORT),
    (&["usd", "usda", "usdc", "usdz"], "a scene in USD", EXPORT),
    (&["pov"], "a scene of POV-Ray", EXPORT),
    (&["xml"], "XML, as scenes of Mitsuba are", EXPORT),
    (
        &["json", "yaml", "yml"],
        "JSON or YAML",
        "a scene is a TOML file: keys = values, below headings such as [camera]",
    ),
    (&["py"], "a program", "`python3 FILE` runs it; a scene is a TOML file"),
];

/// What a file that is no TOML is by the ending of its name, and what to do with it; `shown` is what it is called
/// there.
pub(super) fn foreign(path: &Path, shown: &str) -> Option<(&'static str, String)> {
    let (_, what, help) = KINDS.iter().find(|(endings, ..)| ends_in(path, endings))?;
    Some((what, help.replace("FILE", shown)))
}
