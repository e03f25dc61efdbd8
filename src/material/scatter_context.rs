//! Light that arrives at a surface, followed backward from the viewer.

use super::fresnel::SharedRay;
use super::{Lobes, shared_transmittance};
use crate::math::DVec3;
use crate::spectrum::{Draw, Lanes, Table, Waves};

/// What a material may use to scatter the arriving light, which is followed backward from the viewer.
#[derive(Clone, Copy, Debug)]
pub struct ScatterContext<'a, const N: usize> {
    /// Unit vector to the viewer.
    pub wo: DVec3,
    /// Unit shading normal on the viewer's side; on smooth meshes it differs from that of the triangle.
    pub normal: DVec3,
    /// Surface coordinates of the hit, for spectra that vary over the surface.
    pub uv: [f64; 2],
    /// Which bin each lane reads.
    pub draw: &'a Draw<N>,
    /// Where each lane lies in the spectrum.
    pub waves: &'a Waves,
    /// 1 for the lanes on the ray, 0 for the others.
    pub present: Lanes<N>,
    /// Whether the viewer is behind the surface's front, inside a clear body, and sees a coating from its inner side.
    pub from_inside: bool,
    /// Whether a single lane is left on the ray since lanes parted.
    pub is_alone: bool,
    /// Refractive index on the viewer's side.
    pub incident: Index<'a>,
    /// Refractive index beyond the surface; equal to `incident` where no medium begins or ends.
    pub beyond: Index<'a>,
    /// The indices by which all rays are refracted on the viewer's side and beyond; None where each lane uses its own.
    pub direction_indices: [Option<f64>; 2],
    /// Lanes whose refracted rays lie within this angle of each other, in radians, stay together.
    pub together: f64,
    /// The requested lobes: all of them, unless photons contribute what some of them scatter.
    pub lobes: Lobes,
}

/// The refractive index of a medium.
#[derive(Clone, Copy, Debug)]
pub enum Index<'a> {
    /// One index for all lanes.
    Same(f64),
    /// Each lane's own.
    Own(&'a Table),
}

