//! Small valid files of every kind and of every variant that is read.

use std::fs;
use std::io::Cursor;
use std::path::{Path, PathBuf};

use base64::prelude::*;
use exr::prelude::{Blocks, Compression, Encoding, Image, LineOrder, SpecificChannels, Vec2, WritableImage, f16};

use super::pictures::{self, L8, L16, LA8, LA16, RGB8, RGB16, RGBA8, RGBA16};

const POINTS: [[f32; 3]; 5] = [[-1., 0., -1.], [1., 0., -1.], [1., 0., 1.], [-1., 0., 1.], [0., 1.5, 0.]];
const FACES: [[u32; 3]; 6] = [[0, 1, 2], [0, 2, 3], [0, 4, 1], [1, 4, 2], [2, 4, 3], [3, 4, 0]];

/// Returns scenes that need no files but those of `tests/messages`, each with its path.
pub fn scenes() -> Vec<(PathBuf, String)> {
    let shipped = fs::read_dir("scenes").expect("there are scenes").map(|entry| entry.expect("readable").path());
    let mut paths: Vec<PathBuf> = shipped.filter(|path| path.extension().is_some_and(|e| e == "toml")).collect();
    paths.sort();
    let text = |path: &Path| fs::read_to_string(path).expect("a scene is text");
    let mut scenes: Vec<_> = paths.into_iter().map(|path| (path.clone(), text(&path))).collect();
    scenes
        .retain(|(_, text)| ![".png", ".jpg", ".exr", ".hdr", ".obj", ".ply", ".gl"].iter().any(|e| text.contains(e)));
    // The scene with everything comes up four times as often as any other.
    for name in ["base", "everything", "everything", "everything", "everything"] {
        let path = Path::new("tests/messages").join(name).with_extension("toml");
        scenes.push((path.clone(), text(&path)));
    }
    scenes
}

pub fn ply() -> Vec<Vec<u8>> {
    let header = |format: &str, corners: &str, more: &str| {
        format!(
            "ply\nformat {format} 1.0\ncomment a pyramid\nelement vertex 5\nproperty float x\nproperty float y\n\
             property float z\n{more}element face 6\n{corners}end_header\n"
        )
    };
    let list = "property list uchar int vertex_indices\n";
    let place = |p: &[f32; 3]| p.map(|x| x.to_string()).join(" ");
    let face = |f: &[u32; 3]| format!("3 {} {} {}\n", f[0], f[1], f[2]);
    let faces: String = FACES.iter().map(face).collect();
    let plain: String = POINTS.iter().map(|p| place(p) + "\n").collect();
    let rich: String = POINTS.iter().map(|p| format!("{} 0 1. -0 .5 0.25 7\n", place(p))).collect();
    let more = "property float nx\nproperty float ny\nproperty float nz\nproperty double u\nproperty double v\n\
                property uchar flags\nelement edge 2\nproperty int a\nproperty list ushort float b\n";
    let mut files = vec![
        header("ascii", list, "") + &plain + &faces,
        header("ascii", list, more) + &rich + "1 2 0.5 0.25\n2 1 3\n" + &faces,
    ];
    files[0] += "\n";
    files.push(
        header("ascii", list, "") + &plain + "6 0 4 1 3 2 4\n" + &faces[faces.find('\n').map_or(0, |end| end + 1)..],
    );
    files.push(
        header("ascii", "property list int int vertex_indices\n", "").replace("face 6", "tristrips 1")
            + &plain
            + "8 0 1 2 3 -1 1 4 2\n",
    );
    let own = "property list uchar int vertex_indices\nproperty list uchar float texcoord\n";
    let pairs: String = FACES.iter().map(|f| face(f).trim_end().to_owned() + " 6 0 0 1 0 0 1\n").collect();
    files.push(header("ascii", own, "") + &plain + &pairs);
    let mut files: Vec<Vec<u8>> = files.into_iter().map(String::into_bytes).collect();
    for big in [false, true] {
        let bytes = |x: u32| if big { x.to_be_bytes() } else { x.to_le_bytes() };
        let format = if big { "binary_big_endian" } else { "binary_little_endian" };
        let points = POINTS.iter().flatten().flat_map(|x| bytes(x.to_bits()));
        for (wide, list) in [(false, list), (true, "property list uint uint vertex_index\n")] {
            let faces = FACES.iter().flat_map(|face| {
                let count = if wide { bytes(3).to_vec() } else { vec![3] };
                count.into_iter().chain(face.iter().flat_map(|&corner| bytes(corner)))
            });
            files.push(header(format, list, "").bytes().chain(points.clone()).chain(faces).collect());
        }
        let empty = header(format, list, "element nothing 3\n");
        let faces = FACES.iter().flat_map(|f| [3].into_iter().chain(f.iter().flat_map(|&c| bytes(c))));
        files.push(empty.bytes().chain(points).chain(faces).collect());
    }
    files
}

