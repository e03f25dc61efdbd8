//! Holdouts and shadow catchers beside surfaces with holes.

use abbe::Image;
use abbe::film::Layer;

use super::{id, render_text, rgb};

const PIXELS: usize = 36;
const SAMPLES: usize = 256;

/// Renders a floor seen from above through a black card with holes. The lamp is below the card, which casts no shadow.
fn card_over_floor(floor: &str, card: &str, opacity: [f64; 2]) -> Image {
    seen_through("diffuse.reflectance = 0", floor, card, opacity)
}

/// Renders a floor seen from above through a card of any material. The lamp is below the card.
fn seen_through(of: &str, floor: &str, card: &str, opacity: [f64; 2]) -> Image {
    let [floor_coverage, card_coverage] = opacity;
    let text = format!(
        "camera = {{ projection = \"orthographic\", height = 0.2, position = [0, 5, 0], look_at = [0, 0, 0], \
         up = [0, 0, -1] }}\nfilm = {{ width = 6, height = 6 }}\nrender = {{ samples = {SAMPLES} }}\n[material]\n\
         gray.diffuse.reflectance = 0.5\npaper.{of}\n\
         floor.mask = {{ material = \"gray\", opacity = {floor_coverage} }}\n\
         card.mask = {{ material = \"paper\", opacity = {card_coverage} }}\n\
         [[object]]\n{floor}shape.plane = {{ point = [0, 0, 0], normal = [0, 1, 0] }}\nmaterial = \"floor\"\n\
         [[object]]\n{card}shape.quad = {{ center = [0, 3, 0], u = [0.5, 0, 0], v = [0, 0, 0.5] }}\nmaterial = \"card\"\n\
         [[light]]\npoint = {{ position = [2, 2, 0], intensity = 10 }}\n"
    );
    render_text(&text, &[Layer::Shadow, Layer::Residual])
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    values.sum::<f64>() / PIXELS as f64
}

fn coverage(image: &Image) -> f64 {
    mean(image.layer("A").expect("every image has it").iter().map(|&alpha| f64::from(alpha)))
}

fn red(image: &Image) -> f64 {
    mean(image.rgb().iter().map(|rgb| f64::from(rgb[0])))
}

/// Returns five standard deviations of a fraction that is estimated from all samples of the image.
fn five_sigma(share: f64) -> f64 {
    5.0 * (share * (1.0 - share) / (PIXELS * SAMPLES) as f64).sqrt() + 1e-6
}

fn assert_all_is_accounted_for(image: &Image) {
    assert!(rgb(image, "residual").as_flattened().iter().all(|left| left.abs() < 1e-5));
}

#[test]
fn a_shadow_catcher_seen_through_holes_shows_no_light_of_its_own() {
    for opacity in [0.1, 0.5, 0.9] {
        let image = card_over_floor("shadow_catcher = true\n", "", [1.0, opacity]);
        assert!(image.rgb().iter().all(|rgb| *rgb == [0.0; 3]), "{opacity}: {:?}", image.rgb()[0]);
        let card_coverage = coverage(&image);
        assert!((card_coverage - opacity).abs() < five_sigma(opacity), "{card_coverage} of {opacity}");
        assert!(rgb(&image, "shadow").as_flattened().iter().all(|share| share.abs() < 1e-5), "{opacity}");
        assert_all_is_accounted_for(&image);
        // A catcher with holes of its own is just as clear.
        let image = card_over_floor("shadow_catcher = true\n", "", [opacity, 0.0]);
        assert!(image.rgb().iter().all(|rgb| *rgb == [0.0; 3]), "{opacity}: {:?}", image.rgb()[0]);
        assert!(coverage(&image).abs() < 1e-5, "{opacity}: {}", coverage(&image));
    }
}

#[test]
fn a_holdout_with_holes_hides_the_share_that_it_covers() {
    let open = red(&card_over_floor("", "", [1.0, 0.0]));
    for opacity in [0.01, 0.25, 1.0] {
        let image = card_over_floor("", "holdout = true\n", [1.0, opacity]);
        let (left, within) = (1.0 - opacity, five_sigma(opacity));
        assert!((coverage(&image) - left).abs() < within, "{} for {left}", coverage(&image));
        assert!((red(&image) / open - left).abs() < within, "{} of {open} for {left}", red(&image));
        assert_all_is_accounted_for(&image);
    }
}

