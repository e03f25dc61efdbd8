//! What the lanes of one render stand for, and how spectra are tabulated on them.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::band_response::BandResponse;
use super::bands::Bands;
use super::cardinals::cardinals;
use super::color::{ColorSpace, Matrix, apply, product};
use super::curve::BAND_WAVELENGTHS_NM;
use super::draw::MAX_HEROES;
use super::mixture::Mixture;
use super::palette::palette;
use super::projection::{Part, Projection};
use super::table::{MAX_LANES, Pattern, PatternKind};
use super::visible::{self, COUNT};
use super::{
    Curve, CurveKind, Draw, Dye, Emission, PreparedDye, Quantity, Response, Table, Upsampler, WavelengthBands, Waves,
};

/// What the lanes of one render stand for: the bins in which all its spectra are tabulated.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Basis {
    space: ColorSpace,
    upsampler: Arc<Upsampler>,
    pub(super) lanes: LaneKind,
    /// Wavelengths at which the fixed lanes read an index, in nm, one per bin.
    pub(super) wavelengths_nm: Vec<f64>,
    pub(super) heroes: Option<Heroes>,
    keeps_together: bool,
    /// How interpolated lanes read reflectances, if the lights under which these must look right are known.
    pub(super) projection: Option<Arc<Projection>>,
    /// Whether the level of a light accounts for its whole power, which excites dyes.
    excites: bool,
}

/// Wavelengths that are drawn for each sample.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Heroes {
    pub(super) count: usize,
    pub(super) mixture: Arc<Mixture>,
    /// Whether they carry all light and are drawn independently for each sample, and only one of them continues where
    /// lanes part.
    pub(super) collapse: bool,
}

/// The kinds of fixed lanes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) enum LaneKind {
    /// Linear Rec.709. The bands are those under the film's white.
    Rgb(Arc<Bands>),
    /// Linear Rec.2020. The bands are those under one light.
    Prefiltered(Arc<Bands>),
    /// Wavelengths. The first ones are interpolated, each with its function; the others are ideal lines.
    Wavelengths(Arc<Vec<Vec<f64>>>),
}

/// The wavelength whose index refracts lanes that stay together, in nm: the helium d line.
const DIRECTION_NM: f64 = 587.5618;

impl Basis {
    /// Creates three bands: red, green and blue of linear Rec.709.
    pub fn rgb(space: ColorSpace) -> Self {
        let white: Curve = CurveKind::Illuminant(Arc::new(space.white_light())).into();
        let bands = Bands::new(ColorSpace::Rec709, &Emission::new(&white, space));
        Self::new(space, LaneKind::Rgb(Arc::new(bands)), BAND_WAVELENGTHS_NM.into())
    }

    /// Creates three bands: red, green and blue of Rec.2020, in which every measured spectrum has the color that it has
    /// under one light.
    pub fn prefiltered(space: ColorSpace, light: &Emission) -> Self {
        let bands = Bands::new(ColorSpace::Rec2020, light);
        Self::new(space, LaneKind::Prefiltered(Arc::new(bands)), BAND_WAVELENGTHS_NM.into())
    }

    /// Creates `bands` wavelengths in equal steps over the part of the spectrum that measured best for this number, and
    /// a lane for every ideal line.
    ///
    /// # Panics
    /// If there are no lanes and lines, or more than [`MAX_LANES`].
    pub fn bands(space: ColorSpace, bands: usize, lines_nm: &[f64]) -> Self {
        Self::bands_over(space, bands, Self::best_range_nm(bands), lines_nm)
    }

    /// The range of wavelengths in nm for dyes that are excited by ultraviolet light.
    pub const FROM_ULTRAVIOLET_NM: [f64; 2] = [visible::START_NM, 730.0];

    /// Returns the range in nm over which this number of wavelengths reproduces colors best.
    pub(crate) fn best_range_nm(bands: usize) -> [f64; 2] {
        match bands {
            ..=8 => [410.0, 710.0],
            9..=14 => [400.0, 700.0],
            15..=23 => [380.0, 730.0],
            _ => [390.0, 730.0],
        }
    }

