//! Surfaces that look smoother or rougher than they are. Materials are evaluated with the shading normal, and no light
//! is lost where its hemisphere and that of the triangle disagree.
//!
//! Two measures make up for the difference (Veach 1997, *Robust Monte Carlo Methods for Light Transport Simulation*,
//! section 5.3, describes what goes wrong without them). Where a material mirrors, the shading normal is bent until the
//! mirror image of the viewer's direction lies above the triangle. A direction that leaves on the wrong side of the
//! triangle is folded back through its plane. Folding moves light and removes none: the value of a direction is the sum
//! over both directions that end there, and so is its density.

use crate::material::{Branch, Lobes, Material, Scatter, ScatterContext, reflect};
use crate::math::{DVec3, unit};
use crate::shape::SurfacePoint;
use crate::spectrum::{Lanes, Table};

/// Returns the triangle's normal and the bent shading normal, both on the side of the unit vector `wo` to the viewer.
pub fn normals(point: &SurfacePoint, wo: DVec3) -> [DVec3; 2] {
    let [flat, smooth] = unbent_normals(point, wo);
    if flat == smooth { [flat; 2] } else { [flat, bent_normal(wo, flat, smooth)] }
}

/// Returns both normals for a material with some lobes. What is matte looks the same to every viewer, so its shading
/// normal is not bent.
pub fn normals_for_lobes(lobes: Lobes, point: &SurfacePoint, wo: DVec3) -> [DVec3; 2] {
    if lobes == Lobes::DIFFUSE_REFLECTION { unbent_normals(point, wo) } else { normals(point, wo) }
}

fn unbent_normals(point: &SurfacePoint, wo: DVec3) -> [DVec3; 2] {
    let is_front = point.normal.dot(wo) > 0.0;
    [point.normal, point.shading].map(|normal| if is_front { normal } else { -normal })
}

/// Returns the unbent shading normal, on the side of the unit vector `wo`.
pub fn unbent_normal(point: &SurfacePoint, wo: DVec3) -> DVec3 {
    unbent_normals(point, wo)[1]
}

/// Returns whether light goes from `wi` to the viewer at `wo` by the unbent normal, and so can be followed either way.
pub fn is_reversible(point: &SurfacePoint, wo: DVec3, wi: DVec3, crosses: bool) -> bool {
    if point.shading == point.normal {
        return true;
    }
    let smooth = unbent_normal(point, wo);
    let (wo_above, wi_above) = (wo.dot(point.normal), wi.dot(point.normal));
    let mirrored = reflect(wo, smooth).dot(point.normal);
    wo.dot(smooth) > 0.0 && mirrored * wo_above > 0.0 && crosses == (wi_above * wo_above < 0.0)
}

/// Returns the gain of light that is followed forward from `wi` to `wo`: a beam has another width by the shading normal
/// than by the geometric normal. Veach 1997, equation 5.19.
pub fn forward_factor(point: &SurfacePoint, wo: DVec3, wi: DVec3) -> f64 {
    if point.shading == point.normal {
        return 1.0;
    }
    let [flat, smooth] = [point.normal, point.shading];
    ((wo.dot(flat) * wi.dot(smooth)) / (wo.dot(smooth) * wi.dot(flat))).abs()
}

/// Returns the shading normal or, if that would mirror `wo` below the triangle, the one that mirrors it as far above.
fn bent_normal(wo: DVec3, flat: DVec3, smooth: DVec3) -> DVec3 {
    let mirrored = reflect(wo, smooth);
    if mirrored.dot(flat) > 0.0 { smooth } else { unit(wo + folded_direction(mirrored, flat)) }
}

/// Returns the mirror image of a direction in the triangle's plane.
pub fn folded_direction(direction: DVec3, flat: DVec3) -> DVec3 {
    unit(direction - flat * (2.0 * direction.dot(flat)))
}

/// Calls `Material::scatter`, and folds every direction to its side of the triangle of normal `flat`.
pub fn scatter<const N: usize>(
    material: &Material<Table>,
    context: &ScatterContext<N>,
    flat: DVec3,
    u: [f64; 2],
    branches: &mut Vec<Branch<N>>,
) {
    material.scatter(context, u, branches);
    if flat == context.normal {
        return;
    }
    for branch in branches {
        if branch.crosses != (branch.wi.dot(flat) < 0.0) {
            branch.wi = folded_direction(branch.wi, flat);
        }
        if branch.pdf.is_some() {
            branch.pdf = Some(evaluate(material, context, flat, branch.wi).map_or(0.0, |(_, pdf)| pdf));
        }
    }
}

/// Calls `Material::evaluate` for both ways to a direction: unfolded, and folded at the triangle of normal `flat`.
pub fn evaluate<const N: usize>(
    material: &Material<Table>,
    context: &ScatterContext<N>,
    flat: DVec3,
    wi: DVec3,
) -> Option<(Lanes<N>, f64)> {
    if flat == context.normal {
        return material.evaluate(context, wi);
    }
    // A direction is folded where the two normals put it on different sides.
    let above = wi.dot(flat) > 0.0;
    let evaluate_drawn = |drawn: DVec3| match (drawn.dot(context.normal) > 0.0) == above {
        true => material.evaluate(context, drawn),
        false => None,
    };
    match (evaluate_drawn(wi), evaluate_drawn(folded_direction(wi, flat))) {
        (Some((a, p)), Some((b, q))) => Some((a + b, p + q)),
        (a, b) => a.or(b),
    }
}
