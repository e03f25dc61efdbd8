//! Illuminants, reflectances, and the eye of the standard observer.

use std::sync::OnceLock;

use super::rows::{Row, Rows, fields, numbers};
use crate::math::interpolate;

const ROWS: Rows = Rows::new(include_str!("colors.txt"));

const ILLUMINANT: &str = "illuminant/";
const COLORCHECKER: &str = "colorchecker/";

/// The spectrum of a light, in its own unit.
#[derive(Clone, Debug, PartialEq)]
pub struct Illuminant {
    /// Its name in a scene.
    pub name: &'static str,
    /// Who published it.
    pub source: &'static str,
    /// The wavelength of the first value in nm.
    pub start_nm: f64,
    /// The wavelength from value to value in nm.
    pub step_nm: f64,
    /// The values.
    pub values: Vec<f64>,
}

/// The reflectance of a colored surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Reflectance {
    /// Its full name in a scene: `colorchecker/dark skin`.
    pub name: &'static str,
    /// Who published it.
    pub source: &'static str,
    /// The wavelength of the first value in nm.
    pub start_nm: f64,
    /// The wavelength from value to value in nm.
    pub step_nm: f64,
    /// The values.
    pub values: Vec<f64>,
}

impl Illuminant {
    fn read(row: Row) -> Self {
        let Grid { name, source, start_nm, step_nm, values } = Grid::read(row);
        let name = name.split_once('/').map_or(name, |(_, name)| name);
        Self { name, source, start_nm, step_nm, values }
    }

    /// The value at a wavelength; linear between the tabulated ones, 0 beyond the ends.
    pub fn at(&self, nm: f64) -> f64 {
        let end_nm = self.start_nm + self.step_nm * (self.values.len() - 1) as f64;
        if (self.start_nm..=end_nm).contains(&nm) { at(self.start_nm, self.step_nm, &self.values, nm) } else { 0.0 }
    }
}

impl Reflectance {
    fn read(row: Row) -> Self {
        let Grid { name, source, start_nm, step_nm, values } = Grid::read(row);
        Self { name, source, start_nm, step_nm, values }
    }

    /// The value at a wavelength; linear between the tabulated ones, flat beyond the ends.
    pub fn at(&self, nm: f64) -> f64 {
        at(self.start_nm, self.step_nm, &self.values, nm)
    }
}

/// A line of the table.
struct Grid {
    name: &'static str,
    source: &'static str,
    start_nm: f64,
    step_nm: f64,
    values: Vec<f64>,
}

impl Grid {
    fn read(row: Row) -> Self {
        let mut rest = fields(row);
        let mut field = || rest.next().unwrap_or_default();
        let (name, source, start, step) = (field(), field(), numbers(field()), numbers(field()));
        Self { name, source, start_nm: start[0], step_nm: step[0], values: numbers(field()) }
    }
}

fn at(start: f64, step: f64, values: &[f64], nm: f64) -> f64 {
    let last = values.len() - 1;
    let place = ((nm - start) / step).clamp(0.0, last as f64);
    let i = (place as usize).min(last.saturating_sub(1));
    interpolate(&[[i as f64, values[i]], [(i + 1) as f64, values[(i + 1).min(last)]]], place)[1]
}

fn find(group: &str, name: &str) -> Option<Row> {
    let whole = name.get(..group.len()).is_some_and(|start| start.eq_ignore_ascii_case(group));
    if whole { ROWS.find(name) } else { ROWS.find(&format!("{group}{name}")) }
}

/// The illuminant of that name, whatever the case of its letters.
pub fn illuminant(name: &str) -> Option<Illuminant> {
    find(ILLUMINANT, name).map(Illuminant::read)
}

/// Every illuminant, in the order of the names.
pub fn illuminants() -> impl Iterator<Item = Illuminant> {
    ROWS.starting_with(ILLUMINANT).map(Illuminant::read)
}

/// The reflectance of that name, with or without what it is a part of, whatever the case of its letters.
pub fn reflectance(name: &str) -> Option<Reflectance> {
    find(COLORCHECKER, name).map(Reflectance::read)
}

/// Every reflectance, in the order of the names.
pub fn reflectances() -> impl Iterator<Item = Reflectance> {
    ROWS.starting_with(COLORCHECKER).map(Reflectance::read)
}

/// The sensitivities x, y, z of the CIE 1931 2 degree observer at 360 + i nm.
pub fn color_matching() -> &'static [[f64; 3]; 471] {
    static OBSERVER: OnceLock<[[f64; 3]; 471]> = OnceLock::new();
    OBSERVER.get_or_init(|| {
        let axes = ["x", "y", "z"].map(|axis| ROWS.find(&format!("observer/{axis}")).map(Grid::read));
        std::array::from_fn(|i| std::array::from_fn(|axis| axes[axis].as_ref().map_or(0.0, |grid| grid.values[i])))
    })
}
