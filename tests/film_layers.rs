//! Layers beside the image: their contents, their sum, and that they change nothing in the image.

mod edges;
mod files;
mod hidden;
mod lobes;
mod mattes;
mod mitchell;
mod overscan;
mod polarization;
mod residual;

use abbe::film::{Film, FirstSurface, Layer, Window, id};
use abbe::plan::plan;
use abbe::{Image, Options, Scene};

use crate::support::larger::larger;
use crate::support::scenes::{films_of, mean_and_variance, render_text_with};

/// Dispersive glass, a mirror, a pane, rough metal and a coated ball on a floor, lit by a lamp, a sky and a spot.
/// Photons are splatted and gathered, and lanes part.
const ROOM: &str = r#"
camera = { position = [0, 1.6, 6], look_at = [0, 0.7, 0], vertical_fov = 38 }
film = { width = 40, height = 28 }
render = { samples = 8, seed = 5 }
[material]
floor.diffuse.reflectance = { rgb = [0.7, 0.5, 0.3] }
glass.dielectric.index = "N-SF11"
silver.mirror.reflectance = 0.9
gold.conductor = { metal = "Au", roughness = 0.3 }
coated.plastic = { reflectance = 0.4, roughness = 0.2 }
window.thin.index = 1.5
lamp.emissive.radiance = 40
[[object]]
name = "floor"
shape.plane = { point = [0, 0, 0], normal = [0, 1, 0] }
material = "floor"
[[object]]
shape.sphere = { center = [0.2, 0.8, 0.6], radius = 0.8 }
material = "glass"
[[object]]
shape.quad = { center = [-2, 1, -1], u = [0.5, 0, 0.5], v = [0, 1, 0] }
material = "silver"
[[object]]
shape.cube = { center = [1.9, 0.5, -0.4], size = 1 }
material = "gold"
[[object]]
shape.sphere = { center = [-1.1, 0.4, 1.2], radius = 0.4 }
material = "coated"
[[object]]
shape.quad = { center = [1.6, 0.6, 1.6], u = [0.4, 0, 0.1], v = [0, 0.6, 0] }
material = "window"
[[object]]
name = "key lamp"
shape.sphere = { center = [-1, 2.3, -1], radius = 0.15 }
material = "lamp"
[[light]]
environment.radiance = 0.2
[[light]]
name = "rim"
spot = { position = [3, 3, -2], look_at = [0.2, 0.8, 0.6], cone_angle = 30, intensity = 8 }
"#;

/// Two renders with two samples differ even in pixels where both samples of each render agree.
#[test]
fn too_few_samples_give_no_variance_and_a_warning() {
    let reported = |layers: &[Layer], samples: u32| {
        let options = Options { layers: Some(layers.to_vec()), samples: Some(samples), ..Options::default() };
        render_text_with(ROOM, &options).warnings()
    };
    assert_eq!(
        reported(&[Layer::Variance, Layer::HalfA, Layer::Normal], 3),
        ["variance, half_a show the noise only with 4 or more samples per pixel, not with 3"]
    );
    assert_eq!(
        reported(&[Layer::HalfB], 1),
        ["half_b shows the noise only with 4 or more samples per pixel, not with 1"]
    );
    assert!(reported(&[Layer::Variance, Layer::HalfB], 4).is_empty() && reported(&[Layer::Samples], 1).is_empty());
}

fn render_text(text: &str, layers: &[Layer]) -> Image {
    render_text_with(text, &Options { layers: Some(layers.to_vec()), threads: Some(1), ..Options::default() })
}

/// Returns the RGB channels of a layer of light, pixel by pixel.
fn rgb(image: &Image, layer: &str) -> Vec<[f64; 3]> {
    let [red, green, blue] = ["R", "G", "B"].map(|channel| {
        let values = image.layer(&format!("{layer}.{channel}"));
        values.unwrap_or_else(|| panic!("there is no layer {layer}"))
    });
    (0..red.len()).map(|i| [red[i], green[i], blue[i]].map(f64::from)).collect()
}

fn beauty(image: &Image) -> Vec<[f64; 3]> {
    image.rgb().into_iter().map(|rgb| rgb.map(f64::from)).collect()
}

