//! Film color spaces, their matrices, and the one transfer curve that an image for display needs.

use palette::{LinSrgb, Srgb};
use serde::{Deserialize, Serialize};

use super::data::{self, Grid};

/// A 3 x 3 matrix, row by row.
pub type Matrix = [[f64; 3]; 3];

/// A linear, scene-referred color space, by its Color Interop Forum identifier.
///
/// ```toml
/// film.color_space = "lin_rec709_scene"
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum ColorSpace {
    /// The primaries of Rec.709 (sRGB), white D65.
    #[default]
    Rec709,
    /// ACEScg, the AP1 primaries, white near D60.
    AcesCg,
    /// ACES2065-1, the AP0 primaries, white near D60.
    Aces2065,
    /// The primaries of Rec.2020, white D65.
    Rec2020,
    /// The primaries of DCI-P3, white D65.
    P3D65,
    /// CIE 1931 XYZ. A bare number as an emission is white, D65; the color (1, 1, 1) is the equal-energy spectrum's.
    Xyz,
}

/// CIE 1931 (x, y) of a color space's primaries and white.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Primaries {
    /// Red primary, or X.
    pub red: [f64; 2],
    /// Green primary, or Y.
    pub green: [f64; 2],
    /// Blue primary, or Z.
    pub blue: [f64; 2],
    /// The color (1, 1, 1).
    pub white: [f64; 2],
}

impl Primaries {
    /// Returns the matrix to CIE XYZ. SMPTE RP 177-1993, *Derivation of Basic Television Color Equations*.
    fn to_xyz(self) -> Matrix {
        let columns = transpose([self.red, self.green, self.blue].map(xyz_from_primary));
        let strengths = apply(&inverse(&columns), xyz_from_chromaticity(self.white));
        columns.map(|row| std::array::from_fn(|i| row[i] * strengths[i]))
    }

    /// Returns the space that has these primaries, to the four digits with which most are published.
    pub fn space(self) -> Option<ColorSpace> {
        let list = |it: Self| [it.red, it.green, it.blue, it.white];
        let near = |space: &ColorSpace| {
            let (ours, theirs) = (list(self), list(space.primaries()));
            ours.as_flattened().iter().zip(theirs.as_flattened()).all(|(a, b)| (a - b).abs() < 1e-4)
        };
        ColorSpace::ALL.into_iter().find(near)
    }

    /// Returns the matrix to linear Rec.709, adapted to its white; `None` if the primaries lie on a line or white is
    /// dark.
    pub fn to_rec709(self) -> Option<Matrix> {
        let from_red = |[x, y]: [f64; 2]| [x - self.red[0], y - self.red[1]];
        let [green, blue] = [self.green, self.blue].map(from_red);
        // Twice the area of the triangle, which is 0.2 for Rec.709. Rounding in a file turns a line into up to 1e-7.
        if (green[0] * blue[1] - green[1] * blue[0]).abs() < 1e-6 {
            return None;
        }
        let adapted =
            product(&adaptation(xyz_from_chromaticity(self.white), ColorSpace::Rec709.white()), &self.to_xyz());
        let matrix = product(&ColorSpace::Rec709.matrix_from_xyz(), &adapted);
        matrix.iter().flatten().all(|x| x.is_finite()).then_some(matrix)
    }
}

/// Returns the matrix from the colors of a file to linear Rec.709, adapted to its white. The file describes its colors
/// by the `colorInteropID` of their space, or else by primaries and white. Without either, they are Rec.709.
///
/// # Errors
/// If the meaning of the colors is not known; the message says why.
pub fn file_to_rec709(interop_id: Option<&str>, primaries: Option<Primaries>) -> Result<Matrix, String> {
    if let Some(space) = interop_id.and_then(ColorSpace::from_interop_id).or_else(|| primaries?.space()) {
        return Ok(space.to_rec709());
    }
    match (primaries, interop_id.filter(|id| *id != "unknown")) {
        (Some(primaries), _) => primaries.to_rec709().ok_or_else(|| "its chromaticities define no color space".into()),
        (None, Some("data")) => Err("it says that it holds data, not colors".into()),
        (None, Some(id)) => Err(format!("the color space {id:?} is not known")),
        (None, None) => Ok(IDENTITY),
    }
}

/// Returns what messages call a file's colors: the space that it names or whose primaries it has, or the primaries.
pub fn describe_file_colors(interop_id: Option<&str>, primaries: Option<Primaries>) -> String {
    let point = |[x, y]: [f64; 2]| format!("({}, {})", x as f32, y as f32);
    match (interop_id, primaries.and_then(Primaries::space), primaries) {
        (Some(id), ..) => format!("the color space {id}"),
        (None, Some(space), _) => format!("the primaries of {}", space.interop_id()),
        (None, None, Some(primaries)) => {
            let Primaries { red, green, blue, white } = primaries;
            let [red, green, blue, white] = [red, green, blue, white].map(point);
            format!("the primaries red {red}, green {green}, blue {blue} and white {white}")
        }
        (None, None, None) => format!("no color space, which means {}", ColorSpace::default().interop_id()),
    }
}

