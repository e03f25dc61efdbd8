//! The readers of files. Each is reached in the way that a scene reaches it.

use std::fs;
use std::path::PathBuf;

use abbe::Error;
use abbe::scene::Source;

use super::corpus;
use super::mutate::{Dice, mutated_copy, with_checksums, with_lengths};

/// A kind of file.
pub struct Kind {
    pub name: &'static str,
    /// Its share of all cases.
    pub share: usize,
    words: &'static [&'static str],
    corpus: Vec<Vec<u8>>,
    repair: fn(&mut [u8]),
    via: Via,
}

/// How the bytes reach their reader.
enum Via {
    /// The bytes are a scene at one of these paths.
    Scene(Vec<PathBuf>),
    /// The bytes are a file in a folder of its own, which scenes refer to.
    File { path: PathBuf, scenes: Vec<Source> },
}

/// Whether a file was read, or the message of its refusal.
pub type Outcome = Result<(), String>;

const WORLD: &str = "camera = { position = [0, 0, 9], look_at = [0, 0, 0], vertical_fov = 30 }\n\
                     film = { width = 4, height = 4 }\n";
const BALL: &str = "[[object]]\nmaterial = \"a\"\nshape.sphere = { center = [0, 0, 0], radius = 1 }\n";

impl Kind {
    fn of_file(ending: &'static str, share: usize, corpus: Vec<Vec<u8>>, bodies: &[&str]) -> Self {
        let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("fuzz");
        fs::create_dir_all(&folder).expect("a folder");
        let scenes = (bodies.iter())
            .map(|body| {
                let text = format!("{WORLD}{}", body.replace("FILE", &format!("\"case.{ending}\"")));
                Source { path: folder.join("scene.toml"), text }
            })
            .collect();
        let path = folder.join(format!("case.{ending}"));
        let via = Via::File { path, scenes };
        Self { name: ending, share, words: &[], corpus, repair: |_| (), via }
    }

    /// Returns the file with a given number: a damaged copy of one in the corpus.
    pub fn case(&self, number: u64) -> Vec<u8> {
        let seed = self.name.bytes().fold(number, |seed, byte| seed.wrapping_mul(1_000_003) ^ u64::from(byte));
        let mut dice = Dice::new(seed);
        let mut bytes = mutated_copy(&mut dice, &self.corpus, self.words);
        if dice.below(4) > 0 {
            (self.repair)(&mut bytes);
        }
        bytes
    }

    /// Returns the valid files.
    pub fn corpus(&self) -> &[Vec<u8>] {
        &self.corpus
    }

    /// Reads bytes in way `number` of those that this kind has, and checks that a refusal can be displayed.
    pub fn read(&self, bytes: &[u8], number: u64) -> Outcome {
        let choose = |count: usize| (number % count as u64) as usize;
        let (answer, source) = match &self.via {
            Via::Scene(places) => {
                let path = places[choose(places.len())].clone();
                let source = Source { path, text: String::from_utf8_lossy(bytes).into_owned() };
                (source.compile(), source)
            }
            Via::File { path, scenes } => {
                fs::write(path, bytes).expect("the folder can be written");
                let source = &scenes[choose(scenes.len())];
                let answer = source.compile();
                // Files that are removed at once are never written to the disk. A program that is stopped leaves one
                // behind.
                fs::remove_file(path).expect("the file is there");
                (answer, source.clone())
            }
        };
        match answer {
            Ok(_) => Ok(()),
            Err(Error::Scene(mistakes)) => {
                let whole = |at: usize| at <= source.text.len() && source.text.is_char_boundary(at);
                for mistake in &mistakes {
                    assert!(!mistake.message.is_empty() && !mistake.message.contains('\n'), "{mistake:?}");
                    assert!(mistake.span.start <= mistake.span.end, "{mistake:?}");
                    assert!(whole(mistake.span.start) && whole(mistake.span.end), "{mistake:?}");
                }
                Err(mistakes.into_iter().next().expect("a scene is refused for a reason").message)
            }
            Err(other) => panic!("a file is refused with its place in the scene, not with {other:?}"),
        }
    }

    /// Returns the number of ways to read this kind.
    pub fn ways(&self) -> u64 {
        match &self.via {
            Via::Scene(places) => places.len() as u64,
            Via::File { scenes, .. } => scenes.len() as u64,
        }
    }
}

