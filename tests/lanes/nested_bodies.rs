//! Nested bodies: rows M1, M3 and M4 of the stability catalog.

use abbe::math::DVec3;

use crate::support::random::Random;
use crate::support::scenes::{EVERY_BRANCH, GROUND, SINGLE_PATH, SPLITTING, body, environment, render_film, view};
use abbe::trace::{MAX_MEDIA, Transport};

/// Returns reflectance over transmittance of one interface at normal incidence.
fn r_over_t(n1: f64, n2: f64) -> f64 {
    let r = (n1 - n2) / (n1 + n2);
    r * r / (1.0 - r * r)
}

/// Returns the transmittance of a row of interfaces at normal incidence, with all reflections between them. The
/// interfaces' R / T add up (Stokes 1862, the pile of plates).
fn row_transmittance(indices: &[f64]) -> f64 {
    1.0 / (1.0 + indices.windows(2).map(|pair| r_over_t(pair[0], pair[1])).sum::<f64>())
}

/// Returns the faces of a box, or of a hollow, whose faces point inward.
fn faces(first: u32, hollow: bool) -> String {
    // Bits 0, 1 and 2 of i give the signs of x, y and z = +-1 of corner i.
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let turn = |[a, b, c]: [u32; 3]| if hollow { [a, c, b] } else { [a, b, c] };
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
    triangles.map(|t| format!("{:?}, ", turn(t.map(|corner| corner + first)))).collect()
}

fn corners(half: f64) -> String {
    let side = |bit: bool| if bit { half } else { -half };
    (0..8).map(|i| format!("{:?}, ", [side(i & 1 > 0), side(i & 2 > 0), side(i & 4 > 0)])).collect()
}

/// Returns a glass vessel with a hollow of half width 0.9.
fn vessel() -> String {
    let (points, faces) = (corners(1.0) + &corners(0.9), faces(0, false) + &faces(8, true));
    let mesh = format!("mesh = {{ points = [{points}], faces = [{faces}] }}");
    body("glass", "dielectric = { index = 1.5168, priority = 2 }", &[&mesh])
}

fn water(half: f64, priority: i32) -> String {
    let cube = format!("cube = {{ center = [0, 0, 0], size = {:?} }}", 2.0 * half);
    body("water", &format!("dielectric = {{ index = 1.333, priority = {priority} }}"), &[&cube])
}

/// Returns what is seen straight through the middle of bodies of a plane of radiance 1, with all reflections.
fn radiance_through(bodies: &str) -> f64 {
    let plane = "plane = { point = [0, 0, -5], normal = [0, 0, 1] }";
    let lamp = body("lamp", "emissive = { radiance = 1 }", &[plane]);
    // Off the diagonals of the faces, and so narrow that its rays count as one.
    let text = view([0.31, 0.17, 5.0], [0.31, 0.17, 0.0], 1e-6, 1) + bodies + &lamp;
    let (film, report) = render_film(&text, Transport::Deterministic { cutoff: 1e-12, max_sample_surfaces: u64::MAX });
    assert_eq!(report.unmatched, 0);
    f64::from(film.pixels[0].rgb[1])
}

#[test]
fn m1_water_that_overlaps_its_vessel_lets_through_what_labelled_interfaces_would() {
    let expected = row_transmittance(&[1.0, 1.5168, 1.333, 1.5168, 1.0]);
    let solid = body("glass", SOLID, &["cube = { center = [0, 0, 0], size = 2 }"]);
    let ways = [
        ("overlapping a little", vessel() + &water(0.91, 1)),
        ("overlapping to the middle of the wall", vessel() + &water(0.95, 1)),
        ("displacing glass", solid + &water(0.9, 2)),
    ];
    for (name, bodies) in ways {
        let found = radiance_through(&bodies);
        println!("M1: {name} {:.1e}", found / expected - 1.0);
        // A weight is rounded to 2^-24 at each of the few dozen surfaces that matter.
        assert!((found / expected - 1.0).abs() <= 1e-6, "{name}: {found} for {expected}");
    }
    // The naive vessel, with a film of air between water and glass, differs by more than any rounding.
    let naive = radiance_through(&(vessel() + &water(0.89, 1)));
    assert!((naive / row_transmittance(&[1.0, 1.5168, 1.0, 1.333, 1.0, 1.5168, 1.0]) - 1.0).abs() <= 1e-6, "{naive}");
    assert!(naive < 0.95 * expected);
}

