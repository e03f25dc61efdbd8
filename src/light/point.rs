use super::View;
use crate::math::{DVec3, Ray};
use crate::shape::Sighting;
use crate::spectrum::Quantity;

/// A point that shines evenly in all directions; rays never meet it.
///
/// ```toml
/// [[light]]
/// point = { position = [0, 3, 0], intensity = 10 }     # intensity: radiance times area
/// ```
#[derive(Clone, Debug)]
pub struct Point<S> {
    /// Where it is.
    pub position: [f64; 3],
    /// Radiance times area, in scene units.
    pub intensity: S,
}

impl<S> Point<S> {
    pub(super) fn map<T>(&self, convert: &mut impl FnMut(Quantity, &S) -> T) -> Point<T> {
        Point { position: self.position, intensity: convert(Quantity::Emission, &self.intensity) }
    }

    pub(super) fn aim(&self, from: DVec3) -> Option<Sighting> {
        let direction = (DVec3::from(self.position) - from).try_normalize()?;
        Some(Sighting { direction, part: None, density: None })
    }

    pub(super) fn view(&self, ray: &Ray) -> View {
        let squared = (DVec3::from(self.position) - ray.origin).length_squared();
        View { distance: squared.sqrt(), object: None, pdf: None, factor: 1.0 / squared, uv: [0.0; 2] }
    }
}
