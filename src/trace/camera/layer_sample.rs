//! What one camera sample contributes to the layers.

use super::dimensions::ALBEDO;
use super::surface::Surface;
use crate::film::{FirstSurface, Layer};
use crate::material::Branch;
use crate::math::Sampler;
use crate::spectrum::{Draw, Lanes};
use crate::trace::World;
use crate::trace::contribution::Contribution;
use crate::trace::layers::Layers;
use crate::trace::photon::{Gathered, PhotonShare, PhotonSpectrum};
use crate::trace::received_light::ReceivedLight;
use crate::trace::spectrum_sample::SpectrumSample;
use crate::trace::walk::{Audit, Interaction, ObjectSet, Path, Polarization, shading};

/// A row of numbers, filled by one camera sample after another.
pub struct LayerSample<'a, const N: usize> {
    world: &'a World,
    row: Vec<f64>,
    /// What the sample contributes to the bands of a spectral image, if one is requested.
    spectrum: Option<SpectrumSample<'a, N>>,
    /// The largest share of the sample that a surface has had so far. Position and UV are those of that surface.
    share: f64,
    /// The share of the weight that belongs to what the camera ray has hit, of surfaces with holes and what is behind.
    chance: f64,
    /// The object that the camera ray hit.
    object: Option<u32>,
    branches: Vec<Branch<N>>,
    /// Whether the path was aimed at a highlight, so that only its light belongs to the sample.
    pub is_aimed: bool,
}

/// The contribution of a camera sample to the layers.
pub struct SampleRow<'a> {
    pub row: &'a [f64],
    /// The object that the camera ray hit, if any.
    pub object: Option<u32>,
}

impl<'a, const N: usize> LayerSample<'a, N> {
    /// Returns `None` if no layers are requested.
    pub fn new(world: &'a World) -> Option<Self> {
        let Layers { row_len, .. } = world.layers;
        let (row, spectrum) = (vec![0.0; row_len], world.layers.spectrum.as_ref().map(SpectrumSample::new));
        let (share, chance, object, branches) = (0.0, 1.0, None, Vec::new());
        let is_aimed = false;
        (!world.layers.is_empty()).then_some(Self { world, row, spectrum, share, chance, object, branches, is_aimed })
    }

    /// Begins another sample.
    pub fn begin(&mut self) {
        self.row.fill(0.0);
        self.spectrum.iter_mut().for_each(SpectrumSample::begin);
        (self.share, self.chance) = (0.0, 1.0);
        self.object = None;
    }

