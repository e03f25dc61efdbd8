//! No file stops the program that reads it. Scenes, meshes, images and spectra, damaged at random, are read or refused
//! in one sentence, without a panic, in time and memory that suit their size.
//!
//! The cases are the same in every run. All of them, a million and more, take some minutes:
//!
//! ```text
//! ABBE_FUZZ_CASES=1000000 cargo test --release --test fuzz -- --nocapture
//! ```
//!
//! `ABBE_FUZZ_KINDS=hdr,csv` runs only the cases of some file extensions. Cases that once did harm are kept in
//! `fuzz/regressions.rs`.

mod fuzz {
    mod allocator;
    mod corpus;
    mod mutate;
    #[allow(dead_code)]
    #[path = "../support/pictures.rs"]
    mod pictures;
    mod readers;
    mod regressions;
    mod run;
}