#[test]
fn m3_overlap_and_displacement_bend_light_the_same_way() {
    // Stripes seen at 30 degrees through vessel, water and vessel. The picture is the same whichever body yields.
    let stripes: String = (0..40)
        .map(|i| {
            let quad = format!(
                "quad = {{ center = [{}, 0, -5], u = [0.05, 0, 0], v = [0, 9, 0] }}",
                -2.0 + 0.1 * f64::from(i)
            );
            body(&format!("stripe{i}"), &format!("emissive = {{ radiance = {i} }}"), &[&quad])
        })
        .collect();
    let solid = body("glass", SOLID, &["cube = { center = [0, 0, 0], size = 2 }"]);
    let pictures = [vessel() + &water(0.91, 1), solid + &water(0.9, 2)].map(|bodies| {
        let text = view([2.9, 0.4, 4.7], [0.1, 0.05, 0.0], 12.0, 40) + &bodies + &stripes;
        render_film(&text, Transport::Deterministic { cutoff: 1e-6, max_sample_surfaces: u64::MAX }).0
    });
    let [a, b] = pictures;
    for (at, (a, b)) in a.pixels.iter().zip(&b.pixels).enumerate() {
        assert!((a.rgb[0] - b.rgb[0]).abs() <= 1e-3 * b.rgb[0].max(1.0), "pixel {at}: {} and {}", a.rgb[0], b.rgb[0]);
    }
    assert!(b.pixels.iter().any(|pixel| pixel.rgb[0] > 5.0));
}

/// Glass that water of a higher priority displaces.
const SOLID: &str = "dielectric = { index = 1.5168, priority = 1 }";

/// Balls (center, radius, index, priority), some nested and some overlapping.
const BALLS: [([f64; 3], f64, f64, i32); 5] = [
    ([0.0, 0.0, 0.0], 2.0, 1.6, 1),
    ([0.3, 0.1, 0.0], 1.2, 1.333, 2),
    ([0.4, 0.2, 0.1], 0.5, 1.0, 3),
    ([-1.5, 0.6, 0.3], 0.9, 2.0, 0),
    ([1.4, -0.9, 0.5], 0.8, 1.25, 4),
];

/// Absorption of each ball's medium. Even a short path tells them apart.
const ABSORPTIONS: [f64; 5] = [2.0, 5.0, 0.0, 9.0, 14.0];

/// Returns the ball of highest priority that contains a point, or none.
fn ball_containing(place: DVec3) -> Option<usize> {
    let within = |&i: &usize| (place - DVec3::from(BALLS[i].0)).length() < BALLS[i].1;
    (0..BALLS.len()).filter(within).max_by_key(|&i| BALLS[i].3)
}

#[test]
fn m4_a_camera_finds_the_media_around_it() {
    let bodies: String = BALLS
        .iter()
        .zip(ABSORPTIONS)
        .enumerate()
        .map(|(i, ((center, radius, index, priority), absorption))| {
            let ball = format!("sphere = {{ center = {center:?}, radius = {radius:?} }}");
            let medium = format!("{{ index = {index:?}, priority = {priority}, absorption = {absorption:?} }}");
            body(&format!("medium{i}"), &format!("dielectric = {medium}"), &[&ball])
        })
        .collect();
    let mut random = Random::new(4);
    let mut found = [0; BALLS.len() + 1];
    let mut number = 0;
    while number < 3000 {
        // Every other ray starts away from the camera, possibly in another medium.
        let near = if number % 2 == 0 { 0.0 } else { random.between(0.0, 3.0) };
        let (center, radius, ..) = BALLS[number % BALLS.len()];
        let start = DVec3::from(center) + random.direction() * random.between(0.0, 1.3 * radius);
        let direction = random.direction();
        let position = start - direction * near;
        let surface = |ball: &([f64; 3], f64, f64, i32)| ((start - DVec3::from(ball.0)).length() - ball.1).abs();
        if BALLS.iter().map(surface).fold(f64::INFINITY, f64::min) < 0.13 {
            continue;
        }
        number += 1;
        // A small lamp in front of the start of the ray. Its light crosses only the first medium.
        let lamp = format!("sphere = {{ center = {:?}, radius = 0.02 }}", (start + direction * 0.12).to_array());
        let text = format!(
            "camera = {{ position = {:?}, look_at = {:?}, vertical_fov = 0.001, near = {near:?} }}\n\
             film = {{ width = 1, height = 1 }}\n{bodies}{}",
            position.to_array(),
            (position + direction).to_array(),
            body("lamp", "emissive = { radiance = 1 }", &[&lamp])
        );
        let (film, report) = render_film(&text, EVERY_BRANCH);
        assert_eq!(report.unmatched, 0, "from {position}");
        let around = ball_containing(start);
        found[around.map_or(BALLS.len(), |ball| ball)] += 1;
        let expected = libm::exp(-0.1 * around.map_or(0.0, |ball| ABSORPTIONS[ball]));
        let seen = f64::from(film.pixels[0].rgb[0]);
        assert!(
            (seen - expected).abs() <= 1e-4,
            "from {position} along {direction}, near {near}: {seen} for {expected}"
        );
    }
    assert!(found.iter().all(|&count| count > 20), "{found:?}");
}

