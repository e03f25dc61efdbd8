// Data: refractiveindex.info database v2026-05-24, CC0 1.0 (public domain). Regenerate: python tools/tabulate.py
//! Dispersion formulas of glasses, crystals and water.

/// A clear material: n^2 = 1 + sum of b w^2 / (w^2 - c), w = wavelength in um (Sellmeier 1871).
#[derive(Clone, Copy, Debug)]
pub struct Glass {
    /// Its name in a scene.
    pub name: &'static str,
    /// Other names of the same data.
    pub aliases: &'static [&'static str],
    /// Who published the formula.
    pub source: &'static str,
    /// The wavelengths in nm between which the formula holds.
    pub range_nm: (f64, f64),
    /// The strengths b.
    pub b: &'static [f64],
    /// The squared resonance wavelengths c, in um^2.
    pub c: &'static [f64],
}

/// Every glass, in the order of the names' characters.
pub const GLASSES: &[Glass] = &[
    Glass {
        name: "CaF2",
        aliases: &["fluorite"],
        source: "Daimon and Masumura, Appl. Opt. 41, 5275 (2002), 20 °C",
        range_nm: (138.0, 2326.0),
        b: &[0.443749998, 0.444930066, 0.150133991, 8.85319946],
        c: &[0.00178027854, 0.00788536061, 0.0124119491, 2752.28175],
    },
    Glass {
        name: "F2",
        aliases: &[],
        source: "SCHOTT Zemax catalog 2017-01-20b",
        range_nm: (320.0, 2500.0),
        b: &[1.34533359, 0.209073176, 0.937357162],
        c: &[0.00997743871, 0.0470450767, 111.886764],
    },
    Glass {
        name: "N-BAF10",
        aliases: &[],
        source: "SCHOTT Zemax catalog 2017-01-20b",
        range_nm: (350.0, 2500.0),
        b: &[1.5851495, 0.143559385, 1.08521269],
        c: &[0.00926681282, 0.0424489805, 105.613573],
    },
    Glass {
        name: "N-BK7",
        aliases: &[],
        source: "SCHOTT Zemax catalog 2017-01-20b",
        range_nm: (300.0, 2500.0),
        b: &[1.03961212, 0.231792344, 1.01046945],
        c: &[0.00600069867, 0.0200179144, 103.560653],
    },
    Glass {
        name: "N-F2",
        aliases: &[],
        source: "SCHOTT Zemax catalog 2017-01-20b",
        range_nm: (365.0, 2500.0),
        b: &[1.39757037, 0.159201403, 1.2686543],
        c: &[0.00995906143, 0.0546931752, 119.248346],
    },
    Glass {
        name: "N-K5",
        aliases: &[],
        source: "SCHOTT Zemax catalog 2017-01-20b",
        range_nm: (310.0, 2500.0),
        b: &[1.08511833, 0.199562005, 0.930511663],
        c: &[0.00661099503, 0.024110866, 111.982777],
    },
    Glass {
        name: "N-LAK22",
        aliases: &[],
        source: "SCHOTT Zemax catalog 2017-01-20b",
        range_nm: (310.0, 2500.0),
        b: &[1.14229781, 0.535138441, 1.04088385],
        c: &[0.00585778594, 0.0198546147, 100.834017],
    },
    Glass {
        name: "N-LASF9",
        aliases: &[],
        source: "SCHOTT Zemax catalog 2017-01-20b",
        range_nm: (365.0, 2500.0),
        b: &[2.00029547, 0.298926886, 1.80691843],
        c: &[0.0121426017, 0.0538736236, 156.530829],
    },
    Glass {
        name: "N-SF10",
        aliases: &[],
        source: "SCHOTT Zemax catalog 2017-01-20b",
        range_nm: (380.0, 2500.0),
        b: &[1.62153902, 0.256287842, 1.64447552],
        c: &[0.0122241457, 0.0595736775, 147.468793],
    },
    Glass {
        name: "N-SF11",
        aliases: &[],
        source: "SCHOTT Zemax catalog 2017-01-20b",
        range_nm: (370.0, 2500.0),
        b: &[1.73759695, 0.313747346, 1.89878101],
        c: &[0.013188707, 0.0623068142, 155.23629],
    },
    Glass {
        name: "N-SF6",
        aliases: &[],
        source: "SCHOTT Zemax catalog 2017-01-20b",
        range_nm: (370.0, 2500.0),
        b: &[1.77931763, 0.338149866, 2.08734474],
        c: &[0.0133714182, 0.0617533621, 174.01759],
    },
    Glass {
        name: "SF10",
        aliases: &[],
        source: "SCHOTT Zemax catalog 2017-01-20b",
        range_nm: (380.0, 2500.0),
        b: &[1.61625977, 0.259229334, 1.07762317],
        c: &[0.0127534559, 0.0581983954, 116.60768],
    },
    Glass {
        name: "diamond",
        aliases: &[],
        source: "Peter, Zeitschrift für Physik 15, 358 (1923)",
        range_nm: (226.0, 760.0),
        b: &[0.3306, 4.3356],
        c: &[0.030625, 0.011236],
    },
    Glass {
        name: "fused silica",
        aliases: &["silica", "SiO2"],
        source: "Malitson, J. Opt. Soc. Am. 55, 1205 (1965)",
        range_nm: (210.0, 6700.0),
        b: &[0.6961663, 0.4079426, 0.8974794],
        c: &[0.00467914825849, 0.01351206307396, 97.934002537921],
    },
    Glass {
        name: "sapphire",
        aliases: &[],
        source: "Dodge, Handbook of Laser Science IV (1986), ordinary ray",
        range_nm: (200.0, 5000.0),
        b: &[1.4313493, 0.65054713, 5.3414021],
        c: &[0.00527992610161, 0.01423826470564, 325.017834119001],
    },
    Glass {
        name: "water",
        aliases: &["H2O"],
        source: "Daimon and Masumura, Appl. Opt. 46, 3811 (2007), 20 °C",
        range_nm: (182.0, 1129.0),
        b: &[0.5684027565, 0.1726177391, 0.02086189578, 0.1130748688],
        c: &[0.005101829712, 0.01821153936, 0.02620722293, 10.69792721],
    },
];
