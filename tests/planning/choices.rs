//! The choices of the plan for scenes with known needs.

use abbe::plan::{Plan, plan};
use abbe::spectrum::Basis;
use abbe::trace::{Method, ROUTES_NM, Route, RouteEvent, Step, Transport, World, routes};

use crate::support::scenes::{body, environment, scene, view};

/// Plans a scene with a glass object in front of a painted wall, under a lamp with the given radiance.
fn behind(glass: &str, shape: &str, wall: &str, light: &str, render: &str) -> Plan {
    let view = view([0.0, 0.0, 6.0], [0.0, 0.0, 0.0], 40.0, 200);
    plan(&scene(&format!(
        "{view}\n[render]\n{render}\n\
         [material.glass]\ndielectric = {{ index = {glass} }}\n\
         [material.wall]\ndiffuse = {{ reflectance = {wall} }}\n\
         [material.stripe]\ndiffuse = {{ reflectance = 0.1 }}\n\
         [material.lamp]\nemissive = {{ radiance = {light} }}\n\
         [[object]]\n{shape}\nmaterial = \"glass\"\n\
         [[object]]\nshape.quad = {{ center = [0, 0, -3], u = [9, 0, 0], v = [0, 9, 0] }}\nmaterial = \"wall\"\n\
         [[object]]\nshape.quad = {{ center = [0, 0, -2.9], u = [0.1, 0, 0], v = [0, 9, 0] }}\nmaterial = \"stripe\"\n\
         [[object]]\nshape.sphere = {{ center = [0, 8, 5], radius = 1 }}\nmaterial = \"lamp\"\n"
    )))
}

const PANE: &str = "shape.cube = { center = [0, 0, 3], size = [4, 4, 0.02] }\n\
                    transform = [{ rotate = { axis = [0, 1, 0], degrees = 20 } }]";
const BALL: &str = "shape.sphere = { center = [0, 0, 1], radius = 1 }";
const PRISM: &str = "shape.mesh.points = [[-1, -1, 0], [1, -1, 0], [0, -1, -1.7], [-1, 1, 0], [1, 1, 0], [0, 1, -1.7]]\n\
                     shape.mesh.faces = [[0, 2, 1], [3, 4, 5], [0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4], [2, 0, 3], [2, 3, 5]]\n\
                     transform = [{ rotate = { axis = [0, 1, 0], degrees = 40 } }]";
const RGB: &str = "{ rgb = [0.7, 0.5, 0.3] }";

#[test]
fn a_scene_of_rgb_colors_under_its_own_white_stays_in_rgb() {
    for light in ["10", "{ rgb = [9, 5, 2] }", "{ illuminant = \"D65\" }"] {
        let plan = behind("1.5", BALL, RGB, light, "");
        assert_eq!(plan.method.basis.name(), "rgb", "{light}: {:?}", plan.because);
    }
}

#[test]
fn a_pane_of_window_glass_keeps_lanes_together() {
    for glass in ["\"N-BK7\"", "\"N-SF11\""] {
        let plan = behind(glass, PANE, RGB, "10", "");
        assert_eq!(plan.method.basis.name(), "rgb", "{:?}", plan.because);
        assert!(plan.because.iter().any(|line| line.contains("lanes stay together")), "{:?}", plan.because);
    }
}

#[test]
fn a_prism_and_a_ball_let_wavelengths_part() {
    for (shape, glass) in [(PRISM, "\"N-SF11\""), (PRISM, "\"N-BK7\""), (BALL, "\"N-BK7\"")] {
        let plan = behind(glass, shape, RGB, "10", "");
        assert!(plan.method.basis.draws_wavelengths(), "{shape} {glass}: {:?}", plan.because);
    }
}

#[test]
fn dispersion_too_small_to_be_seen_is_not_modelled() {
    for shape in [PRISM, BALL] {
        let plan = behind("{ cauchy = [1.5168, 1e-6] }", shape, RGB, "10", "");
        assert!(!plan.method.basis.draws_wavelengths(), "{:?}", plan.because);
        assert!(plan.because.iter().any(|line| line.contains("lanes stay together")), "{:?}", plan.because);
    }
    let forced = behind("{ cauchy = [1.5168, 1e-6] }", BALL, RGB, "10", "model = \"hero\"");
    assert!(forced.method.basis.draws_wavelengths());
}

