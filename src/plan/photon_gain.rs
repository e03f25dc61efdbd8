//! Decides whether photons are worth their time, and how many.

use crate::light::{Light, LightId, Point, Spot};
use crate::math::DVec3;
use crate::scene::Scene;
use crate::spectrum::{Curve, CurveCache, Emission, apply};
use crate::trace::{Effort, PhotonWorth, PilotNoise, Smoothness, World, photons_worth};

/// Share of a lamp's radiance that the camera sees via a smooth surface and one that scatters: about half.
const RADIANCE_SHARE: f64 = 0.5;

/// Photons of some lights that may be sent; first those that save most for what they cost.
pub(super) struct OfferedPhotons {
    photons: Vec<PhotonWorth>,
    /// For the light of each, the second moment of what chance finds, divided by its mean.
    spikes: Vec<f64>,
}

/// What photons of some lights are worth beside camera samples.
pub(super) struct PhotonGain {
    /// The photons of those lights whose photons shorten the time to an error.
    pub(super) photons: Vec<PhotonWorth>,
    /// How many times as long chance takes to the same error; `None` where it misses light for good or there is none.
    pub(super) gain: Option<Effort>,
    /// Whether some of the photons were sent to objects that are smooth, entirely or in part.
    pub(super) to_smooth: bool,
}

impl OfferedPhotons {
    /// Weighs the photons that a world sends, from lights of known solid angles in steradians.
    pub(super) fn new(scene: &Scene<Curve>, world: &World, size: impl Fn(LightId) -> f64) -> Self {
        let mut colors = CurveCache::default();
        let mut spike = |photons: &PhotonWorth| {
            let to = TargetObjects::new(scene, photons.to);
            let light_spike =
                |light: &LightId| to.shown_radiance(*light, size(*light), &mut colors).unwrap_or(f64::INFINITY);
            RADIANCE_SHARE * photons.lights.iter().map(light_spike).sum::<f64>() / photons.lights.len() as f64
        };
        let mut offers: Vec<_> = photons_worth(world).into_iter().map(|photons| (spike(&photons), photons)).collect();
        let saves = |(spike, photons): &(f64, PhotonWorth)| spike * photons.brings.iter().sum::<f64>().abs();
        let costs = |photons: &PhotonWorth| photons.variance * photons.rays;
        offers.sort_by(|a, b| (saves(b) * costs(&a.1)).total_cmp(&(saves(a) * costs(&b.1))));
        let (spikes, photons) = offers.into_iter().unzip();
        Self { photons, spikes }
    }

    /// Weighs photons against chance, given the noise of camera samples.
    ///
    /// A light that is left to chance adds to that noise. A sample that hits the lamp sees f of its radiance, just
    /// often enough to make the mean right, so that its second moment is f times the mean. The number of photons is
    /// chosen when all else is decided.
    pub(super) fn weigh(&self, noise: &PilotNoise) -> PhotonGain {
        let Self { photons, spikes } = self;
        let to_smooth = photons.iter().any(|photons| matches!(photons.to, Smoothness::Whole | Smoothness::Partial));
        let totals: Vec<Effort> = (0..=photons.len()).map(|sent| noise.least_work(photons, spikes, sent)).collect();
        let effort_of = |sent: usize| totals[sent].judged();
        let best = (0..totals.len()).min_by(|&a, &b| effort_of(a).total_cmp(&effort_of(b))).unwrap_or(0);
        let best = if totals[0].over(totals[best]).is_clear() { best } else { 0 };
        let gain = totals[0].over(totals[if best == 0 { photons.len() } else { best }]);
        let gain = (gain.judged().is_finite() && !photons.is_empty()).then_some(gain);
        PhotonGain { photons: photons[..best].to_vec(), gain, to_smooth }
    }
}

/// Rounds to a power of the root of 2: the minimum of time x variance is flat, and roundoff must not change an image.
pub(super) fn rounded(photons: f64) -> f64 {
    libm::exp2(0.5 * (2.0 * libm::log2(photons)).round())
}

/// Objects that photons are sent to.
struct TargetObjects<'a> {
    scene: &'a Scene<Curve>,
    to: Smoothness,
    /// The least solid angle in steradians into which they spread what mirrors would send in one direction.
    spread: f64,
}

impl<'a> TargetObjects<'a> {
    fn new(scene: &'a Scene<Curve>, to: Smoothness) -> Self {
        let sent = Self { scene, to, spread: 0.0 };
        let spread = |object: usize| scene.material_of(object as u32).spread();
        let spread = sent.objects().map(spread).fold(f64::INFINITY, f64::min);
        Self { spread, ..sent }
    }

    fn objects(&self) -> impl Iterator<Item = usize> {
        (0..self.scene.objects.len()).filter(|&object| Smoothness::of(self.scene, object) == Some(self.to))
    }

    /// Returns X + Y + Z of the radiance of a light of some solid angle as the objects show it. If the light is smaller
    /// than the solid angle into which they spread it, this is about its irradiance over that solid angle. Returns
    /// `None` for a light without extent where they spread nothing.
    fn shown_radiance(&self, light: LightId, size: f64, colors: &mut CurveCache<[f64; 3]>) -> Option<f64> {
        let light = &self.scene.lights[light];
        let blurred = if self.spread > 0.0 { size / (size + self.spread) } else { 1.0 };
        let factor = match light {
            Light::Area(area) => area.brightness() * blurred,
            Light::Environment(environment) => {
                environment.bright_part().map_or(environment.mean(), |bright| bright.radiance) * blurred
            }
            Light::Sun(sun) if sun.angular_diameter > 0.0 => sun.radiance_factor() * blurred,
            _ if self.spread == 0.0 => return None,
            Light::Sun(_) => 1.0 / self.spread,
            Light::Point(Point { position, .. }) | Light::Spot(Spot { position, .. }) => {
                1.0 / (self.spread * self.squared_distance((*position).into()))
            }
        };
        let space = self.scene.film.color_space;
        let color = colors.of(light.emission(), |curve| Emission::new(curve, space).color());
        Some(apply(&space.to_xyz(), color).iter().sum::<f64>() * factor)
    }

    /// Returns the squared distance from a place to the nearest of the objects.
    fn squared_distance(&self, place: DVec3) -> f64 {
        let distance = |object: usize| Some((self.scene.objects[object].shape.ball()?.center - place).length_squared());
        self.objects().filter_map(distance).fold(f64::INFINITY, f64::min)
    }
}