/// Asserts that layers, weighted by `share`, sum to the image within the precision of 32 bits relative to their size.
fn assert_sum(image: &Image, layers: &[&str], share: f64) {
    let parts: Vec<_> = layers.iter().map(|layer| rgb(image, layer)).collect();
    for (pixel, expected) in beauty(image).into_iter().enumerate() {
        for channel in 0..3 {
            let values = || parts.iter().map(|part| share * part[pixel][channel]);
            let size = values().map(f64::abs).sum::<f64>() + expected[channel].abs();
            let off = (values().sum::<f64>() - expected[channel]).abs();
            assert!(off <= 4.0 * f64::from(f32::EPSILON) * size, "{layers:?}: pixel {pixel}, channel {channel}: {off}");
        }
    }
}

/// A body hidden from the camera absorbs no light on the way to the camera, wherever the camera is.
#[test]
fn a_camera_within_a_hidden_body_sees_as_if_that_were_not_there() {
    let floor = "[camera]\nposition = [0, 9, 0]\nlook_at = [0, 0, 0]\nup = [1, 0, 0]\nvertical_fov = 20\n[film]\nwidth = 4\nheight = 4\n\
        [material.floor]\ndiffuse = { reflectance = 0.5 }\n[[object]]\nmaterial = \"floor\"\n\
        shape.plane = { point = [0, 0, 0], normal = [0, 1, 0] }\n[[light]]\nenvironment = { radiance = 1 }\n";
    let body = "[material.body]\ndielectric = { index = 1, absorption = 3 }\n[[object]]\nmaterial = \"body\"\n\
        shape.sphere = { center = [0, 9, 0], radius = 0.5 }\nvisible_to_camera = false\n";
    let colors = beauty(&render_text(&(floor.to_owned() + body), &[]));
    let shown = colors.iter().map(|color| color[1]).sum::<f64>() / colors.len() as f64;
    // The body blocks at most this fraction of the light that reaches the floor. Random paths may hit it a few times
    // more often.
    let covered = (0.5 / 8.5_f64).powi(2);
    assert!((0.5 * (1.0 - 4.0 * covered)..=0.5 + 1e-6).contains(&shown), "{shown}");
}

#[test]
fn layers_of_light_add_up_to_the_image() {
    let image = render_text(ROOM, &Layer::all());
    assert_sum(&image, &["emission", "background", "direct", "indirect"], 1.0);
    let lobes = ["diffuse", "glossy", "specular", "transmission"];
    let split = lobes.map(|lobe| [format!("{lobe}_direct"), format!("{lobe}_indirect")]);
    let split: Vec<&str> = split.as_flattened().iter().map(String::as_str).collect();
    assert_sum(&image, &[&["emission", "background"], split.as_slice()].concat(), 1.0);
    assert_sum(&image, &["light_key_lamp", "light_environment", "light_rim"], 1.0);
    assert_sum(&image, &["half_a", "half_b"], 0.5);
    let total = |layer: &str| rgb(&image, layer).iter().flatten().sum::<f64>();
    // Nothing here lies behind only one surface.
    for layer in split.into_iter().filter(|layer| *layer != "transmission_direct") {
        assert!(total(layer) > 0.0, "nothing in {layer}");
    }
    for layer in ["emission", "background", "direct", "indirect", "caustics", "dispersed", "light_rim"] {
        assert!(total(layer) > 0.0, "nothing in {layer}");
    }
    assert!(total("caustics") < total("indirect") && total("dispersed") < total("indirect") + total("direct"));
}

#[test]
fn layers_change_no_bit_of_the_image() {
    let (plain, layered) = (render_text(ROOM, &[]), render_text(ROOM, &Layer::all()));
    for channel in ["R", "G", "B", "A", "Z"] {
        assert!(plain.layer(channel) == layered.layer(channel), "{channel}");
    }
    assert_eq!(plain.film().layers.len(), 0);
}

