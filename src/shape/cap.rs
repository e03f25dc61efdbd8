use crate::math::{DVec3, Frame, cone};

/// The part of a sphere around one of its points, which may be all that a scene sees of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cap {
    /// Unit normal in the middle.
    axis: DVec3,
    /// 1 - cos of the angle from the middle to the rim; the cap's share of the sphere is half of it.
    one_minus_cos: f64,
}

/// Points of a cap below which it is not known well enough.
const ENOUGH: usize = 64;

impl Cap {
    /// The cap in which unit normals lie that were met at random; none if they are too few.
    ///
    /// Its middle is nearly that of the smallest one: Badoiu & Clarkson 2003, *Smaller Core-Sets for Balls*. It is larger by a
    /// margin, the more so the fewer are known: what is seen beyond the rim makes rare bright samples, which cost more than
    /// some that see nothing.
    pub fn around(normals: &[DVec3]) -> Option<Self> {
        if normals.len() < ENOUGH {
            return None;
        }
        let mut middle = normals.iter().sum::<DVec3>() / normals.len() as f64;
        let distance = |from: DVec3| move |normal: &DVec3| (*normal - from).length_squared();
        for step in 1..=100_u32 {
            let farthest = normals.iter().max_by(|a, b| distance(middle)(a).total_cmp(&distance(middle)(b)))?;
            middle += (*farthest - middle) / f64::from(step + 1);
        }
        let axis = middle.try_normalize()?;
        let widest = normals.iter().map(distance(axis)).fold(0.0, f64::max);
        Some(Self { axis, one_minus_cos: 0.5 * widest * (1.1 + 4.0 / (normals.len() as f64).sqrt()) })
    }

    /// Its share of the sphere.
    pub fn share(&self) -> f64 {
        0.5 * self.one_minus_cos
    }

    /// Whether the point of a unit normal belongs to it: |n - a|^2 = 2 (1 - cos) keeps its digits on the smallest caps.
    pub(super) fn contains(&self, normal: DVec3) -> bool {
        0.5 * (normal - self.axis).length_squared() <= self.one_minus_cos
    }

    /// The unit normal of a point uniform by area.
    pub(super) fn sample(&self, u: [f64; 2]) -> DVec3 {
        Frame::about(self.axis).to_world(cone(self.one_minus_cos, u).0)
    }
}
