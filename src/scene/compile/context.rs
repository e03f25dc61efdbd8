//! State that the parts of a scene share while they are read.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;

use sha2::{Digest, Sha256};

use super::image_numbers::Meaning;
use crate::scene::text::{Document, LocatedBy, Value};
use crate::shape::Mesh;
use crate::spectrum::{Channel, Image};

/// What has been read so far, besides the scene itself.
#[derive(Default)]
pub(super) struct Context {
    warnings: Vec<Warning>,
    /// Warnings about values. A value may be read for two purposes, but is warned about once.
    value_warnings: HashSet<Warning>,
    /// Hash of the scene's texts and of the files that they name.
    pub(super) hash: Sha256,
    /// The files that the texts name and that have been read.
    pub(super) files: Vec<PathBuf>,
    /// Length of a scene unit in meters, if the scene gives it.
    pub(super) meters_per_unit: Option<f64>,
    /// Whether paths continue from one diffuse surface to another at most once.
    pub(super) few_bounces: bool,
    /// Luminance of the film's white in cd/m^2, if the scene's light is absolute.
    pub(super) white_luminance: Option<f64>,
    /// Images by their file, the meaning of their numbers and the channel.
    pub(super) images: BTreeMap<(PathBuf, Meaning, Option<Channel>), Arc<Image>>,
    /// Meshes by their file and whether they are smooth.
    pub(super) meshes: HashMap<(PathBuf, bool), Arc<Mesh>>,
    /// Meshes whose normals are averages of those of their faces.
    pub(super) averaged_meshes: HashSet<*const Mesh>,
}

/// A message for the author, and the place of its cause.
#[derive(Clone, PartialEq, Eq, Hash)]
struct Warning {
    place: Option<Range<usize>>,
    message: String,
}

impl Context {
    pub(super) fn new(text: &str) -> Self {
        Self { hash: Sha256::new_with_prefix(text.as_bytes()), ..Self::default() }
    }

    /// Records a file that has been read.
    pub(super) fn record_file(&mut self, file: PathBuf, bytes: &[u8]) {
        self.hash.update(bytes);
        self.files.push(file);
    }

    pub(super) fn warn(&mut self, message: impl Into<String>) {
        self.warnings.push(Warning { place: None, message: message.into() });
    }

    /// Warns about a value, with its place in the text.
    pub(super) fn warn_at(&mut self, place: Value, message: impl Into<String>) {
        let warning = Warning { place: Some(place.span()), message: message.into() };
        if self.value_warnings.insert(warning.clone()) {
            self.warnings.push(warning);
        }
    }

    pub(super) fn warnings(&self, document: &Document) -> Vec<String> {
        let places = self.warnings.iter().filter_map(|warning| warning.place.clone());
        let paths = match document.texts.located_by {
            LocatedBy::Line => document.texts.place_names(places),
            LocatedBy::Key => document.paths(places),
        };
        let format_warning = |Warning { place, message }: &Warning| match place {
            Some(place) => {
                let place = paths.get(place).cloned().unwrap_or_else(|| document.texts.place_name(place.clone()));
                format!("{place}: {message}")
            }
            None => message.clone(),
        };
        self.warnings.iter().map(format_warning).collect()
    }
}
