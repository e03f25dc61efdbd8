//! Row H5: a thousand bodies, one behind the other and one inside the other.

use abbe::plan::plan;

use crate::support::scenes::{Mean, SPLITTING, body, render_film, scene, sigma_limit, view};

const COUNT: u32 = 1000;

fn lit(bodies: &str, side: u32, samples: u32) -> String {
    let far = "plane = { point = [0, 0, -20], normal = [0, 0, 1] }";
    view([0.31, 0.17, 10.0], [0.31, 0.17, 0.0], 1e-7, side)
        + &format!("[render]\nsamples = {samples}\n")
        + bodies
        + &body("lamp", "emissive = { radiance = 1, sides = \"front\" }", &[far])
}

/// Panes with reflectance r at each surface transmit (1 - r) / (1 + (2 N - 1) r) over all paths (Stokes 1862). Light
/// that wanders through them meets about (2 N)^2 r surfaces. If there are more than some thousand, roulette leaves to
/// one path what many would have contributed.
#[test]
fn h5_stacks_of_a_hundred_and_of_a_thousand_panes_let_through_what_the_closed_form_says() {
    for (count, index, side) in [(100, 1.5f64, 24), (1000, 1.01, 24)] {
        let step = 10.0 / f64::from(count);
        let pane = |i| {
            let z = -step * f64::from(i);
            format!("cube = {{ center = [0, 0, {z:?}], size = [200, 200, {:?}] }}", 0.5 * step)
        };
        let panes: Vec<String> = (0..count).map(pane).collect();
        let panes: Vec<&str> = panes.iter().map(String::as_str).collect();
        let text = lit(&body("glass", &format!("dielectric = {{ index = {index:?} }}"), &panes), side, 2);
        let transport = plan(&scene(&text)).method.transport;
        assert_eq!(transport, SPLITTING);
        let r = ((index - 1.0) / (index + 1.0)).powi(2);
        let expected = (1.0 - r) / (1.0 + (2.0 * f64::from(count) - 1.0) * r);
        let (film, report) = render_film(&text, transport);
        let mean = Mean::of(&film);
        let rays = report.rays as f64 / report.samples as f64;
        println!("H5: {count} panes: {:.6} +- {:.1e} for {expected:.6}, {rays:.0} rays", mean.value[0], mean.error[0]);
        assert_eq!((report.unmatched, report.non_finite, report.stopped), (0, 0, 0.0));
        let rounding = 2.0 * f64::from(count) * f64::from(f32::EPSILON);
        let off = (mean.value[0] - expected).abs();
        assert!(off <= sigma_limit(2) * mean.error[0] + rounding, "{count} panes: {mean:?} for {expected}");
        assert!(mean.worst_relative_error([expected; 3]) < 0.1, "{count} panes: {mean:?}");
    }
}

/// Nested cubes of one glass are one cube: their media are counted, and their 1998 inner surfaces have no effect. A
/// loss of a part in 30 000 at each would show.
#[test]
fn h5_a_thousand_bodies_in_each_other_are_one() {
    let nested: Vec<String> = (0..COUNT)
        .map(|i| format!("cube = {{ center = [0, 0, 0], size = {:?} }}", 2.0 - 0.0015 * f64::from(i)))
        .collect();
    let nested: Vec<&str> = nested.iter().map(String::as_str).collect();
    let text = lit(&body("glass", "dielectric = { index = 1.5 }", &nested), 4, 1);
    let (film, report) = render_film(&text, SPLITTING);
    let expected = 0.96 / 1.04;
    assert_eq!((report.unmatched, report.stopped), (0, 0.0));
    // Roulette ends one long path in a thousand, and light that is reflected inside returns one time in 33 with a
    // weight of 0.05. That is too rare for sixteen paths to estimate their own deviation.
    let deviation = (0.001 * expected * expected + 0.03 * 0.05f64.powi(2)).sqrt();
    let mean = Mean::of(&film).value[1];
    assert!((mean - expected).abs() <= 3.0 * deviation / 4.0, "{mean} for {expected}");
}

/// Light that wanders through a thousand stacked panes under a uniform sky comes to an end: no stack grows, and no path
/// is lost.
#[test]
fn h5_light_that_wanders_in_a_stack_keeps_its_energy() {
    let panes: Vec<String> = (0..COUNT)
        .map(|i| format!("cube = {{ center = [0, 0, {:?}], size = [2, 2, 0.001] }}", 0.002 * f64::from(i) - 1.0))
        .collect();
    let panes: Vec<&str> = panes.iter().map(String::as_str).collect();
    let text = view([0.3, 0.4, 8.0], [0.0; 3], 14.0, 12)
        + "[render]\nsamples = 4\n"
        + &body("glass", "dielectric = { index = 1.5 }", &panes)
        + "[[light]]\nenvironment.radiance = 1\n";
    let (film, report) = render_film(&text, SPLITTING);
    assert_eq!((report.unmatched, report.non_finite), (0, 0));
    let mean = Mean::of(&film);
    let off = (mean.value[1] - 1.0).abs();
    // The light that the safety stop took from paths caught for good by total reflection is counted.
    assert!(off <= sigma_limit(1) * mean.error[1] + report.stopped * 2.25 + 1e-5, "{mean:?}, {}", report.stopped);
    assert!(mean.error[1] < 0.1 && report.stopped < 0.01, "{mean:?}, {} stopped", report.stopped);
}