/// Three numbers describe the three images of a white lamp. Light of a single wavelength has only one image.
#[test]
fn an_rgb_index_asks_for_heroes_under_light_that_is_not_white() {
    let plan_under = |light: &str| behind("{ rgb = [1.5, 1.55, 1.6] }", PRISM, RGB, light, "");
    assert_eq!(plan_under("10").method.basis.name(), "rgb");
    for light in ["{ lines = [[587.56, 9]] }", "{ samples = [[586, 9], [589, 9]] }"] {
        let plan = plan_under(light);
        assert!(plan.method.basis.draws_wavelengths(), "{light}: {:?}", plan.because);
    }
    let same = behind("{ rgb = [1.5, 1.5, 1.5] }", PRISM, RGB, "{ lines = [[587.56, 9]] }", "");
    assert!(!same.method.basis.draws_wavelengths(), "{:?}", same.because);
}

#[test]
fn a_prism_out_of_sight_that_lamps_shine_through_is_noticed() {
    let view = view([0.0, 0.3, 3.0], [0.0, 0.0, 0.0], 30.0, 200);
    let plan = plan(&scene(&format!(
        "{view}[material.glass]\ndielectric = {{ index = \"N-SF11\" }}\n\
         [material.floor]\ndiffuse = {{ reflectance = 0.7 }}\n[material.lamp]\nemissive = {{ radiance = 10 }}\n\
         [[object]]\nshape.plane = {{ point = [0, -0.5, 0], normal = [0, 1, 0] }}\nmaterial = \"floor\"\n\
         [[object]]\n{PRISM}\nmaterial = \"glass\"\n[[object]]\nshape.sphere = {{ center = [0, 9, 0], radius = 1 }}\nmaterial = \"lamp\"\n"
    ).replace("degrees = 40 } }]", "degrees = 40 } }, { translate = [0, 2.5, 0] }]")));
    assert!(plan.method.basis.draws_wavelengths(), "{:?}", plan.because);
}

#[test]
fn a_drop_out_of_sight_that_throws_a_rainbow_is_noticed() {
    // The sun shines from behind the screen, which has a hole as wide as the drop.
    let screen = |center: &str, half: &str| {
        format!(
            "[[object]]\nshape.quad = {{ center = {center}, u = [{half}, 0, 0], v = [0, 5, 0] }}\nmaterial = \"wall\"\n"
        )
    };
    let scene = scene(&format!(
        "{}[material]\nwater.dielectric.index = \"water\"\nwall.diffuse.reflectance = 0.8\n\
         [[object]]\nshape.sphere = {{ center = [0, 0, 0], radius = 1 }}\nmaterial = \"water\"\n{}{}\
         [[light]]\nsun = {{ toward = [0, 0, 1], irradiance = 100 }}\n",
        view([3.5, 0.5, -2.0], [5.0, 0.5, 6.0], 30.0, 200),
        screen("[6.5, 0, 6]", "5.4"),
        screen("[-6.5, 0, 6]", "5.4"),
    ));
    let plan = plan(&scene);
    assert!(plan.method.basis.draws_wavelengths(), "{:?}", plan.because);
}

#[test]
fn measured_colors_get_as_many_lanes_as_the_tolerance_asks() {
    let lanes = |error: &str| {
        let plan = behind("1.5", BALL, "\"orange\"", "{ illuminant = \"FL11\" }", error);
        plan.method.basis.fixed_lanes()
    };
    let found = ["error = 0.5", "error = 0.03", "error = 0.003"].map(lanes);
    assert!(found[0] <= found[1] && found[1] < found[2], "{found:?}");
    assert_eq!(found[0], 3, "half of everything may be missed");
}

