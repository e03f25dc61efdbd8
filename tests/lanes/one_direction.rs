//! Lanes that stay together share a direction. Their reflectance and transmittance differ from lane to lane.

use abbe::film::Film;
use abbe::material::{
    Branch, Dielectric, Index, Interface, Layer, Material, Roughness, Scatter, ScatterContext, Stack,
    shared_transmittance,
};
use abbe::math::{Complex, DVec2, DVec3};
use abbe::plan::plan;
use abbe::spectrum::{
    Basis, ColorSpace, Curve, CurveKind, Draw, Emission, MAX_LANES, Quantity, Table, comparison, data, visible,
};
use abbe::trace::{Method, prepare, render};

use crate::support::colors::{difference, lab};
use crate::support::fresnel::reflectances;
use crate::support::larger::larger;
use crate::support::materials::{context, direction_at, material};
use crate::support::scenes::{
    EVERY_BRANCH, Mean, SINGLE_PATH, body, environment, film_of, method, scene, sigma_limit, view,
};

const SPACE: ColorSpace = ColorSpace::Rec709;

fn named_curve(kind: fn(&str) -> Option<CurveKind>, name: &str) -> Curve {
    kind(name).expect("it is in the catalog").into()
}

/// Returns R and T of a plate in vacuum with all internal reflections, for light that is unpolarized at every surface,
/// from Fresnel's equations.
fn plate(n: f64, cos: f64) -> [f64; 2] {
    let r = 0.5 * reflectances(n, cos).iter().sum::<f64>();
    [2.0 * r / (1.0 + r), (1.0 - r) / (1.0 + r)]
}

fn bases() -> Vec<Basis> {
    let light = Emission::new(&named_curve(CurveKind::illuminant, "D65"), SPACE);
    let mut bases = vec![Basis::rgb(SPACE), Basis::prefiltered(SPACE, &light)];
    bases.extend([8, 12, 16, 32].map(|bands| Basis::bands(SPACE, bands, &[])));
    bases.push(Basis::bands(SPACE, 12, &[]).with_heroes(4, &[light]));
    bases.into_iter().map(Basis::kept_together).collect()
}

fn clear(basis: &Basis, index: Table) -> Material<Table> {
    let constant = |x: f64| basis.tabulate(Quantity::Transmittance, &x.into());
    let [reflectance, transmittance, emission, absorption] = [1.0, 1.0, 0.0, 0.0].map(constant);
    let (priority, roughness) = (0, Roughness::default());
    Material::Dielectric(Dielectric {
        index,
        reflectance,
        transmittance,
        emission,
        absorption,
        priority,
        roughness,
        coating: None,
    })
}

type Draws = Draw<MAX_LANES>;

/// Returns the reflected and the transmitted branch of a smooth surface, with the shares of each lane and the
/// direction.
fn smooth_branches(material: &Material<Table>, context: &ScatterContext<MAX_LANES>) -> [Option<Branch<MAX_LANES>>; 2] {
    let mut branches = Vec::new();
    material.scatter(context, [0.5; 2], &mut branches);
    assert!(branches.len() <= 2, "lanes part");
    [false, true].map(|crosses| branches.iter().find(|branch| branch.crosses == crosses).copied())
}