pub fn obj() -> Vec<Vec<u8>> {
    let points: String = POINTS.iter().map(|[x, y, z]| format!("v {x} {y} {z}\n")).collect();
    let faces = |corner: &dyn Fn(u32) -> String| -> String {
        FACES.iter().map(|face| format!("f {}\n", face.map(corner).join(" "))).collect()
    };
    let others = "vt 0.5 0.25\nvt 1 0\nvn 0 1 0\nvn 0 0 1\n";
    [
        format!("# a pyramid\no pyramid\n{points}{}", faces(&|i| (i + 1).to_string())),
        format!("{points}{others}g a\ns 1\n{}", faces(&|i| format!("{}/{}/{}", i + 1, i % 2 + 1, i % 2 + 1))),
        format!("{points}{others}{}", faces(&|i| format!("{}//{}", i as i32 - 5, -1))),
        format!("\u{feff}{points}vt 0.5\nf 1 2 \\\n4/1 5 3 # no convex one\r\nf 5 4 1\nfo 2 3 5\n"),
        format!("{points}f 1 2 3 4\nf 1 5 2\nl 1 2\np 3\nmtllib none.mtl\nusemtl none\nf 1 2 5\n"),
    ]
    .map(String::into_bytes)
    .into()
}

pub fn gltf() -> Vec<Vec<u8>> {
    let corners = FACES.iter().flatten().flat_map(|&corner| (corner as u16).to_le_bytes());
    let binary: Vec<u8> = POINTS.iter().flatten().flat_map(|x| x.to_le_bytes()).chain(corners).collect();
    let uri = format!("\"uri\":\"data:application/octet-stream;base64,{}\",", BASE64_STANDARD.encode(&binary));
    let plain = |uri: &str| {
        format!(
            r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],
"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1,"mode":4}}]}}],
"accessors":[{{"bufferView":0,"byteOffset":0,"componentType":5126,"count":5,"type":"VEC3"}},
{{"bufferView":1,"componentType":5123,"count":18,"type":"SCALAR"}}],
"bufferViews":[{{"buffer":0,"byteOffset":0,"byteLength":60,"byteStride":12}},{{"buffer":0,"byteOffset":60,"byteLength":36}}],
"buffers":[{{{uri}"byteLength":96}}]}}"#
        )
    };
    let rich = format!(
        r#"{{"asset":{{"version":"2.0"}},"scenes":[{{"nodes":[1]}}],"extensionsRequired":["KHR_texture_transform"],
"nodes":[{{"mesh":0,"scale":[1,2,-1],"rotation":[0,0.6,0,0.8],"translation":[1,2,3]}},
{{"children":[0,2],"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,1,1]}},{{"mesh":0}}],
"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"NORMAL":2,"TEXCOORD_0":3}},"indices":1,"mode":5,"targets":[{{}}]}}]}}],
"accessors":[{{"bufferView":0,"componentType":5126,"count":5,"type":"VEC3"}},
{{"bufferView":1,"componentType":5121,"count":36,"type":"SCALAR"}},
{{"componentType":5126,"count":5,"type":"VEC3","sparse":{{"count":2,"indices":{{"bufferView":1,"componentType":5121}},"values":{{"bufferView":0}}}}}},
{{"bufferView":0,"componentType":5121,"normalized":true,"count":5,"type":"VEC2"}}],
"bufferViews":[{{"buffer":0,"byteLength":60}},{{"buffer":0,"byteOffset":60,"byteLength":36}}],
"buffers":[{{{uri}"byteLength":96}}],"materials":[{{}}],"animations":[{{}}],"skins":[{{}}]}}"#
    );
    // The vertex indices are read as bytes there, and the high bytes are 0. Enough triangles still have an area.
    vec![
        plain(&uri).into_bytes(),
        rich.replace("\"indices\":{\"bufferView\":1,", "\"indices\":{\"bufferView\":1,\"byteOffset\":1,").into_bytes(),
    ]
}

pub fn glb() -> Vec<Vec<u8>> {
    let text = String::from_utf8(gltf().swap_remove(0)).expect("JSON is text");
    let (before, rest) = text.split_once("\"uri\"").expect("its buffer is embedded");
    let (_, after) = rest.split_once("\",").expect("the address ends");
    let json = format!("{before}{after}");
    let json = format!("{json}{}", " ".repeat(json.len().next_multiple_of(4) - json.len()));
    let corners = FACES.iter().flatten().flat_map(|&corner| (corner as u16).to_le_bytes());
    let binary: Vec<u8> = POINTS.iter().flatten().flat_map(|x| x.to_le_bytes()).chain(corners).collect();
    let number = |n: usize| (n as u32).to_le_bytes();
    let head = [b"glTF".as_slice(), &number(2), &number(28 + json.len() + binary.len()), &number(json.len())].concat();
    vec![[&head, b"JSON".as_slice(), json.as_bytes(), &number(binary.len()), b"BIN\0", &binary].concat()]
}

