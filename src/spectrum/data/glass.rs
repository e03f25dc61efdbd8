//! Clear materials: glasses of the makers, crystals, gems, liquids, plastics and gases.

use std::sync::LazyLock;

use super::rows::{Row, Rows, fields, has_alias, key_of, names, number, numbers, samples};
use crate::math::interpolate;

static ROWS: LazyLock<Rows> = LazyLock::new(|| Rows::new(include_str!("glasses.txt")));

/// Key prefixes of materials not sold as optical glass, in the order in which a bare name is looked up.
const COMMON: [&str; 6] = ["crystal", "gem", "liquid", "glass", "plastic", "gas"];
/// Makers of optical glass, which begin its keys, in the order in which a bare name is looked up.
pub const GLASS_MAKERS: [&str; 6] = ["schott", "ohara", "hoya", "cdgm", "hikari", "sumita"];

/// Fraunhofer's lines F, d and C in nm.
const LINES_NM: [f64; 3] = [486.1327, 587.5618, 656.2725];

/// A clear material.
#[derive(Clone, Debug, PartialEq)]
pub struct Glass {
    /// Its full name: `maker/NAME`, or `liquid/water`.
    pub key: &'static str,
    /// Other names of the same data.
    pub aliases: Vec<&'static str>,
    /// Who published the index.
    pub source: &'static str,
    /// The range of wavelengths in nm in which the index is known.
    pub range_nm: (f64, f64),
    /// The formula of the index.
    pub formula: Formula,
    /// (wavelength in nm, k), ascending; empty if not known.
    pub extinction: Vec<[f64; 2]>,
    /// The index at 587.56 nm, as the maker states it.
    pub stated_nd: Option<f64>,
    /// The Abbe number, as the maker states it.
    pub stated_vd: Option<f64>,
}

/// A dispersion formula of refractiveindex.info with its coefficients C1, C2, ...; w is the wavelength in um.
#[derive(Clone, Debug, PartialEq)]
pub enum Formula {
    /// 1: n^2 - 1 = C1 + sum of C2 w^2 / (w^2 - C3^2).
    Sellmeier(Vec<f64>),
    /// 2: n^2 - 1 = C1 + sum of C2 w^2 / (w^2 - C3).
    SellmeierSquared(Vec<f64>),
    /// 3: n^2 = C1 + sum of C2 w^C3.
    Polynomial(Vec<f64>),
    /// 4: n^2 = C1 + C2 w^C3 / (w^2 - C4^C5) + C6 w^C7 / (w^2 - C8^C9) + sum of C10 w^C11.
    Poles(Vec<f64>),
    /// 5: n = C1 + sum of C2 w^C3.
    Cauchy(Vec<f64>),
    /// 6: n - 1 = C1 + sum of C2 / (C3 - w^-2).
    Gas(Vec<f64>),
    /// (wavelength in nm, n), ascending; linear in between, constant beyond the ends.
    Tabulated(Vec<[f64; 2]>),
}

impl Formula {
    fn read(kind: &str, text: &str) -> Self {
        match kind {
            "1" => Self::Sellmeier(numbers(text)),
            "2" => Self::SellmeierSquared(numbers(text)),
            "3" => Self::Polynomial(numbers(text)),
            "4" => Self::Poles(numbers(text)),
            "5" => Self::Cauchy(numbers(text)),
            "6" => Self::Gas(numbers(text)),
            _ => Self::Tabulated(samples(text)),
        }
    }

    /// Returns the index at a wavelength in nm.
    pub fn index(&self, nm: f64) -> f64 {
        let w = nm * 1e-3;
        let w2 = w * w;
        let sum = |c: &[f64], term: &dyn Fn(f64, f64) -> f64| {
            c[0] + c[1..].chunks_exact(2).map(|pair| term(pair[0], pair[1])).sum::<f64>()
        };
        match self {
            Self::Sellmeier(c) => (1.0 + sum(c, &|b, c| b * w2 / (w2 - c * c))).sqrt(),
            Self::SellmeierSquared(c) => (1.0 + sum(c, &|b, c| b * w2 / (w2 - c))).sqrt(),
            Self::Polynomial(c) => sum(c, &|b, power| b * w.powf(power)).sqrt(),
            Self::Poles(c) => {
                let (poles, powers) = c[1..].split_at((c.len() - 1).min(8));
                let pole = |p: &[f64]| p[0] * w.powf(p[1]) / (w2 - p[2].powf(p[3]));
                let powers = powers.chunks_exact(2).map(|p| p[0] * w.powf(p[1])).sum::<f64>();
                (c[0] + poles.chunks_exact(4).map(pole).sum::<f64>() + powers).sqrt()
            }
            Self::Cauchy(c) => sum(c, &|b, power| b * w.powf(power)),
            Self::Gas(c) => 1.0 + sum(c, &|b, c| b / (c - 1.0 / w2)),
            Self::Tabulated(samples) => interpolate(samples, nm)[1],
        }
    }
}