    /// Creates `bands` wavelengths in equal steps over a range in nm, each in the middle of its step, and a lane for
    /// every ideal line.
    ///
    /// # Panics
    /// If there are no lanes and lines, or more than [`MAX_LANES`].
    pub fn bands_over(space: ColorSpace, bands: usize, [from, to]: [f64; 2], lines_nm: &[f64]) -> Self {
        let step = (to - from) / bands as f64;
        let nodes: Vec<f64> = (0..bands).map(|i| from + (i as f64 + 0.5) * step).collect();
        Self::wavelengths(space, nodes, lines_nm)
    }

    /// Creates lanes of chosen wavelengths in nm, ascending, between which spectra are interpolated, and of lines.
    ///
    /// # Panics
    /// If there are no lanes and lines, or more than [`MAX_LANES`].
    pub fn wavelengths(space: ColorSpace, nodes_nm: Vec<f64>, lines_nm: &[f64]) -> Self {
        let functions = cardinals(&nodes_nm);
        let mut wavelengths = nodes_nm;
        wavelengths.extend(lines_nm);
        assert!((1..=MAX_LANES).contains(&wavelengths.len()), "{} lanes do not fit", wavelengths.len());
        Self::new(space, LaneKind::Wavelengths(Arc::new(functions)), wavelengths)
    }

    /// Makes lanes read reflectances and transmittances so that these have their true colors under the given lights,
    /// and let the right amount of light excite dyes. Otherwise, a lane reads them at its own wavelength. Three bands
    /// are not changed.
    ///
    /// If a spectral image is wanted too, `shown` are its bands: all wavelengths in them count equally.
    #[must_use]
    pub fn with_true_colors_under(self, lights: &[Emission], dyes: &[Dye], shown: Option<&WavelengthBands>) -> Self {
        let LaneKind::Wavelengths(functions) = &self.lanes else { return self };
        let mut lines: Vec<[f64; 2]> = self.wavelengths_nm[functions.len()..].iter().map(|&nm| [nm, 0.0]).collect();
        for &[nm, _] in lights.iter().flat_map(Emission::lines) {
            if !lines.iter().any(|line| line[0] == nm) {
                lines.push([nm, 0.0]);
            }
        }
        let mut parts: Vec<Part> = visible::wavelengths()
            .chain(lines.iter().map(|line| line[0]))
            .map(|at_nm| Part { at_nm, shares: vec![0.0; self.fixed_lanes()], worth: Vec::new() })
            .collect();
        self.distribute(functions, &lines, |part, lane, share| parts[part].shares[lane] = share);
        let dyes: Vec<PreparedDye> = dyes.iter().map(Dye::prepared).collect();
        for light in lights {
            let shown = |(cmf, power): ([f64; 3], f64)| cmf.map(|x| x * power);
            let of_lines = lines.iter().map(|&[nm, _]| (visible::color_matching(nm), light.power_of_line(nm)));
            let smooth = visible::observer().zip(light.spectrum().iter().copied());
            add_measures(&mut parts, smooth.chain(of_lines).map(shown).collect());
            for dye in &dyes {
                let excited = dye.by(light);
                let by_lines = lines.iter().map(|&[nm, _]| excited.by_line(nm));
                add_measures(&mut parts, excited.smooth.iter().copied().chain(by_lines).map(|x| [x]).collect());
            }
        }
        if parts[0].worth.is_empty() {
            return self;
        }
        let ends = [self.wavelengths_nm[0], self.wavelengths_nm[functions.len() - 1]];
        let shown = shown.map(WavelengthBands::range_nm);
        let projection = Projection::new(&parts, functions.len(), ends, shown);
        Self { projection: Some(Arc::new(projection)), ..self }
    }

    /// Adds heroes: wavelengths drawn where the lights shine, which continue where lanes part.
    ///
    /// # Panics
    /// If they do not fit.
    #[must_use]
    pub fn with_heroes(self, heroes: usize, lights: &[Emission]) -> Self {
        assert!(heroes <= MAX_HEROES && self.wavelengths_nm.len() + heroes <= MAX_LANES, "{heroes} heroes do not fit");
        let heroes = Heroes { count: heroes, mixture: Arc::new(Mixture::new(lights)), collapse: false };
        Self { heroes: Some(heroes), ..self }
    }

