//! How the lanes of two paths that meet are combined. One path comes from the camera and one from a light, and each has
//! drawn its own wavelengths.
//!
//! Both paths have the same fixed lanes. If only one path has parted, the light of the other is smooth. It is
//! interpolated between its fixed lanes at the wavelengths of the parted path, by the functions with which responses
//! are integrated. If both have parted, two wavelengths match if they fall into the same bin. Like the disc in which
//! photons are gathered, bins blur where light goes, but keep its color.

use super::basis::{Heroes, LaneKind};
use super::draw::Hero;
use super::visible::{self, COUNT};
use super::{BandResponse, Basis, Draw, Lanes, Response};

/// What connects the lanes of two paths of one basis.
#[derive(Clone, Debug, Default)]
pub struct Matching<const N: usize> {
    /// Weight of each fixed lane at each entry of the fine grid; empty if no wavelengths are drawn.
    weights: Vec<Lanes<N>>,
    /// The bin of each entry of the fine grid.
    bins: Vec<u32>,
    /// Probability of drawing a wavelength from each bin.
    chances: Vec<f64>,
}

/// The wavelength of a lane that has parted.
#[derive(Clone, Copy, Debug)]
pub struct Wavelength {
    hero: Hero,
}

impl Wavelength {
    /// Returns what light at this wavelength is worth.
    pub fn worth(&self, response: &Response) -> [f64; 3] {
        response.hero(&self.hero)
    }

    /// Returns the band of this wavelength and how much light falls into it. The light is given as a film color that
    /// was found by `response`; `bands` is the response of the same light to bands.
    pub fn band(&self, color: [f64; 3], response: &Response, bands: &BandResponse) -> Option<(usize, f64)> {
        let one = response.hero(&self.hero);
        let strongest = (0..3).fold(0, |most, c| if one[c].abs() > one[most].abs() { c } else { most });
        (one[strongest] != 0.0).then(|| bands.hero(&self.hero, color[strongest] / one[strongest]))?
    }
}

/// Returns the bin of each entry of the fine grid and the probability of each bin, from those of steps and lines.
fn bins(probabilities: impl Iterator<Item = f64>, parts: f64) -> (Vec<u32>, Vec<f64>) {
    let steps = COUNT - 1;
    let max_width = ((visible::LAST_NM - visible::FIRST_NM) / parts).max(1.0);
    let (mut bins, mut chances, mut width) = (Vec::new(), vec![0.0], 0.0);
    for (entry, probability) in probabilities.enumerate() {
        if entry == steps {
            // No wavelength is drawn beyond the last one of the grid; the lines follow.
            bins.push(chances.len() as u32 - 1);
        }
        let last = chances.len() - 1;
        if entry >= steps || (width > 0.0 && (width + 1.0 > max_width || (chances[last] + probability) * parts > 1.0)) {
            chances.push(0.0);
            width = 0.0;
        }
        let last = chances.len() - 1;
        // No wavelength is drawn from steps below the visible range: they do not make a bin wider.
        width = if chances[last] == 0.0 { 1.0 } else { width + 1.0 };
        chances[last] += probability;
        bins.push(last as u32);
    }
    (bins, chances)
}

impl<const N: usize> Matching<N> {
    /// Creates what connects the lanes of a basis. A bin holds at most one part in `parts` of the draws and of the
    /// visible range, or else a single nm or line.
    pub fn new(basis: &Basis, parts: f64) -> Self {
        let (LaneKind::Wavelengths(functions), Some(Heroes { mixture, .. })) = (&basis.lanes, &basis.heroes) else {
            return Self::default();
        };
        let own_lines = &basis.wavelengths_nm()[functions.len()..];
        let between = |nm: f64| {
            Lanes::from_fn(|lane| functions.get(lane).map_or(0.0, |function| visible::read(function, nm) as f32))
        };
        let line = |nm: f64| match own_lines.iter().position(|&line| line == nm) {
            Some(own) => Lanes::from_fn(|lane| if lane == functions.len() + own { 1.0 } else { 0.0 }),
            None => between(nm),
        };
        let (bins, chances) = bins(mixture.probabilities(), parts);
        Self { weights: basis.on_fine_grid(between, line), bins, chances }
    }

    /// Returns whether heroes carry the light that arrives in `lanes`. If so, calls `visit` with the lane, the
    /// wavelength and the weight of each.
    pub fn alone(draw: &Draw<N>, lanes: Lanes<N>, parted: bool, mut visit: impl FnMut(usize, Wavelength, f64)) -> bool {
        let Some(heroes) = draw.carrying_heroes(&lanes, parted) else { return false };
        for (lane, hero, weight) in heroes.filter(|(.., weight)| *weight != 0.0) {
            visit(lane, Wavelength { hero: *hero }, weight);
        }
        true
    }

    /// Interpolates fixed lanes at a wavelength.
    pub fn read(&self, wavelength: &Wavelength, lanes: Lanes<N>) -> f64 {
        f64::from(self.between(&wavelength.hero, lanes))
    }

    /// Interpolates fixed lanes at the wavelengths of heroes.
    pub fn onto_heroes(&self, draw: &Draw<N>, lanes: Lanes<N>) -> Lanes<N> {
        let mut read = Lanes::ZERO;
        for (lane, hero) in draw.heroes() {
            read.0[lane] = self.between(hero, lanes);
        }
        read
    }

    /// Returns the light of the heroes that match a wavelength.
    pub fn matching_light(&self, draw: &Draw<N>, wavelength: &Wavelength, lanes: Lanes<N>, parted: bool) -> f64 {
        let bin = self.bins[wavelength.hero.below];
        let same = |hero: &Hero| self.bins[hero.below] == bin;
        let heroes = draw.heroes().filter(|(_, hero)| same(hero));
        let light_sum: f64 = heroes.map(|(lane, _)| f64::from(lanes[lane])).sum();
        let mean = draw.hero_factor(parted).unwrap_or(0.0) / draw.heroes().count() as f64;
        light_sum * mean / self.chances[bin as usize]
    }

    fn between(&self, hero: &Hero, lanes: Lanes<N>) -> f32 {
        let [a, b] = [0, 1].map(|step| (self.weights[hero.below + step] * lanes).sum());
        a + hero.fraction as f32 * (b - a)
    }
}