/// Plans a film with an index and a thickness in nm under a uniform sky. Its colors may be off by a thousandth at most.
fn film(index: f64, nm: u32, keys: &str) -> Plan {
    let view = view([0.0, 0.0, 6.0], [0.0, 0.0, 0.0], 30.0, 16);
    plan(&scene(&format!(
        "{view}{keys}\n[render]\nerror = 0.003\n[material.soap]\nthin = {{ index = {index}, thickness_nm = {nm} }}\n\
         [[object]]\nshape.sphere = {{ center = [0, 0, 0], radius = 1 }}\nmaterial = \"soap\"\n\
         [[light]]\nenvironment = {{ radiance = 1 }}\n"
    )))
}

#[test]
fn where_no_number_of_lanes_is_enough_those_that_miss_least_are_taken() {
    let mut lanes = Vec::new();
    for (index, nm) in [(1.33, 3000), (1.33, 5200), (2.4, 4800)] {
        let plan = film(index, nm, "");
        let least = plan.candidates.iter().map(|candidate| candidate.bound()).fold(f64::INFINITY, f64::min);
        assert!(least > 0.001 && plan.model_error == least, "{nm} nm: {:?}", plan.because);
        let statement = if plan.method.basis.lanes() == 32 {
            "the most lanes available"
        } else {
            "more lanes would be no more accurate"
        };
        let statement = format!("{statement}; some color may be off by more than is tolerated");
        assert!(plan.because.iter().any(|line| line.ends_with(&statement)), "{nm} nm: {:?}", plan.because);
        lanes.push(plan.method.basis.lanes());
    }
    assert!(lanes[0] == 32 && lanes[1] < 32 && lanes[2] < 32, "{lanes:?}");
}

#[test]
fn where_spectra_are_requested_the_error_of_colors_is_still_reported() {
    let statement = |nm: u32| {
        let because = film(1.33, nm, "spectral = true").because;
        let line = because.iter().find(|line| line.starts_with("model bands 32: ")).expect("it is told").clone();
        line.split_once("the most lanes available, for the spectra").expect("spectra are asked for").1.to_owned()
    };
    assert_eq!([3000, 100].map(statement), ["; some color may be off by more than is tolerated", ""]);
}

#[test]
fn every_line_of_a_lamp_has_a_lane_of_its_own() {
    let sodium = "{ lines = [[589.0, 2], [589.6, 1]] }";
    let plan = behind("1.5", BALL, "\"orange\"", sodium, "model = { bands = 12 }");
    assert_eq!(plan.method.basis.wavelengths_nm()[12..], [589.0, 589.6]);
    let many: Vec<String> = (0..40).map(|i| format!("[{}, 1]", 400 + 7 * i)).collect();
    let plan = behind("\"N-BK7\"", BALL, "\"orange\"", &format!("{{ lines = [{}] }}", many.join(", ")), "");
    assert!(plan.method.basis.lanes() <= 32);
}

#[test]
fn what_the_scene_asks_for_is_done() {
    for (model, name) in [("\"rgb\"", "rgb"), ("{ bands = 16 }", "bands 16"), ("\"hero\"", "hero 12 + 4")] {
        let plan = behind("1.5", BALL, RGB, "10", &format!("model = {model}"));
        assert_eq!(plan.method.basis.name(), name);
        assert!(plan.because.iter().any(|line| line.contains("asks for it")), "{:?}", plan.because);
    }
}

/// Otherwise, an animation whose seed is its frame would change its colors from frame to frame.
#[test]
fn the_seed_decides_nothing() {
    let text = view([0.0, 1.5, 6.0], [0.0, 0.7, 0.0], 35.0, 48)
        + "[material.gold]\nconductor = { metal = \"Au\", roughness = 0.25 }\n\
           [material.glass]\ndielectric = { index = \"N-BK7\" }\n\
           [[object]]\nshape.sphere = { center = [-1.2, 1, 0], radius = 1 }\nmaterial = \"gold\"\n\
           [[object]]\nshape.sphere = { center = [1.2, 1, 0], radius = 1 }\nmaterial = \"glass\"\n\
           [[light]]\nenvironment = { radiance = { illuminant = \"FL11\" } }\n";
    let decided = |seed: u64| {
        let mut scene = scene(&text);
        scene.render.seed = seed;
        let plan = plan(&scene);
        assert_eq!(plan.method.seed, seed);
        (abbe::trace::Method { seed: 0, ..plan.method }, plan.model_error)
    };
    let first = decided(0);
    (1..5).for_each(|seed| assert_eq!(decided(seed), first, "seed {seed}"));
}

