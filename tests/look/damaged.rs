//! Files that are cut off, changed or boastful: none stops the program, and none is believed.

#[allow(dead_code)]
#[path = "../fuzz/corpus.rs"]
mod corpus;
#[allow(dead_code)]
#[path = "../fuzz/mutate.rs"]
mod mutate;

use std::fs;

use abbe::Error;
use abbe::film::ExrFile;

use super::files::{Exr, ramp};
use crate::messages::run::Folder;
use crate::support::pictures;

/// Reads damaged bytes; looks at all that a file says where they are still one.
fn look(folder: &Folder, bytes: &[u8]) -> Result<(), String> {
    let path = folder.path().join("case.exr");
    fs::write(&path, bytes).expect("files can be written");
    match ExrFile::read(&path) {
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

fn layered() -> Exr {
    let mut image = ramp();
    image.texts.push(("colorInteropID", "lin_rec709_scene".into()));
    image.parts = ["first", "second"].map(|name| (name, image.parts[0].1.clone())).to_vec();
    image
}

#[test]
fn files_that_are_cut_off_anywhere_are_refused() {
    let folder = Folder::new();
    for image in [ramp(), layered()] {
        image.write(&folder.path().join("whole.exr"));
        let whole = fs::read(folder.path().join("whole.exr")).expect("it is there");
        assert_eq!(look(&folder, &whole), Ok(()));
        for length in 0..whole.len() {
            assert!(look(&folder, &whole[..length]).is_err(), "{length} of {} bytes", whole.len());
        }
    }
}

#[test]
fn files_with_changed_bytes_are_read_or_refused() {
    let folder = Folder::new();
    for image in [ramp(), layered()] {
        image.write(&folder.path().join("whole.exr"));
        let whole = fs::read(folder.path().join("whole.exr")).expect("it is there");
        let mut refused = 0;
        for at in 4..whole.len() {
            for value in [0, 255, whole[at] ^ 128, whole[at].wrapping_add(1)] {
                let mut bytes = whole.clone();
                bytes[at] = value;
                refused += usize::from(look(&folder, &bytes).is_err());
            }
        }
        assert!(refused > whole.len(), "{refused}");
    }
}

/// Scan lines and tiles of every compression, damaged as the fuzzer of scenes damages them.
#[test]
fn damaged_files_of_every_kind_are_read_or_refused() {
    let (folder, files) = (Folder::new(), corpus::exr());
    for file in &files {
        assert_eq!(look(&folder, file), Ok(()));
    }
    let mut dice = mutate::Dice::new(1);
    let read = (0..1000).filter(|_| look(&folder, &mutate::mutated(&mut dice, &files, &[])).is_ok()).count();
    assert!((50..950).contains(&read), "{read}");
}

/// A window of 16000 x 8000 pixels would be 1.5 GB.
#[test]
fn a_size_that_no_such_file_can_have_is_refused_before_memory_is_asked_for() {
    let folder = Folder::new();
    ramp().write(&folder.path().join("whole.exr"));
    let mut bytes = fs::read(folder.path().join("whole.exr")).expect("it is there");
    for name in [&b"dataWindow\0box2i\0"[..], b"displayWindow\0box2i\0"] {
        let at = bytes.windows(name.len()).position(|window| window == name).expect("a window") + name.len() + 4;
        bytes[at + 8..at + 12].copy_from_slice(&15_999_i32.to_le_bytes());
        bytes[at + 12..at + 16].copy_from_slice(&7_999_i32.to_le_bytes());
    }
    let said = look(&folder, &bytes).expect_err("it holds no such image");
    assert!(said.contains("cannot hold 16000 x 8000 pixels"), "{said}");
}