fn numbers(count: usize) -> Vec<u8> {
    (0..count).map(|i| (i * 37 % 251) as u8).collect()
}

pub fn png() -> Vec<Vec<u8>> {
    let file = |kind: pictures::Kind| pictures::png(6, kind, &numbers(6 * 5 * kind.bytes()));
    let mut files: Vec<Vec<u8>> = [L8, L16, LA8, LA16, RGB8, RGB16, RGBA8, RGBA16].into_iter().map(file).collect();
    files.push(fs::read("tests/messages/dots.png").expect("a palette"));
    files
}

pub fn jpeg() -> Vec<Vec<u8>> {
    let encoded =
        |quality, progressive, bytes: usize| pictures::jpeg([17, 9], quality, progressive, &numbers(17 * 9 * bytes));
    // An Exif directory with one entry, the orientation.
    let exif = b"\xff\xe1\0\x22Exif\0\0MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\x06\0\0\0\0\0\0";
    let plain = encoded(50, false, 3);
    vec![
        [&plain[..2], exif, &plain[2..]].concat(),
        encoded(90, false, 3),
        encoded(30, false, 3),
        encoded(80, false, 1),
        encoded(60, true, 3),
        encoded(60, true, 1),
    ]
}

pub fn hdr() -> Vec<Vec<u8>> {
    let encoded = |width: usize| {
        let texels: Vec<[f32; 3]> = (0..width * 4).map(|i| [i as f32, 0.5, 1.0 / (1 + i) as f32]).collect();
        pictures::radiance(width, &texels)
    };
    // Rows of fewer than 8 texels are not packed, longer ones are. Runs of the older encoding repeat a texel.
    let old = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\nEXPOSURE=2\n\n-Y 2 +X 6\n\x80\x40\x20\x81\x01\x01\x01\x05";
    let old = [old.as_slice(), b"\x80\x40\x20\x81\x01\x01\x01\x05"].concat();
    vec![encoded(3), encoded(16), old]
}

pub fn exr() -> Vec<Vec<u8>> {
    use Compression::{B44, B44A, PIZ, PXR24, RLE, Uncompressed, ZIP1, ZIP16};
    let mut files = Vec::new();
    let mut keep = |image: &dyn Fn(&mut Cursor<&mut Vec<u8>>)| {
        let mut file = Vec::new();
        image(&mut Cursor::new(&mut file));
        files.push(file);
    };
    for (number, compression) in [Uncompressed, RLE, ZIP1, ZIP16, PIZ, PXR24, B44, B44A].into_iter().enumerate() {
        let blocks = if number % 2 == 0 { Blocks::ScanLines } else { Blocks::Tiles(Vec2(4, 4)) };
        let encoding = Encoding { compression, blocks, line_order: LineOrder::Increasing };
        let value = |at: Vec2<usize>| (at.x() as f32 / 8.0, at.y() as f32 / 8.0);
        keep(&|file| {
            let rgba = SpecificChannels::rgba(|at| (value(at).0, value(at).1, 0.5_f32, 1.0_f32));
            let image = Image::from_encoded_channels((9, 7), encoding, rgba);
            image.write().non_parallel().to_buffered(file).expect("an image");
        });
        keep(&|file| {
            let rgb = SpecificChannels::rgb(|at| {
                let (x, y) = value(at);
                (f16::from_f32(x), f16::from_f32(y), f16::from_f32(0.5))
            });
            let image = Image::from_encoded_channels((9, 7), encoding, rgb);
            image.write().non_parallel().to_buffered(file).expect("an image");
        });
    }
    let gray = SpecificChannels::build().with_channel("A").with_channel("Y");
    let pixels = gray.with_pixel_fn(|at: Vec2<usize>| (1.0_f32, at.x() as f32 / 8.0));
    keep(&|file| {
        let image = Image::from_channels((9, 7), pixels.clone());
        image.write().non_parallel().to_buffered(file).expect("an image");
    });
    files
}

pub fn csv() -> Vec<Vec<u8>> {
    [
        "# a paint\nnm, dull, shiny\n400, 0.1, 0.2\n\n500, 0.3, 0.4\n600, 0.35, 0.5\n700, 0.1, 0.9\n",
        "400 0.1 0.5\n450\t0.2\t0.5\n500 0.5 0.5\n710 0.05 0.5\n",
        "\u{feff}wavelength;a;b\n380;0.5;1\n390;0.25;1\n780.5;1e-3;1\n",
    ]
    .map(|text| text.as_bytes().to_vec())
    .into()
}
