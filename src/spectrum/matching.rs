//! How the lanes of two paths are brought together that meet, one from the camera and one from a light, each with
//! wavelengths drawn of its own.
//!
//! The fixed lanes of both are the same. Where only one path has parted, what the other carries is smooth and is read
//! at the parted one's wavelengths between its fixed lanes, by the functions with which responses are integrated. Where
//! both have parted, two wavelengths count as one that fall into the same bin: like the disc in which photons are
//! gathered, bins blur where light goes, and keep its color.

use super::basis::{Heroes, LaneKind};
use super::draw::Hero;
use super::visible::{self, COUNT};
use super::{BandResponse, Basis, Draw, Lanes, Response};

/// What connects the lanes of one basis.
#[derive(Clone, Debug, Default)]
pub struct Matching<const N: usize> {
    /// How much each fixed lane counts at each entry of the fine grid; empty if no wavelengths are drawn.
    weights: Vec<Lanes<N>>,
    /// The bin of each entry.
    bins: Vec<u32>,
    /// How likely a wavelength is drawn from each bin.
    chances: Vec<f64>,
}

/// A wavelength that has gone its own way.
#[derive(Clone, Copy, Debug)]
pub struct Wavelength {
    hero: Hero,
}

impl Wavelength {
    /// What a light at this wavelength is worth.
    pub fn worth(&self, response: &Response) -> [f64; 3] {
        response.hero(&self.hero)
    }

    /// The band into which light of this wavelength falls, and how much it is there: light of a film color that was
    /// found by a response, and is looked at by the same light's response to bands.
    pub fn band(&self, color: [f64; 3], response: &Response, bands: &BandResponse) -> Option<(usize, f64)> {
        let one = response.hero(&self.hero);
        let strongest = (0..3).fold(0, |most, c| if one[c].abs() > one[most].abs() { c } else { most });
        (one[strongest] != 0.0).then(|| bands.hero(&self.hero, color[strongest] / one[strongest]))?
    }
}

/// The bin of each entry of the fine grid, and how likely each is, for the probabilities of steps and lines.
fn bins(probabilities: impl Iterator<Item = f64>, parts: f64) -> (Vec<u32>, Vec<f64>) {
    let steps = COUNT - 1;
    let widest = ((visible::LAST_NM - visible::FIRST_NM) / parts).max(1.0);
    let (mut bins, mut chances, mut width) = (Vec::new(), vec![0.0], 0.0);
    for (entry, probability) in probabilities.enumerate() {
        if entry == steps {
            // Nothing is drawn beyond the last wavelength of the grid; lines follow.
            bins.push(chances.len() as u32 - 1);
        }
        let last = chances.len() - 1;
        if entry >= steps || (width > 0.0 && (width + 1.0 > widest || (chances[last] + probability) * parts > 1.0)) {
            chances.push(0.0);
            width = 0.0;
        }
        let last = chances.len() - 1;
        // Steps below the visible range, of which none is drawn, make no bin wider.
        width = if chances[last] == 0.0 { 1.0 } else { width + 1.0 };
        chances[last] += probability;
        bins.push(last as u32);
    }
    (bins, chances)
}

impl<const N: usize> Matching<N> {
    /// What connects the lanes of a basis; a bin holds one part in `parts` of the draws and of the visible range at
    /// most, or a single nm or line.
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
        Self { weights: basis.fine(between, line), bins, chances }
    }

    /// Whether heroes carry light that arrives in lanes; `found` gets the lane, the wavelength
    /// and the weight of each.
    pub fn alone(draw: &Draw<N>, lanes: Lanes<N>, parted: bool, mut found: impl FnMut(usize, Wavelength, f64)) -> bool {
        let Some(heroes) = draw.carrying(&lanes, parted) else { return false };
        for (lane, hero, weight) in heroes.filter(|(.., weight)| *weight != 0.0) {
            found(lane, Wavelength { hero: *hero }, weight);
        }
        true
    }

    /// What fixed lanes hold, read at a wavelength.
    pub fn read(&self, wavelength: &Wavelength, lanes: Lanes<N>) -> f64 {
        f64::from(self.between(&wavelength.hero, lanes))
    }

    /// What fixed lanes hold, read at the wavelengths of heroes.
    pub fn onto_heroes(&self, draw: &Draw<N>, lanes: Lanes<N>) -> Lanes<N> {
        let mut read = Lanes::ZERO;
        for (lane, hero) in draw.heroes() {
            read.0[lane] = self.between(hero, lanes);
        }
        read
    }

    /// What heroes hold that count as one with a wavelength.
    pub fn shared(&self, draw: &Draw<N>, wavelength: &Wavelength, lanes: Lanes<N>, parted: bool) -> f64 {
        let bin = self.bins[wavelength.hero.below];
        let same = |hero: &Hero| self.bins[hero.below] == bin;
        let heroes = draw.heroes().filter(|(_, hero)| same(hero));
        let held: f64 = heroes.map(|(lane, _)| f64::from(lanes[lane])).sum();
        let mean = draw.hero_factor(parted).unwrap_or(0.0) / draw.heroes().count() as f64;
        held * mean / self.chances[bin as usize]
    }

    fn between(&self, hero: &Hero, lanes: Lanes<N>) -> f32 {
        let [a, b] = [0, 1].map(|step| (self.weights[hero.below + step] * lanes).sum());
        a + hero.fraction as f32 * (b - a)
    }
}
