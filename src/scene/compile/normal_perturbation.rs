//! Images that perturb the normals of objects.
//!
//! They belong to the object and not to its material: a depth is a length on the object, one material serves flat and
//! dented things, and it is clear which normal a mix or a mask uses.

use std::sync::Arc;

use super::context::Context;
use super::curve_text::{CHANNELS, ENCODINGS, WRAPS, repeat};
use super::image::image;
use super::image_numbers::Meaning;
use super::ranges::MAX_LENGTH;
use crate::scene::text::{Fields, Value, spanned};
use crate::scene::{NormalPerturbation, PerturbationKind};
use crate::shape::Coordinates;
use crate::spectrum::{Encoding, Placement, TexelFilter, Texture, Wrap};

/// Largest factor on the slopes of a normal map.
const MAX_STRENGTH: f64 = 1e3;

/// The image that perturbs the normals of an object, before it is known where the image lies.
pub(super) struct ReliefText<'d> {
    place: Value<'d>,
    texture: Texture,
    kind: PerturbationKind,
}

/// Reads the image that perturbs the normals of an object, if there is one. Returns none if it is wrong.
pub(super) fn relief<'d>(context: &mut Context, object: &mut Fields<'d>) -> Option<Option<ReliefText<'d>>> {
    match (object.get("normal_map"), object.get("bump_map")) {
        (None, None) => Some(None),
        (Some(_), Some(bump_map)) => bump_map.refuse("an object has a `normal_map` or a `bump_map`, not both"),
        (Some(place), None) => normal_map(context, place).map(Some),
        (None, Some(place)) => bump_map(context, place).map(Some),
    }
}

/// ```toml
/// normal_map = { image = "wall_normal.png", repeat = 2, strength = 1 }
/// ```
///
/// Directions: red along u, green along v, blue out of the surface. One half means 0. The strength is a factor on red
/// and green.
fn normal_map<'d>(context: &mut Context, place: Value<'d>) -> Option<ReliefText<'d>> {
    Fields::read(place, |map| {
        let file = map.need("image", spanned(Value::text));
        let placement = placement(map, "directions");
        let strength = map.or("strength", 1.0, |value| {
            let what = format!("the strength of a normal map lies between 0 and {MAX_STRENGTH}");
            value.number_within(0.0..=MAX_STRENGTH, &what, None)
        });
        let file = file?;
        let image = image(context, &file, Meaning::Directions, None)?;
        if image.mean()[2] <= 0.0 {
            let message = format!("{} is not a normal map: its mean normal points into the surface", file.value);
            let help = "blue points out of the surface and is 128 of 255 or more; for heights use `bump_map`";
            return file.place.advise(message, help);
        }
        let (placement, strength) = (placement?, strength?);
        Some(ReliefText {
            place,
            texture: Texture { image, placement },
            kind: PerturbationKind::Directions { strength },
        })
    })
}

/// ```toml
/// bump_map = { image = "height.png", repeat = 2, depth = 0.02 }
/// ```
///
/// Heights, from one channel or the mean of all three. The depth is the height of white above black in scene units; if
/// it is negative, white is deeper.
fn bump_map<'d>(context: &mut Context, place: Value<'d>) -> Option<ReliefText<'d>> {
    Fields::read(place, |map| {
        let file = map.need("image", spanned(Value::text));
        let channel = map.maybe("channel", |value| value.word(&CHANNELS));
        let placement = placement(map, "heights");
        let depth = map.need("depth", |value| {
            let what = format!("the depth of a bump map is a length up to {MAX_LENGTH:e}");
            value.number_within(-MAX_LENGTH..=MAX_LENGTH, &what, None)
        });
        let image = image(context, &file?, Meaning::Heights, channel?);
        let (image, placement, depth) = (image?, placement?, depth?);
        Some(ReliefText { place, texture: Texture { image, placement }, kind: PerturbationKind::Heights { depth } })
    })
}

/// Reads the placement of an image whose numbers are not colors.
fn placement(map: &mut Fields, what: &str) -> Option<Placement> {
    let repeat = map.or("repeat", [1.0; 2], repeat);
    let wrap = map.or("wrap", Wrap::default(), |value| value.word(&WRAPS));
    let linear = map.or("encoding", (), |value| match value.word(&ENCODINGS)? {
        Encoding::Linear => Some(()),
        Encoding::Srgb => value
            .advise(format!("the numbers of this image are {what}, which are always linear"), "leave `encoding` out"),
    });
    linear?;
    Some(Placement { repeat: repeat?, wrap: wrap?, filter: TexelFilter::Linear })
}

impl ReliefText<'_> {
    /// Puts the image on an object, if the object has texture coordinates.
    pub(super) fn apply_to(&self, coordinates: Option<&Arc<Coordinates>>) -> Option<Arc<NormalPerturbation>> {
        let Some(coordinates) = coordinates.cloned() else {
            let message = "this mesh has no texture coordinates, which the image needs";
            let help = format!("leave `{}` out, or give the mesh texture coordinates (`uv`)", self.place.key());
            return self.place.advise(message, help);
        };
        Some(Arc::new(NormalPerturbation { coordinates, texture: self.texture.clone(), kind: self.kind }))
    }
}