const D65: [f64; 2] = [0.3127, 0.3290];
const ACES_WHITE: [f64; 2] = [0.32168, 0.33767];

impl ColorSpace {
    /// Every space.
    pub const ALL: [Self; 6] = [Self::Rec709, Self::AcesCg, Self::Aces2065, Self::Rec2020, Self::P3D65, Self::Xyz];

    /// Returns the `colorInteropID` of the space.
    pub fn interop_id(self) -> &'static str {
        match self {
            Self::Rec709 => "lin_rec709_scene",
            Self::AcesCg => "lin_ap1_scene",
            Self::Aces2065 => "lin_ap0_scene",
            Self::Rec2020 => "lin_rec2020_scene",
            Self::P3D65 => "lin_p3d65_scene",
            Self::Xyz => "lin_ciexyzd65_scene",
        }
    }

    /// Returns the space that a `colorInteropID` names.
    fn from_interop_id(id: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|space| space.interop_id() == id)
    }

    /// Returns the space that people call by a name such as "sRGB", "ACEScg" or "Rec.2020".
    pub fn from_name(name: &str) -> Option<Self> {
        const NAMES: [(&str, ColorSpace); 9] = [
            ("acescg", ColorSpace::AcesCg),
            ("ap1", ColorSpace::AcesCg),
            ("aces", ColorSpace::Aces2065),
            ("ap0", ColorSpace::Aces2065),
            ("2020", ColorSpace::Rec2020),
            ("p3", ColorSpace::P3D65),
            ("xyz", ColorSpace::Xyz),
            ("709", ColorSpace::Rec709),
            ("srgb", ColorSpace::Rec709),
        ];
        let name = name.to_lowercase();
        NAMES.iter().find(|(part, _)| name.contains(part)).map(|(_, space)| *space)
    }

    /// Returns primaries and white: ITU-R BT.709-6 table 1, ITU-R BT.2020-2 table 3, SMPTE RP 431-2 with the white of
    /// BT.709, AMPAS S-2014-004 (AP1) and SMPTE ST 2065-1 (AP0).
    pub fn primaries(self) -> Primaries {
        let of = |red, green, blue, white| Primaries { red, green, blue, white };
        match self {
            Self::Rec709 => of([0.64, 0.33], [0.30, 0.60], [0.15, 0.06], D65),
            Self::AcesCg => of([0.713, 0.293], [0.165, 0.830], [0.128, 0.044], ACES_WHITE),
            Self::Aces2065 => of([0.7347, 0.2653], [0.0, 1.0], [0.0001, -0.0770], ACES_WHITE),
            Self::Rec2020 => of([0.708, 0.292], [0.170, 0.797], [0.131, 0.046], D65),
            Self::P3D65 => of([0.680, 0.320], [0.265, 0.690], [0.150, 0.060], D65),
            Self::Xyz => of([1.0, 0.0], [0.0, 1.0], [0.0, 0.0], [1.0 / 3.0; 2]),
        }
    }

    /// Returns the XYZ of the space's white, with Y = 1.
    pub fn white(self) -> [f64; 3] {
        xyz_from_chromaticity(if self == Self::Xyz { D65 } else { self.primaries().white })
    }

    /// Returns the CIE illuminant that stands for the space's white where a spectrum is needed.
    pub fn white_light(self) -> Grid {
        let name = match self {
            Self::AcesCg | Self::Aces2065 => "D60",
            Self::Rec709 | Self::Rec2020 | Self::P3D65 | Self::Xyz => "D65",
        };
        data::illuminant(name).expect("both whites are in the catalog")
    }

    /// Returns the matrix from film color to CIE XYZ.
    pub fn to_xyz(self) -> Matrix {
        if self == Self::Xyz {
            return IDENTITY;
        }
        self.primaries().to_xyz()
    }

    /// Returns the matrix from CIE XYZ to film color.
    pub fn matrix_from_xyz(self) -> Matrix {
        inverse(&self.to_xyz())
    }

    /// Returns the matrix from film color to linear Rec.709, adapted to its white.
    pub fn to_rec709(self) -> Matrix {
        if self == Self::Rec709 { IDENTITY } else { inverse(&self.matrix_from_rec709()) }
    }

    /// Returns the matrix from linear Rec.709 to film color, adapted to the film's white.
    pub(super) fn matrix_from_rec709(self) -> Matrix {
        if self == Self::Rec709 {
            return IDENTITY;
        }
        let adapted = product(&adaptation(Self::Rec709.white(), self.white()), &Self::Rec709.to_xyz());
        product(&self.matrix_from_xyz(), &adapted)
    }
}

/// The identity matrix.
pub const IDENTITY: Matrix = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Returns the XYZ of a chromaticity, with Y = 1.
fn xyz_from_chromaticity([x, y]: [f64; 2]) -> [f64; 3] {
    [x / y, 1.0, (1.0 - x - y) / y]
}

