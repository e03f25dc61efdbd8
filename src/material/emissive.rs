use crate::shape::Sides;
use crate::spectrum::Quantity;

/// A surface that emits equal radiance in all directions and reflects nothing. Finite ones light the scene as area
/// lights.
///
/// ```toml
/// emissive = { radiance = 10, sides = "both" }     # or "front"; "both" if absent
/// emissive = { radiance = { image = "screen.png", scale = 5 } }
/// ```
#[derive(Clone, Debug)]
pub struct Emissive<S> {
    /// Emitted radiance.
    pub radiance: S,
    /// The sides that emit.
    pub sides: Sides,
}

impl<S> Emissive<S> {
    pub(super) fn map<T>(&self, convert: &mut impl FnMut(Quantity, &S) -> T) -> Emissive<T> {
        Emissive { radiance: convert(Quantity::Emission, &self.radiance), sides: self.sides }
    }
}