const SCENE_WORDS: [&str; 44] = [
    "camera",
    "film",
    "render",
    "material",
    "object",
    "light",
    "shape",
    "sphere",
    "cube",
    "quad",
    "disc",
    "plane",
    "triangle",
    "mesh",
    "transform",
    "instances",
    "translate",
    "rotate",
    "scale",
    "matrix",
    "diffuse",
    "mirror",
    "conductor",
    "dielectric",
    "plastic",
    "mix",
    "mask",
    "emissive",
    "thin",
    "coat",
    "roughness",
    "index",
    "absorption",
    "reflectance",
    "radiance",
    "rgb",
    "samples",
    "file",
    "image",
    "checker",
    "lines",
    "illuminant",
    "[[object]]\n",
    "\"\"\"",
];
const PLY_WORDS: [&str; 20] = [
    "char",
    "uchar",
    "short",
    "ushort",
    "int",
    "uint",
    "float",
    "double",
    "list",
    "property",
    "element",
    "face",
    "tristrips",
    "vertex",
    "x",
    "vertex_indices",
    "ascii",
    "comment",
    "obj_info",
    "end_header\n",
];
const OBJ_WORDS: [&str; 10] = ["v", "vt", "vn", "f", "l", "p", "g", "usemtl", "\\\n", "//"];
const GLTF_WORDS: [&str; 22] = [
    "nodes",
    "children",
    "mesh",
    "meshes",
    "matrix",
    "scale",
    "rotation",
    "primitives",
    "attributes",
    "indices",
    "mode",
    "accessors",
    "bufferView",
    "byteOffset",
    "byteLength",
    "byteStride",
    "count",
    "SCALAR",
    "VEC2",
    "MAT4",
    "sparse",
    "null",
];
const EXR_WORDS: [&str; 14] = [
    "channels",
    "chlist",
    "compression",
    "dataWindow",
    "displayWindow",
    "lineOrder",
    "tiles",
    "tiledesc",
    "box2i",
    "chunkCount",
    "R",
    "Y",
    "deepscanline",
    "name",
];
const CSV_WORDS: [&str; 6] = ["nan", ",", ";", "\t", "#", "\n"];

/// Returns every kind of file that is read.
pub fn kinds() -> Vec<Kind> {
    let (places, scenes): (Vec<_>, Vec<_>) =
        corpus::scenes().into_iter().map(|(path, text)| (path, text.into_bytes())).unzip();
    let matt = "[material.a]\ndiffuse.reflectance = 0.5\n[[object]]\nmaterial = \"a\"\nshape.mesh.file = FILE\n";
    let smooth = "[material.a]\ndielectric.index = 1.5\n[[object]]\nmaterial = \"a\"\n\
                  shape.mesh = { file = FILE, smooth = true }\n\
                  instances = [[], [{ translate = [5, 0, 0] }]]\n";
    let lamp = "[material.a]\nemissive.radiance = 3\n[[object]]\nmaterial = \"a\"\nshape.mesh.file = FILE\n\
                transform = [{ scale = [1, 2, 0.5] }]\n";
    let meshes = [matt, smooth, lamp];
    let paper = format!("[material.a]\ndiffuse.reflectance = {{ image = FILE }}\n{BALL}");
    let part =
        format!("[material.a]\ndiffuse.reflectance = {{ image = FILE, channel = \"alpha\", scale = 0.1 }}\n{BALL}");
    let dents = format!("[material.a]\ndiffuse.reflectance = 0.5\n{BALL}bump_map = {{ image = FILE, depth = 0.1 }}\n");
    let bent = format!("[material.a]\ndiffuse.reflectance = 0.5\n{BALL}normal_map = {{ image = FILE }}\n");
    let sky = "[[light]]\nenvironment.radiance = { image = FILE }\n".to_owned();
    let textures = [paper.as_str(), part.as_str(), dents.as_str(), bent.as_str()];
    let floats = [paper.as_str(), part.as_str(), dents.as_str(), bent.as_str(), sky.as_str()];
    let paint = format!("[material.a]\ndiffuse.reflectance = {{ file = FILE, column = 3 }}\n{BALL}");
    let glass = format!("[material.a]\ndielectric = {{ index = {{ file = FILE, scale = 3 }} }}\n{BALL}");
    let metal = format!("[material.a]\nconductor = {{ n = {{ file = FILE }}, k = {{ file = FILE }} }}\n{BALL}");
    let glow = format!("[material.a]\nemissive.radiance = {{ file = FILE, luminance = 2 }}\n{BALL}");
    let curves = [paint.as_str(), glass.as_str(), metal.as_str(), glow.as_str()];
    vec![
        Kind { name: "toml", share: 25, words: &SCENE_WORDS, corpus: scenes, repair: |_| (), via: Via::Scene(places) },
        Kind { words: &PLY_WORDS, ..Kind::of_file("ply", 13, corpus::ply(), &meshes) },
        Kind { words: &OBJ_WORDS, ..Kind::of_file("obj", 12, corpus::obj(), &meshes) },
        Kind { words: &GLTF_WORDS, ..Kind::of_file("gltf", 10, corpus::gltf(), &meshes) },
        Kind { words: &GLTF_WORDS, repair: with_lengths, ..Kind::of_file("glb", 8, corpus::glb(), &meshes) },
        Kind { repair: with_checksums, ..Kind::of_file("png", 8, corpus::png(), &textures) },
        Kind::of_file("jpg", 6, corpus::jpeg(), &textures),
        Kind { words: &EXR_WORDS, ..Kind::of_file("exr", 8, corpus::exr(), &floats) },
        Kind::of_file("hdr", 5, corpus::hdr(), &floats),
        Kind { words: &CSV_WORDS, ..Kind::of_file("csv", 5, corpus::csv(), &curves) },
    ]
}
