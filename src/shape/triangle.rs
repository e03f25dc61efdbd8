use super::bvh::Line;
use super::outline::{Outline, is_near};
use super::{Intersection, SurfacePoint};
use crate::math::{Bounds, DVec3, Ray, Transform, gamma, sample_triangle};

/// A triangle; its front is the side from which the points run counterclockwise.
///
/// A point of it is p1 + u (p2 - p1) + v (p3 - p1) with affine coordinates u, v >= 0, u + v <= 1.
///
/// ```toml
/// shape.triangle = { points = [[0, 0, 0], [1, 0, 0], [0, 1, 0]] }
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Triangle {
    pub(super) points: [DVec3; 3],
}

impl Triangle {
    /// Creates the triangle of three points that do not lie on a line.
    pub fn new(points: [DVec3; 3]) -> Self {
        Self { points }
    }

    /// Returns whether three points span no area: they coincide or lie on a line as exactly as f64 can tell.
    pub fn is_degenerate(points: [DVec3; 3]) -> bool {
        scaled_normal(points).length_squared() == 0.0
    }

    pub(super) fn intersect(&self, ray: &Ray, t_max: f64) -> Option<Intersection> {
        ShearedRay::new(ray).intersect(self.points, t_max)
    }

    pub(super) fn point(&self, uv: [f64; 2]) -> SurfacePoint {
        let (position, normal) = (self.at(uv), self.normal());
        SurfacePoint { position, error: self.error(), normal, shading: normal }
    }

    /// Returns a bound of the error of a point.
    fn error(&self) -> DVec3 {
        let [p1, p2, p3] = self.points;
        let largest = p1.abs().max(p2.abs()).max(p3.abs());
        // The intersection test forms differences as long as the triangle in every coordinate, even in one that is 0 at
        // all corners.
        let extent = p1.max(p2).max(p3) - p1.min(p2).min(p3);
        (largest + DVec3::splat(extent.max_element())) * gamma(7)
    }

    fn at(&self, [u, v]: [f64; 2]) -> DVec3 {
        let [p1, p2, p3] = self.points;
        p1 * (1.0 - u - v) + p2 * u + p3 * v
    }

    /// Returns the unit normal by the right-hand rule.
    pub fn normal(&self) -> DVec3 {
        scaled_normal(self.points).normalize()
    }

    pub(super) fn bounds(&self) -> Bounds {
        Bounds::around(self.points)
    }

    pub(super) fn transformed(&self, map: &Transform) -> Self {
        Self { points: map.fix_winding(self.points.map(|p| map.point(p))) }
    }

    pub(super) fn area(&self) -> f64 {
        let [p1, p2, p3] = self.points;
        0.5 * (p2 - p1).cross(p3 - p1).length()
    }

    /// Returns the outline as seen from a point, if it is near.
    pub(super) fn outline(&self, from: DVec3) -> Option<Outline> {
        self.outline_from(from, self.centroid(), self.radius2())
    }

    fn outline_from(&self, from: DVec3, centroid: DVec3, radius2: f64) -> Option<Outline> {
        let [p1, p2, p3] = self.points;
        if !is_near(centroid - from, radius2) {
            return None;
        }
        Outline::seen_from(from, &self.points, (p2 - p1).cross(p3 - p1))
    }

    fn centroid(&self) -> DVec3 {
        let [p1, p2, p3] = self.points;
        (p1 + p2 + p3) / 3.0
    }

    /// Returns the square of half the longest edge.
    fn radius2(&self) -> f64 {
        let [p1, p2, p3] = self.points;
        let longest = (p2 - p1).length_squared().max((p3 - p1).length_squared()).max((p3 - p2).length_squared());
        0.25 * longest
    }

    pub(super) fn sample_area(&self, u: [f64; 2]) -> DVec3 {
        self.at(sample_triangle(u))
    }
}

/// A triangle with precomputed values that all of its points share.
#[derive(Clone, Debug)]
pub struct Facet {
    pub(super) triangle: Triangle,
    pub(super) normal: DVec3,
    pub(super) area: f64,
    error: DVec3,
    centroid: DVec3,
    radius2: f64,
}

impl Facet {
    pub(super) fn new(triangle: Triangle) -> Self {
        let (normal, area, error) = (triangle.normal(), triangle.area(), triangle.error());
        let (centroid, radius2) = (triangle.centroid(), triangle.radius2());
        Self { triangle, normal, area, error, centroid, radius2 }
    }

    pub(super) fn outline(&self, from: DVec3) -> Option<Outline> {
        self.triangle.outline_from(from, self.centroid, self.radius2)
    }

    pub(super) fn point(&self, uv: [f64; 2]) -> SurfacePoint {
        let (position, normal) = (self.triangle.at(uv), self.normal);
        SurfacePoint { position, error: self.error, normal, shading: normal }
    }
}

/// Returns the normal of the edges divided by their largest coordinate, so that tiny and huge triangles neither
/// underflow nor overflow.
fn scaled_normal([p1, p2, p3]: [DVec3; 3]) -> DVec3 {
    let (e1, e2) = (p2 - p1, p3 - p1);
    let size = e1.abs().max(e2.abs()).max_element();
    if size == 0.0 { DVec3::ZERO } else { (e1 / size).cross(e2 / size) }
}