    /// Draws a third of the heroes evenly over the bands of a spectral image, where the lights shine. Fixed lanes are
    /// not changed.
    #[must_use]
    pub fn spread_over_bands(self, bands: &WavelengthBands, lights: &[Emission]) -> Self {
        let shown =
            |heroes: Heroes| Heroes { mixture: Arc::new(heroes.mixture.spread_over_bands(bands, lights)), ..heroes };
        Self { heroes: self.heroes.map(shown), ..self }
    }

    /// Refracts all lanes by the index at the d line, except where an index is given as `rgb`. Reflection and
    /// transmission still use each lane's own index. For three bands, this is the index whose reflectance at normal
    /// incidence is the mean over the band.
    #[must_use]
    pub fn kept_together(self) -> Self {
        Self { keeps_together: true, ..self }
    }

    /// Prepares the basis for lights that excite dyes: heroes are also drawn where they do.
    #[must_use]
    pub fn for_dyes(self, dyes: &[Dye], lights: &[&Curve]) -> Self {
        if self.excites || !self.has_wavelengths() {
            return self;
        }
        let heroes = self.heroes.map(|heroes| {
            let lights = lights.iter().map(|light| Emission::new(light, self.space));
            let shining: Vec<Emission> = dyes.iter().map(|dye| dye.shines(self.space)).collect();
            let lights: Vec<Emission> = lights.chain(shining.iter().cloned()).collect();
            let of_dye = |dye: PreparedDye| lights.iter().map(|light| dye.by(light)).collect::<Vec<_>>();
            let excitations: Vec<_> = dyes.iter().map(Dye::prepared).flat_map(of_dye).collect();
            Heroes { mixture: Arc::new(heroes.mixture.for_dyes(&excitations, &shining)), ..heroes }
        });
        Self { heroes, excites: true, ..self }
    }

    /// Returns whether lanes are wavelengths. Only for these is it known what dyes absorb.
    pub fn has_wavelengths(&self) -> bool {
        matches!(self.lanes, LaneKind::Wavelengths(_))
    }

    fn new(space: ColorSpace, lanes: LaneKind, wavelengths_nm: Vec<f64>) -> Self {
        let upsampler = Arc::new(Upsampler::new(space));
        Self {
            space,
            upsampler,
            lanes,
            wavelengths_nm,
            heroes: None,
            keeps_together: false,
            projection: None,
            excites: false,
        }
    }

    /// Returns the model's name as it is recorded in a file.
    pub fn name(&self) -> String {
        let lanes = self.wavelengths_nm.len();
        match (&self.lanes, &self.heroes) {
            (LaneKind::Rgb(_), _) => "rgb".into(),
            (LaneKind::Prefiltered(_), _) => "rgb, Rec.2020 prefiltered by the light".into(),
            (LaneKind::Wavelengths(_), None) => format!("bands {lanes}"),
            (LaneKind::Wavelengths(_), Some(heroes)) => format!("hero {lanes} + {}", heroes.count),
        }
    }

    /// Returns the number of lanes that a camera sample carries.
    pub fn lanes(&self) -> usize {
        self.wavelengths_nm.len() + self.heroes.as_ref().map_or(0, |heroes| heroes.count)
    }

    /// Returns the number of lanes that stand for the same light in every sample.
    pub fn fixed_lanes(&self) -> usize {
        self.wavelengths_nm.len()
    }

    /// Returns the wavelengths at which the fixed lanes read an index, an absorption or a metal, in nm.
    pub fn wavelengths_nm(&self) -> &[f64] {
        &self.wavelengths_nm
    }

    /// Returns the upsampler that makes spectra of `rgb` for this film.
    pub fn upsampler(&self) -> &Upsampler {
        &self.upsampler
    }

    /// Returns the film's color space.
    pub fn color_space(&self) -> ColorSpace {
        self.space
    }

    /// Returns whether samples differ in what their lanes stand for.
    pub fn draws_wavelengths(&self) -> bool {
        self.heroes.is_some()
    }

