use std::f64::consts::PI;

use super::{Intersection, SurfacePoint};
use crate::math::{Bounds, DMat3, DVec3, Ray, Transform, gamma};

/// A sphere after a non-uniform scale: all points `center + axes * x` with |x| = 1. Its front is the outside.
#[derive(Clone, Debug, PartialEq)]
pub struct Ellipsoid {
    pub(super) center: DVec3,
    axes: DMat3,
    inverse: DMat3,
}

impl Ellipsoid {
    /// Creates the image of the unit sphere under an invertible matrix.
    pub fn new(center: DVec3, axes: DMat3) -> Self {
        Self { center, axes, inverse: axes.inverse() }
    }

    /// Returns both roots, by the sphere's cross-product form in the space where the ellipsoid is the unit sphere.
    fn roots(&self, ray: &Ray) -> Option<[f64; 2]> {
        let d = self.inverse * (self.center - ray.origin);
        let direction = self.inverse * ray.direction;
        let length = direction.length();
        let n = direction / length;
        let s2 = 1.0 - d.cross(n).length_squared();
        if s2 >= 0.0 {
            let (middle, s) = (d.dot(n), s2.sqrt());
            Some([(middle - s) / length, (middle + s) / length])
        } else {
            None
        }
    }

    pub(super) fn intersect(&self, ray: &Ray, t_max: f64) -> Option<Intersection> {
        let t = self.roots(ray)?.into_iter().find(|&t| t > 0.0)?;
        (t <= t_max).then(|| Intersection::at(t))
    }

    pub(super) fn point(&self, hit: DVec3) -> SurfacePoint {
        self.point_at(self.to_unit_sphere(hit))
    }

    /// Returns the point of the unit sphere that corresponds to a point of the surface.
    pub(super) fn to_unit_sphere(&self, point: DVec3) -> DVec3 {
        (self.inverse * (point - self.center)).normalize()
    }

    /// Returns the vectors from the center to three points of the surface, which need not be at right angles.
    pub(super) fn half_axes(&self) -> [DVec3; 3] {
        [self.axes.x_axis, self.axes.y_axis, self.axes.z_axis]
    }

    pub(super) fn is_outside(&self, point: DVec3) -> bool {
        (self.inverse * (point - self.center)).length_squared() > 1.0
    }

    /// Returns the point of the surface that corresponds to a point of the unit sphere.
    pub(super) fn point_at(&self, unit: DVec3) -> SurfacePoint {
        let arm = self.axes * unit;
        let position = self.center + arm;
        let gradient = self.inverse.transpose() * unit;
        let length = gradient.length();
        let normal = gradient / length;
        // As on a sphere, with 3 more roundings for the matrix, relative to its terms. The unit vector itself comes
        // from the inverse matrix. The rounding of that grows with the ratio of the axes, and moves the point along the
        // surface.
        let terms = self.axes.abs() * unit.abs();
        // The roots of a ray that leaves are off by up to 24 roundings on the unit sphere, relative to the terms of the
        // inverse matrix. A step along the normal changes the height over that sphere by the length of the gradient.
        let height = unit.abs().dot(self.inverse.abs() * terms) / length;
        let error = terms * gamma(12) + position.abs() * gamma(6) + normal.abs() * height * gamma(24);
        SurfacePoint { position, error, normal, shading: normal }
    }

    pub(super) fn bounds(&self) -> Bounds {
        Bounds::of_ellipsoid(self.center, self.axes).padded(12)
    }

    pub(super) fn transformed(&self, map: &Transform) -> Self {
        let [x, y, z] = [self.axes.x_axis, self.axes.y_axis, self.axes.z_axis].map(|axis| map.vector(axis));
        Self::new(map.point(self.center), DMat3::from_cols(x, y, z))
    }

    /// Returns an approximate area, at most 16 % too large for flat ellipsoids. It only weights lights against each
    /// other.
    ///
    /// This is Thomsen's formula with p = 2. Its sum of squares needs no principal axes: the sum over the products of
    /// two axes is the same for any three axes that span the ellipsoid (Cauchy and Binet).
    pub(super) fn area(&self) -> f64 {
        let [a, b, c] = [self.axes.x_axis, self.axes.y_axis, self.axes.z_axis];
        let squares = a.cross(b).length_squared() + b.cross(c).length_squared() + c.cross(a).length_squared();
        4.0 * PI * (squares / 3.0).sqrt()
    }

    /// Returns the density per steradian of the direction of a ray. Either crossing along it can be drawn, so their
    /// densities add.
    pub(super) fn pdf(&self, ray: &Ray) -> f64 {
        let roots = self.roots(ray).into_iter().flatten();
        roots.filter(|&t| t > 0.0).map(|t| self.density_at(ray, t)).sum()
    }

    /// Returns the density per steradian of one crossing.
    fn density_at(&self, ray: &Ray, t: f64) -> f64 {
        let unit = self.to_unit_sphere(ray.at(t));
        t * t / (4.0 * PI * self.area_normal(unit).dot(ray.direction).abs())
    }

    /// Returns the density per unit area of points that are uniform on the unit sphere.
    pub(super) fn area_density(&self, unit: DVec3) -> f64 {
        1.0 / (4.0 * PI * self.area_normal(unit).length())
    }

    /// Returns the normal, its length the growth of area from the unit sphere: Nanson's relation, |det A| A^-T n.
    fn area_normal(&self, unit: DVec3) -> DVec3 {
        self.inverse.transpose() * unit * self.axes.determinant().abs()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tests a sphere, a flat disc seen from both sides, and a needle, each with and without a rotation before the
    /// stretch.
    #[test]
    fn areas_of_thin_ellipsoids_are_a_sixth_too_large_at_most_whichever_way_their_axes_are_given() {
        let cases = [
            (DVec3::ONE, 4.0 * PI),
            (DVec3::new(2.0, 3.0, 1e-9), 2.0 * PI * 6.0),
            (DVec3::new(1000.0, 1.0, 1.0), PI * PI * 1000.0),
        ];
        for (half_axes, area) in cases {
            for turned in [DMat3::IDENTITY, DMat3::from_rotation_z(0.7), DMat3::from_rotation_x(2.0)] {
                let found = Ellipsoid::new(DVec3::ZERO, DMat3::from_diagonal(half_axes) * turned).area();
                assert!((0.999..1.16).contains(&(found / area)), "{half_axes} turned by {turned}: {found} for {area}");
            }
        }
    }
}