#[test]
fn a_light_of_its_own_layer_is_the_image_that_it_makes_alone() {
    let room = |lights: &str| {
        format!(
            "camera = {{ position = [0, 1, 4], look_at = [0, 0.5, 0], vertical_fov = 40 }}\n\
             film = {{ width = 24, height = 16 }}\nrender = {{ samples = 16, diffuse_bounces = 0 }}\n\
             material.white.diffuse.reflectance = 0.8\n\
             object = [{{ shape.plane = {{ point = [0, 0, 0], normal = [0, 1, 0] }}, material = \"white\" }}]\n{lights}"
        )
    };
    let (point, late) = (
        "[[light]]\npoint = { position = [0, 2, 0], intensity = 3 }\n",
        "[[light]]\nname = \"late light\"\npoint = { position = [1, 1, 1], intensity = 2 }\n",
    );
    let both = render_text(&room(&format!("{point}{late}")), &[Layer::Lights]);
    for (layer, light) in [("light_point", point), ("light_late_light", late)] {
        let alone = render_text(&room(light), &[]);
        let pairs = rgb(&both, layer).into_iter().zip(beauty(&alone));
        for (pixel, (part, whole)) in pairs.enumerate() {
            let near = (0..3).all(|i| (part[i] - whole[i]).abs() <= 1e-6 + 1e-5 * whole[i]);
            assert!(near, "{layer}, pixel {pixel}: {part:?} is not {whole:?}");
        }
    }
}

/// A coat reflects the same whatever lies below it. A base scatters the same in every pixel as it does alone.
#[test]
fn lobes_of_one_surface_are_told_apart_to_the_last_digits() {
    let lit_layer = |materials: &str, layer: Layer| {
        let text = BALL
            .replace(
                "material.clay.diffuse.reflectance = { rgb = [0.2, 0.5, 0.8] }",
                &format!("[material]\n{materials}"),
            )
            .replace("environment.radiance = 1", "point = { position = [3, 2, 4], intensity = 30 }")
            .replace("render =", "render.model = \"rgb\"\nrender.seed = 1\n#");
        let image = render_text(&text, &[layer]);
        rgb(&image, layer.name())
    };
    let same = |[a, b]: [Vec<[f64; 3]>; 2], what: &str| {
        assert!(a.as_flattened().iter().sum::<f64>() > 1.0, "{what}");
        for (a, b) in a.as_flattened().iter().zip(b.as_flattened()) {
            assert!((a - b).abs() <= 1e-6 + 2e-6 * b.abs(), "{what}: {a} is not {b}");
        }
    };
    let coated = "clay.plastic = { reflectance = { rgb = [0.2, 0.5, 0.8] }, roughness = 0.3 }";
    let coat = "clay.plastic = { reflectance = 0, roughness = 0.3 }";
    same([lit_layer(coated, Layer::GlossyDirect), lit_layer(coat, Layer::Direct)], "the coat");
    let mixed = "clay.mix = { materials = [\"chalk\", \"gold\"], amount = 0.25 }\nchalk.diffuse.reflectance = 0.8\n\
                 gold.conductor = { metal = \"Au\", roughness = 0.3 }";
    let chalk = "clay.diffuse.reflectance = 0.6";
    let gold = "clay.mix = { materials = [\"gold\", \"soot\"], amount = 0.75 }\nsoot.diffuse.reflectance = 0\n\
                gold.conductor = { metal = \"Au\", roughness = 0.3 }";
    same([lit_layer(mixed, Layer::DiffuseDirect), lit_layer(chalk, Layer::Direct)], "the chalk");
    same([lit_layer(mixed, Layer::GlossyDirect), lit_layer(gold, Layer::Direct)], "the gold");
}

#[test]
fn lights_of_one_group_share_a_layer() {
    let text = ROOM.replace("name = \"key lamp\"", "group = \"warm\"").replace("name = \"rim\"", "group = \"warm\"");
    let image = render_text(&text, &[Layer::Lights]);
    let names: Vec<_> = image.film().layers.iter().map(|layer| layer.name.as_str()).collect();
    assert_eq!(names, ["light_warm", "light_environment"]);
    assert_sum(&image, &names, 1.0);
}

#[test]
fn layers_that_would_fill_all_memory_are_refused() {
    let huge = ROOM.replace("width = 40, height = 28", "width = 16384, height = 16384");
    let mut scene = Scene::parse(&huge, "").expect("the scene is valid");
    let options = Options { layers: Some(Layer::all()), ..Options::default() };
    let error = options.apply(&mut scene).expect_err("it is refused").to_string();
    assert!(error.contains("channels of layers would take") && error.contains("GB of memory"), "{error}");
    let crop = Some(Window { left: 0, top: 0, width: 64, height: 64 });
    let mut scene = Scene::parse(&huge, "").expect("the scene is valid");
    assert!(Options { crop, ..options }.apply(&mut scene).is_ok());
}

