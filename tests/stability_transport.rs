//! The rows of the stability catalog about trees of branches: they must neither explode, nor lose light, nor run
//! forever. Each test is named after its row.
//!
//! ```text
//! cargo test --test all stability_transport::
//! ```

use std::f64::consts::PI;

use abbe::math::DVec3;
use abbe::plan::plan;
use abbe::trace::{Transport, prepare, render};

use crate::support::random::Random;
use crate::support::scenes::{
    Mean, SINGLE_PATH, SPLITTING, body, environment, mean_and_variance, mean_color, render_film, render_films, scene,
    view,
};

/// Returns twenty glass balls with radii of 0.35 to 0.65 in a box of edge 4. They do not touch, and they are under a
/// uniform sky with a sun.
fn glass_balls(side: u32, filter: &str, sun_radius: f64, sun_radiance: f64) -> String {
    let mut random = Random::new(77);
    let mut balls: Vec<(DVec3, f64)> = Vec::new();
    while balls.len() < 20 {
        let center = DVec3::from([(); 3].map(|()| random.between(-2.0, 2.0)));
        let radius = random.between(0.35, 0.65);
        if balls.iter().all(|ball| (ball.0 - center).length() > ball.1 + radius) {
            balls.push((center, radius));
        }
    }
    let shapes: Vec<String> = balls
        .iter()
        .map(|(center, radius)| format!("sphere = {{ center = {:?}, radius = {radius:?} }}", center.to_array()))
        .collect();
    let shapes: Vec<&str> = shapes.iter().map(String::as_str).collect();
    let sun = format!("sphere = {{ center = [60, 64, 48], radius = {sun_radius:?} }}");
    view([0.0, 0.0, 8.0], [0.0; 3], 22.6, side)
        + &format!("filter = \"{filter}\"\n")
        + &body("glass", "dielectric = { index = 1.5 }", &shapes)
        + &body("sun", &format!("emissive = {{ radiance = {sun_radiance:?} }}"), &[&sun])
        + &environment(0.5)
}

/// Radius of a sun that emits as much light as the catalog's lobe, 30 cos^400, in as much of the sky: 2 pi / 401.
const SUN_RADIUS: f64 = 7.0;

/// Returns ten panes of index 1.5 in front of an emissive plane. If `seen` is false, the plane is behind the camera
/// instead.
fn panes(seen: bool, side: u32) -> String {
    let panes: Vec<String> =
        (0..10).map(|i| format!("cube = {{ center = [0, 0, {}], size = [200, 200, 0.5] }}", -i)).collect();
    let panes: Vec<&str> = panes.iter().map(String::as_str).collect();
    let (z, facing) = if seen { (-20, 1) } else { (20, -1) };
    let plane = format!("plane = {{ point = [0, 0, {z}], normal = [0, 0, {facing}] }}");
    view([0.0, 0.0, 10.0], [0.0; 3], 1e-6, side)
        + &body("glass", "dielectric = { index = 1.5 }", &panes)
        + &body("lamp", "emissive = { radiance = 1, sides = \"front\" }", &[&plane])
}

/// Share that N panes with reflectance r at each surface reflect over all paths: 2 N r / (1 + (2 N - 1) r).
const REFLECTED: f64 = 20.0 * 0.04 / (1.0 + 19.0 * 0.04);

/// Returns the transport that the plan chooses by itself, which must be a random one.
fn planned_transport(text: &str) -> Transport {
    let transport = plan(&scene(text)).method.transport;
    assert!(matches!(transport, Transport::Random { .. }), "{transport:?}");
    transport
}

#[test]
fn w1_a_camera_ray_into_a_cluster_of_glass_balls_costs_at_most_15_rays() {
    let text = glass_balls(100, "box", SUN_RADIUS, 30.0);
    let (_, report) = render_film(&text, planned_transport(&text));
    let rays = report.rays as f64 / report.samples as f64;
    println!("W1: {rays:.2} rays for each camera ray");
    assert!((2.0..=15.0).contains(&rays), "{rays} rays for each camera ray");
}

#[test]
fn w2_a_stack_of_ten_panes_loses_no_light() {
    for (seen, expected) in [(true, 1.0 - REFLECTED), (false, REFLECTED)] {
        let mean = Mean::of(&render_film(&panes(seen, 160), planned_transport(&panes(seen, 1))).0);
        println!("W2: {} +- {:.1e} for {expected:.6}", mean.value[0], mean.error[0]);
        assert!((mean.value[0] - expected).abs() <= 0.002, "{mean:?}");
        assert!(3.0 * mean.error[0] <= 0.002, "{mean:?}");
    }
}