#[test]
fn overlapping_bodies_of_one_material_are_one_body() {
    let pair = ["cube = { center = [0, 0, 0.5], size = [9, 9, 1] }", "cube = { center = [0, 0, 1], size = [8, 8, 1] }"];
    let bodies = body("glass", "dielectric = { index = 1.5, absorption = 0.5 }", &pair);
    // A slab of thickness 1.5 with all its internal reflections: T = (1 - R)^2 a / (1 - R^2 a^2), a = e^(-absorption
    // d).
    let (r, a) = (0.04, libm::exp(-0.5 * 1.5));
    let expected = (1.0 - r) * (1.0 - r) * a / (1.0 - r * r * a * a);
    let found = radiance_through(&bodies);
    assert!((found / expected - 1.0).abs() <= 1e-6, "{found} for {expected}");
}

/// In one direction, a half space has no outside at infinity. A slab of two planes has one in both directions.
#[test]
fn m4_a_camera_knows_whether_it_is_in_a_half_space_whichever_way_it_looks() {
    let plane = |x: f64, normal: f64| format!("plane = {{ point = [{x:?}, 0, 0], normal = [{normal:?}, 0, 0] }}");
    let (half, slab) = (vec![plane(0.0, 1.0)], vec![plane(0.0, 1.0), plane(-4.0, -1.0)]);
    let inside = (-1_f64).exp();
    // Position of the camera, position of the lamp at a distance of 1, and the fraction of its light that arrives.
    let cases =
        [(&half, -2.0, -3.0, inside), (&half, -2.0, -1.0, inside), (&half, 1.0, 2.0, 1.0), (&slab, 1.0, 2.0, 1.0)];
    let more = [(&slab, -5.0, -6.0, 1.0), (&slab, -2.0, -3.0, inside), (&slab, -2.0, -1.0, inside)];
    let assert_arrival = |planes: &[String], ways: [[f64; 3]; 2], sides: &str, expected: f64| {
        let planes: Vec<&str> = planes.iter().map(String::as_str).collect();
        let water = body("water", "dielectric = { index = 1.333, absorption = 1 }", &planes);
        let quad = format!("quad = {{ center = {:?}, {sides} }}", ways[1]);
        let text = view(ways[0], ways[1], 1e-6, 1) + &water + &body("lamp", "emissive = { radiance = 1 }", &[&quad]);
        let (film, report) = render_film(&text, EVERY_BRANCH);
        let seen = f64::from(film.pixels[0].rgb[1]);
        assert!((seen - expected).abs() < 1e-6, "{ways:?}: {seen} for {expected}");
        assert_eq!(report.unmatched, 0, "{ways:?}");
    };
    for (planes, camera, lamp, expected) in cases.into_iter().chain(more) {
        assert_arrival(planes, [[camera, 0.0, 0.0], [lamp, 0.0, 0.0]], "u = [0, 1, 0], v = [0, 0, 1]", expected);
    }
    // The camera is in two half spaces at once, and the path to the lamp leaves one of them.
    let wedge = vec![plane(0.0, 1.0), GROUND.to_owned()];
    let ways = [[-1.0, -1.0, 0.0], [1.0, -3.0, 0.0]];
    assert_arrival(&wedge, ways, "u = [1, 1, 0], v = [0, 0, 1]", (-8_f64.sqrt()).exp());
    // The view is exactly along the surface.
    for (planes, camera, expected) in [(&half, -2.0, inside), (&half, 1.0, 1.0), (&slab, -2.0, inside)] {
        assert_arrival(planes, [[camera, 0.0, 0.0], [camera, 0.0, 1.0]], "u = [1, 0, 0], v = [0, 1, 0]", expected);
    }
}