#[test]
fn names_of_lights_that_no_file_can_tell_apart_are_refused() {
    for (from, to, reported) in [
        ("\"key lamp\"", "\"a lamp with quite a long name\"", "is too long for some programs"),
        ("\"rim\"", "\"key-lamp\"", "the lights key lamp and key-lamp would share the layer light_key_lamp"),
    ] {
        let scene = Scene::parse(&ROOM.replace(from, to), "").expect("the scene is valid");
        let options = Options { layers: Some(vec![Layer::Lights]), ..Options::default() };
        let error = abbe::render(&scene, &options).expect_err("the names are refused");
        assert!(error.to_string().contains(reported), "{error}");
        assert!(abbe::render(&scene, &Options { samples: Some(1), ..Options::default() }).is_ok());
    }
}

/// A single ball that is fully in view.
const BALL: &str = r#"
camera = { position = [0, 0, 4], look_at = [0, 0, 0], vertical_fov = 40 }
film = { width = 33, height = 33, filter = "center" }
render = { samples = 4 }
material.clay.diffuse.reflectance = { rgb = [0.2, 0.5, 0.8] }
[[object]]
shape.sphere = { center = [0, 0, 0], radius = 1 }
material = "clay"
[[light]]
environment.radiance = 1
"#;

#[test]
fn surfaces_are_those_that_the_camera_meets() {
    let image = render_text(BALL, &[Layer::Position, Layer::Normal, Layer::GeometricNormal, Layer::Albedo, Layer::Uv]);
    let layer = |name: &str| image.layer(name).unwrap_or_else(|| panic!("there is no {name}"));
    let [position, normal, flat] =
        ["P", "N", "Nd"].map(|name| ["X", "Y", "Z"].map(|axis| layer(&format!("{name}.{axis}"))));
    let (alpha, depth) = (layer("A"), layer("Z"));
    let mut hits = 0;
    for pixel in 0..33 * 33 {
        let at = |of: &[Vec<f32>; 3]| [0, 1, 2].map(|axis| f64::from(of[axis][pixel]));
        let (p, n) = (at(&position), at(&normal));
        if alpha[pixel] == 0.0 {
            assert_eq!((p, n), ([0.0; 3], [0.0; 3]), "pixel {pixel} is empty");
            continue;
        }
        hits += 1;
        // A point on the unit ball about the origin equals its own normal.
        assert!((0..3).all(|i| (p[i] - n[i]).abs() < 1e-6), "pixel {pixel}: {p:?} and {n:?}");
        assert_eq!(n, at(&flat));
        assert!((p.iter().map(|x| x * x).sum::<f64>() - 1.0).abs() < 1e-6 && n[2] > 0.0);
        assert!((f64::from(depth[pixel]) - (4.0 - p[2])).abs() < 1e-6);
        let albedo = rgb(&image, "albedo")[pixel];
        assert!((0..3).all(|i| (albedo[i] - [0.2, 0.5, 0.8][i]).abs() < 1e-6), "{albedo:?}");
        let uv = ["UV.U", "UV.V"].map(|name| layer(name)[pixel]);
        assert!(uv.iter().all(|x| (0.0..=1.0).contains(x)), "{uv:?}");
    }
    assert!(hits > 300);
}

#[test]
fn albedo_of_metal_and_glass_is_what_they_send_back() {
    let of = |material: &str| {
        let text =
            BALL.replace("diffuse.reflectance = { rgb = [0.2, 0.5, 0.8] }", material).replace("= 4 }\n", "= 256 }\n");
        let image = render_text(&text, &[Layer::Albedo]);
        rgb(&image, "albedo")[16 * 33 + 16]
    };
    // Glass reflects or transmits all light that hits it. A mirror reflects its reflectance.
    for (material, expected) in [
        ("dielectric.index = 1.5", [1.0; 3]),
        ("dielectric.index = \"N-SF11\"", [1.0; 3]),
        ("thin.index = 1.5", [1.0; 3]),
        ("mirror.reflectance = { rgb = [0.9, 0.6, 0.3] }", [0.9, 0.6, 0.3]),
    ] {
        let albedo = of(material);
        assert!((0..3).all(|i| (albedo[i] - expected[i]).abs() < 2e-3), "{material}: {albedo:?}");
    }
    // Gold at normal incidence: n and k of the catalog give 0.9 in red and 0.3 in blue.
    let gold = of("conductor = { metal = \"Au\", roughness = 0.1 }");
    assert!(gold[0] > 0.85 && gold[2] < 0.5, "{gold:?}");
}