/// Where the camera sees the lamp or the sky, light reaches it straight, without being scattered.
#[test]
fn lamps_and_skies_that_the_camera_does_not_see_are_not_seen_through_holes_and_panes_either() {
    let view = view([0.0, 0.0, 6.0], [0.0, 0.0, 0.0], 30.0, 64);
    let lamp = "[[object]]\nshape.quad = { center = [0, 0, 0], u = [9, 0, 0], v = [0, 9, 0] }\nmaterial = \"gray\"\n\
                [[object]]\nshape.sphere = { center = [0, 0, 2], radius = 0.5 }\nmaterial = \"lamp\"\n";
    let sky = "[[light]]\nenvironment = { radiance = 1 }\n";
    for (sheet, shines) in [("holes", lamp), ("pane", lamp), ("holes", sky)] {
        for is_hidden in [false, true] {
            let hidden = if is_hidden { "visible_to_camera = false\n" } else { "" };
            let scene = scene(&format!(
                "{view}\n[material]\ngray.diffuse.reflectance = 0.5\nlamp.emissive.radiance = 1\n\
                 pane.thin.index = 1.5\nholes.mask = {{ material = \"gray\", opacity = 0 }}\n\
                 [[object]]\nshape.quad = {{ center = [0, 0, 4], u = [9, 0, 0], v = [0, 9, 0] }}\n\
                 material = \"{sheet}\"\n{shines}{hidden}"
            ));
            let basis = Basis::wavelengths(scene.film.color_space, ROUTES_NM.into(), &[]);
            let method = Method::of_paths(basis, Transport::Random { split: 1.0, roulette: 0.0 }, 1);
            let found = routes(&World::new(&scene, method)).concat();
            let [straight, lit] = [0, 1].map(|least| found.iter().any(|route| route.scattered.min(1) == least));
            assert_eq!([straight, lit], [!is_hidden, shines == lamp], "{sheet} before {shines}{hidden}");
        }
    }
}

#[test]
fn an_error_of_one_is_explained_as_100_percent() {
    for (error, is_told) in [("1", true), ("0.01", false)] {
        let plan = behind("1.5", BALL, RGB, "10", &format!("error = {error}"));
        let hints = plan.because.concat().contains("at most 100 % (0.01 asks for 1 %) in 95 of 100 renders");
        assert_eq!(hints, is_told, "{:?}", plan.because);
    }
}

#[test]
fn routes_are_no_longer_than_paths() {
    let view = view([0.0, 0.0, 6.0], [0.0, 0.0, 0.0], 30.0, 64);
    let scene = scene(&format!(
        "{view}\n[material]\ngray.diffuse.reflectance = 0.5\nlamp.emissive.radiance = 1\npane.thin.index = 1.5\n\
         glass.dielectric.index = 1.5\n\
         [[object]]\nshape.quad = {{ center = [0, 0, 4], u = [9, 0, 0], v = [0, 9, 0] }}\nmaterial = \"pane\"\n\
         [[object]]\nshape.sphere = {{ center = [0, 0, 1], radius = 1 }}\nmaterial = \"glass\"\n\
         [[object]]\nshape.quad = {{ center = [0, 0, -2], u = [9, 0, 0], v = [0, 9, 0] }}\nmaterial = \"gray\"\n\
         [[object]]\nshape.sphere = {{ center = [0, 1, 2], radius = 0.3 }}\nmaterial = \"lamp\"\n"
    ));
    for max_bounces in [0, 1, 2, 3, 4] {
        let basis = Basis::wavelengths(scene.film.color_space, ROUTES_NM.into(), &[]);
        let method = Method::of_paths(basis, Transport::Random { split: 1.0, roulette: 0.0 }, 1);
        let found = routes(&World::new(&scene, Method { max_bounces, ..method })).concat();
        let is_pane = |step: &Step| scene.materials[step.material as usize].name == "pane";
        let counts = |step: &&Step| {
            !(matches!(step.way, RouteEvent::Inside(_)) || is_pane(step) && step.way == RouteEvent::Crossed)
        };
        let surfaces = |route: &Route| route.steps.iter().filter(counts).count();
        let longest = found.iter().map(surfaces).max();
        assert_eq!(longest, Some(max_bounces as usize), "{} routes", found.len());
    }
}

