//! Illuminants, reflectances, and the color matching functions of the standard observer.

use std::sync::{LazyLock, OnceLock};

use super::rows::{Row, Rows, fields, numbers};

static ROWS: LazyLock<Rows> = LazyLock::new(|| Rows::new(include_str!("colors.txt")));

const ILLUMINANT: &str = "illuminant/";
const COLORCHECKER: &str = "colorchecker/";

/// A spectrum at wavelengths in equal steps: an illuminant, or the reflectance of a colored surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    /// Its name in a scene: `D65`, or in full `colorchecker/dark skin`.
    pub name: &'static str,
    /// Who published it.
    pub source: &'static str,
    /// The wavelength of the first value in nm.
    pub(super) start_nm: f64,
    /// The step from wavelength to wavelength in nm.
    pub(super) step_nm: f64,
    /// The values. Those of a light are in its own unit.
    pub(super) values: Vec<f64>,
    is_light: bool,
}

impl Grid {
    fn read(row: Row) -> Self {
        let mut rest = fields(row);
        let mut field = || rest.next().unwrap_or_default();
        let (key, source, start, step) = (field(), field(), numbers(field()), numbers(field()));
        let light = key.strip_prefix(ILLUMINANT);
        let (name, values) = (light.unwrap_or(key), numbers(field()));
        Self { name, source, start_nm: start[0], step_nm: step[0], values, is_light: light.is_some() }
    }

    /// Returns the first and the last wavelength in nm.
    pub fn range_nm(&self) -> [f64; 2] {
        [self.start_nm, self.start_nm + self.step_nm * (self.values.len() - 1) as f64]
    }

    /// Returns the value at a wavelength, interpolated linearly. Beyond the ends, a light is 0 and a reflectance
    /// constant.
    pub fn at(&self, nm: f64) -> f64 {
        let [first, end] = self.range_nm();
        if self.is_light && !(first..=end).contains(&nm) {
            return 0.0;
        }
        let last = self.values.len() - 1;
        let place = ((nm - self.start_nm) / self.step_nm).clamp(0.0, last as f64);
        let i = (place as usize).min(last.saturating_sub(1));
        let [low, high] = [i, (i + 1).min(last)].map(|i| self.values[i]);
        low + (high - low) * (place - i as f64)
    }
}

fn find(group: &str, name: &str) -> Option<Row> {
    let has_group = name.get(..group.len()).is_some_and(|start| start.eq_ignore_ascii_case(group));
    if has_group { ROWS.find(name) } else { ROWS.find(&format!("{group}{name}")) }
}

/// Returns the illuminant of that name, ignoring case.
pub fn illuminant(name: &str) -> Option<Grid> {
    find(ILLUMINANT, name).map(Grid::read)
}

/// Returns every illuminant, in the order of the names.
pub fn illuminants() -> impl Iterator<Item = Grid> {
    ROWS.starting_with(ILLUMINANT).map(Grid::read)
}

/// Returns the reflectance of that name, with or without the name of its chart, ignoring case.
pub fn reflectance(name: &str) -> Option<Grid> {
    find(COLORCHECKER, name).map(Grid::read)
}

/// Returns every reflectance, in the order of the names.
pub fn reflectances() -> impl Iterator<Item = Grid> {
    ROWS.starting_with(COLORCHECKER).map(Grid::read)
}

/// Returns the sensitivities x, y, z of the CIE 1931 2 degree observer at 360 + i nm.
pub fn color_matching() -> &'static [[f64; 3]; 471] {
    static OBSERVER: OnceLock<[[f64; 3]; 471]> = OnceLock::new();
    OBSERVER.get_or_init(|| {
        let axes = ["x", "y", "z"].map(|axis| ROWS.find(&format!("observer/{axis}")).map(Grid::read));
        std::array::from_fn(|i| std::array::from_fn(|axis| axes[axis].as_ref().map_or(0.0, |grid| grid.values[i])))
    })
}