#[test]
fn w3_light_caught_in_a_glass_cube_does_not_run_forever() {
    // A view of a quarter turn shows one of six equal faces.
    let cube = body("glass", "dielectric = { index = 1.5 }", &["cube = { center = [0, 0, 0], size = 2 }"]);
    let text = |side: u32| view([0.0; 3], [0.0, 0.0, -1.0], 90.0, side) + &cube + &environment(1.0);
    // 3 (1 - cos of the critical angle) of the directions lead out.
    let exact = 3.0 * (1.0 - (1.0 - 1.0 / 2.25f64).sqrt());
    for (transport, side) in [
        (SPLITTING, 142),
        (SINGLE_PATH, 60),
        (Transport::Deterministic { cutoff: 1e-9, max_sample_surfaces: u64::MAX }, 60),
    ] {
        let (film, report) = render_film(&text(side), transport);
        // Pixels of a plane cover solid angles in proportion to the cube of the cosine.
        let solid_angle = |at: usize| {
            let place = |i: u32| 2.0 * (f64::from(i) + 0.5) / f64::from(side) - 1.0;
            let (x, y) = (place(at as u32 % side), place(at as u32 / side));
            let squared: f64 = 1.0 + x * x + y * y;
            1.0 / (squared * squared.sqrt())
        };
        let all: f64 = (0..film.pixels.len()).map(solid_angle).sum();
        let out: f64 = film.pixels.iter().enumerate().map(|(at, p)| solid_angle(at) * f64::from(p.rgb[0])).sum();
        let escaped = out / all / 2.25;
        println!("W3: {escaped:.4} for {exact:.4}, stopped {:.4}", report.stopped);
        assert!((escaped - exact).abs() <= 0.01, "{escaped} escapes for {exact}");
        if let Transport::Deterministic { .. } = transport {
            let caught = film.pixels.iter().filter(|pixel| pixel.rgb[0] < 1.0).count() as f64;
            let share = caught / film.pixels.len() as f64;
            assert!((report.stopped - share).abs() <= 0.01, "{} stopped, {share} caught", report.stopped);
        }
    }
}

#[test]
fn w4_roulette_below_any_weight_keeps_the_mean() {
    for (split, roulette, side) in
        [(1.0, 0.05, 120), (0.3, 0.3, 100), (0.05, 0.05, 64), (1e-2, 1e-2, 40), (1e-3, 1e-3, 24)]
    {
        let mean = Mean::of(&render_film(&panes(true, side), Transport::Random { split, roulette }).0);
        println!("W4: split {split}: {} +- {:.1e}", mean.value[0], mean.error[0]);
        mean.assert_near([1.0 - REFLECTED; 3], 5, &format!("split {split}, roulette {roulette}"));
        assert!(mean.error[0] <= 0.004, "{mean:?}");
    }
}

#[test]
fn w5_splitting_and_roulette_agree_with_following_every_branch() {
    // A sun so large that many pixels see it in the glass.
    let radiance = 4.0;
    let text = glass_balls(24, "center", 28.0, radiance);
    let cutoff = 1e-7;
    let (whole, report) = render_film(&text, Transport::Deterministic { cutoff, max_sample_surfaces: u64::MAX });
    let [whole, ..] = mean_color(&whole);
    for transport in [SPLITTING, SINGLE_PATH] {
        let mean = Mean::render_text(&text, transport, 100);
        // Nothing is brighter than the sun, so at most this much is missing from the tree.
        let missing = radiance * report.dropped;
        println!("W5: {} +- {:.1e} for {whole}, missing at most {missing:.1e}", mean.value[0], mean.error[0]);
        assert!(missing < 0.2 * mean.error[0], "{missing} missing, {} uncertain", mean.error[0]);
        assert!((mean.value[0] - whole).abs() <= 3.0 * mean.error[0], "{mean:?} for {whole}");
    }
}

