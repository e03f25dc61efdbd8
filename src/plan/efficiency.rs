//! Whether photons are worth their time, and how many.

use crate::light::{Light, LightId, Point, Spot};
use crate::math::DVec3;
use crate::scene::Scene;
use crate::spectrum::{Curve, Distinct, Emission, apply};
use crate::trace::{PhotonWorth, SampleWorth, Smoothness, World, photons_worth, samples_worth};

/// Of a lamp's radiance, what the camera sees of it by way of a smooth surface and one that scatters: about half.
const LEFT: f64 = 0.5;
/// A gain below this is none: a pilot does not know better.
const CLEARLY: f64 = 1.1;

/// What photons of some lights are worth beside camera samples.
pub(super) struct Worth {
    /// The photons of those lights whose photons lower the time to an error.
    pub(super) photons: Vec<PhotonWorth>,
    /// How many times as long chance takes to the same error; none where it misses light for good, or there is no
    /// light.
    pub(super) gain: Option<f64>,
    /// Whether some of the photons were sent to what is smooth, all of it or a part.
    pub(super) of_smooth: bool,
}

/// Weighs photons of some lights, which the world sends, against chance.
///
/// An image of n_p camera samples and n_l photons has the variance A / n_p + sum B_i / n_i in the time C_p n_p + sum
/// C_i n_i; their product is least for n_i / n_p = sqrt(B_i C_p / (A C_i)), where it is (sqrt(A C_p) + sum sqrt(B_i
/// C_i))^2. A light that is left to chance adds K to A: a camera sample that meets the lamp sees f of its radiance, and
/// does so as often as makes the mean right, so that its second moment is f times the mean. Rays followed stand for
/// time, so that the plan is the same everywhere. How many photons there are is found when all else is decided.
pub(super) fn weigh(scene: &Scene<Curve>, world: &World, size: impl Fn(LightId) -> f64) -> Worth {
    let samples = samples_worth(world);
    let film = scene.film;
    let pixels = f64::from(film.width) * f64::from(film.height);
    let mut colors = Distinct::default();
    let with_chance = |photons: PhotonWorth| {
        let to = Sent::new(scene, photons.to);
        let of_light = |light: &LightId| match to.shows(*light, size(*light), &mut colors) {
            Some(shown) => (0..3).map(|i| LEFT * shown[i] * photons.brings[i]).sum::<f64>().abs() * pixels,
            None => f64::INFINITY,
        };
        let left = photons.lights.iter().map(of_light).sum::<f64>() / photons.lights.len() as f64;
        (photons, left)
    };
    let mut known: Vec<(PhotonWorth, f64)> = photons_worth(world).into_iter().map(with_chance).collect();
    // Those first whose photons save most.
    known.sort_by(|(a, of_a), (b, of_b)| (of_b * a.variance * a.rays).total_cmp(&(of_a * b.variance * b.rays)));
    let total = |sent: usize| product(&samples, &known, sent);
    let best = (0..=known.len()).min_by(|&a, &b| total(a).total_cmp(&total(b))).unwrap_or(0);
    let best = if total(0) > CLEARLY * total(best) { best } else { 0 };
    let gain = total(0) / total(if best == 0 { known.len() } else { best });
    let gain = (gain.is_finite() && !known.is_empty()).then_some(gain);
    let of_smooth = known.iter().any(|(photons, _)| matches!(photons.to, Smoothness::Whole | Smoothness::Partial));
    Worth { of_smooth, photons: known.into_iter().take(best).map(|light| light.0).collect(), gain }
}

/// The nearest power of the square root of 2: the least of time x variance is flat, and rounding must not change an
/// image.
pub(super) fn rounded(photons: f64) -> f64 {
    libm::exp2(0.5 * (2.0 * libm::log2(photons)).round())
}

/// The least product of time and variance where the first lights send photons.
fn product(samples: &SampleWorth, known: &[(PhotonWorth, f64)], sent: usize) -> f64 {
    let left: f64 = known[sent..].iter().map(|light| light.1).sum();
    let photons: f64 = known[..sent].iter().map(|(photons, _)| (photons.variance * photons.rays).sqrt()).sum();
    let root = ((samples.variance + left) * samples.rays).sqrt() + photons;
    root * root
}

/// Objects that photons are sent to.
struct Sent<'a> {
    scene: &'a Scene<Curve>,
    to: Smoothness,
    /// The least solid angle in steradians into which they spread what mirrors would send in one direction.
    spread: f64,
}

impl<'a> Sent<'a> {
    fn new(scene: &'a Scene<Curve>, to: Smoothness) -> Self {
        let sent = Self { scene, to, spread: 0.0 };
        let spread = |object: usize| scene.material_of(object as u32).spread();
        let spread = sent.objects().map(spread).fold(f64::INFINITY, f64::min);
        Self { spread, ..sent }
    }

    fn objects(&self) -> impl Iterator<Item = usize> {
        (0..self.scene.objects.len()).filter(|&object| Smoothness::of(self.scene, object) == Some(self.to))
    }

    /// XYZ of the radiance of a light of a solid angle as they show it: of one that is smaller than what they spread it
    /// into, about its irradiance over that. None of one that has no extent where they spread nothing.
    fn shows(&self, light: LightId, size: f64, colors: &mut Distinct<[f64; 3]>) -> Option<[f64; 3]> {
        let light = &self.scene.lights[light];
        let blurred = size / (size + self.spread);
        let factor = match light {
            Light::Area(area) => area.brightness() * blurred,
            Light::Environment(environment) => environment.bright()?.radiance() * blurred,
            Light::Sun(sun) if sun.angular_diameter > 0.0 => sun.radiance_factor() * blurred,
            _ if self.spread == 0.0 => return None,
            Light::Sun(_) => 1.0 / self.spread,
            Light::Point(Point { position, .. }) | Light::Spot(Spot { position, .. }) => {
                1.0 / (self.spread * self.squared_distance((*position).into()))
            }
        };
        let space = self.scene.film.color_space;
        let color = colors.of(light.emission(), |curve| Emission::new(curve, space).color());
        Some(apply(&space.to_xyz(), color.map(|x| x * factor)))
    }

    /// From a place to the nearest of them.
    fn squared_distance(&self, place: DVec3) -> f64 {
        let distance = |object: usize| Some((self.scene.objects[object].shape.ball()?.center - place).length_squared());
        self.objects().filter_map(distance).fold(f64::INFINITY, f64::min)
    }
}