    /// Returns the lanes of a camera sample, for a random number in 0..1.
    pub fn draw<const N: usize>(&self, u: f64) -> Draw<N> {
        let Some(Heroes { count, mixture, collapse }) = &self.heroes else { return Draw::fixed(self.fixed_lanes()) };
        // Independent draws: the last digits of a well-distributed number are not well distributed at all.
        let u = if *collapse { (u * 4096.0).fract() } else { u };
        // Rotated in equal steps (Wilkie et al. 2014, *Hero Wavelength Spectral Sampling*, equation 13).
        let mut heroes = [Default::default(); MAX_HEROES];
        for (i, hero) in heroes[..*count].iter_mut().enumerate() {
            let rotated = u + i as f64 / *count as f64;
            *hero = mixture.draw(if rotated < 1.0 { rotated } else { rotated - 1.0 }, *count);
        }
        let draw = Draw::with_heroes(self.fixed_lanes(), &heroes[..*count]);
        if *collapse { draw.collapsing() } else { draw }
    }

    /// Tabulates a curve. In a basis of wavelengths, an emission is a flat table: its colors are in its response.
    pub fn tabulate(&self, quantity: Quantity, curve: &Curve) -> Table {
        if let Some(table) = self.tabulate_pattern(quantity, curve) {
            return table;
        }
        if quantity == Quantity::Emission {
            return self.tabulate_emission(curve);
        }
        let reader = curve.reader(quantity, &self.upsampler);
        let is_share = matches!(quantity, Quantity::Reflectance | Quantity::Transmittance | Quantity::Share);
        let table = match (&self.lanes, curve.kind.rgb(), &self.projection) {
            (LaneKind::Rgb(_), Some(rgb), _) if is_share || quantity == Quantity::Absorption => {
                Table::new(rgb.map(|x| x * curve.scale))
            }
            (LaneKind::Prefiltered(bands), ..) if quantity != Quantity::Index => {
                Table::new(bands.filter(quantity, curve, &*reader))
            }
            (_, _, Some(projection)) if is_share => self.table(projection.read(&*reader), &*reader),
            _ => self.table(self.wavelengths_nm.iter().map(|&nm| reader(nm)).collect(), &*reader),
        };
        let refracts = quantity == Quantity::Index && !matches!(curve.kind, CurveKind::Rgb(_));
        match &self.lanes {
            _ if !(self.keeps_together && refracts) || table.is_flat() => table,
            LaneKind::Wavelengths(_) => table.refracting_as(reader(DIRECTION_NM)),
            LaneKind::Rgb(bands) | LaneKind::Prefiltered(bands) => {
                self.table(bands.index(&*reader).into(), &*reader).refracting_as(reader(DIRECTION_NM))
            }
        }
    }

    /// Returns where the lanes lie in the spectrum.
    pub fn waves(&self) -> Waves {
        Waves::new(self.table(self.wavelengths_nm.clone(), &|nm| nm), self.band_widths())
    }

    /// Tabulates a curve that varies over a surface; `None` if it does not vary.
    fn tabulate_pattern(&self, quantity: Quantity, curve: &Curve) -> Option<Table> {
        let part = if quantity == Quantity::Thickness { quantity } else { Quantity::Transmittance };
        let tabulate_cell = |curve: &Curve| self.tabulate(part, curve);
        let kind = match &curve.kind {
            CurveKind::Texture(texture) => {
                let palette = (!matches!(self.lanes, LaneKind::Rgb(_))).then(|| palette(tabulate_cell));
                PatternKind::Image(texture.clone(), palette)
            }
            CurveKind::Checker { cells, repeat } => {
                PatternKind::Checker { cells: cells.each_ref().map(tabulate_cell), repeat: *repeat }
            }
            _ => return None,
        };
        let shines = quantity == Quantity::Emission;
        let level = match shines {
            true => self.tabulate(quantity, &curve.level()),
            false => self.constant_table(curve.scale),
        };
        let limit = if shines || quantity == Quantity::Thickness { f32::INFINITY } else { 1.0 };
        Some(level.with_pattern(Pattern { kind, limit, mean: curve.kind.mean() }))
    }

    /// Returns a table of the same number everywhere.
    fn constant_table(&self, value: f64) -> Table {
        self.table(vec![value; self.fixed_lanes()], &|_| value)
    }