#[test]
fn d16_every_lane_of_every_glass_of_the_catalog_has_its_own_plate() {
    let (mut worst, mut lanes) = (0.0_f64, 0_u64);
    for basis in bases() {
        let draw: Draws = basis.draw(0.37);
        for glass in data::glasses() {
            let table = basis.tabulate(Quantity::Index, &named_curve(CurveKind::glass, glass.key));
            let own = draw.read_exact(&table);
            let Some(direction) = table.direction() else { panic!("{} does not disperse", glass.key) };
            assert!((direction - glass.n_d()).abs() < 1e-9, "{}: {direction}", glass.key);
            let material = clear(&basis, table.clone());
            for degrees in (0..18).map(|i| f64::from(5 * i)) {
                let (sin, cos) = libm::sincos(degrees.to_radians());
                let wo = DVec3::new(sin, 0.0, cos);
                let enters = ScatterContext {
                    normal: DVec3::Z,
                    beyond: Index::Own(&table),
                    direction_indices: [Some(1.0), Some(direction)],
                    ..context(&draw, wo, 1.0)
                };
                let [Some(r), Some(t)] = smooth_branches(&material, &enters) else {
                    panic!("{} at {degrees}", glass.key)
                };
                let leaves = ScatterContext { wo: -t.wi, ..enters.turned_around() };
                let [Some(inner), Some(out)] = smooth_branches(&material, &leaves) else {
                    panic!("{} at {degrees}", glass.key)
                };
                assert!((out.wi + wo).length() < 1e-12, "{} at {degrees} degrees goes on to {}", glass.key, out.wi);
                assert!((t.eta_scale * out.eta_scale - 1.0).abs() < 1e-14);
                let Some(forward) = leaves.forward() else { panic!("{} at {degrees}", glass.key) };
                for lane in (0..MAX_LANES).filter(|&lane| enters.present[lane] != 0.0) {
                    // A photon that leaves the glass contributes what a path into it would find, per solid angle.
                    let photon = f64::from(out.share[lane] * forward[lane]) / out.eta_scale;
                    assert!((photon / (f64::from(t.share[lane]) / t.eta_scale) - 1.0).abs() < 1e-6);
                    let [r, t, inner, out] = [&r, &t, &inner, &out].map(|branch| f64::from(branch.share[lane]));
                    let through = t * out / (1.0 - inner * inner);
                    let expected = plate(own[lane], cos);
                    for (found, expected) in [r + inner * through, through].into_iter().zip(expected) {
                        worst = larger(worst, (found - expected).abs());
                        lanes += 1;
                    }
                }
            }
        }
    }
    println!("{lanes} shares of plates, at most {worst:.1e} off");
    assert!(worst < 1e-6, "{worst}");
}

/// Returns a view with rays at 0 to 85 degrees onto a plate, and a plane of radiance 1 in front of it or behind it.
fn plate_view(glass: &str, reflected: bool) -> String {
    let (sin, cos) = libm::sincos(42.5_f64.to_radians());
    let (y, facing) = if reflected { (30, -1) } else { (-5, 1) };
    let plane = format!("plane = {{ point = [0, {y}, 0], normal = [0, {facing}, 0] }}");
    view([0.0, 10.0, 0.0], [0.0, 10.0 - cos, -sin], 85.0, 5)
        + "filter = \"center\"\n"
        + &body("glow", "emissive = { radiance = 1, sides = \"front\" }", &[&plane])
        + &body(
            "glass",
            &format!("dielectric = {{ index = \"{glass}\" }}"),
            &["cube = { center = [0, -0.005, 0], size = [4000, 0.01, 4000] }"],
        )
}

