use super::{Crossing, SurfacePoint};
use crate::math::{Bounds, DVec3, Ray, Transform, gamma, triangle_coordinates};

/// A triangle; its front is the side from which the points run counterclockwise.
///
/// A point of it is p1 + u (p2 - p1) + v (p3 - p1) with affine coordinates u, v >= 0, u + v <= 1.
///
/// ```toml
/// shape.triangle = { points = [[0, 0, 0], [1, 0, 0], [0, 1, 0]] }
/// ```
#[derive(Clone, Debug)]
pub struct Triangle {
    points: [DVec3; 3],
}

impl Triangle {
    /// The triangle of three points that do not lie on a line.
    pub fn new(points: [DVec3; 3]) -> Self {
        Self { points }
    }

    /// Whether three points span no area: they coincide or lie on a line as exactly as f64 can tell.
    pub fn is_degenerate(points: [DVec3; 3]) -> bool {
        scaled_normal(points).length_squared() == 0.0
    }

    pub(super) fn intersect(&self, ray: &Ray, t_max: f64) -> Option<Crossing> {
        Sheared::new(ray).intersect(self.points, t_max)
    }

    pub(super) fn point(&self, [u, v]: [f64; 2]) -> SurfacePoint {
        let [p1, p2, p3] = self.points;
        let position = p1 * (1.0 - u - v) + p2 * u + p3 * v;
        let largest = p1.abs().max(p2.abs()).max(p3.abs());
        // The test forms differences as long as the triangle in every coordinate, also in one that is 0 at all corners.
        let extent = p1.max(p2).max(p3) - p1.min(p2).min(p3);
        let error = (largest + DVec3::splat(extent.max_element())) * gamma(7);
        SurfacePoint { position, error, normal: self.normal() }
    }

    /// Unit normal by the right-hand rule.
    pub fn normal(&self) -> DVec3 {
        scaled_normal(self.points).normalize()
    }

    pub(super) fn bounds(&self) -> Bounds {
        Bounds::around(self.points)
    }

    pub(super) fn transformed(&self, map: &Transform) -> Self {
        let [p1, p2, p3] = self.points.map(|p| map.point(p));
        // A mirror image runs the other way around; swapping two points keeps the front in front.
        Self { points: if map.mirrors() { [p1, p3, p2] } else { [p1, p2, p3] } }
    }

    pub(super) fn area(&self) -> f64 {
        let [p1, p2, p3] = self.points;
        0.5 * (p2 - p1).cross(p3 - p1).length()
    }

    pub(super) fn sample(&self, u: [f64; 2]) -> DVec3 {
        self.point(triangle_coordinates(u)).position
    }
}

/// The normal, scaled by the largest edge so that tiny and huge triangles neither underflow nor overflow.
fn scaled_normal([p1, p2, p3]: [DVec3; 3]) -> DVec3 {
    let (e1, e2) = (p2 - p1, p3 - p1);
    let size = e1.abs().max(e2.abs()).max_element();
    if size == 0.0 { DVec3::ZERO } else { (e1 / size).cross(e2 / size) }
}

/// A ray prepared for watertight tests: sheared so that it runs along +z.
///
/// Woop, Benthin & Wald 2013, *Watertight Ray/Triangle Intersection*; here in 64 bits, with edge functions that round
/// to zero decided by their exact sign, so that of two triangles sharing an edge at least one is hit.
pub(super) struct Sheared {
    origin: DVec3,
    order: [usize; 3],
    shear: DVec3,
}

impl Sheared {
    pub(super) fn new(ray: &Ray) -> Self {
        let d = ray.direction.to_array();
        let z = (0..3).max_by(|&a, &b| d[a].abs().total_cmp(&d[b].abs())).unwrap_or(2);
        let (mut x, mut y) = ((z + 1) % 3, (z + 2) % 3);
        if d[z] < 0.0 {
            std::mem::swap(&mut x, &mut y);
        }
        let shear = DVec3::new(d[x] / d[z], d[y] / d[z], 1.0 / d[z]);
        Self { origin: ray.origin, order: [x, y, z], shear }
    }

    /// The crossing with 0 < t <= `t_max`, edges and corners included.
    #[inline]
    pub(super) fn intersect(&self, points: [DVec3; 3], t_max: f64) -> Option<Crossing> {
        let [x, y, z] = self.order;
        let [a, b, c] = points.map(|p| {
            let p = (p - self.origin).to_array();
            [p[x] - self.shear.x * p[z], p[y] - self.shear.y * p[z], p[z]]
        });
        let mut u = c[0] * b[1] - c[1] * b[0];
        let mut v = a[0] * c[1] - a[1] * c[0];
        let mut w = b[0] * a[1] - b[1] * a[0];
        if u == 0.0 || v == 0.0 || w == 0.0 {
            u = difference_of_products(c[0], b[1], c[1], b[0]);
            v = difference_of_products(a[0], c[1], a[1], c[0]);
            w = difference_of_products(b[0], a[1], b[1], a[0]);
        }
        if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
            return None;
        }
        let determinant = u + v + w;
        if determinant == 0.0 {
            return None;
        }
        let t = (u * a[2] + v * b[2] + w * c[2]) * self.shear.z / determinant;
        (t > 0.0 && t <= t_max).then(|| Crossing { t, part: 0, uv: [v / determinant, w / determinant] })
    }
}

/// a b - c d with the right sign even where the rounded products are equal.
///
/// Each fused multiply-add recovers a product's rounding error exactly: Kahan's algorithm, Jeannerod et al. 2013.
fn difference_of_products(a: f64, b: f64, c: f64, d: f64) -> f64 {
    let (ab, cd) = (a * b, c * d);
    (ab - cd) + (a.mul_add(b, -ab) - c.mul_add(d, -cd))
}
