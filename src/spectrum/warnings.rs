//! What an author should know about an index: how far its formula reaches, and which glass it imitates badly.

use super::data::{self, Glass, GlassConstants};
use super::{CatalogEntry, Curve, CurveKind};

/// The range of visible wavelengths by which nearly all light is seen, in nm.
const MAIN_RANGE_NM: [f64; 2] = [400.0, 700.0];

/// Returns a warning if a glass of the catalog is used beyond the wavelengths for which its formula holds.
pub fn index_range_warning(curve: &Curve) -> Option<String> {
    let CurveKind::Glass(CatalogEntry { entry: glass, .. }) = &curve.kind else { return None };
    let (from, to) = glass.range_nm;
    (from > MAIN_RANGE_NM[0] || to < MAIN_RANGE_NM[1]).then(|| {
        format!("{} is known from {from} to {to} nm; beyond that its index at the nearest end is taken", glass.key)
    })
}

/// Returns a warning if the absorption of a catalog glass is used beyond the wavelengths at which it was measured.
pub fn absorption_range_warning(glass: &Glass) -> Option<String> {
    let (from, to) = (glass.extinction.first()?[0], glass.extinction.last()?[0]);
    (from > MAIN_RANGE_NM[0] || to < MAIN_RANGE_NM[1]).then(|| {
        let key = glass.key;
        format!(
            "the absorption of {key} is known from {from} to {to} nm; beyond, its value at the nearest end is taken"
        )
    })
}

/// Largest error of a prism's deviation that an imitated glass may have, in degrees.
const MAX_ERROR_DEGREES: f64 = 0.1;

/// Returns a warning if two terms stand in for a catalog glass of the same n_d and V_d that refracts clearly
/// differently.
pub fn imitation_warning(curve: &Curve) -> Option<String> {
    let CurveKind::Cauchy([a, b]) = &curve.kind else { return None };
    let index = |nm: f64| curve.scale * (a + b / (nm * nm * 1e-6));
    let [nd, nf, nc] = [587.5618, 486.1327, 656.2725].map(index);
    let vd = (nd - 1.0) / (nf - nc);
    let distance = |glass: &GlassConstants| {
        let vd_distance = glass.v_d.map_or(f64::INFINITY, |other| (other - vd) / 0.3);
        ((glass.n_d - nd) / 5e-4).abs().max(vd_distance.abs())
    };
    let similar = data::glass_constants().iter().filter(|glass| distance(glass) < 1.0);
    let nearest = data::glass(similar.min_by(|x, y| distance(x).total_cmp(&distance(y)))?.key)?;
    let apex = if nd < 1.9 { 60.0 } else { 30.0_f64 };
    let deviation = |n: f64| 2.0 * libm::asin(n * libm::sin((0.5 * apex).to_radians())).to_degrees() - apex;
    let error = |nm: f64| deviation(index(nm)) - deviation(nearest.index(nm));
    // The lines h, g and r, beyond F and C, where two terms depart from the glass.
    let (nm, worst) = [404.6561, 435.8343, 706.5188]
        .map(|nm| (nm, error(nm).abs()))
        .into_iter()
        .max_by(|x, y| x.1.total_cmp(&y.1))?;
    (worst > MAX_ERROR_DEGREES).then(|| {
        format!(
            "two terms deviate from {} by {worst:.2} degrees at {nm:.0} nm in a prism of {apex} degrees: index = \
             \"{}\" is exact",
            nearest.key, nearest.key
        )
    })
}

/// Returns the source of an index and, if several makers share the name, whose glass it is.
pub fn index_source(curve: &Curve) -> Option<String> {
    let CatalogEntry { name, entry: glass } = match &curve.kind {
        CurveKind::Glass(glass) => glass,
        CurveKind::Metal(metal) => return Some(metal.entry.source.to_owned()),
        _ => return None,
    };
    let namesakes: Vec<_> = data::glass_makers(name).into_iter().filter(|key| *key != glass.key).collect();
    Some(match namesakes.is_empty() || name.contains('/') {
        true => format!("{}, {}", glass.key, glass.source),
        false => format!("{}, {}; {name} is also {}", glass.key, glass.source, namesakes.join(", ")),
    })
}