#[test]
fn d16_plates_of_glass_are_rendered_as_bright_in_every_lane_as_they_are() {
    let keys: Vec<&str> = data::glasses().map(|glass| glass.key).step_by(41).collect();
    let mut worst = 0.0_f64;
    for (number, key) in keys.into_iter().enumerate() {
        let basis = &bases()[number % 6];
        let index = basis.tabulate(Quantity::Index, &named_curve(CurveKind::glass, key));
        for reflected in [true, false] {
            let scene = scene(&plate_view(key, reflected));
            let world = || {
                let method = Method { basis: basis.clone(), ..method(&scene, EVERY_BRANCH) };
                prepare(&scene, method)
            };
            for lane in (0..basis.lanes()).step_by(if basis.lanes() > 12 { 5 } else { 1 }) {
                let own = index.bins()[lane];
                let (film, _) =
                    render(&world().with_responses(|response| comparison::response_of_lane(response, lane)), &|_| ());
                // The color of the lane by itself, and the channel that has most of it.
                let light = Curve::from(1.0);
                let alone = {
                    let draw = Draw::<MAX_LANES>::fixed(basis.fixed_lanes());
                    let table = basis.tabulate(Quantity::Emission, &light);
                    comparison::response_of_lane(&basis.response(&light), lane).film_rgb(
                        &draw,
                        draw.read(&table),
                        false,
                    )
                };
                let channel = (0..3).fold(0, |most, c| if alone[c].abs() > alone[most].abs() { c } else { most });
                for (at, pixel) in film.pixels.iter().enumerate() {
                    let place = DVec2::new((at % 5) as f64 + 0.5, (at / 5) as f64 + 0.5);
                    let cos = -scene.camera.ray(place).direction.y;
                    if cos < libm::cos(85.5_f64.to_radians()) {
                        continue;
                    }
                    let [r, t] = plate(own, cos);
                    let found = f64::from(pixel.rgb[channel]) / alone[channel];
                    let off = (found - if reflected { r } else { t }).abs();
                    assert!(off < 1e-5, "{key} in {}, lane {lane}: {found} for R {r}, T {t}", basis.name());
                    worst = larger(worst, off);
                }
            }
        }
    }
    println!("rendered plates are at most {worst:.1e} off");
}

/// Liquids and glasses inside each other, hit at any angle: light in both directions agrees, and R + T = 1.
#[test]
fn d16_lanes_of_one_direction_lose_nothing_between_any_two_media() {
    let indices = |name: &str| {
        let glass = data::glass(name).unwrap_or_else(|| panic!("no {name}"));
        let own: [f64; 16] = std::array::from_fn(|i| glass.index(390.0 + 20.0 * i as f64));
        (own, glass.n_d())
    };
    let media = ["N-BK7", "N-SF66", "N-SF11", "N-FK51A", "N-LAK9"].map(indices);
    for (here, beyond) in media.iter().flat_map(|here| media.iter().map(move |beyond| (here, beyond))) {
        for step in 0..=2000 {
            let cos = f64::from(step) / 2000.0;
            let t = shared_transmittance([&here.0, &beyond.0], [here.1, beyond.1], cos);
            let k = here.1 * (1.0 - cos * cos).sqrt();
            let back = (1.0 - (k / beyond.1) * (k / beyond.1)).max(0.0).sqrt();
            let other = shared_transmittance([&beyond.0, &here.0], [beyond.1, here.1], back);
            for lane in 0..16 {
                assert!((0.0..=1.0 + 1e-15).contains(&t[lane]), "{}", t[lane]);
                // Where the direction grazes one medium, the angle on the other side has lost digits.
                let ends = [here.1, here.0[lane], beyond.1, beyond.0[lane]];
                let near_end = k > 0.999 * ends.into_iter().fold(f64::INFINITY, f64::min);
                assert!(near_end || (t[lane] - other[lane]).abs() < 1e-9, "{} and {}", t[lane], other[lane]);
            }
        }
    }
}

