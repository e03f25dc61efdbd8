//! Images that several machines make: finished tiles, and all that the image's file says beside them.

use std::collections::BTreeMap;
use std::fmt::Display;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::identity::Identity;
use super::image::Image;
use crate::error::{Error, Result};
use crate::film::{
    BlockReader, DEPTH_OF_NOTHING, Fact, Film, Format, Kind, LayerImage, Pixel, Provenance, Shard, SpectralImage,
    TilePlace, View, Window, write_blocks,
};
use crate::scene::FilmSettings;
use crate::trace::Report;

/// The first bytes of a part.
const PART: Kind = *b"AbbePrt1";

/// What stands before the tiles.
#[derive(Serialize, Deserialize)]
struct Head {
    identity: Identity,
    shard: Shard,
    /// The image without its pixels.
    film: Film,
    format: Format,
    view: View,
    /// With what was left out of the light that all parts send alike; and what was left out beside that.
    provenance: Provenance,
    non_finite: u64,
}

/// A tile of the image: its pixels, and their numbers in each layer and in the spectral image.
#[derive(Serialize, Deserialize)]
struct Tile {
    pixels: Vec<Pixel>,
    layers: Vec<Vec<f32>>,
    spectral: Vec<f32>,
}

const NON_FINITE: &str = "nonFinite";

/// Writes the finished tiles of an image.
///
/// # Errors
/// If they cannot be written; a file that was there before is then untouched.
pub(super) fn write(path: &Path, identity: &Identity, shard: Shard, shared: u64, image: Image) -> Result<()> {
    let Image { mut film, report, view, format, mut provenance, .. } = image;
    set_non_finite(&mut provenance, shared);
    let pixels = std::mem::take(&mut film.pixels);
    let layers: Vec<_> =
        film.layers.iter_mut().map(|layer| (std::mem::take(&mut layer.values), numbers(layer))).collect();
    let spectra = film.spectral.as_mut().map(|spectral| (std::mem::take(&mut spectral.values), spectral.bands.count()));
    let window = window(&film);
    let (identity, non_finite) = (identity.of_all_parts(), report.non_finite - shared);
    let head = Head { identity, shard, film, format, view, provenance, non_finite };
    write_blocks(path, PART, &|blocks| {
        blocks.block(&head)?;
        shard.tiles(window).try_for_each(|tile| {
            blocks.block(&Tile {
                pixels: cut(&pixels, 1, window, tile),
                layers: layers.iter().map(|(values, each)| cut(values, *each, window, tile)).collect(),
                spectral: spectra.as_ref().map_or(Vec::new(), |(values, each)| cut(values, *each, window, tile)),
            })
        })
    })
}

/// Lays the parts of an image together, one tile after another: the same image, to the last bit, as one render makes.
///
/// ```
/// # let scene = abbe::Scene::parse("camera = { position = [0, 0, 4], look_at = [0, 0, 0], vertical_fov = 40 }
/// # film = { width = 40, height = 8 }
/// # light = [{ environment = { radiance = 1 } }]", "")?;
/// # let folder = tempfile::tempdir().expect("a folder");
/// let parts = [1, 2].map(|number| folder.path().join(format!("{number}-of-2.part")));
/// for (number, path) in (1..).zip(&parts) {
///     let shard = abbe::film::Shard::new(number, 2).expect("there are two parts");
///     let options = abbe::Options { shard, ..Default::default() };
///     let mut rendering = abbe::Rendering::new(&scene, &options)?;
///     while rendering.advance(&|_| ()) {}
///     rendering.write_part(path)?;
/// }
/// let whole = abbe::render(&scene, &abbe::Options::default())?;
/// assert_eq!(abbe::merge(&parts)?.film(), whole.film());
/// # Ok::<(), abbe::Error>(())
/// ```
///
/// # Errors
/// [`Error::Arguments`] if a part is missing or there twice, or parts are not of the same render; [`Error::Decode`] if
/// one is damaged.
pub fn merge(parts: &[PathBuf]) -> Result<Image> {
    let Some((first, others)) = parts.split_first() else {
        return Err(refused("no part of an image is given", "name all of them: render merge out.exr *.part"));
    };
    let (whole, _) = open(first)?;
    let (count, mut non_finite) = (whole.shard.count(), whole.non_finite);
    let mut found = BTreeMap::from([(whole.shard.number(), first)]);
    for path in others {
        let (head, _) = open(path)?;
        if let Some(difference) = difference(&whole, &head) {
            let message = format!("{} does not belong to {}: {difference}", path.display(), first.display());
            return Err(refused(message, "render it again, or leave it out"));
        }
        let number = head.shard.number();
        if let Some(other) = found.insert(number, path) {
            let message = format!("{} and {} are both part {number} of {count}", other.display(), path.display());
            return Err(refused(message, "leave one of them out"));
        }
        non_finite += head.non_finite;
    }
    let missing: Vec<u32> = (1..=count).filter(|number| !found.contains_key(number)).collect();
    if let [number, more @ ..] = &*missing {
        let more = if more.is_empty() { String::new() } else { format!(", and {} more", more.len()) };
        let help = format!("render it: --shard {number}/{count}");
        return Err(refused(format!("part {number} of {count} is missing{more}"), help));
    }
    let Head { film, format, view, mut provenance, .. } = whole;
    let shared = provenance.facts.iter().find_map(|fact| match fact {
        (key, Fact::Count(shared)) if key == NON_FINITE => Some(*shared),
        _ => None,
    });
    non_finite += shared.unwrap_or_default();
    set_non_finite(&mut provenance, non_finite);
    let film = joined(film, found.values().copied())?;
    let report = Report { non_finite, ..Report::default() };
    Ok(Image { film, report, error: None, because: Vec::new(), view, format, provenance })
}

