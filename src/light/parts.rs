//! The parts of a light whose shape has several, such as the triangles of a mesh.

use std::collections::HashMap;
use std::fmt;
use std::sync::Arc;

use super::{LightBounds, LightTree};
use crate::math::{DVec3, DiscreteSample, Distribution, Transform};
use crate::shape::{Mesh, Shape};

/// The parts of a light, with the distributions that draw one of them.
#[derive(Clone, Debug)]
pub struct LightParts {
    shared: Arc<PartDistributions>,
    /// For a mesh placed by a similarity transform: the map back to the mesh, and the factor on lengths.
    placement: Option<(Transform, f64)>,
}

#[derive(Debug)]
struct PartDistributions {
    /// The tree that draws parts by the light that they send to a point.
    tree: LightTree,
    /// The distribution of parts by all the light that they send.
    flux: Distribution,
}

/// The parts of known meshes, for all placements by similarity transforms: these keep each part's share of the light.
#[derive(Default)]
pub struct MeshPartsCache(HashMap<*const Mesh, (Arc<Mesh>, Option<Arc<PartDistributions>>)>);

impl fmt::Debug for MeshPartsCache {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.debug_struct("MeshPartsCache").field("meshes", &self.0.len()).finish_non_exhaustive()
    }
}

impl MeshPartsCache {
    /// Returns the parts of a mesh that emits evenly.
    fn distributions_of(&mut self, mesh: &Arc<Mesh>) -> Option<Arc<PartDistributions>> {
        // The mesh is kept alive here, so its address stays unique.
        let new = || (mesh.clone(), PartDistributions::new(&Shape::Mesh(mesh.clone()), |_| 1.0).map(Arc::new));
        self.0.entry(Arc::as_ptr(mesh)).or_insert_with(new).1.clone()
    }
}

impl PartDistributions {
    fn new(shape: &Shape, weight: impl Fn(u32) -> f64) -> Option<Self> {
        let part = |number| {
            let part = LightBounds::of_part(&shape.part(number)?);
            Some(LightBounds { intensity: part.intensity * weight(number), ..part })
        };
        let parts: Vec<_> = (0..shape.part_count()).filter_map(part).collect();
        let flux = || Distribution::new(parts.iter().map(|part| part.intensity));
        (parts.len() > 1).then(|| Self { tree: LightTree::new(&parts), flux: flux() })
    }
}

impl LightParts {
    /// Returns the parts of a shape that emits evenly; `None` if it has only one.
    pub fn of_even_emitter(shape: &Shape, cache: &mut MeshPartsCache) -> Option<Self> {
        let mesh_and_placement = match shape {
            Shape::Mesh(mesh) => Some((mesh, None)),
            Shape::Instance(instance) => instance.similarity().map(|placement| (instance.mesh(), Some(placement))),
            _ => None,
        };
        let Some((mesh, placement)) = mesh_and_placement else { return Self::of(shape, |_| 1.0) };
        Some(Self { shared: cache.distributions_of(mesh)?, placement })
    }

    /// Returns the parts of a shape, where an area of each is weighted by `weight`; `None` if it has only one.
    pub fn of(shape: &Shape, weight: impl Fn(u32) -> f64) -> Option<Self> {
        Some(Self { shared: Arc::new(PartDistributions::new(shape, weight)?), placement: None })
    }

    /// Converts a point and a unit normal to the space of the parts.
    fn to_part_space(&self, from: DVec3, normal: DVec3) -> (DVec3, DVec3) {
        match &self.placement {
            Some((to_own, scale)) => (to_own.point(from), to_own.vector(normal) * *scale),
            None => (from, normal),
        }
    }

    /// Samples a part for a point on a surface, as [`LightTree::sample`] does.
    pub fn sample(&self, from: DVec3, normal: DVec3, two_sided: bool, u: f64) -> Option<DiscreteSample> {
        let (from, normal) = self.to_part_space(from, normal);
        self.shared.tree.sample(from, normal, two_sided, u)
    }

    /// Returns the probability with which `sample` draws a part.
    pub fn probability(&self, part: u32, from: DVec3, normal: DVec3, two_sided: bool) -> f64 {
        let (from, normal) = self.to_part_space(from, normal);
        self.shared.tree.probability(part as usize, from, normal, two_sided)
    }

    /// Samples a part by all the light that it sends.
    pub(super) fn sample_by_flux(&self, u: f64) -> DiscreteSample {
        self.shared.flux.sample(u)
    }
}