    pub fn sample_row(&self) -> SampleRow<'_> {
        SampleRow { row: &self.row, object: self.object }
    }

    /// Adds what an audit of the sample has left open.
    pub fn add_residual(&mut self, audit: &Audit<N>, draw: &Draw<N>) {
        if let Some(white) = &self.world.layers.white {
            self.world.layers.add_to(Layer::Residual, &mut self.row, audit.residual(white, draw));
        }
    }

    /// Stores the object that the camera ray hit, `None` if it went through a hole of one, and its share of the weight.
    pub fn set_object(&mut self, hit_object: Option<u32>, chance: f64) {
        if self.is_aimed {
            return;
        }
        self.object = hit_object;
        self.chance *= chance;
    }

    /// Replaces the row by the light of a shadow catcher, with all objects and with only those of the plate.
    pub fn catch(&mut self, with_and_without: [[f64; 3]; 2]) {
        self.begin();
        if with_and_without.as_flattened().iter().all(|x| x.is_finite()) {
            self.world.layers.write_catcher(&mut self.row, with_and_without);
        }
    }

    /// Receives light that has reached the sensor, and the lanes by which it arrived. `factor` is that on the lanes;
    /// the contribution has it already.
    pub fn receive(
        &mut self,
        contribution: &Contribution,
        received: &ReceivedLight<N>,
        stokes: Option<[Lanes<N>; 3]>,
        factor: f64,
    ) {
        self.world.layers.add(&mut self.row, contribution);
        if let Some(stokes) = &stokes {
            let stokes = stokes.map(|part| received.times(part, &self.world.responses));
            self.world.layers.add_stokes(&mut self.row, stokes, factor);
        }
        if let Some(spectrum) = &mut self.spectrum {
            spectrum.receive(received, stokes.as_ref(), factor);
        }
    }

    /// Receives the light of gathered photons.
    pub fn receive_gathered(&mut self, gathered: &Gathered<N>, draw: &Draw<N>) {
        let Some(parts) = &gathered.parts else { return self.world.layers.add(&mut self.row, &gathered.all) };
        for PhotonShare { contribution, stokes, spectrum, factor } in parts {
            let rgb = contribution.rgb.map(|x| factor * x);
            self.world.layers.add(&mut self.row, &Contribution { rgb, ..*contribution });
            if let Some(stokes) = stokes {
                self.world.layers.add_stokes(&mut self.row, *stokes, *factor);
            }
            let (Some(sample), Some(light)) = (&mut self.spectrum, contribution.light) else { continue };
            match spectrum {
                PhotonSpectrum::Lanes { source, lanes, parted, stokes } => {
                    let received = ReceivedLight { source: *source, draw, lanes, parted: *parted };
                    sample.receive(&received, stokes.as_deref(), *factor);
                }
                PhotonSpectrum::SingleLane(wavelength) => {
                    let responses = (&self.world.responses[light], sample.response(light));
                    let others = stokes.iter().flatten().map(|part| part.map(|x| factor * x));
                    for (component, color) in std::iter::once(rgb).chain(others).enumerate() {
                        sample.receive_single(component, wavelength.band(color, responses.0, responses.1));
                    }
                }
            }
        }
    }

    /// Keeps what the current sample contributes to the bands of a spectral image, to be added or subtracted.
    pub fn keep_spectrum(&mut self, is_subtracted: bool) {
        self.spectrum.iter_mut().for_each(|spectrum| spectrum.keep(is_subtracted));
    }

    /// Adds all spectra that were kept to a pixel's rows. The second row is for samples that are subtracted.
    pub fn add_spectra_to(&mut self, rows: [&mut [f64]; 2]) {
        if let Some(spectrum) = &mut self.spectrum {
            spectrum.add_sums_to(rows);
        }
    }

    /// Stores a surface, if it is the first one.
    pub fn record_surface<P: Polarization<N>>(
        &mut self,
        path: &Path<N, P>,
        interaction: &Interaction<N>,
        surface: &Surface<N, P>,
        sampler: &Sampler,
    ) {
        let layers = &self.world.layers;
        if path.object_set == ObjectSet::Plate || self.is_aimed {
            return;
        }
        // A filter in front of the camera is not a property of a surface.
        let unfiltered = 1.0 / self.world.scene.camera.transmittance();
        let share =
            if layers.shows_surfaces() { surface.share(path, interaction, layers.first, unfiltered) } else { 0.0 };
        if share <= 0.0 {
            return;
        }
        let normal = shading::unbent_normal(interaction.point, interaction.context.wo);
        layers.add_to(Layer::Normal, &mut self.row, (share * normal).to_array());
        layers.add_to(Layer::GeometricNormal, &mut self.row, (share * interaction.flat).to_array());
        // What passes through a pane belongs to it like what glass refracts, unless what is behind counts by itself.
        let panes = surface
            .transmitted
            .filter(|_| layers.first == FirstSurface::Met)
            .map(|transmitted| transmitted.straight.panes);
        // Of surfaces with holes and what is behind them, one was hit at random. Its weight already includes that.
        let chance = if layers.first == FirstSurface::Met { self.chance } else { 1.0 };
        let albedo = self.albedo(path, interaction, panes, sampler).map(|x| unfiltered * x / chance);
        layers.add_to(Layer::Albedo, &mut self.row, albedo);
        if share > self.share {
            self.share = share;
            let position = interaction.point.position;
            let object = &self.world.scene.objects[interaction.object as usize];
            self.write_layer(Layer::Position, &position.to_array());
            self.write_layer(Layer::Uv, &object.chart_uv(&surface.surface_hit.hit.intersection, interaction.point));
        }
    }

    fn write_layer(&mut self, layer: Layer, numbers: &[f64]) {
        if let Some(offset) = self.world.layers.offset(layer) {
            self.row[offset..offset + numbers.len()].copy_from_slice(numbers);
        }
    }

    /// Returns what a white light all around would show of the surface, if that is requested. This is an estimate by
    /// the directions of one sample, and exact if shares do not depend on them.
    fn albedo<P: Polarization<N>>(
        &mut self,
        path: &Path<N, P>,
        interaction: &Interaction<N>,
        panes: Option<Lanes<N>>,
        sampler: &Sampler,
    ) -> [f64; 3] {
        let layers = &self.world.layers;
        let (Some(white), Some(_)) = (&layers.white, layers.offset(Layer::Albedo)) else { return [0.0; 3] };
        let [u, v, ..] = sampler.get_random_4d(path.key, ALBEDO);
        let (context, draw) = (&interaction.context, interaction.context.draw);
        self.branches.clear();
        shading::scatter(interaction.material, context, interaction.flat, [u, v], &mut self.branches);
        // Where light crosses, radiance changes by each lane's own index, and `eta_scale` by that of the ray.
        let crossing = context.forward().map(|twice| Lanes::from_fn(|i| twice[i].sqrt()));
        let panes_rgb = panes.map(|panes| white.times(draw, path.throughput.of(panes), path.parted));
        let mut albedo = panes_rgb.map_or([0.0; 3], |rgb| rgb.map(|x| x / path.eta_scale));
        for branch in &self.branches {
            let share = match crossing {
                Some(crossing) if branch.crosses => branch.share * crossing,
                _ => branch.share,
            };
            let parted = path.parted || (interaction.is_parting && branch.crosses);
            let rgb = white.times(draw, path.throughput.of(share), parted);
            let scale = path.eta_scale * branch.eta_scale;
            (0..3).for_each(|channel| albedo[channel] += rgb[channel] / scale);
        }
        albedo
    }
}