fn refused(message: impl Display, help: impl Display) -> Error {
    Error::Arguments { message: message.to_string(), help: Some(help.to_string()) }
}

/// Opens a part and reads what stands before its tiles.
fn open(path: &Path) -> Result<(Head, BlockReader)> {
    let Some(mut blocks) = BlockReader::open(path, PART)? else {
        let message = format!("{} is no part of an image", path.display());
        return Err(refused(message, "parts are made by --shard, as in render --shard 1/4 scene.toml"));
    };
    let head: Head = blocks.block()?;
    let Film { width, height, .. } = head.film;
    let fits = u64::from(width) * u64::from(height) <= FilmSettings::MAX_PIXELS;
    if fits { Ok((head, blocks)) } else { Err(blocks.damaged()) }
}

/// Why two parts are not of the same image, if they are not.
fn difference(whole: &Head, part: &Head) -> Option<String> {
    if part.shard.count() != whole.shard.count() {
        return Some(format!("it is one of {} parts, not of {}", part.shard.count(), whole.shard.count()));
    }
    if let Some(difference) = whole.identity.difference(&part.identity) {
        return Some(difference);
    }
    let facts = |head: &Head| head.provenance.clone();
    let (ours, theirs) = (facts(whole), facts(part));
    if let Some((key, _)) = theirs.facts.iter().zip(&ours.facts).find(|(a, b)| a != b).map(|(theirs, _)| theirs) {
        return Some(format!("its {key} is another"));
    }
    let is_other = (&part.film, &part.format, &part.view) != (&whole.film, &whole.format, &whole.view);
    (is_other || ours != theirs).then(|| "it was made with other options".into())
}

fn set_non_finite(provenance: &mut Provenance, count: u64) {
    provenance.facts.iter_mut().filter(|(key, _)| key == NON_FINITE).for_each(|(_, fact)| *fact = Fact::Count(count));
}

/// The window of pixels that a film is.
fn window(film: &Film) -> Window {
    Window { left: film.corner[0], top: film.corner[1], width: film.width, height: film.height }
}

/// Numbers of a pixel in a layer.
fn numbers(layer: &LayerImage) -> usize {
    layer.layer.channels().len()
}

/// The values of a tile's pixels, so many of each, row by row.
fn cut<T: Copy>(values: &[T], each: usize, window: Window, tile: TilePlace) -> Vec<T> {
    let row = |row: u32| {
        let first = tile.pixel(window, row * tile.width);
        &values[first * each..(first + tile.width as usize) * each]
    };
    (0..tile.height).flat_map(row).copied().collect()
}

/// Puts them into the image.
fn paste<T: Copy>(values: &[T], each: usize, window: Window, tile: TilePlace, image: &mut [T]) {
    let length = tile.width as usize * each;
    for (row, values) in (0..tile.height).zip(values.chunks_exact(length)) {
        let first = tile.pixel(window, row * tile.width) * each;
        image[first..first + length].copy_from_slice(values);
    }
}

/// A film with the tiles of all parts.
fn joined<'p>(mut film: Film, parts: impl Iterator<Item = &'p PathBuf>) -> Result<Film> {
    let (window, blank) = (window(&film), Pixel { rgb: [0.0; 3], alpha: 0.0, depth: DEPTH_OF_NOTHING, samples: 0.0 });
    let pixels = window.pixels() as usize;
    film.pixels = vec![blank; pixels];
    film.layers.iter_mut().for_each(|layer| layer.values = vec![0.0; pixels * numbers(layer)]);
    let bands = film.spectral.as_ref().map_or(0, |spectral| spectral.bands.count());
    film.spectral.iter_mut().for_each(|spectral| spectral.values = vec![0.0; pixels * bands]);
    for path in parts {
        let (head, mut blocks) = open(path)?;
        for place in head.shard.tiles(window) {
            let tile: Tile = blocks.block()?;
            let length = |layer: &LayerImage| place.pixels() * numbers(layer);
            let fits = tile.pixels.len() == place.pixels()
                && tile.layers.iter().map(Vec::len).eq(film.layers.iter().map(length))
                && tile.spectral.len() == place.pixels() * bands;
            if !fits {
                return Err(blocks.damaged());
            }
            paste(&tile.pixels, 1, window, place, &mut film.pixels);
            for (layer, values) in film.layers.iter_mut().zip(&tile.layers) {
                paste(values, numbers(layer), window, place, &mut layer.values);
            }
            if let Some(SpectralImage { values, .. }) = &mut film.spectral {
                paste(&tile.spectral, bands, window, place, values);
            }
        }
        blocks.end()?;
    }
    Ok(film)
}
