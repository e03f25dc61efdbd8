//! Files that are truncated, changed or claim too much: none stops the program, and none is trusted.

#[allow(dead_code)]
#[path = "../fuzz/corpus.rs"]
mod corpus;
#[allow(dead_code)]
#[path = "../fuzz/mutate.rs"]
mod mutate;

use abbe::Error;
use abbe::film::ExrFile;
use exr::meta::MetaData;
use exr::prelude::Compression;

use super::files::{Exr, ramp};
use crate::support::pictures;
use crate::support::run::Folder;

/// Reads damaged bytes. If they are still a valid file, looks at everything in it.
fn inspect(folder: &Folder, bytes: &[u8]) -> Result<(), String> {
    folder.write("case.exr", bytes);
    match ExrFile::read(folder.path_of("case.exr")) {
        Ok(file) => {
            for layer in file.layers() {
                layer.channels.iter().for_each(|channel| assert!(channel.statistics().finite <= 1 << 20));
            }
            Ok(())
        }
        Err(Error::Decode { message, .. }) => Err(message),
        Err(other) => panic!("a damaged file is no complete image, not {other:?}"),
    }
}

fn layered_file() -> Exr {
    let mut image = ramp();
    image.texts.push(("colorInteropID", "lin_rec709_scene".into()));
    image.parts = ["first", "second"].map(|name| (name, image.parts[0].1.clone())).to_vec();
    image
}

#[test]
fn files_that_are_cut_off_anywhere_are_refused() {
    let folder = Folder::new();
    for image in [ramp(), layered_file()] {
        let whole = image.bytes();
        assert_eq!(inspect(&folder, &whole), Ok(()));
        for length in 0..whole.len() {
            assert!(inspect(&folder, &whole[..length]).is_err(), "{length} of {} bytes", whole.len());
        }
    }
}

#[test]
fn files_with_changed_bytes_are_read_or_refused() {
    let folder = Folder::new();
    for image in [ramp(), layered_file()] {
        let whole = image.bytes();
        let mut refused = 0;
        for at in 4..whole.len() {
            for value in [0, 255, whole[at] ^ 128, whole[at].wrapping_add(1)] {
                let mut bytes = whole.clone();
                bytes[at] = value;
                refused += usize::from(inspect(&folder, &bytes).is_err());
            }
        }
        assert!(refused > whole.len(), "{refused}");
    }
}

/// Scan lines and tiles of every compression, damaged as the fuzzer damages scenes.
#[test]
fn damaged_files_of_every_kind_are_read_or_refused() {
    let (folder, files) = (Folder::new(), corpus::exr());
    for file in &files {
        assert_eq!(inspect(&folder, file), Ok(()));
    }
    let mut dice = mutate::Dice::new(1);
    let read = (0..1000).filter(|_| inspect(&folder, &mutate::mutated_copy(&mut dice, &files, &[])).is_ok()).count();
    assert!((50..950).contains(&read), "{read}");
}

/// A block starts with a version and the packed and unpacked sizes of its parts in bytes.
#[test]
fn a_block_that_claims_more_than_the_image_is_refused_before_memory_is_asked_for() {
    let folder = Folder::new();
    let values: Vec<f32> = (0..4096).map(|i| 0.01 * (i % 64) as f32).collect();
    let channels = ["R", "G", "B"].map(|name| (name, values.clone())).to_vec();
    let image = Exr { compression: Compression::DWAA(None), half: true, ..Exr::new([64, 64], channels) };
    let whole = image.bytes();
    assert_eq!(inspect(&folder, &whole), Ok(()));
    let mut rest = std::io::Cursor::new(&whole);
    MetaData::read_from_buffered(&mut rest, false).expect("it has a head");
    let offsets = rest.position() as usize;
    let block = u64::from_le_bytes(whole[offsets..offsets + 8].try_into().expect("8 bytes")) as usize + 8;
    for number in 1..10 {
        let mut bytes = whole.clone();
        bytes[block + 8 * number..block + 8 * number + 8].copy_from_slice(&(1_u64 << 50).to_le_bytes());
        let refusal = inspect(&folder, &bytes).expect_err("no block is so large");
        assert!(refusal.contains("a block claims to be larger than the image"), "{refusal}");
    }
}

/// Returns a ramp whose first channel claims to have half the size.
pub fn subsampled() -> Vec<u8> {
    let mut bytes = ramp().bytes();
    let name = b"channels\0chlist\0";
    let list = bytes.windows(name.len()).position(|window| window == name).expect("channels") + name.len() + 4;
    // The one-letter name of the first channel is followed by its type, 4 bytes, and the sampling steps along both
    // axes.
    for axis in [0, 4] {
        bytes[list + 10 + axis..list + 14 + axis].copy_from_slice(&2_i32.to_le_bytes());
    }
    bytes
}

/// Luminance at full size and chroma at half the size, as other programs write them.
#[test]
fn channels_of_half_the_size_are_reported_as_such() {
    let refusal = inspect(&Folder::new(), &subsampled()).expect_err("not every pixel has a number");
    assert!(refusal.starts_with("OpenEXR images of this kind are not supported: channel subsampling"), "{refusal}");
}

/// A window of 16000 x 8000 pixels would take 1.5 GB.
#[test]
fn a_size_that_no_such_file_can_have_is_refused_before_memory_is_asked_for() {
    let folder = Folder::new();
    let mut bytes = ramp().bytes();
    for name in [&b"dataWindow\0box2i\0"[..], b"displayWindow\0box2i\0"] {
        let at = bytes.windows(name.len()).position(|window| window == name).expect("a window") + name.len() + 4;
        bytes[at + 8..at + 12].copy_from_slice(&15_999_i32.to_le_bytes());
        bytes[at + 12..at + 16].copy_from_slice(&7_999_i32.to_le_bytes());
    }
    let refusal = inspect(&folder, &bytes).expect_err("it holds no such image");
    assert!(refusal.contains("cannot hold 16000 x 8000 pixels"), "{refusal}");
}