#[test]
fn what_is_seen_in_a_mirror_is_the_first_surface_if_asked_for() {
    let text = "camera = { position = [0, 0, 4], look_at = [0, 0, 0], vertical_fov = 10 }\n\
                film = { width = 8, height = 8, first = \"visible\", layers = [\"N\", \"albedo\", \"P\"] }\n\
                render.samples = 4\n[material]\nsilver.mirror.reflectance = 0.5\n\
                wall.diffuse.reflectance = { rgb = [0.8, 0.4, 0.2] }\n\
                [[object]]\nshape.quad = { center = [0, 0, 0], u = [1, 0, 1], v = [0, 1, 0] }\nmaterial = \"silver\"\n\
                [[object]]\nshape.plane = { point = [-3, 0, 0], normal = [1, 0, 0] }\nmaterial = \"wall\"\n\
                [[object]]\nshape.plane = { point = [3, 0, 0], normal = [-1, 0, 0] }\nmaterial = \"wall\"\n\
                [[light]]\nenvironment.radiance = 1\n";
    let scene = Scene::parse(text, "").expect("the scene is valid");
    assert_eq!(scene.format.first, FirstSurface::Visible);
    let image = abbe::render(&scene, &Options::default()).expect("it renders");
    let middle = 4 * 8 + 4;
    // The normal is weighted by the throughput that the mirror leaves.
    let normal = ["N.X", "N.Y", "N.Z"].map(|name| image.layer(name).expect("it was asked for")[middle]);
    assert!((normal[0].abs() - 0.5).abs() < 1e-6 && normal[1] == 0.0 && normal[2] == 0.0, "{normal:?}");
    let albedo = rgb(&image, "albedo")[middle];
    assert!((0..3).all(|i| (albedo[i] - [0.4, 0.2, 0.1][i]).abs() < 1e-6), "{albedo:?}");
    assert!((image.layer("P.X").expect("it was asked for")[middle].abs() - 3.0).abs() < 1e-6);
}

#[test]
fn a_hidden_sky_lights_the_scene_and_is_not_in_the_image() {
    let hidden = BALL.replace("[[light]]", "[[light]]\nvisible_to_camera = false");
    let (seen, hidden) = (render_text(BALL, &[]), render_text(&hidden, &[]));
    let alpha = seen.layer("A").expect("every image has it");
    assert_eq!(hidden.layer("A").as_ref(), Some(&alpha));
    for (pixel, ((alpha, seen), hidden)) in alpha.iter().zip(seen.rgb()).zip(hidden.rgb()).enumerate() {
        assert_eq!(hidden, if *alpha == 0.0 { [0.0; 3] } else { seen }, "pixel {pixel}");
    }
}

#[test]
fn a_hidden_object_is_not_in_the_image_but_in_its_light() {
    // A screen between the camera and the ball, which blocks some of the environment's light.
    let screen = "\n[[object]]\nvisible_to_camera = false\n\
                  shape.quad = { center = [0, 0, 2], u = [0.4, 0, 0], v = [0, 0.4, 0] }\nmaterial = \"clay\"\n";
    let (without, with) = (render_text(BALL, &[]), render_text(&format!("{BALL}{screen}"), &[]));
    for channel in ["A", "Z"] {
        assert_eq!(without.layer(channel), with.layer(channel), "{channel}");
    }
    let middle = |image: &Image| image.rgb_at(16, 16)[0];
    assert!(middle(&with) < 0.99 * middle(&without), "the screen takes light from the ball");
}