/// A ray that hits a corner of the silhouette exactly does not find a surface that leads out of the body.
#[test]
fn m4_a_camera_that_looks_exactly_at_a_corner_of_a_glass_mesh_is_outside_of_it() {
    let octahedron =
        "mesh = { points = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], faces = [
        [0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]] }";
    let glass = body("glass", "dielectric = { index = 1.5, absorption = 20 }", &[octahedron]);
    for corner in [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]] {
        for position in [[2.5, 3.5, 2.0], [-3.0, 1.0, 2.5], [1.0, -4.0, -2.0], [4.0, 1.0, 0.0]] {
            let text = view(position, corner.map(f64::from), 70.0, 8) + &glass + &environment(1.0);
            let (film, report) = render_film(&text, EVERY_BRANCH);
            assert_eq!(report.unmatched, 0, "{corner:?} from {position:?}");
            assert_eq!(film.pixels[0].rgb, [1.0; 3], "{corner:?} from {position:?}");
        }
    }
}

/// Returns the shells of a lens with varying index: nested balls, each of its own material, which absorbs but does not
/// refract.
fn shells(count: u32) -> String {
    let shell = |i: u32| {
        let material = format!("dielectric = {{ index = 1, absorption = 0.02, priority = {i} }}");
        let ball =
            format!("sphere = {{ center = [0, 0, 0], radius = {} }}", 1.0 - 0.9 * f64::from(i) / f64::from(count));
        body(&format!("shell{i}"), &material, &[&ball])
    };
    (0..count).map(shell).collect()
}

#[test]
fn bodies_may_be_nested_up_to_the_limit_and_more_are_reported() {
    for (position, path) in [([0.0, 0.0, 5.0], 2.0_f64), ([0.0, 0.0, 0.05], 1.05)] {
        let seen = |count: u32| {
            let text = view(position, [0.0, 0.0, -9.0], 1e-6, 1) + &shells(count) + &environment(1.0);
            let (film, report) = render_film(&text, EVERY_BRANCH);
            (f64::from(film.pixels[0].rgb[1]), report)
        };
        let (shown, report) = seen(MAX_MEDIA as u32);
        assert_eq!((report.unmatched, report.has_many_media), (0, false), "from {position:?}");
        let expected = (-0.02 * path).exp();
        assert!((shown - expected).abs() < 1e-6, "from {position:?}: {shown}, not {expected}");
        let (_, report) = seen(MAX_MEDIA as u32 + 1);
        assert!(report.unmatched > 0 && report.has_many_media, "from {position:?}");
    }
}

/// A camera in a sea sees a lamp through bodies that the sea displaces.
#[test]
fn hidden_bodies_are_no_surfaces_of_what_is_seen_through_them() {
    let lamp = "quad = { center = [0, 0, -5], u = [3, 0, 0], v = [0, 3, 0] }";
    for hidden in 0..4 {
        for max_bounces in [0, 1, 9] {
            for seen in [true, false] {
                let ball = |number: i32| format!("sphere = {{ center = [0, 0, {}], radius = 0.4 }}", 2 - number);
                let balls: Vec<String> = (0..hidden).map(ball).collect();
                let balls: Vec<&str> = balls.iter().map(String::as_str).collect();
                let ball = body("glass", "dielectric = { index = 1.5, priority = 0 }", &balls);
                let lamp = body("lamp", "emissive = { radiance = 1 }", &[lamp]);
                let text = view([0.0, 0.0, 5.0], [0.0, 0.0, 0.0], 2.0, 4)
                    + &format!("[render]\nsamples = 4\nmax_bounces = {max_bounces}\n")
                    + &body(
                        "water",
                        "dielectric = { index = 1.33, priority = 1 }",
                        &["sphere = { center = [0, 0, 0], radius = 20 }"],
                    )
                    + &ball
                    + &lamp
                    + if seen { "" } else { "visible_to_camera = false\n" };
                for transport in [EVERY_BRANCH, SPLITTING, SINGLE_PATH] {
                    let (film, _) = render_film(&text, transport);
                    for pixel in &film.pixels {
                        let label = format!("{hidden} {max_bounces} {seen}: {pixel:?}");
                        if seen {
                            // All light arrives, apart from the factor of radiance.
                            assert!((pixel.rgb[0] - 1.0).abs() < 1e-5, "{label}");
                            assert!((pixel.depth - 10.0).abs() < 1e-3 && pixel.alpha == 1.0, "{label}");
                        } else if max_bounces == 0 {
                            assert!(pixel.rgb[0] == 0.0, "{label}");
                        } else {
                            assert!(pixel.rgb[0] < 0.5, "{label}");
                        }
                    }
                }
            }
        }
    }
}
