//! Light that reaches a camera path from a vertex of a light path.

use std::cell::Cell;

use super::dimensions::VERTEX;
use super::sensor::Sensor;
use crate::math::{Ray, Sampler, gamma, unit};
use crate::scene::RayEnds;
use crate::shape::prefetch;
use crate::trace::World;
use crate::trace::contribution::{Contribution, FoundBy};
use crate::trace::photon::{LightVertex, LightVertices};
use crate::trace::received_light::ReceivedLight;
use crate::trace::walk::{FoundLight, Interaction, ObjectSet, Occluders, Path, Polarization, VisibilityTest, shading};

/// A path at a diffuse surface.
pub struct Resampling<'a, const N: usize, P> {
    pub world: &'a World,
    pub path: &'a Path<N, P>,
    pub interaction: &'a Interaction<'a, N>,
    pub vertices: &'a LightVertices<N>,
    /// The object that last occluded a light.
    pub last_occluder: &'a Cell<Option<u32>>,
}

impl<const N: usize, P: Polarization<N>> Resampling<'_, N, P> {
    /// Passes the light of two vertices to the sensor, if they are visible.
    pub fn gather(&self, sampler: &Sampler, sensor: &mut Sensor<N>) {
        let [a, b, c, d] = sampler.get_4d(self.path.key, VERTEX);
        // Both are chosen first, so that the memory of one is read while the other is chosen.
        let chosen = [[a, b], [c, d]].map(|u| {
            let chosen = self.vertices.choose(self.interaction.point.position, self.interaction.flat, u);
            chosen.inspect(|(vertex, _)| prefetch(*vertex))
        });
        for (vertex, factor) in chosen.into_iter().flatten() {
            self.connect(vertex, 0.5 * factor, sensor);
        }
    }

    /// Passes the light of a vertex to the sensor. Returns `None` if the vertex is not visible or contributes nothing.
    fn connect(&self, vertex: &LightVertex<N>, factor: f64, sensor: &mut Sensor<N>) -> Option<()> {
        let (world, interaction) = (self.world, self.interaction);
        let bounces = self.path.surfaces().saturating_add(vertex.surfaces);
        if bounces > world.method.max_bounces || vertex.diffuse > self.path.diffuse_left {
            return None;
        }
        let to = vertex.position;
        let origin = interaction.point.leave((to - interaction.point.position).try_normalize()?).origin;
        let way = to - origin;
        let distance_squared = way.length_squared();
        let direction = unit(way.try_normalize()?);
        let (ray, distance) = (Ray { origin, direction }, distance_squared.sqrt());
        let cos = -direction.dot(vertex.flat);
        if direction.dot(interaction.flat) <= 0.0 || cos <= 0.0 {
            return None;
        }
        let (mut bsdf_cos, _) =
            shading::evaluate(interaction.material, &interaction.context, interaction.flat, direction)?;
        // The ray ends before the surface of the vertex. That surface lies within its error of the point, and the ray,
        // whose direction is rounded, passes the point within a few rounding errors of the distance.
        let margin = (vertex.error + gamma(8) * distance) / cos;
        let ends = RayEnds { start: self.path.last_primitive, ..RayEnds::default() };
        let (distance, inside, last_occluder) = (distance - margin, interaction.boundary.here, self.last_occluder);
        let occluders = Occluders::Objects(ObjectSet::All);
        let segment = VisibilityTest { ray: &ray, distance, ends, inside, occluders, last_occluder };
        let toward = || self.path.polarization.toward_light(interaction, direction, &mut bsdf_cos);
        let (arriving, on_its_way) =
            segment.arriving_light(world, interaction.context.draw, toward, || vertex.leaving)?;
        let factor = factor * cos / (distance_squared + self.vertices.near_squared());
        let lanes = &self.path.throughput.scaled(factor).of(bsdf_cos * arriving);
        let received =
            ReceivedLight { source: vertex.light, draw: interaction.context.draw, lanes, parted: self.path.parted };
        let found_light = FoundLight::new(world, &received, None);
        let rgb = found_light.rgb;
        let polarization_change =
            self.path.polarization.change_along(interaction, direction, &on_its_way, &found_light);
        let (bounces, dispersed) = (self.path.bounces + 1 + vertex.surfaces, self.path.parted || vertex.parted);
        let first = self.path.first_lobe(world, interaction, direction, false);
        let light = Some(vertex.light);
        let found = if vertex.is_of_photon { FoundBy::Gathered } else { FoundBy::Connected };
        sensor.receive(
            Contribution { light, found, rgb, polarization_change, first, bounces, dispersed },
            &found_light,
            &on_its_way,
        );
        Some(())
    }
}
