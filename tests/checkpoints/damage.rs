//! Truncated or corrupted files: they never give an image and never cause a panic.

use std::fs;
use std::path::Path;

use abbe::film::{Layer, Shard};
use abbe::{Error, Options, Rendering, merge};

use super::{GLASS, advance, rendering};
use crate::support::scenes::scene;

/// Every byte at a multiple of this offset is changed, one at a time.
const STEP: usize = 97;

/// Runs a reader on damaged versions of a file. Each time, it has to return an error that names the file.
fn try_damaged_versions(path: &Path, what: &str, mut read: impl FnMut() -> Result<(), Error>) {
    let whole = fs::read(path).expect("it was written");
    assert!(read().is_ok(), "{what}");
    let mut refused = |bytes: &[u8], how: &str| {
        fs::write(path, bytes).expect("it can be written");
        let message = read().expect_err(how).to_string();
        assert!(message.contains(&path.display().to_string()), "{how}: {message}");
    };
    for place in (0..whole.len()).step_by(STEP) {
        for bits in [1, 0x80, 0xff] {
            let mut bytes = whole.clone();
            bytes[place] ^= bits;
            refused(&bytes, &format!("{what}, byte {place} changed by {bits}"));
        }
    }
    for length in (0..whole.len()).step_by(STEP).chain([whole.len() - 1]) {
        refused(&whole[..length], &format!("{what}, {length} bytes of {}", whole.len()));
    }
    refused(&[&*whole, &[0]].concat(), &format!("{what}, a byte longer"));
    refused(GLASS.as_bytes(), &format!("{what}, another file"));
    fs::write(path, whole).expect("it can be written");
    assert!(read().is_ok(), "{what}");
}

#[test]
fn f3_a_changed_byte_of_a_checkpoint_or_a_part_is_found_and_so_is_a_missing_end() {
    let folder = tempfile::tempdir().expect("a folder");
    let [checkpoint, part, other] = ["a.checkpoint", "a.part", "b.part"].map(|name| folder.path().join(name));
    let scene = scene(&GLASS.replace("width = 37, height = 21", "width = 20, height = 6"));
    let layers = Some(vec![Layer::Direct, Layer::Position, Layer::CryptoObject]);
    let options = Options { layers, samples: Some(4), ..Options::default() };
    let [mut first, mut next] = [2, 2].map(|threads| rendering(&scene, &options, threads));
    advance(&mut first, 100);
    first.save(&checkpoint).expect("it can be written");
    try_damaged_versions(&checkpoint, "a checkpoint", || next.resume(&checkpoint).map(|_| ()));
    for (number, path) in [(1, &part), (2, &other)] {
        let shard = Shard::new(number, 2).expect("there are two parts");
        let mut rendering = rendering(&scene, &Options { shard, ..options.clone() }, 2);
        advance(&mut rendering, u64::MAX);
        rendering.write_part(path).expect("it can be written");
    }
    let parts = [part.clone(), other];
    try_damaged_versions(&part, "a part", || merge(&parts).map(|_| ()));
}

#[test]
fn f3_a_changed_byte_of_a_plan_is_found_and_so_is_a_missing_end() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.plan");
    let scene = scene(&GLASS.replace("samples = 20", "samples = 20, model = \"rgb\""));
    abbe::write_plan(&abbe::plan::plan(&scene), &scene, &path).expect("it can be written");
    let planned = Options { plan: Some(path.clone()), threads: Some(1), ..Options::default() };
    try_damaged_versions(&path, "a plan", || Rendering::new(&scene, &planned).map(|_| ()));
}