    /// Returns the width of each fixed lane's band over its wavelength; 0 for a lane that reads a single wavelength.
    fn band_widths(&self) -> Table {
        let LaneKind::Wavelengths(functions) = &self.lanes else { return self.constant_table(0.0) };
        let nodes = &self.wavelengths_nm[..functions.len()];
        let width = |i: usize| {
            let [first, last] = [i.saturating_sub(1), (i + 1).min(nodes.len() - 1)];
            if first == last { 0.0 } else { (nodes[last] - nodes[first]) / ((last - first) as f64 * nodes[i]) }
        };
        let lines = self.wavelengths_nm[functions.len()..].iter().map(|_| 0.0);
        Table::with_fine(
            &(0..nodes.len()).map(width).chain(lines).collect::<Vec<_>>(),
            self.on_fine_grid(|_| 0.0, |_| 0.0),
        )
    }

    /// Creates a table of the bins, and of the fine grid if wavelengths are drawn.
    fn table(&self, bins: Vec<f64>, value: &dyn Fn(f64) -> f64) -> Table {
        Table::with_fine(&bins, self.on_fine_grid(value, value))
    }

    /// Evaluates the visible grid, followed by the lines; empty if no wavelengths are drawn.
    pub(super) fn on_fine_grid<T: Clone>(&self, smooth: impl Fn(f64) -> T, line: impl Fn(f64) -> T) -> Vec<T> {
        let Some(Heroes { mixture, .. }) = &self.heroes else { return Vec::new() };
        let mut fine: Vec<T> = visible::wavelengths().map(smooth).collect();
        fine.extend(mixture.lines.iter().map(|&nm| line(nm)));
        // One more entry, so that interpolation never runs off the end.
        fine.push(fine[fine.len() - 1].clone());
        fine
    }

    fn tabulate_emission(&self, curve: &Curve) -> Table {
        let emission = || Emission::new(curve, self.space);
        match (&self.lanes, curve.kind.rgb()) {
            (LaneKind::Rgb(_), Some(rgb)) if curve.luminance.is_none() => Table::new(rgb.map(|x| x * curve.scale)),
            (LaneKind::Rgb(_), _) => Table::new(apply(&ColorSpace::Rec709.matrix_from_xyz(), emission().xyz())),
            (LaneKind::Prefiltered(_), _) => {
                Table::new(apply(&ColorSpace::Rec2020.matrix_from_xyz(), emission().xyz()))
            }
            (LaneKind::Wavelengths(_), _) => self.constant_table(self.level(&emission())),
        }
    }

    /// Returns the number that stands for a light's brightness in every lane.
    fn level(&self, emission: &Emission) -> f64 {
        let color = emission.level();
        if self.excites { color.max(f64::from(emission.power() as f32)) } else { color }
    }

    /// Returns what the lanes are worth to the sensor when a path ends in a light of this emission.
    pub fn response(&self, curve: &Curve) -> Response {
        let curve = &*curve.level();
        let matrix_response =
            |matrix: &Matrix| Response::new(&[0, 1, 2].map(|lane| matrix.map(|row| row[lane])), Vec::new());
        match &self.lanes {
            LaneKind::Rgb(_) if curve.is_measured() || curve.luminance.is_some() => {
                matrix_response(&product(&self.space.matrix_from_xyz(), &ColorSpace::Rec709.to_xyz()))
            }
            LaneKind::Rgb(_) => matrix_response(&self.space.matrix_from_rec709()),
            LaneKind::Prefiltered(_) => {
                matrix_response(&product(&self.space.matrix_from_xyz(), &ColorSpace::Rec2020.to_xyz()))
            }
            LaneKind::Wavelengths(functions) => {
                let emission = Emission::new(curve, self.space);
                let lines = emission.lines().iter().map(|&[nm, power]| emission.film_color(nm).map(|x| x * power));
                let light = emission.columns().chain(lines).collect();
                self.integrate_response(&emission, functions, light)
            }
        }
    }

    /// Returns what the lanes are worth to a dye when a path ends in a light of this emission: in all three channels,
    /// the number that stands for the brightness of what the dye emits. It is 0 if lanes are not wavelengths.
    pub fn excitation(&self, dye: &PreparedDye, light: &Emission) -> Response {
        let LaneKind::Wavelengths(functions) = &self.lanes else { return Response::new(&[], Vec::new()) };
        let level = self.level(&dye.dye().shines(self.space));
        let excited = dye.by(light).parts().map(|x| [level * x; 3]).collect();
        self.integrate_response(light, functions, excited)
    }