#[test]
fn w5_splitting_is_at_least_3_times_as_efficient_as_a_single_path() {
    let text = glass_balls(40, "box", SUN_RADIUS, 30.0);
    let [splitting, single] = [planned_transport(&text), SINGLE_PATH].map(|transport| {
        let (films, reports): (Vec<_>, Vec<_>) = render_films(&text, transport, 64).into_iter().unzip();
        let rays = reports.iter().map(|report| report.rays as f64 / report.samples as f64).sum::<f64>();
        let of_pixel = |at: usize| mean_and_variance(films.iter().map(move |film| f64::from(film.pixels[at].rgb[0]))).1;
        1.0 / ((0..films[0].pixels.len()).map(of_pixel).sum::<f64>() * rays)
    });
    println!("W5: {:.2} times as efficient", splitting / single);
    assert!(splitting / single >= 3.0, "{} times as efficient", splitting / single);
}

#[test]
fn w6_light_in_a_closed_white_box_dies_out_at_the_right_radiance() {
    const REFLECTANCE: f64 = 0.99;
    let white = format!("diffuse = {{ reflectance = {REFLECTANCE} }}");
    let lit = "[[light]]\npoint = { position = [0, 0, 0], intensity = 1 }\n";
    // The irradiance of the walls by a point light in the middle, with all bounces: 4 pi I / (S (1 - reflectance)).
    let radiance = |area: f64| REFLECTANCE / PI * 4.0 * PI / (area * (1.0 - REFLECTANCE));
    // A ball looks the same everywhere. In a box, a view of a quarter turn evenly shows one of six equal faces.
    let rooms = [
        ("sphere = { center = [0, 0, 0], radius = 2 }", radiance(16.0 * PI)),
        ("cube = { center = [0, 0, 0], size = 2 }", radiance(24.0)),
    ];
    for (room, expected) in rooms {
        let text = view([0.0; 3], [0.0, 0.0, -1.0], 90.0, 60) + &body("white", &white, &[room]) + lit;
        let (films, reports): (Vec<_>, Vec<_>) = render_films(&text, SPLITTING, 3).into_iter().unzip();
        let mean = Mean::over_seeds(&films);
        let rays = reports[0].rays as f64 / reports[0].samples as f64;
        println!("W6: {} +- {:.1e} for {expected}, {rays:.0} rays", mean.value[0], mean.error[0]);
        mean.assert_near([expected; 3], 1, room);
        assert!(mean.worst_relative_error([expected; 3]) <= 0.02, "{mean:?}");
    }
}

#[test]
fn a_surface_that_passes_no_light_on_shows_its_own_and_nothing_else() {
    let black = "{ index = { rgb = [1.5, 1.6, 1.7] }, reflectance = 0, transmittance = 0, emission = 0.5 }";
    let ball = body("ember", &format!("dielectric = {black}"), &["sphere = { center = [0, 0, 0], radius = 1 }"]);
    let text = view([0.0, 0.0, 5.0], [0.0; 3], 10.0, 16) + &ball + &environment(1.0);
    for transport in [SPLITTING, SINGLE_PATH, Transport::Deterministic { cutoff: 1e-9, max_sample_surfaces: u64::MAX }]
    {
        let (film, report) = render_film(&text, transport);
        assert_eq!(report.non_finite, 0, "{transport:?}");
        assert!(film.pixels.iter().all(|pixel| pixel.rgb == [0.5; 3]), "{transport:?}");
    }
}

/// Returns bodies and panes in which the number of light paths grows with `count`.
fn branching_scene(kind: &str, count: i32) -> String {
    let mirror = body("mirror", "mirror = {}", &["quad = { center = [0, 0, -6], u = [9, 1, 0], v = [0, 9, 0] }"]);
    let repeat_shape = |material: &str, shape: &dyn Fn(i32) -> String| {
        let shapes: Vec<String> = (0..count).map(shape).collect();
        body("glass", material, &shapes.iter().map(String::as_str).collect::<Vec<_>>())
    };
    let pane = |i: i32| format!("quad = {{ center = [0, 0, {}], u = [9, 0, 0], v = [0, 9, 0] }}", -0.5 * f64::from(i));
    let slab = |i: i32| format!("cube = {{ center = [0, 0, {}], size = [18, 18, 0.2] }}", -0.5 * f64::from(i));
    let ball = |i: i32| format!("sphere = {{ center = [0, 0, 0], radius = {} }}", 1.0 + 0.2 * f64::from(i));
    let glass = "dielectric = { index = 1.5 }";
    view([0.0, 0.0, 9.0], [0.0; 3], 20.0, 4)
        + "filter = \"center\"\n"
        + &environment(1.0)
        + &match kind {
            "thin" => repeat_shape("thin = { index = 1.5 }", &pane),
            "slabs" => repeat_shape(glass, &slab),
            "slabs before a mirror" => repeat_shape(glass, &slab) + &mirror,
            _ => (0..count)
                .map(|i| {
                    let material =
                        format!("dielectric = {{ index = {}, priority = {} }}", [1.8, 1.2][i as usize % 2], -i);
                    body(&format!("shell{i}"), &material, &[&ball(i)])
                })
                .collect(),
        }
}