impl<const N: usize> ScatterContext<'_, N> {
    /// Returns a lane's index on the viewer's side.
    pub fn incident_of(&self, lane: usize) -> f64 {
        self.index_of(self.incident, lane)
    }

    /// Returns a lane's index beyond the surface.
    pub fn beyond_of(&self, lane: usize) -> f64 {
        self.index_of(self.beyond, lane)
    }

    #[inline]
    fn index_of(&self, index: Index, lane: usize) -> f64 {
        match index {
            Index::Same(index) => index,
            Index::Own(table) => self.draw.read_lane(table, lane),
        }
    }

    /// Returns the vacuum wavelength of a lane in nm, and the width of its band divided by that wavelength.
    pub(super) fn wave(&self, lane: usize) -> [f64; 2] {
        self.waves.of_lane(self.draw, lane)
    }

    /// Returns the indices of all lanes on both sides.
    pub(super) fn indices(&self) -> [[f64; N]; 2] {
        [self.incident, self.beyond].map(|index| match index {
            Index::Same(index) => [index; N],
            Index::Own(table) => self.draw.read_exact(table),
        })
    }

    /// Reads a table of the material for this ray.
    pub fn read(&self, table: &Table) -> Lanes<N> {
        self.draw.read_at(table, self.uv)
    }

    /// Reads a factor on the lanes of this ray. Unused lanes get any number.
    pub(super) fn read_tint(&self, table: &Table) -> Lanes<N> {
        if table.is_one() { Lanes::ONE } else { self.read(table) }
    }

    /// Returns the context of the same surface seen from its other side.
    #[must_use]
    pub fn turned_around(self) -> Self {
        let [here, beyond] = self.direction_indices;
        let (incident, new_beyond) = (self.beyond, self.incident);
        let from_inside = !self.from_inside;
        Self { from_inside, incident, beyond: new_beyond, direction_indices: [beyond, here], ..self }
    }

    /// Returns the indices on both sides by which a lane's ray is refracted.
    pub(super) fn ray_indices(&self, lane: usize) -> [f64; 2] {
        let [here, beyond] = self.direction_indices;
        [here.unwrap_or_else(|| self.incident_of(lane)), beyond.unwrap_or_else(|| self.beyond_of(lane))]
    }

    /// Returns the indices by which the rays of all lanes are refracted, if they are given on both sides.
    pub fn one_direction(&self) -> Option<[f64; 2]> {
        let [here, beyond] = self.direction_indices;
        Some([here?, beyond?])
    }

    /// Returns the transmittance of each lane at a smooth boundary between the media, which the ray meets at an angle
    /// with cosine `cos`. Returns None where all rays are refracted by the lanes' own indices.
    pub(super) fn own_transmittance(&self, cos: f64) -> Option<[f64; N]> {
        if self.direction_indices == [None; 2] {
            return None;
        }
        let [incident, beyond] = self.indices();
        Some(match self.one_direction() {
            Some(directions) => shared_transmittance([&incident, &beyond], directions, cos),
            None => std::array::from_fn(|i| {
                let own = [&[incident[i]], &[beyond[i]]];
                shared_transmittance::<1>(own, self.ray_indices(i), cos)[0]
            }),
        })
    }

    /// Returns a lane's indices on both sides, and the cosine at which the lane, by its own index, meets a smooth
    /// boundary that its ray meets at an angle with cosine `cos`. Returns those of the ray under total reflection.
    pub(super) fn own_boundary(&self, lane: usize, cos: f64) -> [f64; 3] {
        let own @ [n1, n2] = [self.incident_of(lane), self.beyond_of(lane)];
        if self.direction_indices == [None; 2] {
            return [n1, n2, cos];
        }
        let ray @ [here, beyond] = self.ray_indices(lane);
        if ray == own || here * here * (1.0 - cos * cos) >= beyond * beyond {
            return [here, beyond, cos];
        }
        [n1, n2, SharedRay::new(ray, cos).normal_component(own) / n1]
    }

    /// Returns the factor that turns shares of crossing light, computed as if the light source were the viewer, into
    /// shares of flux.
    ///
    /// Radiance changes by each lane's own (n_here / n_beyond)^2, and solid angles by the same ratio of the ray's
    /// indices. Flux changes by the quotient of both, which is inverted between light and viewer. Returns None where
    /// both are equal.
    pub fn forward(&self) -> Option<Lanes<N>> {
        (self.direction_indices != [None; 2]).then(|| {
            Lanes::from_fn(|i| {
                let [here, beyond] = self.ray_indices(i);
                let ratio = (self.beyond_of(i) / self.incident_of(i)) * (here / beyond);
                ((ratio * ratio) * (ratio * ratio)) as f32
            })
        })
    }

    /// Returns whether crossing light takes different directions in different lanes.
    pub fn parts(&self) -> bool {
        if self.is_alone
            || self.one_direction().is_some()
            || matches!((self.incident, self.beyond), (Index::Same(_), Index::Same(_)))
        {
            return false;
        }
        let first = self.ray_indices(0);
        let same = |i: usize| self.ray_indices(i) == first;
        !((1..N).all(same) || (self.together > 0.0 && self.lanes_stay_together()))
    }

    /// Returns the smallest and the largest index by which rays are refracted on one side: the given one, or the lanes'
    /// own.
    #[inline]
    fn range(&self, given: Option<f64>, index: Index) -> [f64; 2] {
        match (given, index) {
            (Some(index), _) | (None, Index::Same(index)) => [index; 2],
            (None, Index::Own(table)) => self.draw.range(table),
        }
    }

    /// Returns whether the outermost refracted rays lie within `together`. Considers all lanes of a draw, on this ray
    /// or not, so that the result does not depend on what was absorbed earlier.
    fn lanes_stay_together(&self) -> bool {
        let cos = self.wo.dot(self.normal).clamp(0.0, 1.0);
        let [given, given_beyond] = self.direction_indices;
        let (here, beyond) = (self.range(given, self.incident), self.range(given_beyond, self.beyond));
        let ratios = if here[0] == here[1] || beyond[0] == beyond[1] {
            [here[0] / beyond[1], here[1] / beyond[0]]
        } else {
            // Plain comparisons suffice, since no index is NaN: `min` and `max` would check for it in every lane.
            let widen = |[l, m]: [f64; 2], [here, beyond]: [f64; 2]| {
                let x = here / beyond;
                [if x < l { x } else { l }, if x > m { x } else { m }]
            };
            (0..N).map(|i| self.ray_indices(i)).fold([f64::INFINITY, 0.0], widen)
        };
        let [a, b] = ratios.map(|eta| {
            let sin = eta * (1.0 - cos * cos).sqrt();
            [sin, (1.0 - sin * sin).max(0.0).sqrt()]
        });
        // sin(a - b), for rays that cross.
        a[1] > 0.0 && b[1] > 0.0 && (b[0] * a[1] - a[0] * b[1]).abs() <= self.together
    }
}