#[test]
fn a_pane_with_holes_shows_a_shadow_catcher_where_it_is() {
    let open = red(&card_over_floor("", "", [1.0, 0.0]));
    for opacity in [0.2, 0.5] {
        let pane = "thin = { index = 1, transmittance = 0.2 }";
        let image = seen_through(pane, "shadow_catcher = true\n", "", [1.0, opacity]);
        let (card_coverage, shown) = (coverage(&image), red(&image) / (0.2 * open));
        assert!((card_coverage - opacity).abs() < five_sigma(opacity), "{card_coverage} of {opacity}");
        // The pixels differ a little in brightness.
        assert!((shown / card_coverage - 1.0).abs() < 1e-3, "{shown} through {card_coverage}");
    }
}

/// A pane or sheet that is a holdout makes as complete a hole as an opaque body does.
#[test]
fn a_holdout_of_what_is_seen_through_hides_all_but_what_is_behind_its_holes() {
    let open = red(&card_over_floor("", "", [1.0, 0.0]));
    let sheets = [
        "thin = { index = 1.5, transmittance = 0.6 }",
        "polarizer.axis = [1, 0, 0]",
        "retarder = { axis = [1, 0, 0], retardance = 90 }",
    ];
    for sheet in sheets {
        let whole = seen_through(sheet, "", "holdout = true\n", [1.0, 1.0]);
        assert!(whole.rgb().iter().all(|rgb| *rgb == [0.0; 3]) && coverage(&whole) == 0.0, "{sheet}");
        assert_all_is_accounted_for(&whole);
        let image = seen_through(sheet, "", "holdout = true\n", [1.0, 0.3]);
        assert!((coverage(&image) - 0.7).abs() < five_sigma(0.3), "{sheet}: {}", coverage(&image));
        assert!((red(&image) / open - 0.7).abs() < five_sigma(0.3), "{sheet}: {} of {open}", red(&image));
    }
}

/// Photons are not splatted behind a pane that is a holdout.
#[test]
fn a_caustic_behind_a_pane_that_is_held_out_is_hidden() {
    let text = |pane: &str| {
        format!(
            "camera = {{ position = [0, 4, 4], look_at = [0, 0, 0], vertical_fov = 30 }}\n\
             film = {{ width = 32, height = 32 }}\nrender = {{ samples = 16 }}\n[material]\n\
             gray.diffuse.reflectance = 0.5\nball.dielectric.index = 1.5\npane.thin.index = 1.5\n\
             [[object]]\nshape.plane = {{ point = [0, 0, 0], normal = [0, 1, 0] }}\nmaterial = \"gray\"\n\
             [[object]]\nshape.sphere = {{ center = [0, 1, 0], radius = 0.6 }}\nmaterial = \"ball\"\n\
             [[object]]\n{pane}shape.quad = {{ center = [0, 3, 3], u = [9, 0, 0], v = [0, 9, -9] }}\nmaterial = \"pane\"\n\
             [[light]]\npoint = {{ position = [2, 4, -2], intensity = 10 }}\n"
        )
    };
    let caustics = |image: &Image| rgb(image, "caustics").as_flattened().iter().sum::<f64>();
    let shown = render_text(&text(""), &[Layer::Caustics]);
    assert!(shown.because().iter().any(|line| line.starts_with("photon")), "{:?}", shown.because());
    assert!(caustics(&shown) > 0.0);
    let hidden = render_text(&text("holdout = true\n"), &[Layer::Caustics]);
    assert!(hidden.rgb().as_flattened().iter().all(|&x| x == 0.0), "light comes through");
    assert_eq!(caustics(&hidden), 0.0);
}