/// A camera in a liquid looks at glass. Every lane is at grazing incidence where the ray is. Before that, each lane has
/// its own share, bare or under a layer. Lanes with an index below that of the ray used to be totally reflected within
/// 8 degrees.
#[test]
fn d16_lanes_in_a_dispersive_liquid_meet_denser_glass_as_if_each_were_alone() {
    let [liquid, flint] = ["liquid/carbon disulfide", "N-SF66"]
        .map(|name| data::glass(name).unwrap_or_else(|| panic!("no {name}")))
        .map(|glass| ([450.0, 550.0, 650.0].map(|nm| glass.index(nm)), glass.n_d()));
    let (draw, direction) = (Draw::<4>::fixed(3), [liquid.1, flint.1]);
    let [incident, beyond] = [liquid.0, flint.0].map(Table::new);
    let layers = [None, Some((1.7, 80.0))];
    let mut worst = [0.0_f64; 2];
    for (which, layer) in layers.into_iter().enumerate() {
        let coating = layer.map_or(String::new(), |(index, thickness)| {
            format!(", coating = [{{ index = {index}, thickness_nm = {thickness} }}]")
        });
        let material = material(&format!("dielectric = {{ index = \"N-SF66\"{coating} }}"));
        for step in 0..=500 {
            let cos = f64::from(step) / 500.0 + 1e-5;
            let context = ScatterContext {
                incident: Index::Own(&incident),
                beyond: Index::Own(&beyond),
                direction_indices: direction.map(Some),
                ..context(&draw, direction_at(cos, 0.4), 1.0)
            };
            let mut branches = Vec::new();
            material.scatter(&context, [0.5; 2], &mut branches);
            let reflected = branches.iter().find(|branch| !branch.crosses).expect("some is reflected");
            for lane in 0..3 {
                let [n1, n2] = [liquid.0, flint.0].map(|n| n[lane]);
                let wave = context.waves.of_lane(&draw, lane);
                let layers = layer.map(|(index, thickness_nm)| Layer { index: Complex::from(index), thickness_nm });
                let alone = Stack::new(wave, layers.into_iter()).shares(n1, n2.into(), n1 * cos.min(1.0));
                let off = (f64::from(reflected.share[lane]) - alone.reflected.mean()).abs();
                worst[which] = larger(worst[which], off);
            }
        }
    }
    println!("reflectances in carbon disulfide are at most {worst:?} off");
    assert!(worst[0] < 6e-3 && worst[1] < 6e-3, "{worst:?}");
}

/// Where a ray grazes the rarer medium, no lane is transmitted. Before that, the shares have no jumps.
#[test]
fn d16_shares_of_lanes_of_one_direction_are_continuous() {
    let media = ["liquid/carbon disulfide", "N-BK7", "N-SF66", "N-SF11", "liquid/water"].map(|name| {
        let glass = data::glass(name).unwrap_or_else(|| panic!("no {name}"));
        ([400.0, 450.0, 500.0, 550.0, 600.0, 650.0, 700.0].map(|nm| glass.index(nm)), glass.n_d())
    });
    let mut all = media.to_vec();
    all.push(([1.0; 7], 1.0));
    for (here, beyond) in all.iter().flat_map(|here| all.iter().map(move |beyond| (here, beyond))) {
        if here == beyond {
            continue;
        }
        let least = here.1.min(beyond.1);
        // Even steps of the cosine in the rarer medium, in which the shares are smooth.
        let at = |step: u32| {
            let cos = f64::from(step) / 1000.0;
            let k = least * (1.0 - cos * cos).sqrt() / here.1;
            shared_transmittance([&here.0, &beyond.0], [here.1, beyond.1], (1.0 - k * k).max(0.0).sqrt())
        };
        let mut last = [0.0; 7];
        for step in 1..=1000 {
            let now = at(step);
            for lane in 0..7 {
                let jump = (now[lane] - last[lane]).abs();
                assert!(jump < 0.03, "{} to {} at step {step}: {jump} in lane {lane}", here.1, beyond.1);
            }
            last = now;
        }
    }
}