/// With `diffuse_bounces` of 0, light that leaves matte surfaces only reaches the camera.
#[test]
fn the_surface_is_named_that_leaves_light_to_chance() {
    for (render, name) in [("", "object 1"), ("diffuse_bounces = 0", "object 2")] {
        let view = view([0.0, 1.0, 6.0], [0.0, 1.0, 0.0], 40.0, 8);
        let plan = plan(&scene(&format!(
            "{view}\n[render]\n{render}\n[material.floor]\ndiffuse = {{ reflectance = 0.5 }}\n\
             [material.metal]\nconductor = {{ metal = \"Au\", roughness = 0.3 }}\n\
             [[object]]\nshape.plane = {{ point = [0, 0, 0], normal = [0, 1, 0] }}\nmaterial = \"floor\"\n\
             [[object]]\nshape.sphere = {{ center = [0, 1, 0], radius = 1 }}\nmaterial = \"metal\"\n\
             [[light]]\npoint = {{ position = [3, 3, 3], intensity = 9 }}\n"
        )));
        let says = format!("transport random: light leaves {name} in every direction");
        assert!(plan.because.iter().any(|line| line.starts_with(&says)), "{:?}", plan.because);
    }
}

#[test]
fn a_black_wall_leaves_nothing_to_chance() {
    let behind = |black: &str| {
        let plan = plan(&scene(&format!(
            "{}filter = \"center\"\n[material]\nfilm.thin = {{ index = 1.33, thickness_nm = 400 }}\nblack.diffuse = {black}\n\
             [[object]]\nshape.quad = {{ center = [0, 0, 0], u = [1, 0, 0], v = [0, 1, 0] }}\nmaterial = \"film\"\n\
             [[object]]\nshape.quad = {{ center = [0, 0, -1], u = [3, 0, 0], v = [0, 3, 0] }}\nmaterial = \"black\"\n\
             [[light]]\nenvironment.radiance = 1\n",
            view([0.0, 0.0, 5.0], [0.0, 0.0, 0.0], 20.0, 20)
        )));
        (matches!(plan.method.transport, Transport::Deterministic { .. }), plan.method.samples)
    };
    assert_eq!(behind("{ reflectance = 0 }"), (true, 1));
    assert_eq!(behind("{ reflectance = { rgb = [0, 0, 0] } }"), (true, 1));
    assert_eq!(behind("{ reflectance = 0.01 }"), (false, 256));
    let dye = "absorption = { samples = [[300, 1], [400, 1], [450, 0]] }, emission = { samples = [[450, 0], [500, 1], [550, 0]] }";
    let dyed = format!("{{ reflectance = 0, fluorescence = {{ {dye}, quantum_yield = 0.9 }} }}");
    assert!(!behind(&dyed).0);
}

#[test]
fn a_mask_without_holes_leaves_nothing_to_chance_beside_a_holdout() {
    let view = view([0.0, 1.0, 6.0], [0.0, 1.0, 0.0], 40.0, 8).replace("[film]", "[film]\nfilter = \"center\"");
    let scene = |opacity: &str, render: &str| {
        scene(&format!(
            "{view}\n[render]\ndiffuse_bounces = 0\n{render}\n[material]\nfloor.diffuse.reflectance = 0.5\n\
             leaf.mask = {{ material = \"floor\", opacity = {opacity} }}\n\
             [[object]]\nshape.plane = {{ point = [0, 0, 0], normal = [0, 1, 0] }}\nmaterial = \"floor\"\nholdout = true\n\
             [[object]]\nshape.sphere = {{ center = [0, 1, 0], radius = 1 }}\nmaterial = \"leaf\"\n\
             [[light]]\npoint = {{ position = [3, 3, 3], intensity = 9 }}\n"
        ))
    };
    for (opacity, says) in
        [("1", "deterministic"), ("1.0", "deterministic"), ("0.9", "random"), ("{ rgb = [1, 1, 0] }", "random")]
    {
        assert_eq!(plan(&scene(opacity, "")).method.transport.name(), says, "{opacity}");
    }
    for (render, more) in [("", false), ("samples = 1", false), ("samples = 8", true), ("error = 0.01", true)] {
        let because = plan(&scene("1", render)).because.concat();
        assert_eq!(because.contains("and more samples repeat it, so samples = 1 is enough"), more, "{render}");
    }
}