#[test]
fn a_holdout_cuts_a_hole_and_leaves_the_rest_alone() {
    let other = "\n[[object]]\nshape.sphere = { center = [0.5, 0, 1.2], radius = 0.3 }\nmaterial = \"clay\"\n";
    let plain = render_text(&format!("{BALL}{other}"), &[]);
    let cut = render_text(&format!("{BALL}{}", other.replace("shape.", "holdout = true\nshape.")), &[]);
    let behind = render_text(BALL, &[]);
    let (mut holes, mut same) = (0, 0);
    for pixel in 0..33 * 33 {
        let of = |image: &Image, channel: &str| image.layer(channel).expect("every image has it")[pixel];
        if of(&plain, "Z") == of(&behind, "Z") {
            same += 1;
            assert_eq!(cut.rgb()[pixel], plain.rgb()[pixel], "pixel {pixel}");
        } else {
            holes += 1;
            assert_eq!((cut.rgb()[pixel], of(&cut, "A"), of(&cut, "Z")), ([0.0; 3], 0.0, 1e10), "pixel {pixel}");
        }
    }
    assert!(holes > 20 && same > 800, "{holes} {same}");
}

/// Renders dark bodies on gray ground under a sky and a lamp, either as a plate or as the image that is composited over
/// it.
fn ball_on_ground(ball: bool, ground: &str, sky: &str, lamp: &str) -> Image {
    let ball = if ball {
        "[[object]]\nshape.sphere = { center = [0, 0.5, 0], radius = 0.5 }\nmaterial = \"dark\"\n\
         [[object]]\nshape.cube = { center = [1, 0.3, 0.5], size = 0.6 }\nmaterial = \"dark\"\n"
    } else {
        ""
    };
    let text = format!(
        "camera = {{ position = [0, 2, 5], look_at = [0, 0.3, 0], vertical_fov = 36 }}\n\
         film = {{ width = 32, height = 24 }}\nrender = {{ samples = 256 }}\n[material]\n\
         gray.diffuse.reflectance = 0.5\ndark.diffuse.reflectance = 0.05\nlamp.emissive.radiance = 60\n{ball}\
         [[object]]\n{ground}shape.plane = {{ point = [0, 0, 0], normal = [0, 1, 0] }}\nmaterial = \"gray\"\n\
         [[object]]\n{lamp}shape.sphere = {{ center = [2, 4, 1], radius = 0.5 }}\nmaterial = \"lamp\"\n\
         [[light]]\n{sky}environment.radiance = 0.5\n"
    );
    render_text(&text, &[Layer::Shadow])
}

#[test]
fn an_image_with_shadow_catcher_over_its_plate_is_the_whole_picture() {
    let whole = ball_on_ground(true, "", "", "");
    let plate = ball_on_ground(false, "", "", "");
    let over = ball_on_ground(true, "shadow_catcher = true\n", "visible_to_camera = false\n", "");
    let (alpha, shadow) = (over.layer("A").expect("every image has it"), rgb(&over, "shadow"));
    let (mut shaded, mut worst) = (0, 0.0_f64);
    // Blocks of 4 x 4 pixels have a fourth of a pixel's noise.
    for block in 0..8 * 6 {
        let pixels = (0..16).map(|i| (block / 8 * 4 + i / 4) * 32 + block % 8 * 4 + i % 4);
        let (mut composited, mut expected) = ([0.0; 3], [0.0; 3]);
        for pixel in pixels {
            let clear = 1.0 - f64::from(alpha[pixel]);
            let is_catcher = over.rgb()[pixel] == [0.0; 3];
            shaded += usize::from(is_catcher && alpha[pixel] > 0.3);
            for channel in 0..3 {
                composited[channel] += beauty(&over)[pixel][channel] + clear * beauty(&plate)[pixel][channel];
                expected[channel] += beauty(&whole)[pixel][channel];
            }
            assert!(!is_catcher || (0..3).all(|i| shadow[pixel][i] <= 1.0));
        }
        for channel in 0..3 {
            worst = larger(worst, (composited[channel] / expected[channel] - 1.0).abs());
        }
    }
    assert!(shaded > 8, "{shaded} pixels lie in the shadow");
    // The coverage does not include light that the bodies reflect onto the ground. It is about a hundredth for such
    // dark bodies.
    assert!(worst < 0.02, "a block is {worst:.4} off");
}

