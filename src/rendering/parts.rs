//! Merges images whose parts were rendered on several machines.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::{Path, PathBuf};

use super::image::Image;
use super::part::{PartHeader, open};
use super::provenance::NON_FINITE;
use crate::error::{Error, Result};
use crate::film::{
    BlockReader, Film, Format, Rows, Shard, TILE, TilePlace, TileValues, Window, write_exr, write_spectral_exr,
};
use crate::trace::Report;

/// All parts of an image, made by the same render. Only one tile of each part is read at a time.
///
/// ```
/// # let scene = abbe::Scene::parse("camera = { position = [0, 0, 4], look_at = [0, 0, 0], vertical_fov = 40 }
/// # film = { width = 40, height = 8 }
/// # light = [{ environment = { radiance = 1 } }]", "")?;
/// # let folder = tempfile::tempdir().expect("a folder");
/// let paths = [1, 2].map(|number| folder.path().join(format!("{number}-of-2.part")));
/// for (number, path) in (1..).zip(&paths) {
///     let shard = abbe::film::Shard::new(number, 2).expect("there are two parts");
///     let options = abbe::Options { shard, ..Default::default() };
///     let mut rendering = abbe::Rendering::new(&scene, &options)?;
///     while rendering.advance(&|_| ()) {}
///     rendering.write_part(path)?;
/// }
/// let parts = abbe::Parts::open(&paths)?;
/// parts.write_exr(folder.path().join("image.exr"))?;
/// let whole = abbe::render(&scene, &abbe::Options::default())?;
/// assert_eq!(parts.image()?.film(), whole.film());
/// # Ok::<(), abbe::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Parts {
    /// The image without its pixels, and the number of samples left out of all parts.
    image: Image,
    /// The files, in the order of the parts' numbers.
    files: Vec<Tiles>,
}

/// The tiles of a part in its file.
#[derive(Clone, Debug)]
struct Tiles {
    path: PathBuf,
    /// The byte at which the first unread tile begins.
    start: u64,
}

/// Merges the parts of an image in memory. Returns the same image, to the last bit, as a single render.
///
/// # Errors
/// The errors of [`Parts::open`]; [`Error::Decode`](crate::Error::Decode) if a part is damaged.
pub fn merge(parts: &[impl AsRef<Path>]) -> Result<Image> {
    Parts::open(parts)?.image()
}

impl Parts {
    /// Checks that parts, given in any order, make up an image.
    ///
    /// # Errors
    /// [`Error::Arguments`](crate::Error::Arguments) if a part is missing or given twice, or if the parts are not of
    /// the same render; [`Error::Decode`](crate::Error::Decode) if one is damaged before its tiles.
    pub fn open(paths: &[impl AsRef<Path>]) -> Result<Self> {
        let mut paths = paths.iter().map(AsRef::as_ref);
        let Some(first) = paths.next() else {
            return Error::refuse("no part of an image is given", "name all of them: render merge out.exr *.part");
        };
        let (whole, blocks) = open(first)?;
        let (count, window) = (whole.shard.count(), whole.film.window());
        let mut non_finite = whole.non_finite;
        let mut found = BTreeMap::from([(whole.shard.number(), tiles(first, blocks, whole.shard, window)?)]);
        for path in paths {
            let (head, blocks) = open(path)?;
            if let Some(difference) = whole.difference(&head) {
                let message = format!("{} does not belong to {}: {difference}", path.display(), first.display());
                return Error::refuse(message, "render it again, or leave it out");
            }
            let number = head.shard.number();
            if let Some(other) = found.insert(number, tiles(path, blocks, head.shard, window)?) {
                let message =
                    format!("{} and {} are both part {number} of {count}", other.path.display(), path.display());
                return Error::refuse(message, "leave one of them out");
            }
            non_finite += head.non_finite;
        }
        let missing = count - found.len() as u32;
        if missing > 0 {
            let gap = (1..).zip(found.keys()).find(|(number, found)| number != *found);
            let number = gap.map_or(found.len() as u32 + 1, |(number, _)| number);
            let more = if missing == 1 { String::new() } else { format!(", and {} more", missing - 1) };
            let help = format!("render it: --shard {number}/{count}");
            return Error::refuse(format!("part {number} of {count} is missing{more}"), help);
        }
        non_finite += whole.shared_non_finite();
        let PartHeader { film, format, view, mut provenance, .. } = whole;
        provenance.set_count(NON_FINITE, non_finite);
        let report = Report { non_finite, ..Report::default() };
        let image =
            Image { film, report, error: None, because: Vec::new(), view, format, provenance, dark_warning: None };
        Ok(Self { image, files: found.into_values().collect() })
    }