/// An object of the plate is seen through a pane as through glass. The pane does not turn into a black cover.
#[test]
fn what_stands_for_the_plate_is_seen_through_panes_as_all_else() {
    let floor = |sheet: &str, visibility: &str| seen_through(sheet, visibility, "", [1.0, 1.0]);
    for sheet in ["thin = { index = 1.5, transmittance = 0.6 }", "polarizer.axis = [1, 0, 0]"] {
        let shown = floor(sheet, "");
        assert!(red(&shown) > 0.0);
        for visibility in ["holdout = true\n", "shadow_catcher = true\n"] {
            let image = floor(sheet, visibility);
            assert_eq!(image.rgb(), shown.rgb(), "{sheet}, {visibility}");
            assert_eq!(rgb(&image, "residual"), rgb(&shown, "residual"), "{sheet}, {visibility}");
            assert!((coverage(&image) - 1.0).abs() < 1e-6, "{sheet}, {visibility}: {}", coverage(&image));
        }
    }
    // A sheet that transmits all light does not count as a surface.
    let image = floor("retarder = { axis = [1, 0, 0], retardance = 90 }", "holdout = true\n");
    assert!(red(&image) == 0.0 && coverage(&image) == 0.0, "{} and {}", red(&image), coverage(&image));
}

/// Photons are splatted there as well: a caustic on a floor that stands for the plate is seen through a pane. The part
/// of it behind the pane's holes is not.
#[test]
fn a_caustic_on_what_stands_for_the_plate_is_seen_through_panes() {
    let image = |visibility: &str, opacity: f64| {
        let text = format!(
            "camera = {{ position = [0, 4, 4], look_at = [0, 0, 0], vertical_fov = 12 }}\n\
             film = {{ width = 16, height = 16 }}\nrender = {{ samples = 16 }}\n[material]\n\
             gray.diffuse.reflectance = 0.5\nball.dielectric.index = 1.5\nclear.thin.index = 1.5\n\
             pane.mask = {{ material = \"clear\", opacity = {opacity} }}\n\
             [[object]]\n{visibility}shape.plane = {{ point = [0, 0, 0], normal = [0, 1, 0] }}\nmaterial = \"gray\"\n\
             [[object]]\nshape.sphere = {{ center = [1.5, 2, 0], radius = 0.6 }}\nmaterial = \"ball\"\n\
             [[object]]\nshape.quad = {{ center = [0, 3, 3], u = [9, 0, 0], v = [0, 9, -9] }}\nmaterial = \"pane\"\n\
             [[light]]\npoint = {{ position = [3, 4, 0], intensity = 10 }}\n"
        );
        render_text(&text, &[Layer::Caustics])
    };
    let caustics = |image: &Image| rgb(image, "caustics").as_flattened().iter().sum::<f64>();
    let [whole, half] = [1.0, 0.5].map(|opacity| caustics(&image("", opacity)));
    assert!(whole > 0.0 && half > whole, "{whole} and {half}");
    for visibility in ["holdout = true\n", "shadow_catcher = true\n"] {
        let [through_whole, through_half] = [1.0, 0.5].map(|opacity| caustics(&image(visibility, opacity)));
        assert!((through_whole / whole - 1.0).abs() < 0.02, "{visibility}: {through_whole} of {whole}");
        assert!((through_half / (0.5 * whole) - 1.0).abs() < 0.02, "{visibility}: {through_half} of half {whole}");
    }
}

/// The fraction of the light of a disc that another disc blocks at the middle of a floor, which is seen through both:
/// b^2 / (b^2 + k^2) divided by a^2 / (a^2 + h^2), for radii and heights of the discs (Howell, Menguc, Daun & Siegel
/// 2020, *Thermal Radiation Heat Transfer*, configuration factor of an element parallel to a disk).
#[test]
fn a_shadow_catcher_seen_through_a_lamp_that_the_camera_does_not_see_shows_the_shadow_alone() {
    let shadow = |more: &str| {
        let text = format!(
            "camera = {{ projection = \"orthographic\", height = 0.04, position = [0, 6, 0], look_at = [0, 0, 0], \
             up = [0, 0, -1] }}\nfilm = {{ width = 6, height = 6 }}\nrender = {{ samples = {SAMPLES} }}\n[material]\n\
             lamp.emissive.radiance = 5\ngray.diffuse.reflectance = 0.5\nblack.diffuse.reflectance = 0\n\
             [[object]]\nshape.disc = {{ center = [0, 2, 0], normal = [0, -1, 0], radius = 1 }}\nmaterial = \"lamp\"\n\
             visible_to_camera = false\n\
             [[object]]\nshape.plane = {{ point = [0, 0, 0], normal = [0, 1, 0] }}\nmaterial = \"gray\"\n\
             shadow_catcher = true\n{more}"
        );
        coverage(&render_text(&text, &[Layer::Shadow]))
    };
    assert_eq!(shadow(""), 0.0);
    let disc = "[[object]]\nshape.disc = { center = [0, 1, 0], normal = [0, 1, 0], radius = 0.25 }\n\
                material = \"black\"\nvisible_to_camera = false\n";
    let expected = (0.0625 / 1.0625) / 0.2;
    assert!((shadow(disc) - expected).abs() < 0.005, "{} for {expected}", shadow(disc));
}