/// Returns the XYZ of a chromaticity that may have y = 0, with X + Y + Z = 1.
fn xyz_from_primary([x, y]: [f64; 2]) -> [f64; 3] {
    [x, y, 1.0 - x - y]
}

/// Returns the matrix from XYZ under one white to the corresponding XYZ under another: linear Bradford (Lam 1985).
pub fn adaptation(from: [f64; 3], to: [f64; 3]) -> Matrix {
    const CONES: Matrix = [[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]];
    let (from, to) = (apply(&CONES, from), apply(&CONES, to));
    let scaled: Matrix = std::array::from_fn(|i| CONES[i].map(|x| x * to[i] / from[i]));
    product(&inverse(&CONES), &scaled)
}

/// Multiplies a matrix by a column.
pub fn apply(matrix: &Matrix, [x, y, z]: [f64; 3]) -> [f64; 3] {
    matrix.map(|row| row[0] * x + row[1] * y + row[2] * z)
}

/// Returns the sum of colors times their weights.
pub(super) fn weighted_sum(colors: impl Iterator<Item = (f64, [f64; 3])>) -> [f64; 3] {
    colors.fold([0.0; 3], |sum, (weight, color)| std::array::from_fn(|i| sum[i] + weight * color[i]))
}

/// Returns the matrix that applies `b`, then `a`.
pub fn product(a: &Matrix, b: &Matrix) -> Matrix {
    transpose(transpose(*b).map(|column| apply(a, column)))
}

fn transpose(m: Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| m[j][i]))
}

/// Returns the inverse, by cofactors.
pub fn inverse(m: &Matrix) -> Matrix {
    let cofactor = |i: usize, j: usize| {
        let (a, b, c, d) = ((i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3);
        m[a][c] * m[b][d] - m[a][d] * m[b][c]
    };
    let determinant: f64 = (0..3).map(|j| m[0][j] * cofactor(0, j)).sum();
    std::array::from_fn(|i| std::array::from_fn(|j| cofactor(j, i) / determinant))
}

/// Encodes a linear Rec.709 color as eight-bit sRGB: clips it to 0..1, then encodes it (IEC 61966-2-1).
pub fn encode_srgb(linear: [f32; 3]) -> [u8; 3] {
    let [red, green, blue] = linear.map(|x| x.clamp(0.0, 1.0));
    Srgb::<u8>::from_linear(LinSrgb::new(red, green, blue)).into()
}

/// Decodes an sRGB value to a linear one, both 0 to 1: IEC 61966-2-1, equations 5 and 6.
pub fn decode_srgb(encoded: f64) -> f64 {
    if encoded <= 0.04045 { encoded / 12.92 } else { libm::pow((encoded + 0.055) / 1.055, 2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn assert_near(found: [f64; 3], expected: [f64; 3], tolerance: f64) {
        for i in 0..3 {
            assert!((found[i] - expected[i]).abs() < tolerance, "{found:?} is not {expected:?}");
        }
    }

    #[test]
    fn white_is_one_in_every_space_and_white_in_xyz() {
        for space in ColorSpace::ALL.into_iter().filter(|space| *space != ColorSpace::Xyz) {
            assert_near(apply(&space.matrix_from_xyz(), space.white()), [1.0; 3], 1e-12);
            assert_near(apply(&space.matrix_from_rec709(), [1.0; 3]), [1.0; 3], 1e-12);
        }
        assert_near(apply(&ColorSpace::Xyz.matrix_from_rec709(), [1.0; 3]), ColorSpace::Xyz.white(), 1e-12);
    }

    /// IEC 61966-2-1, equation 7, prints the Rec.709 matrix to four decimals.
    #[test]
    fn the_rec709_matrix_is_the_published_one() {
        let m = ColorSpace::Rec709.to_xyz();
        assert_near(m[0], [0.4124, 0.3576, 0.1805], 5e-5);
        assert_near(m[1], [0.2126, 0.7152, 0.0722], 5e-5);
        assert_near(m[2], [0.0193, 0.1192, 0.9505], 5e-5);
    }

    #[test]
    fn primaries_that_a_file_gives_are_adapted_as_those_of_a_space_are() {
        for space in [ColorSpace::Rec709, ColorSpace::AcesCg, ColorSpace::Rec2020] {
            let matrix = space.primaries().to_rec709().expect("the primaries span a triangle");
            (0..3).for_each(|i| assert_near(matrix[i], space.to_rec709()[i], 1e-12));
            assert_eq!(ColorSpace::from_interop_id(space.interop_id()), Some(space));
        }
        let line = Primaries { red: [0.2, 0.2], green: [0.3, 0.3], blue: [0.4, 0.4], white: D65 };
        assert_eq!(line.to_rec709(), None);
        assert_eq!(Primaries { white: [0.3, 0.0], ..ColorSpace::Rec709.primaries() }.to_rec709(), None);
    }
}
