use super::palette::tint_factor;
use super::table::{Pattern, PatternKind};
use super::texture::checker_cell;
use super::{Lanes, Table};

/// What each lane of a camera sample stands for. Fixed lanes read the bins of every table. Heroes read a wavelength
/// that was drawn for this sample.
///
/// Heroes ride along until lanes part for the first time. From there on only they count, and the fixed lanes count on
/// all paths on which lanes never part: the two sets of paths have no path in common. The tracer passes the draw on and
/// never looks inside.
#[derive(Clone, Debug)]
pub struct Draw<const N: usize> {
    fixed: usize,
    heroes: [Hero; MAX_HEROES],
    count: usize,
    /// Factor on what a hero is worth, while lanes are together and after they parted; `None` where the fixed lanes
    /// carry the light.
    hero_factors: [Option<f64>; 2],
    /// Weight of each lane, while lanes are together and after they parted.
    shares: [Lanes<N>; 2],
}

/// Maximum number of heroes of one camera sample.
pub const MAX_HEROES: usize = 8;

/// A wavelength drawn at random, as a position on the fine grid of every table.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Hero {
    /// Entry of the fine grid at or below the wavelength.
    pub(super) below: usize,
    /// Fraction of the step to the next entry.
    pub(super) fraction: f64,
    /// One over the product of the number of heroes and the pdf of the wavelength, per nm. For an ideal line, its
    /// probability takes the place of the pdf.
    pub(super) factor: f64,
}

impl<const N: usize> Draw<N> {
    /// Creates the draw in which lane i reads bin i; lanes beyond the last bin stay empty.
    ///
    /// # Panics
    /// If there are more bins than lanes.
    pub fn fixed(bins: usize) -> Self {
        Self::with_heroes(bins, &[])
    }

    /// Creates a draw of fixed lanes, followed by heroes.
    pub(super) fn with_heroes(fixed: usize, heroes: &[Hero]) -> Self {
        let count = heroes.len();
        assert!(fixed + count <= N, "{fixed} bins and {count} heroes do not fit into {N} lanes");
        let together = Lanes::from_fn(|i| if i < fixed { 1.0 / fixed as f32 } else { 0.0 });
        let alone = Lanes::from_fn(|i| if (fixed..fixed + count).contains(&i) { 1.0 } else { 0.0 });
        let shares = [together, if count == 0 { together } else { alone }];
        let heroes = std::array::from_fn(|i| heroes.get(i).copied().unwrap_or_default());
        Self { fixed, heroes, count, hero_factors: [None, (count > 0).then_some(1.0)], shares }
    }

    /// Makes the heroes carry all light until lanes part, where all but the first end.
    pub(super) fn collapsing(self) -> Self {
        let heroes = self.count as f64;
        let together = self.shares[1] * (1.0 / heroes as f32);
        let alone = Lanes::from_fn(|i| if i == self.fixed { 1.0 } else { 0.0 });
        Self { hero_factors: [Some(1.0), Some(heroes)], shares: [together, alone], ..self }
    }

    /// The factor on what a hero is worth, where heroes carry the light; none where the fixed lanes do.
    pub fn hero_factor(&self, parted: bool) -> Option<f64> {
        self.hero_factors[usize::from(parted)]
    }

    /// Reads a weight: one number per lane.
    pub fn read(&self, table: &Table) -> Lanes<N> {
        let mut lanes = Lanes(*table.weights());
        for (lane, hero) in self.heroes() {
            lanes.0[lane] = table.interpolate(hero.below, hero.fraction) as f32;
        }
        lanes
    }

    /// Reads a weight at a place of a surface; the place matters only if the table varies.
    #[inline]
    pub fn read_at(&self, table: &Table, uv: [f64; 2]) -> Lanes<N> {
        match table.pattern() {
            None => self.read(table),
            Some(pattern) => self.read_pattern(table, pattern, uv),
        }
    }

    /// Reads a color as a factor on white light, from the table of an image. The color's numbers have no upper limit. A
    /// table without colors does not tint.
    pub fn tint(&self, table: &Table, color: [f32; 3]) -> Lanes<N> {
        match table.pattern().map(|pattern| &pattern.kind) {
            Some(PatternKind::Image(_, palette)) => self.tint_by(palette.as_ref(), color, false),
            _ => Lanes::ONE,
        }
    }