/// Renders `count` sheets, one behind the other, in front of a wall. The coverage of each sheet and of the wall depends
/// on what reaches it, not on the light that it sends.
fn sheets_before_a_wall(count: u32, opacity: f64, more: &str) -> Image {
    let sheet = |number: u32| {
        format!(
            "[[object]]\nname = \"sheet {number}\"\nmaterial = \"veil\"\n\
             shape.quad = {{ center = [0, 0, {}], u = [3, 0, 0], v = [0, 3, 0] }}\n",
            -0.1 * f64::from(number)
        )
    };
    let text = format!(
        "camera = {{ position = [0, 0, 5], look_at = [0, 0, 0], vertical_fov = 20 }}\n\
         film = {{ width = 6, height = 6 }}\nrender = {{ samples = {SAMPLES}{more} }}\n[material]\n\
         white.diffuse.reflectance = 0.5\nveil.mask = {{ material = \"white\", opacity = {opacity} }}\n\
         {}[[object]]\nname = \"wall\"\nshape.quad = {{ center = [0, 0, -5], u = [9, 0, 0], v = [0, 9, 0] }}\n\
         material = \"white\"\n[[light]]\npoint = {{ position = [1, 1, 4], intensity = 10 }}\n",
        (0..count).map(sheet).collect::<String>()
    );
    render_text(&text, &[Layer::CryptoObject, Layer::Normal, Layer::Residual])
}

#[test]
fn what_is_behind_many_holes_is_met_as_often_as_it_is_seen() {
    for (count, opacity, more) in [(1, 0.98, ""), (5, 0.5, ""), (12, 0.5, ""), (5, 0.3, ", max_bounces = 0")] {
        let image = sheets_before_a_wall(count, opacity, more);
        let alpha = image.layer("A").expect("every image has it");
        assert!(alpha.iter().all(|&alpha| alpha == 1.0), "{count} of {opacity}: {alpha:?}");
        assert!(image.layer("N.Z").expect("it was asked for").iter().all(|&z| (z - 1.0).abs() < 1e-6), "{more}");
        // There are no ranks for more objects.
        for number in 0..=count.min(5) {
            let name = if number == count { "wall".into() } else { format!("sheet {number}") };
            let reached = (1.0 - opacity).powi(number as i32);
            let share = reached * if number == count { 1.0 } else { opacity };
            let found = mean((0..PIXELS).map(|pixel| coverage_of(&image, &name, pixel)));
            assert!((found - share).abs() < five_sigma(share), "{name} of {count}: {found} for {share}");
        }
        // Random gains and losses of samples average to nothing. A limit cuts off everything.
        let left_out = if more.is_empty() { 0.0 } else { 1.0 };
        let left = rgb(&image, "residual");
        let left = left.iter().map(|rgb| rgb[1]).sum::<f64>() / left.len() as f64;
        assert!((left - left_out).abs() < 0.02, "{count} of {opacity}: {left}");
    }
}

/// Returns the coverage of an object in a pixel.
fn coverage_of(image: &Image, name: &str, pixel: usize) -> f64 {
    let bits = id(name);
    let rank = |rank: usize, half: usize| {
        let names = [["r", "g"], ["b", "a"]][half];
        let layer = |channel: &str| image.layer(&format!("CryptoObject0{rank}.{channel}"));
        names.map(|channel| layer(channel).map_or(0.0, |values| values[pixel]))
    };
    let pairs = (0..3).flat_map(|number| [rank(number, 0), rank(number, 1)]);
    pairs.filter(|[id, _]| id.to_bits() == bits).map(|[_, coverage]| f64::from(coverage)).sum()
}