#[test]
fn a_shadow_catcher_on_which_nothing_stands_is_clear() {
    let over = ball_on_ground(false, "shadow_catcher = true\n", "visible_to_camera = false\n", "");
    assert!(over.layer("A").expect("every image has it").iter().all(|alpha| *alpha == 0.0));
    assert!(beauty(&over).iter().all(|rgb| *rgb == [0.0; 3]));
    assert!(rgb(&over, "shadow").iter().all(|rgb| *rgb == [0.0; 3]));
}

#[test]
fn mattes_cover_what_the_image_covers() {
    let text = ROOM.replace(
        "[[light]]\nenvironment",
        "[[object]]\nname = \"stones\"\nshape.cube = { center = [0, 0, 0], size = 0.3 }\nmaterial = \"floor\"\n\
         instances = [[{ translate = [-1.6, 0.2, 1.8] }], [{ translate = [-1.6, 0.2, 2.2] }]]\n\n[[light]]\nenvironment",
    );
    let mattes = [Layer::CryptoObject, Layer::CryptoMaterial, Layer::CryptoAsset];
    let image = render_text(&text, &mattes);
    let alpha = image.layer("A").expect("every image has it");
    let bits = |name: &str| id(name);
    let coverage = |matte: &str, id: u32, pixel: usize| -> f32 {
        let channels = |rank: usize, channel: &str| {
            image.layer(&format!("{matte}{rank:02}.{channel}")).expect("it was asked for")[pixel]
        };
        let of = |rank: usize| [["r", "g"], ["b", "a"]].map(|two| two.map(|channel| channels(rank, channel)));
        (0..3).flat_map(of).filter(|[number, _]| number.to_bits() == id).map(|[_, share]| share).sum()
    };
    let mut found = 0.0;
    for (pixel, alpha) in alpha.iter().enumerate() {
        for manifest in &image.film().manifests {
            let all: f32 = manifest.entries.iter().map(|(_, id)| coverage(&manifest.name, *id, pixel)).sum();
            assert!((all - alpha).abs() < 1e-6, "{}, pixel {pixel}: {all} of {alpha}", manifest.name);
        }
        let stones = coverage("CryptoAsset", bits("stones"), pixel);
        let each = ["stones [1]", "stones [2]"].map(|name| coverage("CryptoObject", bits(name), pixel));
        assert!((stones - each[0] - each[1]).abs() < 1e-6);
        let floor = coverage("CryptoObject", bits("floor"), pixel);
        assert!((coverage("CryptoMaterial", bits("floor"), pixel) - floor - stones).abs() < 1e-6);
        found += stones;
    }
    assert!(found > 5.0, "the stones cover {found} pixels");
}

/// The variance layer and the two halves agree with the variance over other seeds.
#[test]
fn variance_is_no_less_than_images_of_other_seeds_show() {
    let mut scene = Scene::parse(ROOM, "").expect("the scene is valid");
    scene.format.layers = vec![Layer::Variance, Layer::HalfA, Layer::HalfB];
    let method = plan(&scene).method;
    let films = films_of(&scene, &method, 0..24);
    let (mut reported, mut seen, mut halves) = (0.0, 0.0, 0.0);
    for pixel in 0..40 * 28 {
        for channel in 0..3 {
            let (mean, variance) =
                mean_and_variance(films.iter().map(|film| f64::from(film.pixels[pixel].rgb[channel])));
            let weight = 1.0 / (mean * mean + 0.01);
            seen += weight * variance;
            for film in &films {
                reported += weight * rgb_of(film, "variance", pixel, channel) / 24.0;
                let half_difference = rgb_of(film, "half_a", pixel, channel) - rgb_of(film, "half_b", pixel, channel);
                halves += weight * 0.25 * half_difference * half_difference / 24.0;
            }
        }
    }
    // Samples are distributed more evenly than independent ones, so their variance is an upper bound.
    assert!(reported >= 0.9 * seen && reported <= 6.0 * seen, "told {reported:.3}, seen {seen:.3}");
    assert!((0.5..2.0).contains(&(halves / seen)), "halves {halves:.3}, seen {seen:.3}");
}

fn rgb_of(film: &Film, name: &str, pixel: usize, channel: usize) -> f64 {
    let layer = film.layers.iter().find(|layer| layer.name == name).expect("it was asked for");
    f64::from(layer.values[3 * pixel + channel])
}
