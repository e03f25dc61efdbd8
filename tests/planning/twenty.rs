//! Twenty rooms with and without caustics.

/// A room, with the expected decision of the plan.
pub struct Room {
    pub name: &'static str,
    /// The objects on the floor and the lights.
    pub text: String,
    /// Whether a light pass lowers the time to an error, as measured by `cargo bench --bench rooms`.
    pub asks: bool,
    /// Words that the plan must state.
    pub words: &'static str,
}

const CAMERA: &str =
    "[camera]\nposition = [0, 2.2, 5]\nlook_at = [0, 0.5, 0]\nvertical_fov = 40\n[film]\nwidth = 48\nheight = 36\n";
const MATERIALS: &str = "[material.white]\ndiffuse = { reflectance = 0.7 }\n[material.black]\ndiffuse = { reflectance = 0 }\n\
    [material.lamp]\nemissive = { radiance = 5 }\n\
    [material.glass]\ndielectric = { index = 1.5 }\n[material.water]\ndielectric = { index = 1.33, priority = 1 }\n\
    [material.flint]\ndielectric = { index = \"N-SF11\" }\n\
    [material.frosted]\ndielectric = { index = 1.5, roughness = 0.5 }\n[material.pane]\nthin = { index = 1.5 }\n\
    [material.mirror]\nmirror = { reflectance = 0.9 }\n[material.silver]\nconductor = { metal = \"Ag\" }\n\
    [material.brushed]\nconductor = { metal = \"Ag\", roughness = 0.4 }\n";
const BALL: &str = "sphere = { center = [0, 0.8, 0], radius = 0.5 }";
const POINT: &str = "[[light]]\npoint = { position = [1, 3, 0], intensity = 3 }\n";
const SUN: &str = "[[light]]\nsun = { toward = [1, 2, 0.3], irradiance = 1 }\n";
const SKY: &str = "[[light]]\nenvironment = { radiance = 0.3 }\n";
const PRISM: &str = "mesh = { points = [[-0.6, 0.7, -0.6], [0.6, 0.7, -0.6], [0, 1.7, -0.6], [-0.6, 0.7, 0.6], [0.6, 0.7, 0.6], [0, 1.7, 0.6]], \
    faces = [[0, 2, 1], [3, 4, 5], [0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4], [2, 0, 3], [2, 3, 5]] }";

fn object(name: &str, material: &str, shape: &str) -> String {
    format!("[[object]]\nname = \"{name}\"\nmaterial = \"{material}\"\nshape.{shape}\n")
}

fn floor(material: &str) -> String {
    object("floor", material, "plane = { point = [0, 0, 0], normal = [0, 1, 0] }")
}

fn bulb(radius: f64) -> String {
    object("bulb", "lamp", &format!("sphere = {{ center = [-1, 3.5, 0], radius = {radius:?} }}"))
}