#[test]
fn w7_where_light_has_too_many_ways_the_plan_leaves_them_to_chance_and_says_so() {
    for kind in ["thin", "slabs", "slabs before a mirror", "shells"] {
        let mut by_chance = 0;
        for count in 2..=10 {
            let scene = scene(&branching_scene(kind, count));
            let mut plan = plan(&scene);
            let says = plan.because.iter().any(|line| line.contains("light has too many paths"));
            let random = matches!(plan.method.transport, Transport::Random { .. });
            assert_eq!(says, random, "{count} {kind}: {:?}", plan.because);
            by_chance += u32::from(random);
            plan.method.samples = if random { 16 } else { 1 };
            let (_, report) = render(&prepare(&scene, plan.method), &|_| ());
            let rays = report.rays as f64 / report.samples as f64;
            println!(
                "W7: {count} {kind}: {rays:.1} rays a sample, {}",
                if random { "random" } else { "deterministic" }
            );
            // Light that is not lost wanders: the surfaces that it meets grow as the square of their number.
            let most = if random { 32.0 + 8.0 * f64::from(count * count) } else { 4096.0 };
            assert!(rays <= most, "{count} {kind}: {rays} rays");
            assert_eq!(report.by_chance, 0, "{count} {kind}");
        }
        assert!(by_chance >= 3, "{kind}: all ways followed where they are too many");
    }
}

#[test]
fn w7_a_camera_sample_that_meets_too_many_surfaces_goes_on_by_chance_to_the_same_mean() {
    let rendered = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| {
            render_film(&panes(true, 20), Transport::Deterministic { cutoff: 1e-9, max_sample_surfaces: 16_384 })
        })
    };
    let (film, report) = rendered(1);
    assert_eq!(report.by_chance, report.samples);
    let rays = report.rays as f64 / report.samples as f64;
    let mean = Mean::of(&film);
    println!("W7: {} +- {:.1e}, {rays:.0} rays a sample", mean.value[0], mean.error[0]);
    assert!(rays < 20_000.0, "{rays} rays");
    mean.assert_near([1.0 - REFLECTED; 3], 1, "ten panes");
    assert!(mean.error[0] < 0.005, "{mean:?}");
    assert!(rendered(3).0.pixels == film.pixels, "another number of threads makes other bits");
}

/// The lamp of smallpt: the tip of a sphere of radius 600 reaches 0.27 through the ceiling. Seen from the floor, it
/// fills the cone through its rim, which is 1 / 20 of the cone of the whole sphere.
#[test]
fn a_lamp_of_which_the_tip_is_seen_costs_no_more_than_the_tip() {
    let (radius, tip, height, samples) = (600.0_f64, 0.27_f64, 81.33, 16);
    let rim = tip * (2.0 * radius - tip);
    let expected = 0.5 * 12.0 * rim / (rim + height * height);
    let lamp = format!("sphere = {{ center = [0, {:?}, 0], radius = {radius:?} }}", height + radius - tip);
    let ceiling = format!("plane = {{ point = [0, {height:?}, 0], normal = [0, -1, 0] }}");
    let text = view([0.0, 40.0, 0.1], [0.0; 3], 0.01, 32)
        + "[render]\ndiffuse_bounces = 0\nsamples = 16\n"
        + &body(
            "floor",
            "diffuse = { reflectance = 0.5 }",
            &["quad = { center = [0, 0, 0], u = [50, 0, 0], v = [0, 0, -50] }"],
        )
        + &body("ceiling", "diffuse = { reflectance = 0 }", &[&ceiling])
        + &body("lamp", "emissive = { radiance = 12 }", &[&lamp]);
    let mean = Mean::of(&render_film(&text, SPLITTING).0);
    mean.assert_near([expected; 3], 1, "floor below the tip");
    // With samples over the whole cone, 19 of 20 would see nothing: a deviation of 4 times the mean.
    let deviation = mean.worst_relative_error([expected; 3]) * f64::from(32 * 32 * samples).sqrt();
    assert!(deviation < 0.5, "a sample deviates by {deviation}");
}
