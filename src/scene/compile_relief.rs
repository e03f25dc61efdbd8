//! Images that bend the normals of objects, checked.

use std::sync::Arc;

use super::compile::Compiler;
use super::compile_shape::MAX_LENGTH;
use super::description::ObjectText;
use super::gather::Gather;
use super::image_file::Meaning;
use super::relief::{Relief, ReliefKind};
use super::source::At;
use crate::error::Result;
use crate::shape::Coordinates;
use crate::spectrum::{Encoding, Placement, TexelFilter, Texture, Wrap};

/// Largest factor on the slopes of a normal map.
const MOST_STRENGTH: f64 = 1e3;

impl Compiler<'_> {
    /// What bends the normals of an object, before it is known where the image lies.
    pub(super) fn relief(&mut self, at: &At, text: &ObjectText) -> Result<Option<(Texture, ReliefKind)>> {
        match (&text.normal_map, &text.bump_map) {
            (None, None) => Ok(None),
            (Some(_), Some(_)) => {
                let message = "an object has a `normal_map` or a `bump_map`, not both";
                Err(self.source.mistake_at(&at.key("bump_map"), message, None))
            }
            (Some(map), None) => {
                let at = at.key("normal_map");
                let strength = map.strength.unwrap_or(1.0);
                let bounded = match strength {
                    0.0..=MOST_STRENGTH => Ok(()),
                    _ => {
                        let message =
                            format!("the strength of a normal map lies between 0 and {MOST_STRENGTH}, not {strength}");
                        Err(self.source.mistake_at(&at.key("strength"), message, None))
                    }
                };
                let linear = self.linear(&at, map.encoding, "directions");
                let placement = self.placement(&at, map.repeat, map.wrap);
                let image = self.image(&at.key("image"), &map.image, Meaning::Directions, None);
                let (_, _, placement, image) = (bounded, linear, placement, image).gather()?;
                if image.mean()[2] <= 0.0 {
                    let message = format!("{} is no normal map: its mean normal looks into the surface", map.image);
                    let help = "blue is out of the surface and 128 of 255 or more; heights are a `bump_map`";
                    return Err(self.source.mistake_at(&at.key("image"), message, Some(help.into())));
                }
                Ok(Some((Texture { image, placement }, ReliefKind::Directions { strength })))
            }
            (None, Some(map)) => {
                let at = at.key("bump_map");
                let depth = map.depth;
                let bounded = match depth.abs() {
                    0.0..=MAX_LENGTH => Ok(()),
                    _ => {
                        let message = format!("the depth of a bump map is a length up to {MAX_LENGTH:e}, not {depth}");
                        Err(self.source.mistake_at(&at.key("depth"), message, None))
                    }
                };
                let linear = self.linear(&at, map.encoding, "heights");
                let placement = self.placement(&at, map.repeat, map.wrap);
                let image = self.image(&at.key("image"), &map.image, Meaning::Heights, map.channel);
                let (_, _, placement, image) = (bounded, linear, placement, image).gather()?;
                Ok(Some((Texture { image, placement }, ReliefKind::Heights { depth })))
            }
        }
    }

    fn linear(&self, at: &At, encoding: Option<Encoding>, what: &str) -> Result<()> {
        if encoding != Some(Encoding::Srgb) {
            return Ok(());
        }
        let message = format!("the numbers of this image are {what}, which no screen encodes: they are always linear");
        Err(self.source.mistake_at(&at.key("encoding"), message, Some("leave `encoding` out".into())))
    }

    fn placement(&self, at: &At, repeat: Option<[f64; 2]>, wrap: Wrap) -> Result<Placement> {
        let repeat = repeat.unwrap_or([1.0; 2]);
        self.repeat(at, repeat)?;
        Ok(Placement { repeat, wrap, filter: TexelFilter::Linear })
    }

    /// The relief of an object, whose image lies on it by its coordinates.
    pub(super) fn relief_on(
        &self,
        at: &At,
        relief: &(Texture, ReliefKind),
        coordinates: Option<&Arc<Coordinates>>,
    ) -> Result<Arc<Relief>> {
        let (texture, kind) = relief.clone();
        let Some(coordinates) = coordinates.cloned() else {
            let map = if matches!(kind, ReliefKind::Heights { .. }) { "bump_map" } else { "normal_map" };
            let message = "this mesh has no texture coordinates, by which the image would lie on it";
            let help = format!("leave `{map}` out, or give the mesh coordinates (`uv`)");
            return Err(self.source.mistake_at(&at.key(map), message, Some(help)));
        };
        Ok(Arc::new(Relief { coordinates, texture, kind }))
    }
}