/// A ray prepared for watertight tests: sheared so that it runs along +z.
///
/// Woop, Benthin & Wald 2013, *Watertight Ray/Triangle Intersection*, here in 64 bits. Edge functions that round to
/// zero are decided by their exact sign, so that of two triangles that share an edge at least one is hit.
pub(super) struct ShearedRay {
    origin: DVec3,
    /// The axes that become x, y and z.
    pub(super) order: [usize; 3],
    shear: DVec3,
}

/// Bound of 264 chained roundings, relative to the cube of the largest difference. Nearer to the plane than this, the
/// side on which a ray starts is decided exactly, so that a ray that leaves any triangle by any offset does not hit it
/// again.
const ROUNDING_BOUND: f64 = gamma(264);

impl ShearedRay {
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

    /// Returns the ray in the form that the test of four triangles at once takes.
    pub(super) fn line(&self) -> Line {
        Line { origin: self.order.map(|axis| self.origin[axis]), shear: self.shear.to_array(), near: ROUNDING_BOUND }
    }

    /// Returns the crossing with 0 < t <= `t_max`, edges and corners included.
    #[inline]
    pub(super) fn intersect(&self, points: [DVec3; 3], t_max: f64) -> Option<Intersection> {
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
        let mut along = (u * a[2] + v * b[2] + w * c[2]) * self.shear.z;
        let size = points.map(|p| (p - self.origin).abs().max_element()).into_iter().fold(0.0, f64::max);
        if along.abs() <= ROUNDING_BOUND * size * size * size * self.shear.z.abs() {
            along = -triple_product(points.map(|p| difference(p, self.origin))) * self.shear.z.abs();
        }
        let t = along / determinant;
        (t > 0.0 && t <= t_max).then(|| Intersection { t, part: 0, uv: [v / determinant, w / determinant] })
    }
}

/// Returns a b - c d, with the right sign even where the rounded products are equal.
///
/// Each fused multiply-add gives the rounding error of a product exactly: Kahan's algorithm, Jeannerod et al. 2013.
pub(super) fn difference_of_products(a: f64, b: f64, c: f64, d: f64) -> f64 {
    let (ab, cd) = (a * b, c * d);
    (ab - cd) + (a.mul_add(b, -ab) - c.mul_add(d, -cd))
}

/// An unevaluated sum of two f64, with twice the working precision.
///
/// Hida, Li & Bailey 2001, *Algorithms for Quad-Double Precision Floating Point Arithmetic*, section 3.
#[derive(Clone, Copy)]
struct DoubleDouble(f64, f64);

impl DoubleDouble {
    /// Returns a + b without rounding (Knuth 1969, theorem B of section 4.2.2).
    fn two_sum(a: f64, b: f64) -> Self {
        let sum = a + b;
        let b_virtual = sum - a;
        Self(sum, (a - (sum - b_virtual)) + (b - b_virtual))
    }

    fn add(self, other: Self) -> Self {
        let Self(high, low) = Self::two_sum(self.0, other.0);
        Self::two_sum(high, low + (self.1 + other.1))
    }

    fn times(self, other: Self) -> Self {
        let high = self.0 * other.0;
        let low = self.0.mul_add(other.0, -high);
        Self::two_sum(high, low + (self.0 * other.1 + self.1 * other.0))
    }

    fn minus(self, other: Self) -> Self {
        self.add(Self(-other.0, -other.1))
    }
}

/// Returns p - q without rounding.
fn difference(p: DVec3, q: DVec3) -> [DoubleDouble; 3] {
    std::array::from_fn(|axis| DoubleDouble::two_sum(p[axis], -q[axis]))
}

/// Returns a . (b x c), accurate to about 30 digits of the largest term.
fn triple_product([a, b, c]: [[DoubleDouble; 3]; 3]) -> f64 {
    let cross = |i: usize, j: usize| b[i].times(c[j]).minus(b[j].times(c[i]));
    a[0].times(cross(1, 2)).add(a[1].times(cross(2, 0))).add(a[2].times(cross(0, 1))).0
}

/// Returns the derivatives over a triangle with respect to coordinates given at its corners, or `None` if those lie on
/// a line.
pub(super) fn tangents_over([p1, p2, p3]: [DVec3; 3], at: [[f32; 2]; 3]) -> Option<[DVec3; 2]> {
    let [a, b, c] = at.map(|uv| uv.map(f64::from));
    let [along, across] = [p2 - p1, p3 - p1];
    let [[u1, v1], [u2, v2]] = [b, c].map(|uv| [uv[0] - a[0], uv[1] - a[1]]);
    let area = u1 * v2 - v1 * u2;
    let tangents = [(along * v2 - across * v1) / area, (across * u1 - along * u2) / area];
    (area != 0.0 && tangents.iter().all(|tangent| tangent.is_finite())).then_some(tangents)
}