/// A cube of one glass inside a ball of another, under a uniform sky of 1, smooth and rough. Lanes may also part at the
/// cube.
#[test]
fn d16_glass_whose_lanes_stay_together_is_invisible_in_an_even_sky() {
    const PARTS: &str = "{ rgb = [1.70, 1.72, 1.76] }";
    const FLINT: &str = "\"N-SF66\"";
    for (inner, roughness, tolerance) in [
        (FLINT, "", 0.0),
        (PARTS, "", 0.0),
        (FLINT, ", roughness = 0.05", 2e-3),
        (PARTS, ", roughness = 0.05", 2e-3),
        (FLINT, ", roughness = 0.5", 5e-3),
    ] {
        let text = view([0.2, 0.3, 5.0], [0.0; 3], 30.0, 8)
            + &format!("[render]\nsamples = {}\n", if roughness.is_empty() { 1 } else { 256 })
            + &environment(1.0)
            + &body(
                "outer",
                &format!("dielectric = {{ index = \"N-BK7\"{roughness} }}"),
                &["sphere = { center = [0, 0, 0], radius = 1.2 }"],
            )
            + &body(
                "inner",
                &format!("dielectric = {{ index = {inner}, priority = 1{roughness} }}"),
                &["cube = { center = [0.1, 0, 0], size = [0.8, 0.7, 0.9] }"],
            );
        let scene = scene(&text);
        let transport = if roughness.is_empty() { EVERY_BRANCH } else { SINGLE_PATH };
        for basis in [Basis::rgb(SPACE), Basis::bands(SPACE, 16, &[])] {
            if inner == PARTS && basis.lanes() > 3 {
                continue;
            }
            let basis = basis.kept_together();
            let film = film_of(&scene, Method { basis, ..method(&scene, transport) });
            if roughness.is_empty() {
                let off = film.pixels.iter().flat_map(|p| p.rgb).map(|x| (x - 1.0).abs());
                let worst = off.max_by(f32::total_cmp).expect("a film has pixels");
                println!("{inner}: an even sky is at most {worst:.1e} off");
                assert!(worst < 1e-5, "{inner}: {worst}");
                continue;
            }
            let Mean { value, error } = Mean::of(&film);
            for (band, (mean, error)) in value.into_iter().zip(error).enumerate() {
                let error = sigma_limit(15) * error;
                assert!((mean - 1.0).abs() < tolerance + error, "{roughness}: {mean} +- {error} in band {band}");
            }
        }
    }
}

/// Renders a glass ball that absorbs what enters it, under a D65 sky. The film is in CIE XYZ.
fn mirror_ball(model: &str) -> (abbe::plan::Plan, Film, Vec<f64>) {
    let text = view([0.0, 0.0, 8.0], [0.0; 3], 14.0, 9)
        + &format!(
            "color_space = \"lin_ciexyzd65_scene\"\nfilter = \"center\"\n[render]\nmodel = {model}\n\
             [[light]]\nenvironment = {{ radiance = {{ illuminant = \"D65\" }} }}\n"
        )
        + &body(
            "glass",
            "dielectric = { index = \"N-SF66\", absorption = 1e4 }",
            &["sphere = { center = [0, 0, 0], radius = 1.5 }"],
        );
    let scene = scene(&text);
    let plan = plan(&scene);
    let film = film_of(&scene, plan.method.clone());
    let cosines = (0..81).map(|at| {
        let ray = scene.camera.ray(DVec2::new(f64::from(at % 9) + 0.5, f64::from(at / 9) + 0.5));
        let along = -ray.origin.dot(ray.direction);
        let off = (ray.origin.length_squared() - along * along) / 2.25;
        (1.0 - off).sqrt()
    });
    (plan, film, cosines.collect())
}

#[test]
fn d16_a_ball_of_dense_flint_mirrors_daylight_in_its_color() {
    let (light, glass) = (Emission::new(&named_curve(CurveKind::illuminant, "D65"), SPACE), data::glass("N-SF66"));
    let (white, glass) = (light.xyz(), glass.unwrap_or_else(|| panic!("no N-SF66")));
    for (model, bound) in [("\"rgb\"", 0.1), ("{ bands = 8 }", 0.3), ("{ bands = 16 }", 0.05), ("{ bands = 32 }", 0.05)]
    {
        let (plan, film, cosines) = mirror_ball(model);
        let because = plan.because.join("\n");
        assert!(because.contains("lanes stay together"), "{because}");
        let mut worst = 0.0_f64;
        for (pixel, cos) in film.pixels.iter().zip(cosines).filter(|(_, cos)| *cos > 0.05) {
            let (mut sum, mut total) = ([0.0; 3], [0.0; 3]);
            for (nm, &power) in visible::wavelengths().zip(light.spectrum()) {
                let r = Interface::new(1.0, glass.index(nm), cos).reflectance;
                for (c, cmf) in visible::color_matching(nm).into_iter().enumerate() {
                    sum[c] += r * power * cmf;
                    total[c] += power * cmf;
                }
            }
            let expected = [0, 1, 2].map(|c| white[c] * sum[c] / total[c]);
            worst = larger(worst, difference(lab(pixel.rgb.map(f64::from), white), lab(expected, white)));
        }
        println!("{model}: dE2000 at most {worst:.4}");
        assert!(worst < bound, "{model}: {worst}");
    }
}

