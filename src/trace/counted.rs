//! Which light of a camera sample counts, where some samples are aimed at small lights.

use super::highlight::{Highlight, SeenHighlight, density, density_of};
use super::lens_light::{LensLight, LensPoint, SeenLensLights};
use crate::film::Filter;
use crate::light::LightId;
use crate::math::DVec2;

/// Which light of a camera sample counts, and how much.
#[derive(Clone, Copy, Debug)]
pub(super) enum Counted<'a> {
    /// All light of a sample of the pixel, at a point of the film. `pdf` is the density of such samples there. Light
    /// that the highlights show counts less.
    Ordinary { film: DVec2, pdf: f64, highlights: &'a [SeenHighlight] },
    /// All light of a sample through a point of the lens. Light that samples aim at counts less.
    OfLens { place: DVec2, lights: SeenLensLights<'a> },
    /// Light of a sample that was aimed at a highlight, or at a light that the lens blurs: only what it shows, by this
    /// factor.
    Aimed { light: LightId, bounces: u32, factor: f64 },
}

impl<'a> Counted<'a> {
    /// All light.
    pub const ALL: Self = Self::Ordinary { film: DVec2::ZERO, pdf: 1.0, highlights: &[] };

    /// Returns what counts of an ordinary sample. `offset` is that of its point from the middle of the pixel.
    pub fn ordinary(filter: Filter, film: DVec2, offset: DVec2, highlights: &'a [SeenHighlight]) -> Self {
        if highlights.is_empty() {
            Self::ALL
        } else {
            Self::Ordinary { film, pdf: density(filter, offset), highlights }
        }
    }

    /// Returns what counts of a sample that was aimed at one of the highlights; `None` if its point is outside the
    /// pixel's filter.
    pub fn aimed(
        filter: Filter,
        film: DVec2,
        offset: DVec2,
        aim: &SeenHighlight,
        highlights: &[SeenHighlight],
    ) -> Option<Self> {
        let Highlight { light, bounces, .. } = *aim.highlight;
        let value = filter.value(offset);
        let factor = value / (density(filter, offset) + density_of(highlights, light, bounces, film));
        (value != 0.0).then_some(Self::Aimed { light, bounces, factor })
    }

    /// Returns what counts of a sample that looks through a point of the lens at one of the lights.
    pub fn through_lens(point: &LensPoint, lights: &SeenLensLights) -> Self {
        let LensLight { light, bounces, .. } = *point.light;
        Self::Aimed { light, bounces, factor: lights.factor(light, bounces, point.place) }
    }

    /// Whether the sample was aimed at a light.
    pub fn is_aimed(&self) -> bool {
        matches!(self, Self::Aimed { .. })
    }

    /// Whether nothing counts of what surfaces send on that a path hits after so many bounces.
    #[inline]
    pub fn ends_after(&self, bounces: u32) -> bool {
        matches!(*self, Self::Aimed { bounces: last, .. } if bounces >= last)
    }

    /// Returns the factor on light of a source that surfaces sent on `bounces` times. It may be negative, where a
    /// filter is.
    #[inline]
    pub fn factor(&self, source: Option<LightId>, bounces: u32) -> f64 {
        match *self {
            Self::Ordinary { highlights: [], .. } => 1.0,
            Self::Ordinary { film, pdf, highlights } => match source {
                Some(light) => pdf / (pdf + density_of(highlights, light, bounces, film)),
                None => 1.0,
            },
            Self::OfLens { place, lights } => match source {
                Some(light) => lights.factor(light, bounces, place),
                None => 1.0,
            },
            Self::Aimed { light, bounces: mirrors, factor } if (source, bounces) == (Some(light), mirrors) => factor,
            Self::Aimed { .. } => 0.0,
        }
    }
}