    #[inline]
    fn tint_by(&self, palette: Option<&Vec<Table>>, color: [f32; 3], bounded: bool) -> Lanes<N> {
        match palette {
            Some(palette) => tint_factor(palette, |tint| self.read(tint), color, bounded),
            None => Lanes::from_fn(|i| color[i.min(2)]),
        }
    }

    #[inline(never)]
    fn read_pattern(&self, table: &Table, pattern: &Pattern, uv: [f64; 2]) -> Lanes<N> {
        let tint_factor = match &pattern.kind {
            PatternKind::Image(texture, palette) => {
                self.tint_by(palette.as_ref(), texture.color(uv), pattern.limit == 1.0)
            }
            PatternKind::Checker { cells, repeat } => self.read_at(&cells[checker_cell(*repeat, uv)], uv),
        };
        let product = self.read(table) * tint_factor;
        Lanes::from_fn(|i| product[i].min(pattern.limit))
    }

    /// Reads a refractive index: one number per lane, in full precision.
    pub fn read_exact(&self, table: &Table) -> [f64; N] {
        let mut lanes = *table.fixed();
        for (lane, hero) in self.heroes() {
            lanes[lane] = table.interpolate(hero.below, hero.fraction);
        }
        lanes
    }

    /// Reads the number of a single lane, in full precision.
    pub fn read_lane(&self, table: &Table, lane: usize) -> f64 {
        match self.heroes[..self.count].get(lane.wrapping_sub(self.fixed)) {
            Some(hero) => table.interpolate(hero.below, hero.fraction),
            None => table.fixed::<N>()[lane],
        }
    }

    /// Returns the smallest and the largest number that a lane reads in a table.
    #[inline]
    pub fn range(&self, table: &Table) -> [f64; 2] {
        self.heroes().fold(table.fixed_range, |[least, most], (_, hero)| {
            let x = table.interpolate(hero.below, hero.fraction);
            [if x < least { x } else { least }, if x > most { x } else { most }]
        })
    }

    /// Returns whether a lane stands for the same light in every sample.
    pub fn is_fixed(&self, lane: usize) -> bool {
        lane < self.fixed
    }

    /// Returns the weight of each lane where a single number must stand for a throughput. While lanes are together, the
    /// weights sum to 1. A hero that has parted counts in full, because it continues alone in place of all lanes. Its
    /// path is then followed as far as if no lanes had parted, which on glass measured half the noise for a third more
    /// time than counting it by its share.
    pub fn shares(&self, parted: bool) -> &Lanes<N> {
        &self.shares[usize::from(parted)]
    }

    /// Returns the number of rays that together stand for one path.
    pub fn siblings(&self, parted: bool) -> f64 {
        f64::from(self.shares(parted).sum())
    }

    /// Returns 1 for the lanes that cross a surface where lanes part: the heroes, or all lanes if there are no heroes.
    pub fn parting(&self) -> Lanes<N> {
        Lanes::from_fn(|i| if self.shares[1][i] == 0.0 { 0.0 } else { 1.0 })
    }

    /// Returns the lanes with which a camera ray starts: 1 for each lane that stands for something.
    pub fn start(&self) -> Lanes<N> {
        Lanes::from_fn(|i| if i < self.fixed + self.count { 1.0 } else { 0.0 })
    }

    /// Returns the lane of each hero, and the hero.
    pub(super) fn heroes(&self) -> impl Iterator<Item = (usize, &Hero)> {
        (self.fixed..).zip(&self.heroes[..self.count])
    }

    /// Returns the lane of each hero, the hero, and the weight of the light that arrives in that lane; `None` if the
    /// fixed lanes carry the light.
    pub(super) fn carrying_heroes(
        &self,
        lanes: &Lanes<N>,
        parted: bool,
    ) -> Option<impl Iterator<Item = (usize, &Hero, f64)>> {
        let factor = self.hero_factor(parted)?;
        Some(self.heroes().map(move |(lane, hero)| (lane, hero, factor * hero.factor * f64::from(lanes[lane]))))
    }
}
