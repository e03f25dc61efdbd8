//! Materials parsed from text, and scattering contexts to test them with.

use std::sync::LazyLock;

use abbe::material::{Index, Lobes, Material, Scatter, ScatterContext};
use abbe::math::{DVec3, Frame};
use abbe::spectrum::{Basis, ColorSpace, Draw, Table, Waves};
use abbe::trace::prepare;

use super::scenes::{SINGLE_PATH, method, scene, view};

/// Materials that layered materials refer to.
pub const BASE_MATERIALS: &str = "[material.white]\ndiffuse = { reflectance = 1 }\n\
    [material.mirror]\nmirror = { reflectance = 1 }\n\
    [material.pane]\nthin = { index = 1.5 }\n\
    [material.smooth]\nplastic = { reflectance = 1 }\n\
    [material.rough]\nplastic = { reflectance = 1, roughness = 0.4 }\n\
    [material.satin]\nplastic = { reflectance = { rgb = [0.9, 0.1, 0.5] }, roughness = 0.31 }\n\
    [material.silver]\nconductor = { n = 1e-6, k = 100, roughness = 0.6 }\n";

/// A metal that absorbs less than 1e-9 of the light at normal incidence.
pub const LOSSLESS: &str = "n = 1e-6, k = 100";

/// Parses a material and prepares it for three bands.
pub fn material(text: &str) -> Material<Table> {
    let object = "[[object]]\nshape.sphere = { center = [0, 0, 0], radius = 1 }\nmaterial = \"tested\"\n";
    let text =
        view([0.0, 0.0, 9.0], [0.0; 3], 1.0, 1) + BASE_MATERIALS + &format!("[material.tested]\n{text}\n{object}");
    let scene = scene(&text);
    prepare(&scene, method(&scene, SINGLE_PATH)).scene().material_of(0).clone()
}

pub const NORMAL: DVec3 = DVec3::new(0.6, -0.48, 0.64);

/// Returns a unit vector whose angle to `NORMAL` has the given cosine.
pub fn direction_at(cos: f64, azimuth: f64) -> DVec3 {
    Frame::about(NORMAL).to_world(direction_about_z(cos, azimuth)).normalize()
}

/// The three bands of [`material`].
static WAVES: LazyLock<Waves> = LazyLock::new(|| Basis::rgb(ColorSpace::Rec709).waves());

/// Returns the context of scattering toward `wo` on a surface below a medium of the given index.
pub fn context<const N: usize>(draw: &Draw<N>, wo: DVec3, index: f64) -> ScatterContext<'_, N> {
    let [incident, beyond] = [Index::Same(index); 2];
    ScatterContext {
        lobes: Lobes::ALL,
        wo,
        normal: NORMAL,
        uv: [0.0; 2],
        draw,
        waves: &WAVES,
        present: draw.start(),
        from_inside: false,
        is_alone: false,
        incident,
        beyond,
        direction_indices: [None; 2],
        together: 0.0,
    }
}

/// Returns a unit vector whose angle to the z axis has the given cosine.
pub fn direction_about_z(cos: f64, azimuth: f64) -> DVec3 {
    let (sin, (y, x)) = ((1.0 - cos * cos).max(0.0).sqrt(), libm::sincos(azimuth));
    DVec3::new(sin * x, sin * y, cos)
}

/// Estimates what each band reflects and transmits of a uniform environment whose radiance over n^2 is 1. Returns each
/// mean with the standard error that independent draws would have.
pub fn furnace(material: &Material<Table>, context: &ScatterContext<4>, draws: u32) -> [[f64; 2]; 3] {
    let (mut sums, mut branches) = ([[0.0; 2]; 3], Vec::new());
    for u in hammersley_points(draws) {
        material.scatter(context, u, &mut branches);
        let mut total = [0.0; 3];
        for branch in branches.drain(..) {
            (0..3).for_each(|band| total[band] += f64::from(branch.share[band]) / branch.eta_scale);
        }
        for (sum, total) in sums.iter_mut().zip(total) {
            *sum = [sum[0] + total / f64::from(draws), sum[1] + total * total / f64::from(draws)];
        }
    }
    let straight =
        material.straight(context).map_or([0.0; 3], |straight| [0, 1, 2].map(|band| straight.share()[band].into()));
    std::array::from_fn(|band| {
        let [mean, square] = sums[band];
        [mean + straight[band], ((square - mean * mean).max(0.0) / f64::from(draws)).sqrt()]
    })
}

/// Returns the Hammersley points in the unit square.
pub fn hammersley_points(count: u32) -> impl Iterator<Item = [f64; 2]> {
    (0..count).map(move |i| [(f64::from(i) + 0.5) / f64::from(count), f64::from(i.reverse_bits()) / 4_294_967_296.0])
}