#[test]
fn a_color_that_is_missed_entirely_is_reported_without_a_number() {
    let copper = "[material]\ncopper.conductor = { metal = \"Cu\" }\nlamp.emissive.radiance.blackbody = 2800\n";
    let wall = |point: &str, normal: &str| {
        format!("[[object]]\nshape.plane = {{ point = {point}, normal = {normal} }}\nmaterial = \"copper\"\n")
    };
    let walls = wall("[0, 0, 0]", "[0, 1, 0]") + &wall("[0, 1, 0]", "[0, -1, 0]");
    let lamp =
        "[[object]]\nshape.quad = { center = [0, 0.5, -20], u = [9, 0, 0], v = [0, 0.5, 0] }\nmaterial = \"lamp\"\n";
    let view = view([0.0, 0.5, 0.0], [0.0, 0.5, -1.0], 140.0, 60);
    let plan = plan(&scene(&format!("{view}{copper}{walls}{lamp}")));
    let statement = plan.because.iter().find(|line| line.starts_with("colors are off")).expect("a bound");
    assert!(plan.candidates[0].bound() > 1.0, "{statement}");
    assert!(statement.contains("prefiltered by the light over 100 %, bands 8 "), "{statement}");
}

#[test]
fn polarization_that_is_left_out_is_reported_with_the_tolerance() {
    let view = view([0.0, 2.0, 6.0], [0.0, 0.0, 0.0], 30.0, 60);
    let plan = plan(&scene(&format!(
        "{view}[material]\nwhite.diffuse.reflectance = 0.7\nglass.dielectric.index = 1.5\n\
         [[object]]\nshape.plane = {{ point = [0, 0, 0], normal = [0, 1, 0] }}\nmaterial = \"white\"\n\
         [[object]]\nshape.sphere = {{ center = [0, 1, 0], radius = 0.2 }}\nmaterial = \"glass\"\n\
         [[light]]\nenvironment.radiance = 1\n"
    )));
    let statement =
        plan.left_out.iter().find(|line| line.starts_with("left out: polarization")).expect("it is left out");
    assert!(statement.ends_with("% of the light seen, within the 1.0 % that is tolerated"), "{statement}");
}

#[test]
fn of_many_materials_the_first_are_named_and_the_others_counted() {
    let named_materials = |count: usize| {
        let glass = |i: usize| {
            let shape = format!("sphere = {{ center = [{i}, 0, 0], radius = 0.4 }}");
            body(&format!("glass{i}"), "dielectric.index = 1.5", &[&shape])
        };
        let text = view([0.0, 0.0, 60.0], [0.0, 0.0, 0.0], 40.0, 4) + &environment(1.0);
        let because = plan(&scene(&(text + &(0..count).map(glass).collect::<String>()))).because;
        let about = |line: &String| line.contains("material");
        because.into_iter().filter(about).collect::<Vec<_>>()
    };
    let line = |i: usize| format!("material glass{i}: index 1.5000 in every lane, so lanes stay together");
    assert_eq!(named_materials(20), (0..20).map(line).collect::<Vec<_>>());
    for (count, more) in [(21, "1 more material is"), (30, "10 more materials are")] {
        let named_materials = named_materials(count);
        assert_eq!(named_materials[..20], (0..20).map(line).collect::<Vec<_>>());
        assert!(named_materials.len() == 21 && named_materials[20].starts_with(more), "{named_materials:?}");
    }
}
