//! Holdouts and shadow catchers beside surfaces with holes.

use abbe::Image;
use abbe::film::Layer;

use super::{rendered, rgb};

const PIXELS: usize = 36;
const SAMPLES: usize = 256;

/// A floor seen from above through a black card with holes. The lamp is below the card, which throws no shadow.
fn card_over_floor(floor: &str, card: &str, opacity: [f64; 2]) -> Image {
    seen_through("diffuse.reflectance = 0", floor, card, opacity)
}

/// A floor seen from above through a card of any material, below which the lamp is.
fn seen_through(of: &str, floor: &str, card: &str, opacity: [f64; 2]) -> Image {
    let [of_floor, of_card] = opacity;
    let text = format!(
        "camera = {{ projection = \"orthographic\", height = 0.2, position = [0, 5, 0], look_at = [0, 0, 0], \
         up = [0, 0, -1] }}\nfilm = {{ width = 6, height = 6 }}\nrender = {{ samples = {SAMPLES} }}\n[material]\n\
         gray.diffuse.reflectance = 0.5\npaper.{of}\n\
         floor.mask = {{ material = \"gray\", opacity = {of_floor} }}\n\
         card.mask = {{ material = \"paper\", opacity = {of_card} }}\n\
         [[object]]\n{floor}shape.plane = {{ point = [0, 0, 0], normal = [0, 1, 0] }}\nmaterial = \"floor\"\n\
         [[object]]\n{card}shape.quad = {{ center = [0, 3, 0], u = [0.5, 0, 0], v = [0, 0, 0.5] }}\nmaterial = \"card\"\n\
         [[light]]\npoint = {{ position = [2, 2, 0], intensity = 10 }}\n"
    );
    rendered(&text, &[Layer::Shadow, Layer::Residual])
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

/// Of how many samples a share is: five standard deviations of it.
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
        let of_card = coverage(&image);
        assert!((of_card - opacity).abs() < five_sigma(opacity), "{of_card} of {opacity}");
        assert!(rgb(&image, "shadow").as_flattened().iter().all(|share| share.abs() < 1e-5), "{opacity}");
        assert_all_is_accounted_for(&image);
        // With holes of its own it is as clear.
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
        let (of_card, shown) = (coverage(&image), red(&image) / (0.2 * open));
        assert!((of_card - opacity).abs() < five_sigma(opacity), "{of_card} of {opacity}");
        // Its pixels are not all as bright.
        assert!((shown / of_card - 1.0).abs() < 1e-3, "{shown} through {of_card}");
    }
}
