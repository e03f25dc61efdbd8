use std::collections::HashMap;
use std::hash::{DefaultHasher, Hash, Hasher};

use super::{Curve, CurveKind};

/// Values made from curves, each made once for all equal curves: thousands of lamps are often alike.
#[derive(Debug)]
pub struct CurveCache<T> {
    entries: HashMap<u64, Vec<(Curve, T)>>,
}

impl<T> Default for CurveCache<T> {
    fn default() -> Self {
        Self { entries: HashMap::new() }
    }
}

impl<T: Clone> CurveCache<T> {
    /// Returns the value that was made from an equal curve, or makes it now.
    pub fn of(&mut self, curve: &Curve, make: impl FnOnce(&Curve) -> T) -> T {
        let bucket = self.entries.entry(hash(curve)).or_default();
        if let Some((_, known)) = bucket.iter().find(|(other, _)| other == curve) {
            return known.clone();
        }
        let value = make(curve);
        bucket.push((curve.clone(), value.clone()));
        value
    }
}

/// Returns a hash that is the same for equal curves.
fn hash(curve: &Curve) -> u64 {
    let mut hasher = DefaultHasher::new();
    // 0 and -0 are equal.
    let mut add = |x: f64| (x + 0.0).to_bits().hash(&mut hasher);
    add(curve.scale);
    add(curve.luminance.unwrap_or(-1.0));
    match &curve.kind {
        CurveKind::Number(x) | CurveKind::Blackbody(x) => add(*x),
        CurveKind::Rgb(rgb) => rgb.iter().for_each(|&x| add(x)),
        CurveKind::Samples(pairs) | CurveKind::Lines(pairs) => pairs.as_flattened().iter().for_each(|&x| add(x)),
        CurveKind::Illuminant(light) => light.name.hash(&mut hasher),
        _ => {}
    }
    hasher.finish()
}
