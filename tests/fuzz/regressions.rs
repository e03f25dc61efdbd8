//! Files that once did harm, and the messages that refuse them now.

use super::corpus;
use super::readers::{Kind, kinds};
use super::run::{lock_memory, read};

fn kind(name: &str) -> Kind {
    kinds().into_iter().find(|kind| kind.name == name).expect("a kind of file")
}

/// Returns the messages that refuse a file, one for each way to its reader.
fn refusals(kind: &Kind, bytes: &[u8]) -> Vec<String> {
    let refusal = |way| read(kind, bytes, way, "regression").outcome.expect_err("it is damaged");
    (0..kind.ways()).map(refusal).collect()
}

fn replaced(bytes: &[u8], from: &str, to: &str) -> Vec<u8> {
    let at = bytes.windows(from.len()).position(|window| window == from.as_bytes()).expect("it is there");
    [&bytes[..at], to.as_bytes(), &bytes[at + from.len()..]].concat()
}

/// Such elements take no bytes in a binary file, so the end of the file never stopped the reader.
#[test]
fn countless_elements_without_properties_are_passed_over() {
    let _alone = lock_memory();
    let ply = kind("ply");
    let has_nothing = |bytes: &&Vec<u8>| bytes.windows(9).any(|window| window == b"nothing 3");
    let files: Vec<&Vec<u8>> = ply.corpus().iter().filter(has_nothing).collect();
    assert_eq!(files.len(), 2);
    for bytes in files {
        let bytes = replaced(bytes, "nothing 3", "nothing 18446744073709551615");
        assert_eq!(read(&ply, &bytes, 0, "regression").outcome, Ok(()));
    }
}

/// Vertex indices were multiplied before they were compared with the length of their list. They overflowed or led far
/// outside of it.
#[test]
fn corners_far_outside_of_their_lists_are_refused() {
    let _alone = lock_memory();
    let obj = kind("obj");
    let file = |corner: &str| format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\nf 1/1/1 2/1/1 {corner}\n");
    for (corner, what) in [
        ("-9/1/1", "vertex"),
        ("3/-2/1", "texture coordinate"),
        ("3/1/-5", "normal"),
        ("3/1/6148914691236517206", "normal"),
        ("9223372036854775807/1/1", "vertex"),
    ] {
        for refusal in refusals(&obj, file(corner).as_bytes()) {
            assert_eq!(refusal, format!("case.obj: the face in line 6 refers to a {what} that the file does not have"));
        }
    }
    assert_eq!(read(&obj, file("-1/-1/-1").as_bytes(), 1, "regression").outcome, Ok(()));
}

/// Memory was allocated before it was known that the file has no texels.
#[test]
fn a_header_alone_gets_no_memory() {
    let _alone = lock_memory();
    let hdr = kind("hdr");
    let bytes = replaced(corpus::hdr().last().expect("a file"), "-Y 2 +X 6", "-Y 8192 +X 16384");
    for refusal in refusals(&hdr, &bytes) {
        let length = bytes.len();
        let reason = format!("its {length} bytes cannot hold 16384 x 8192 pixels");
        assert_eq!(refusal, format!("case.hdr is not a valid Radiance image ({reason})"));
    }
    let exr = kind("exr");
    for whole in corpus::exr() {
        // The data window of an image of 9 by 7, then that of one of 16384 by 8192.
        let window = |x: i32, y: i32| [[0; 8].as_slice(), &x.to_le_bytes(), &y.to_le_bytes()].concat();
        let at = whole.windows(16).position(|bytes| bytes == window(8, 6)).expect("a window");
        let second = at + 16 + whole[at + 16..].windows(16).position(|bytes| bytes == window(8, 6)).expect("two");
        let mut bytes = whole.clone();
        for at in [at, second] {
            bytes[at..at + 16].copy_from_slice(&window(16383, 8191));
        }
        assert!(refusals(&exr, &bytes)[0].starts_with("case.exr is not a valid OpenEXR image"));
    }
}

/// The reader did not check that there is a first texel.
#[test]
fn an_image_without_texels_is_refused() {
    let _alone = lock_memory();
    for (from, to) in [("-Y 2", "-Y 0"), ("+X 6", "+X 0")] {
        let bytes = replaced(corpus::hdr().last().expect("a file"), from, to);
        for refusal in refusals(&kind("hdr"), &bytes) {
            assert!(refusal.starts_with("case.hdr is not a valid Radiance image ("), "{refusal}");
        }
    }
}

/// Packed 16-bit floats that end too early. The decoder panics if overflow is checked, and reads something otherwise.
#[test]
fn a_decoder_that_panics_stops_nothing() {
    let _alone = lock_memory();
    let (exr, bytes) = (kind("exr"), std::fs::read("tests/fuzz/seeds/short_b44.exr").expect("a seed"));
    for way in 0..exr.ways() {
        if let Err(refusal) = read(&exr, &bytes, way, "regression").outcome {
            assert!(refusal.starts_with("case.exr"), "{refusal}");
        }
    }
}
