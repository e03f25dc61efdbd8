//! Lenses that leave nothing that the camera sees in focus.

use super::view::View;
use crate::scene::Scene;
use crate::scene::text::six_digits;
use crate::spectrum::Curve;

/// Minimum number of rays that must hit something, of 576.
const MIN_HITS: usize = 144;
/// Diameter of a point's blur circle, in heights of the image, above which the point is unrecognizable.
const BLURRED_DIAMETER: f64 = 0.25;
/// A lens radius above this fraction of the focus distance is unrealistic: a fast lens has a twentieth.
const WIDE_LENS: f64 = 0.25;

/// Returns a warning about a lens that blurs nearly everything that the camera sees beyond recognition.
pub(super) fn out_of_focus(scene: &Scene<Curve>) -> Option<String> {
    let camera = &scene.camera;
    let lens = camera.lens?;
    let mut depths: Vec<f64> = View::new(scene).depths().collect();
    if depths.len() < MIN_HITS {
        return None;
    }
    depths.sort_by(f64::total_cmp);
    let median = depths[depths.len() / 2];
    let focus = if lens.inverse_focus > 0.0 { 1.0 / lens.inverse_focus } else { median };
    let blurred = depths.iter().filter(|depth| camera.blur(**depth) > BLURRED_DIAMETER).count();
    let is_blurred = 20 * blurred >= 19 * depths.len() && lens.radius > WIDE_LENS * focus;
    is_blurred.then(|| {
        let median = six_digits(format!("{median:.2e}").parse().unwrap_or(median));
        format!(
            "almost nothing that the camera sees is in focus: `radius` and `focus_distance` of its lens are in scene \
             units, and half of what it sees is nearer than {median}"
        )
    })
}
