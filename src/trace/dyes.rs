//! The dyes of a scene, both as light sources and as what light excites.

use std::ops::Range;
use std::sync::Arc;

use super::received_light::{ReceivedLight, SourceId};
use crate::light::LightId;
use crate::material::{Diffuse, Material};
use crate::scene::Scene;
use crate::spectrum::{Basis, Curve, CurveCache, Draw, Dye, Emission, Lanes, Quantity, Response, Table};

/// Smallest probability of one dye, unless there are many, and largest of all together: only sampling depends on them.
const MIN_SHARE: f64 = 0.05;
const MAX_TOTAL: f64 = 0.75;

#[derive(Clone, Debug)]
pub(super) struct Dyes {
    /// The number of the first dye of each material, and at the end the number of all dyes.
    first: Vec<usize>,
    /// For each dye, the response to the lanes of each source.
    excitations: Vec<Vec<Response>>,
    /// Roughly the share of light of a flat spectrum that each dye emits again.
    shares: Vec<f64>,
    /// Number of lights. As sources, dyes are numbered after the lights.
    lights: usize,
    /// The matte white surface at which paths look for light that excites a dye: `excitations` include what it absorbs.
    pub(super) white: Material<Table>,
}

impl Dyes {
    /// Returns the dyes of a scene and the sensor's responses to their light, and replaces the basis by one that
    /// excites them. Returns `None` if there are no dyes, or if lanes are not wavelengths.
    pub(super) fn new(scene: &Scene<Curve>, basis: &mut Basis) -> Option<(Self, Vec<Response>)> {
        let (mut first, mut dyes): (Vec<usize>, Vec<Dye>) = (Vec::new(), Vec::new());
        for named in &scene.materials {
            first.push(dyes.len());
            dyes.extend(named.material.dyes().into_iter().map(|dye| dye.dye()));
        }
        first.push(dyes.len());
        if dyes.is_empty() || !basis.has_wavelengths() {
            return None;
        }
        let lights: Vec<&Curve> = scene.lights.iter().map(|light| light.emission()).collect();
        *basis = basis.clone().for_dyes(&dyes, &lights);
        let mut emissions = CurveCache::default();
        let mut emission = |curve| emissions.of(curve, |curve| Arc::new(Emission::new(curve, basis.color_space())));
        let curves = lights.iter().copied().chain(dyes.iter().map(|dye| &dye.emission));
        let sources: Vec<(&Curve, Arc<Emission>)> = curves.map(|curve| (curve, emission(curve))).collect();
        let of_dye = |dye: &Dye| {
            let (dye, mut distinct) = (dye.prepared(), CurveCache::default());
            let mut response = |curve, emission| distinct.of(curve, |_| basis.excitation(&dye, emission));
            sources.iter().map(|(curve, emission)| response(*curve, emission)).collect()
        };
        let share = |dye: &Dye| {
            let absorbed = basis.tabulate(Quantity::Excitation, &dye.absorption);
            let mean = absorbed.bins().iter().sum::<f64>() / absorbed.bins().len() as f64;
            (dye.quantum_yield * mean).max(MIN_SHARE)
        };
        let reflectance = basis.tabulate(Quantity::Reflectance, &1.0.into());
        let white = Material::Diffuse(Diffuse { reflectance, fluorescence: None });
        let (excitations, shares) = (dyes.iter().map(of_dye).collect(), dyes.iter().map(share).collect());
        let responses = dyes.iter().map(|dye| basis.response(&dye.emission)).collect();
        Some((Self { first, excitations, shares, lights: lights.len(), white }, responses))
    }

    /// Returns the numbers of an object's dyes.
    #[inline]
    pub(super) fn of_object(&self, scene: &Scene<Table>, object: u32) -> Range<usize> {
        let material = scene.objects[object as usize].material as usize;
        self.first[material]..self.first[material + 1]
    }

    /// Returns the probabilities of following each of these dyes, for a path that continues in only one way.
    pub(super) fn chances(&self, dyes: Range<usize>) -> DyeChances<'_> {
        let total: f64 = self.shares[dyes].iter().sum();
        DyeChances { dyes: self, scale: (MAX_TOTAL / total).min(1.0), total }
    }

    /// Returns the number of a dye as a source of light.
    pub(super) fn source(&self, dye: usize) -> SourceId {
        self.lights + dye
    }

    /// Returns a dye's response to the lanes of a source.
    pub(super) fn excitation(&self, dye: usize, source: SourceId) -> &Response {
        &self.excitations[dye][source]
    }

    /// Returns the maximum of `measure` over all dyes, each as a source with the lanes that a light's emission excites.
    pub(super) fn max_excited<const N: usize>(
        &self,
        light: LightId,
        draw: &Draw<N>,
        emission: Lanes<N>,
        measure: impl Fn(SourceId, Lanes<N>) -> f64,
    ) -> f64 {
        let received = ReceivedLight { source: light, draw, lanes: &emission, parted: false };
        let of_dye = |dye| measure(self.source(dye), draw.start() * self.brightness(dye, &received) as f32);
        (0..self.excitations.len()).map(of_dye).fold(0.0, f64::max)
    }

    /// Returns the brightness of a dye where light arrives in lanes.
    pub(super) fn brightness<const N: usize>(&self, dye: usize, received: &ReceivedLight<N>) -> f64 {
        let ReceivedLight { source, draw, lanes, parted } = *received;
        self.excitation(dye, source).film_rgb(draw, *lanes, parted)[0]
    }
}

/// The probabilities with which a path follows some dyes.
pub(super) struct DyeChances<'a> {
    dyes: &'a Dyes,
    scale: f64,
    total: f64,
}

impl DyeChances<'_> {
    /// Returns the probability of one of the dyes.
    pub(super) fn chance(&self, dye: usize) -> f64 {
        self.scale * self.dyes.shares[dye]
    }

    /// Returns the probability of all dyes together.
    pub(super) fn total(&self) -> f64 {
        self.scale * self.total
    }
}