/// Returns all rooms, starting with those that gain from a light pass.
pub fn rooms() -> Vec<Room> {
    let ball = || object("ball", "glass", BALL);
    let floor_with = |material: &str, things: &[&str]| floor(material) + &things.concat();
    let mut rooms = Vec::new();
    let mut room = |name, things: String, asks, words| {
        rooms.push(Room { name, text: format!("{CAMERA}{MATERIALS}{things}"), asks, words });
    };
    room(
        "a glass ball under a point",
        floor_with("white", &[&ball(), POINT]),
        true,
        "photons from a point light toward ball",
    );
    room("a glass ball under a small lamp", floor_with("white", &[&ball(), &bulb(0.1)]), true, "photons from bulb");
    room("a glass ball in the sun", floor_with("white", &[&ball(), SUN]), true, "photons from the sun");
    let tilted = object("mirror", "mirror", "quad = { center = [-1, 0.7, 0], u = [0.2, 0.6, 0], v = [0, 0, 0.8] }");
    room("a tilted mirror in the sun", floor_with("white", &[&tilted, SUN]), true, "photons from the sun");
    let small = object("bulb", "lamp", "sphere = { center = [1, 2, 0], radius = 0.1 }");
    room("a tilted mirror that shows a small lamp", floor_with("white", &[&tilted, &small]), true, "photons from bulb");
    let spot =
        "[[light]]\nspot = { position = [-1.8, 0.1, 0], toward = [1.5, 1.05, 0], cone_angle = 8, intensity = 20 }\n";
    room(
        "a prism in the light of a spot",
        floor_with("white", &[&object("prism", "flint", PRISM), spot]),
        true,
        "photons from a spotlight",
    );
    let block = object("block", "silver", "cube = { center = [-0.5, 0.5, 0], size = [0.6, 1, 0.6] }");
    room(
        "a block of polished silver in the sun",
        floor_with("white", &[&block, SUN, SKY]),
        true,
        "photons from the sun",
    );
    // Light passes straight through a pane, so next-event estimation finds it. What the pane reflects goes up.
    let pane = object("pane", "pane", "quad = { center = [0, 1, 0], u = [0.8, 0, 0], v = [0, 0, 0.8] }");
    room(
        "a pane of window glass in the sun",
        floor_with("white", &[&pane, SUN, SKY]),
        false,
        "no caustic from the sun",
    );
    let glass = object("glass", "glass", "cube = { center = [0, 0.6, 0], size = [0.8, 1, 0.8] }")
        + &object("water", "water", "cube = { center = [0, 0.6, 0], size = [0.7, 0.8, 0.7] }");
    room("a vessel of water in the sun", floor_with("white", &[&glass, SUN, SKY]), true, "photons from the sun");
    room(
        "a glass ball under a lamp as wide as the ball",
        floor_with("white", &[&ball(), &bulb(0.5)]),
        true,
        "photons from bulb",
    );
    room(
        "a glass ball on brushed metal under a point",
        floor_with("brushed", &[&ball(), POINT]),
        true,
        "photons from a point light",
    );

    room(
        "a chalk ball under a point",
        floor_with("white", &[&object("ball", "white", BALL), POINT]),
        false,
        "no caustics: no surface is smooth glass, a mirror or polished metal",
    );
    room(
        "a ball of frosted glass under a point",
        floor_with("white", &[&object("ball", "frosted", BALL), POINT]),
        false,
        "no caustics: no surface is smooth glass, a mirror or polished metal",
    );
    room(
        "a glass ball under a huge lamp",
        floor_with("white", &[&ball(), &bulb(2.0)]),
        false,
        "no photon tracing: rays hit bulb (solid angle ",
    );
    let past = "[[light]]\nspot = { position = [-3, 3, 0], toward = [1, -3, 0], cone_angle = 20, intensity = 20 }\n";
    room(
        "a glass ball beside the cone of a spot",
        floor_with("white", &[&ball(), past]),
        false,
        "no caustic from a spotlight in sight",
    );
    room(
        "a glass ball under the floor",
        floor_with("white", &[&ball().replace("0.8, 0]", "-0.8, 0]"), POINT]),
        false,
        "no caustic from a point light in sight",
    );
    let wall = object("wall", "white", "quad = { center = [0.6, 1.5, 0], u = [0, 1.5, 0], v = [0, 0, 3] }");
    let low = "[[light]]\npoint = { position = [2, 1.5, 0], intensity = 3 }\n";
    room(
        "a glass ball behind a wall",
        floor_with("white", &[&ball(), &wall, low]),
        false,
        "no caustic from a point light in sight",
    );
    room(
        "a glass ball on a mirror under a point",
        floor_with("mirror", &[&ball(), POINT]),
        false,
        "no caustics: there is no diffuse or rough surface to show one",
    );
    room(
        "a glass ball where light leaves no diffuse surface",
        floor_with("white", &[&ball(), POINT, "[render]\ndiffuse_bounces = 0\n"]),
        false,
        "no caustics: with diffuse_bounces 0",
    );
    room(
        "a glass ball on a black floor",
        floor_with("black", &[&ball(), POINT]),
        false,
        "the surfaces they land on are black",
    );
    rooms
}
