//! Materials written as text, and light that arrives at them.

use abbe::material::{Arrival, Index, Material};
use abbe::math::{DVec3, Frame};
use abbe::spectrum::{Draw, Table};
use abbe::trace::prepare;

use crate::support::scenes::{SINGLE_PATH, method, scene, view};

/// Materials that others are made of.
pub const PARTS: &str = "[material.white]\ndiffuse = { reflectance = 1 }\n\
    [material.mirror]\nmirror = { reflectance = 1 }\n\
    [material.pane]\nthin = { index = 1.5 }\n\
    [material.smooth]\nplastic = { reflectance = 1 }\n\
    [material.rough]\nplastic = { reflectance = 1, roughness = 0.4 }\n\
    [material.silver]\nconductor = { n = 1e-6, k = 100, roughness = 0.6 }\n";

/// The material of a text, in three bands.
pub fn material(text: &str) -> Material<Table> {
    let object = "[[object]]\nshape.sphere = { center = [0, 0, 0], radius = 1 }\nmaterial = \"tested\"\n";
    let text = view([0.0, 0.0, 9.0], [0.0; 3], 1.0, 1) + PARTS + &format!("[material.tested]\n{text}\n{object}");
    let scene = scene(&text);
    prepare(&scene, method(&scene, SINGLE_PATH)).scene().material_of(0).clone()
}

pub const NORMAL: DVec3 = DVec3::new(0.6, -0.48, 0.64);

/// A unit vector at a cosine to the normal.
pub fn toward(cos: f64, azimuth: f64) -> DVec3 {
    let (sin, (y, x)) = ((1.0 - cos * cos).max(0.0).sqrt(), libm::sincos(azimuth));
    Frame::about(NORMAL).to_world(DVec3::new(sin * x, sin * y, cos)).normalize()
}

/// Light from a surface under a medium of an index, toward `wo`.
pub fn arrival(draw: &Draw<4>, wo: DVec3, index: f64) -> Arrival<'_, 4> {
    let [incident, beyond] = [Index::Same(index); 2];
    Arrival {
        wo,
        normal: NORMAL,
        uv: [0.0; 2],
        draw,
        present: draw.start(),
        from_inside: false,
        is_alone: false,
        incident,
        beyond,
        direction_indices: [None; 2],
        together: 0.0,
    }
}

/// The points of Hammersley in the unit square.
pub fn points(count: u32) -> impl Iterator<Item = [f64; 2]> {
    (0..count).map(move |i| [(f64::from(i) + 0.5) / f64::from(count), f64::from(i.reverse_bits()) / 4_294_967_296.0])
}
