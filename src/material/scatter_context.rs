//! Light that arrives at a surface, followed backward from the viewer.

use super::fresnel::SharedRay;
use super::{Lobes, shared_transmittance};
use crate::math::DVec3;
use crate::spectrum::{Draw, Lanes, Table, Waves};

/// What a material may know of the light that arrives, followed backward from the viewer.
#[derive(Clone, Copy, Debug)]
pub struct ScatterContext<'a, const N: usize> {
    /// Unit vector to the viewer.
    pub wo: DVec3,
    /// Unit normal by which the surface scatters, on the viewer's side: on smooth meshes not that of the triangle.
    pub normal: DVec3,
    /// Where the surface is hit, for what varies over it.
    pub uv: [f64; 2],
    /// Which bin each lane reads.
    pub draw: &'a Draw<N>,
    /// Where each lane lies in the spectrum.
    pub waves: &'a Waves,
    /// The lanes on the ray, each 1, the others 0.
    pub present: Lanes<N>,
    /// Whether the viewer is behind the surface's front, inside a clear body, and meets a coating at its inner side.
    pub from_inside: bool,
    /// Whether one lane is alone on the ray since lanes parted.
    pub is_alone: bool,
    /// Refractive index on the viewer's side.
    pub incident: Index<'a>,
    /// Refractive index beyond the surface; the same as `incident` where no medium begins or ends.
    pub beyond: Index<'a>,
    /// The index by which all rays are refracted on the viewer's side and beyond; none where that is each lane's own.
    pub direction_indices: [Option<f64>; 2],
    /// Lanes whose refracted rays lie within this angle of each other, in radians, go on as one.
    pub together: f64,
    /// The lobes that are asked for: all, but where photons bring what a part of them scatters.
    pub lobes: Lobes,
}

/// The refractive index of a medium.
#[derive(Clone, Copy, Debug)]
pub enum Index<'a> {
    /// That of all lanes.
    Same(f64),
    /// Each lane's own.
    Own(&'a Table),
}