    /// Returns the format of the image's file.
    pub fn format(&self) -> &Format {
        &self.image.format
    }

    /// Writes the image like [`Image::write_exr`] does, with the same bytes as a single render. Needs memory for only
    /// some rows of the image, whatever the number of parts.
    ///
    /// # Errors
    /// The errors of [`Image::write_exr`], and [`Error::Decode`](crate::Error::Decode) if a part is damaged.
    pub fn write_exr(&self, path: impl AsRef<Path>) -> Result<u64> {
        write_exr(self.image.heading(), &mut Strip::new(self, Some(ROWS_AT_ONCE)), path)
    }

    /// Writes the spectra like [`Image::write_spectral_exr`] does, in as little memory. Returns whether there are any.
    ///
    /// # Errors
    /// The errors of [`write_exr`](Self::write_exr).
    pub fn write_spectral_exr(&self, path: impl AsRef<Path>) -> Result<bool> {
        write_spectral_exr(self.image.heading(), &mut Strip::new(self, Some(ROWS_AT_ONCE)), path)?;
        Ok(self.image.film.spectral.is_some())
    }

    /// Returns the image in memory. About its rendering, it contains only what its files record.
    ///
    /// # Errors
    /// [`Error::Decode`](crate::Error::Decode) if a part is damaged.
    pub fn image(&self) -> Result<Image> {
        let mut all = Strip::new(self, None);
        all.rows(0..self.image.film.height)?;
        Ok(Image { film: all.film, ..self.image.clone() })
    }
}

/// Finds where the tiles of a part begin. The part may have none.
fn tiles(path: &Path, blocks: BlockReader, shard: Shard, window: Window) -> Result<Tiles> {
    let start = blocks.place();
    if shard.tiles(window).next().is_none() {
        blocks.end()?;
    }
    Ok(Tiles { path: path.to_owned(), start })
}

/// The number of rows that are merged at a time: some blocks of the default compression.
const ROWS_AT_ONCE: u32 = 64;
/// The maximum number of open files, of the 256 that the strictest system allows. If there are more parts, some are
/// reopened for each of their tiles.
const MAX_OPEN_FILES: usize = 200;

/// Rows of an image, assembled from the tiles of all parts.
struct Strip<'p> {
    parts: &'p Parts,
    /// How far each part has been read, and its reader if that stays open.
    files: Vec<Tiles>,
    readers: Vec<Option<BlockReader>>,
    at_once: Option<u32>,
    /// The number of tiles in all parts.
    tiles: usize,
    /// The current rows.
    film: Film,
}

impl<'p> Strip<'p> {
    fn new(parts: &'p Parts, at_once: Option<u32>) -> Self {
        let readers = parts.files.iter().take(MAX_OPEN_FILES).map(|_| None).collect();
        let (files, film) = (parts.files.clone(), &parts.image.film);
        let tiles = Shard::WHOLE.tiles(film.window()).count();
        Self { parts, files, readers, at_once, tiles, film: Film { height: 0, ..film.clone() } }
    }

    /// Reads the next tile from the part that contains it. After a part's last tile, checks that nothing follows.
    fn read(&mut self, place: TilePlace) -> Result<TileValues> {
        let (number, count) = (place.number as usize, self.files.len());
        let part = number % count;
        let kept_reader = self.readers.get_mut(part).and_then(Option::take);
        let file = &mut self.files[part];
        let mut blocks = kept_reader.map_or_else(|| BlockReader::open_at(&file.path, file.start), Ok)?;
        let tile: TileValues = blocks.block()?;
        if !tile.fit(place, &self.film) {
            return Err(blocks.damaged());
        }
        if number + count >= self.tiles {
            blocks.end()?;
        } else {
            file.start = blocks.place();
            if let Some(reader) = self.readers.get_mut(part) {
                *reader = Some(blocks);
            }
        }
        Ok(tile)
    }
}

/// Rows must be requested from the top down, in whole tiles.
impl Rows for Strip<'_> {
    fn at_once(&self) -> Option<u32> {
        self.at_once
    }

    fn rows(&mut self, rows: Range<u32>) -> Result<(&Film, usize)> {
        self.film.resize(rows.end - rows.start);
        let window = self.parts.image.film.window();
        let per_row = window.width.div_ceil(TILE) as usize;
        let [first, end] = [rows.start, rows.end].map(|row| row.div_ceil(TILE) as usize * per_row);
        for place in Shard::WHOLE.tiles(window).skip(first).take(end - first) {
            let tile = self.read(place)?;
            let [left, top] = place.corner;
            tile.put_into(&mut self.film, TilePlace { corner: [left, top - rows.start], ..place });
        }
        Ok((&self.film, 0))
    }
}