    /// Returns what the lanes contribute to bands of wavelengths when a path ends in a light of this emission; `None`
    /// for three bands, which are not wavelengths.
    pub fn band_response(&self, curve: &Curve, bands: WavelengthBands) -> Option<BandResponse> {
        let LaneKind::Wavelengths(functions) = &self.lanes else { return None };
        let emission = Emission::new(&curve.level(), self.space);
        let level = self.level(&emission);
        let unit = if level == 0.0 { 0.0 } else { emission.unit() / level };
        let mut columns = vec![0.0; self.fixed_lanes() * bands.count()];
        let mut add = |lane: usize, band: usize, light: f64| {
            columns[lane * bands.count() + band] += light * unit / bands.known_nm(band);
        };
        let lines = emission.lines();
        self.distribute(functions, lines, |part, lane, weight| match part.checked_sub(COUNT) {
            None => {
                let light = weight * emission.spectrum()[part];
                bands.around(visible::START_NM + part as f64).for_each(|(band, width)| add(lane, band, light * width));
            }
            Some(line) => {
                let [nm, power] = lines[line];
                bands.band_at(nm).into_iter().for_each(|band| add(lane, band, weight * power));
            }
        });
        let at = |nm: f64| unit * emission.spectrum()[(nm - visible::START_NM) as usize];
        let line = |nm: f64| unit * emission.power_of_line(nm);
        let lines_nm = self.heroes.as_ref().map_or(&[][..], |heroes| &*heroes.mixture.lines);
        Some(BandResponse::new(bands, columns, self.on_fine_grid(at, line), lines_nm))
    }

    /// Distributes each part of a light over the lanes. Calls `add_share` with the number of the part (those of the
    /// visible grid, then the lines), a lane, and the share that the lane carries.
    fn distribute(&self, functions: &[Vec<f64>], lines: &[[f64; 2]], mut add_share: impl FnMut(usize, usize, f64)) {
        for part in 0..COUNT {
            functions.iter().enumerate().for_each(|(lane, function)| add_share(part, lane, function[part]));
        }
        for (part, &[nm, _]) in (COUNT..).zip(lines) {
            let own_lane = self.wavelengths_nm[functions.len()..].iter().position(|&lane| lane == nm);
            match own_lane {
                Some(lane) => add_share(part, functions.len() + lane, 1.0),
                None => {
                    let carried = functions.iter().map(|function| visible::read(function, nm));
                    carried.enumerate().for_each(|(lane, share)| add_share(part, lane, share));
                }
            }
        }
    }

    /// Integrates what each part of a light is worth, over the light's level, with the function of each lane. `light`
    /// holds the worth per nm at the wavelengths of the visible grid, then that of the lines.
    fn integrate_response(&self, emission: &Emission, functions: &[Vec<f64>], light: Vec<[f64; 3]>) -> Response {
        let level = self.level(emission);
        let per_level = |color: [f64; 3]| if level == 0.0 { [0.0; 3] } else { color.map(|x| x / level) };
        let light: Vec<[f64; 3]> = light.into_iter().map(per_level).collect();
        let mut columns = vec![[0.0; 3]; self.fixed_lanes()];
        self.distribute(functions, emission.lines(), |part, lane, weight| {
            (0..3).for_each(|c| columns[lane][c] += weight * light[part][c]);
        });
        let at = |nm: f64| light[(nm - visible::START_NM) as usize];
        let of_lines = emission.lines().iter().zip(&light[COUNT..]);
        let line = |nm: f64| {
            let here = of_lines.clone().filter(|(line, _)| line[0] == nm).map(|(_, color)| *color);
            here.fold([0.0; 3], |sum, color| std::array::from_fn(|c| sum[c] + color[c]))
        };
        Response::new(&columns, self.on_fine_grid(at, line))
    }
}

/// Adds what each part of the light is worth to some measures, as a share of the sum. Adds nothing if the sum is 0.
fn add_measures<const M: usize>(parts: &mut [Part], worth: Vec<[f64; M]>) {
    let sum = worth.iter().flatten().map(|x| x.abs()).sum::<f64>();
    if sum > 0.0 {
        parts.iter_mut().zip(worth).for_each(|(part, worth)| part.worth.extend(worth.map(|x| x / sum)));
    }
}