impl<const N: usize> ScatterContext<'_, N> {
    /// A lane's index on the viewer's side.
    pub fn incident_of(&self, lane: usize) -> f64 {
        self.index_of(self.incident, lane)
    }

    /// A lane's index beyond the surface.
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

    /// The wavelength of a lane in nm in vacuum, and the width of its band over that.
    pub(super) fn wave(&self, lane: usize) -> [f64; 2] {
        self.waves.of_lane(self.draw, lane)
    }

    /// The indices of all lanes on both sides.
    pub(super) fn indices(&self) -> [[f64; N]; 2] {
        [self.incident, self.beyond].map(|index| match index {
            Index::Same(index) => [index; N],
            Index::Own(table) => self.draw.read_exact(table),
        })
    }

    /// A table of the material, read for this ray.
    pub fn read(&self, table: &Table) -> Lanes<N> {
        self.draw.read_at(table, self.uv)
    }

    /// A factor on the lanes of this ray. Lanes that stand for nothing get any number.
    pub(super) fn read_tint(&self, table: &Table) -> Lanes<N> {
        if table.is_one() { Lanes::ONE } else { self.read(table) }
    }

    /// The same surface, seen from its other side.
    pub fn turned_around(self) -> Self {
        let [here, beyond] = self.direction_indices;
        let (incident, beyond_it) = (self.beyond, self.incident);
        let from_inside = !self.from_inside;
        Self { from_inside, incident, beyond: beyond_it, direction_indices: [beyond, here], ..self }
    }

    /// The indices by which a lane's ray is refracted, on both sides.
    pub(super) fn refracting(&self, lane: usize) -> [f64; 2] {
        let [here, beyond] = self.direction_indices;
        [here.unwrap_or_else(|| self.incident_of(lane)), beyond.unwrap_or_else(|| self.beyond_of(lane))]
    }

    /// The indices by which the rays of all lanes are refracted, where they are given.
    pub fn one_direction(&self) -> Option<[f64; 2]> {
        let [here, beyond] = self.direction_indices;
        Some([here?, beyond?])
    }

    /// What of each lane crosses a smooth boundary between the media that its ray meets at an angle of some cosine;
    /// none where all rays are refracted by the lanes' own indices.
    pub(super) fn own_transmittance(&self, cos: f64) -> Option<[f64; N]> {
        if self.direction_indices == [None; 2] {
            return None;
        }
        let [incident, beyond] = self.indices();
        Some(match self.one_direction() {
            Some(directions) => shared_transmittance([&incident, &beyond], directions, cos),
            None => std::array::from_fn(|i| {
                let own = [&[incident[i]], &[beyond[i]]];
                shared_transmittance::<1>(own, self.refracting(i), cos)[0]
            }),
        })
    }

    /// A lane's indices on both sides, and the cosine under which it meets, by its own index, a smooth boundary that
    /// its ray meets at an angle of some cosine; those of the ray where that is reflected totally.
    pub(super) fn own_boundary(&self, lane: usize, cos: f64) -> [f64; 3] {
        let own @ [n1, n2] = [self.incident_of(lane), self.beyond_of(lane)];
        if self.direction_indices == [None; 2] {
            return [n1, n2, cos];
        }
        let along @ [here, beyond] = self.refracting(lane);
        if along == own || here * here * (1.0 - cos * cos) >= beyond * beyond {
            return [here, beyond, cos];
        }
        [n1, n2, SharedRay::new(along, cos).normal_component(own) / n1]
    }

    /// What turns the shares of light that crosses, followed from the light as if it were the viewer, into those of
    /// flux.
    ///
    /// Radiance changes by each lane's own (n_here / n_beyond)^2 and solid angles by that of the rays: flux by their
    /// ratio, which light and viewer see the other way round. None where both are the same.
    pub fn forward(&self) -> Option<Lanes<N>> {
        (self.direction_indices != [None; 2]).then(|| {
            Lanes::from_fn(|i| {
                let [here, beyond] = self.refracting(i);
                let ratio = (self.beyond_of(i) / self.incident_of(i)) * (here / beyond);
                ((ratio * ratio) * (ratio * ratio)) as f32
            })
        })
    }

    /// Whether light that crosses the surface goes different ways in different lanes.
    pub fn parts(&self) -> bool {
        if self.is_alone
            || self.one_direction().is_some()
            || matches!((self.incident, self.beyond), (Index::Same(_), Index::Same(_)))
        {
            return false;
        }
        let first = self.refracting(0);
        let same = |i: usize| self.refracting(i) == first;
        !((1..N).all(same) || (self.together > 0.0 && self.is_one_way()))
    }

    /// The smallest and the largest index by which rays are refracted on a side: the one given, or the lanes' own.
    #[inline]
    fn range(&self, given: Option<f64>, index: Index) -> [f64; 2] {
        match (given, index) {
            (Some(index), _) | (None, Index::Same(index)) => [index; 2],
            (None, Index::Own(table)) => self.draw.range(table),
        }
    }

    /// Whether the outermost refracted rays lie within `together`. All lanes of a draw are asked, on this ray or not,
    /// so that what becomes of a surface does not depend on what was absorbed before.
    fn is_one_way(&self) -> bool {
        let cos = self.wo.dot(self.normal).clamp(0.0, 1.0);
        let [given, given_beyond] = self.direction_indices;
        let (here, beyond) = (self.range(given, self.incident), self.range(given_beyond, self.beyond));
        let ratios = if here[0] == here[1] || beyond[0] == beyond[1] {
            [here[0] / beyond[1], here[1] / beyond[0]]
        } else {
            // Plain comparisons, since no index is a NaN: `min` and `max` would ask about that in every lane.
            let wider = |[l, m]: [f64; 2], [here, beyond]: [f64; 2]| {
                let x = here / beyond;
                [if x < l { x } else { l }, if x > m { x } else { m }]
            };
            (0..N).map(|i| self.refracting(i)).fold([f64::INFINITY, 0.0], wider)
        };
        let [a, b] = ratios.map(|eta| {
            let sin = eta * (1.0 - cos * cos).sqrt();
            [sin, (1.0 - sin * sin).max(0.0).sqrt()]
        });
        // sin(a - b), for rays that cross.
        a[1] > 0.0 && b[1] > 0.0 && (b[0] * a[1] - a[0] * b[1]).abs() <= self.together
    }
}
