//! What the reading of one part of a scene leaves for that of others.

use std::collections::{BTreeMap, HashMap};
use std::io::ErrorKind;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use sha2::{Digest, Sha256};

use super::image_file::Meaning;
use crate::error::nearest_file;
use crate::scene::text::{Document, Value};
use crate::shape::Mesh;
use crate::spectrum::{Channel, Image};

/// What was read so far, besides the scene itself.
pub(super) struct Context<'d> {
    /// Where the names of files begin.
    pub(super) folder: &'d Path,
    warnings: Vec<Warning>,
    /// Of the scene file and the files that it names.
    pub(super) hash: Sha256,
    /// Length of a scene unit in meters, if the scene says it.
    pub(super) meters_per_unit: Option<f64>,
    /// Luminance of the film's white in cd/m^2, if the scene's light is absolute.
    pub(super) white_luminance: Option<f64>,
    /// By file and by what was read of it.
    pub(super) images: BTreeMap<(PathBuf, Meaning, Option<Channel>), Arc<Image>>,
    /// By file and whether it is smooth.
    pub(super) meshes: HashMap<(String, bool), Arc<Mesh>>,
}

/// What the author should know, and where the reason stands.
struct Warning {
    place: Option<Range<usize>>,
    message: String,
}

/// A kind of file that a scene names.
pub(super) struct FileKind {
    /// What is told where its name is empty.
    pub(super) nameless: &'static str,
    pub(super) most_bytes: u64,
}

impl<'d> Context<'d> {
    pub(super) fn new(folder: &'d Path, text: &str) -> Self {
        let hash = Sha256::new_with_prefix(text.as_bytes());
        let (images, meshes) = (BTreeMap::new(), HashMap::new());
        let (meters_per_unit, white_luminance) = (None, None);
        Self { folder, warnings: Vec::new(), hash, meters_per_unit, white_luminance, images, meshes }
    }

    pub(super) fn warn(&mut self, message: impl Into<String>) {
        self.warnings.push(Warning { place: None, message: message.into() });
    }

    /// Warns by the path of a value.
    pub(super) fn warn_at(&mut self, place: Value, message: impl Into<String>) {
        self.warnings.push(Warning { place: Some(place.span()), message: message.into() });
    }

    /// All warnings of a document.
    pub(super) fn warnings(&self, document: &Document) -> Vec<String> {
        let paths = document.paths(self.warnings.iter().filter_map(|warning| warning.place.clone()));
        let told = |Warning { place, message }: &Warning| match place.as_ref().and_then(|place| paths.get(place)) {
            Some(path) => format!("{path}: {message}"),
            None => message.clone(),
        };
        self.warnings.iter().map(told).collect()
    }

    /// The bytes of a file of which the name stands at a place.
    pub(super) fn bytes(&self, place: Value, file: &str, kind: &FileKind) -> Option<Vec<u8>> {
        let path = self.folder.join(file);
        match std::fs::metadata(&path) {
            Ok(found) if found.is_file() && found.len() > kind.most_bytes => {
                return place.refuse(format!("{file} has {} bytes, more than {}", found.len(), kind.most_bytes));
            }
            // A device never ends.
            Ok(found) if !found.is_file() && !found.is_dir() => {
                return place.refuse(format!("{file} is no file but a device"));
            }
            _ => {}
        }
        match std::fs::read(&path) {
            Ok(bytes) => Some(bytes),
            Err(_) if file.is_empty() => place.refuse(kind.nameless),
            Err(_) if path.is_dir() => place.refuse(format!("{file} is a folder")),
            Err(error) if matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => {
                self.missing(place, file)
            }
            Err(error) => place.refuse(format!("cannot read {file}: {error}")),
        }
    }

    /// Tells that there is no such file.
    pub(super) fn missing<T>(&self, place: Value, file: &str) -> Option<T> {
        let near = nearest_file(&self.folder.join(file));
        let near = near.and_then(|near| near.file_name().map(|name| Path::new(file).with_file_name(name)));
        let help = match near {
            Some(near) => format!("did you mean \"{}\"?", near.display()),
            None => "the path starts at the folder of the scene".into(),
        };
        place.advise(format!("there is no file {file}"), help)
    }
}