impl Glass {
    fn read(row: Row) -> Self {
        let mut rest = fields(row);
        let mut field = || rest.next().unwrap_or_default();
        let (key, aliases, kind, range, formula) = (field(), names(field()).collect(), field(), field(), field());
        let (extinction, stated_nd, stated_vd) = (samples(field()), field(), field());
        let (low, high) = range.split_once(' ').unwrap_or_default();
        let stated = |text: &str| (!text.is_empty()).then(|| number(text));
        Self {
            key,
            aliases,
            range_nm: (number(low), number(high)),
            formula: Formula::read(kind, formula),
            extinction,
            stated_nd: stated(stated_nd),
            stated_vd: stated(stated_vd),
            source: field(),
        }
    }

    /// Returns its name without the maker.
    pub fn name(&self) -> &'static str {
        bare(self.key)
    }

    /// Returns the index. Beyond the known wavelengths, it is the value at their end.
    pub fn index(&self, nm: f64) -> f64 {
        self.formula.index(nm.clamp(self.range_nm.0, self.range_nm.1))
    }

    /// Returns the extinction k, if it is known; linear between its samples, constant beyond the ends.
    pub fn extinction(&self, nm: f64) -> Option<f64> {
        (!self.extinction.is_empty()).then(|| interpolate(&self.extinction, nm)[1])
    }

    /// Returns the index at 587.56 nm.
    pub fn n_d(&self) -> f64 {
        self.index(LINES_NM[1])
    }

    /// Returns the Abbe number (n_d - 1) / (n_F - n_C), if the index is known at these lines.
    pub fn v_d(&self) -> Option<f64> {
        let ([f, d, c], (first, last)) = (LINES_NM.map(|nm| self.index(nm)), self.range_nm);
        (first <= LINES_NM[0] && LINES_NM[2] <= last).then_some((d - 1.0) / (f - c))
    }
}

/// Returns the glass of that name, ignoring case.
///
/// `maker/NAME` is one glass. A bare name is looked up among crystals, gems, liquids, common glasses, plastics and
/// gases, then among their aliases, then at Schott, Ohara, Hoya, CDGM, Hikari and Sumita. The first match is returned.
pub fn glass(name: &str) -> Option<Glass> {
    rows_called(name).next().map(Glass::read)
}

/// Returns the keys of all glasses that a name stands for, in the order in which they are looked up.
pub fn glass_makers(name: &str) -> Vec<&'static str> {
    rows_called(name).map(key_of).collect()
}

fn rows_called(name: &str) -> impl Iterator<Item = Row> {
    let exact = ROWS.find(name);
    let keyed = move |group: &&str| ROWS.find(&format!("{group}/{name}"));
    let aliased = || common_rows().find(|row| has_alias(row, name));
    let common = COMMON.iter().find_map(keyed).or_else(aliased);
    exact.into_iter().chain(common).chain(GLASS_MAKERS.iter().filter_map(keyed))
}

fn common_rows() -> impl Iterator<Item = Row> {
    COMMON.iter().flat_map(|group| ROWS.starting_with(group))
}

/// Returns every glass, in the order of the keys.
pub fn glasses() -> impl Iterator<Item = Glass> {
    ROWS.all().map(Glass::read)
}

/// How strongly a glass refracts and disperses light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GlassConstants {
    /// The full name of the glass.
    pub key: &'static str,
    /// See [`Glass::n_d`].
    pub n_d: f64,
    /// See [`Glass::v_d`].
    pub v_d: Option<f64>,
}

/// Returns the constants of every glass, in the order of the keys. A scene may compare thousands of materials with all
/// of them, and reading them takes 2 ms.
pub fn glass_constants() -> &'static [GlassConstants] {
    static ALL: LazyLock<Vec<GlassConstants>> = LazyLock::new(|| {
        glasses().map(|glass| GlassConstants { key: glass.key, n_d: glass.n_d(), v_d: glass.v_d() }).collect()
    });
    &ALL
}

/// Returns the keys of all glasses.
pub fn glass_names() -> impl Iterator<Item = &'static str> {
    ROWS.all().map(key_of)
}

/// Returns every name that stands for a glass: bare names and aliases first, then keys.
pub fn known_as() -> impl Iterator<Item = &'static str> {
    let aliases = common_rows().flat_map(|row| names(fields(row).nth(1).unwrap_or_default()));
    let makers = GLASS_MAKERS.iter().flat_map(|maker| ROWS.starting_with(maker));
    aliases.chain(common_rows().chain(makers).map(|row| bare(key_of(row)))).chain(glass_names())
}

/// Returns a key without its maker or its chart.
pub fn bare(key: &str) -> &str {
    key.split_once('/').map_or(key, |(_, name)| name)
}