#[test]
fn the_plan_counts_the_color_of_glass_and_keeps_three_lanes_where_they_do() {
    let ball = |glass: &str, render: &str| {
        let text = view([0.0, 0.0, 8.0], [0.0; 3], 14.0, 9)
            + render
            + &environment(1.0)
            + &body(
                "glass",
                &format!("dielectric = {{ index = {glass} }}"),
                &["cube = { center = [0, 0, 0], size = [9, 9, 0.1] }"],
            );
        plan(&scene(&text))
    };
    for glass in ["\"N-BK7\"", "\"N-SF66\""] {
        let plan = ball(glass, "");
        assert_eq!(plan.method.basis.name(), "rgb", "{glass}: {:?}", plan.because);
        let stated = plan.candidates[0].bound();
        assert!(stated > 0.0 && stated < 0.01, "{glass}: {stated}");
        assert!(plan.because.iter().any(|line| line.contains("colors are off by at most")), "{:?}", plan.because);
    }
    let plain = ball("1.5", "");
    assert!(plain.candidates[0].error == 0.0 && plain.candidates.len() == 1);
    let words = ball("\"N-BK7\"", "").because.join("\n");
    assert!(words.contains("all lanes are refracted by 1.5168, so lanes stay together"), "{words}");
}

/// A lamp lights a floor inside dense flint, once by photons and once by random paths. Both contribute the same in
/// every lane, although solid angles change by the index of the direction and radiance by each lane's own index.
#[test]
fn photons_and_paths_bring_the_same_color_through_glass_whose_lanes_stay_together() {
    let color = |caustics: &str, samples: u32| {
        let text = view([0.0, 4.0, 0.5], [0.0; 3], 20.0, 16)
            + &format!(
                "color_space = \"lin_ciexyzd65_scene\"\n[render]\nsamples = {samples}\nmodel = {{ bands = 16 }}\n\
                 caustics = \"{caustics}\"\n"
            )
            + &body(
                "glass",
                "dielectric = { index = \"N-SF66\" }",
                &["cube = { center = [0, 0, 0], size = [12, 0.04, 12] }"],
            )
            + &body(
                "floor",
                "diffuse = { reflectance = 0.5 }",
                &["quad = { center = [0, -0.01, 0], u = [0, 0, 5], v = [5, 0, 0] }"],
            )
            + &body(
                "lamp",
                "emissive = { radiance = { illuminant = \"D65\", scale = 20 } }",
                &["sphere = { center = [0, 4, -4], radius = 0.5 }"],
            );
        let scene = scene(&text);
        let method = plan(&scene).method;
        assert!(method.light_pass.is_some() == (caustics == "auto"), "{:?}", method.light_pass);
        let film = film_of(&scene, method);
        let sum = |band: usize| film.pixels.iter().map(|pixel| f64::from(pixel.rgb[band])).sum::<f64>();
        [sum(0) / sum(1), sum(2) / sum(1)]
    };
    let (photons, chance) = (color("auto", 64), color("off", 512));
    println!("X / Y and Z / Y: {photons:?} by photons, {chance:?} by chance");
    // If one followed the other's factor, Z would be 10 % off. The noise is the same in all lanes.
    assert!((0..2).all(|i| (photons[i] / chance[i] - 1.0).abs() < 2e-3), "{photons:?} and {chance:?}");
}
