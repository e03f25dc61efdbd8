//! Ordinary rooms with glass, mirrors, clear coats and lamps, where most of the noise is in a few pixels or a few rays.

use super::twenty::Room;

/// The number of pixels that a plan needs to use light vertices.
const FILM: &str = "[film]\nwidth = 80\nheight = 54\n";
const OUTDOORS: &str = "[camera]\nposition = [0, 2.2, 5]\nlook_at = [0, 0.5, 0]\nvertical_fov = 40\n";
const INDOORS: &str = "[camera]\nposition = [0, 1.5, 2.4]\nlook_at = [0, 1.1, 0]\nvertical_fov = 65\n";
const MATERIALS: &str = "[material]\nwhite.diffuse.reflectance = 0.7\n\
    tiles.diffuse.reflectance = { checker = [0.15, 0.7], repeat = 4 }\n\
    varnish.plastic.reflectance = { checker = [0.2, 0.5], repeat = 4 }\nplastic.plastic.reflectance = 0.5\n\
    glass.dielectric.index = 1.5\nmirror.mirror.reflectance = 0.9\nlamp.emissive.radiance = 60\n";
const BALL: &str = "sphere = { center = [0.4, 0.5, -0.5], radius = 0.5 }";

fn object(name: &str, material: &str, shape: &str) -> String {
    format!("[[object]]\nname = \"{name}\"\nmaterial = \"{material}\"\nshape.{shape}\n")
}

fn quad(center: [f64; 3], u: [f64; 3], v: [f64; 3]) -> String {
    format!("quad = {{ center = {center:?}, u = {u:?}, v = {v:?} }}")
}

fn bulb(center: [f64; 3], radius: f64) -> String {
    object("bulb", "lamp", &format!("sphere = {{ center = {center:?}, radius = {radius:?} }}"))
}

/// Returns objects on a floor under a dim sky.
fn outdoors(floor: &str, things: &[String]) -> String {
    let floor = object("floor", floor, "plane = { point = [0, 0, 0], normal = [0, 1, 0] }");
    let sky = "[[light]]\nenvironment = { radiance = 0.1 }\n";
    format!("{OUTDOORS}{FILM}{MATERIALS}{floor}{}{sky}", things.concat())
}

/// Returns objects in a closed white room, 4 wide, 3 high and 5 deep.
fn indoors(floor: &str, things: &[String]) -> String {
    let walls = [
        object("floor", floor, &quad([0.0; 3], [2.0, 0.0, 0.0], [0.0, 0.0, -2.5])),
        object("ceiling", "white", &quad([0.0, 3.0, 0.0], [2.0, 0.0, 0.0], [0.0, 0.0, 2.5])),
        object("right", "white", &quad([2.0, 1.5, 0.0], [0.0, 0.0, 2.5], [0.0, 1.5, 0.0])),
        object("left", "white", &quad([-2.0, 1.5, 0.0], [0.0, 0.0, 2.5], [0.0, 1.5, 0.0])),
        object("back", "white", &quad([0.0, 1.5, -2.5], [2.0, 0.0, 0.0], [0.0, 1.5, 0.0])),
        object("front", "white", &quad([0.0, 1.5, 2.5], [2.0, 0.0, 0.0], [0.0, 1.5, 0.0])),
    ];
    format!("{INDOORS}{FILM}{MATERIALS}{}{}", walls.concat(), things.concat())
}

/// Returns all rooms. In each of them, photons gain if errors are counted relative to the brightness of each pixel, as
/// `cargo bench --bench rooms` measures it.
pub fn rooms() -> Vec<Room> {
    let mut rooms = Vec::new();
    let mut room = |name, text| rooms.push(Room { name, text, asks: true, words: "photons from" });
    let upright = object("mirror", "mirror", &quad([0.0, 0.9, -1.2], [1.2, 0.0, 0.0], [0.0, 0.9, 0.0]));
    room("an upright mirror that shows a lamp", outdoors("tiles", &[upright, bulb([0.5, 1.2, 0.0], 0.12)]));
    let tilted = object("mirror", "mirror", &quad([-1.0, 0.7, 0.0], [0.2, 0.6, 0.0], [0.0, 0.0, 0.8]));
    room("a tilted mirror that shows a wide lamp", outdoors("white", &[tilted, bulb([1.0, 2.0, 0.0], 0.3)]));
    let coated = object("ball", "plastic", BALL);
    room("a ball with a clear coat", outdoors("white", &[coated.clone(), bulb([-1.0, 3.0, 0.0], 0.1)]));
    let ball = || object("ball", "glass", BALL);
    let lamp = |radius| bulb([-0.8, 2.3, -0.5], radius);
    room("a closed room with a glass ball", indoors("white", &[ball(), lamp(0.1)]));
    let four = (0..4).map(|i| bulb([0.8 * f64::from(i) - 1.2, 2.6, -0.5], 0.08));
    room("a closed room with a glass ball and four lamps", indoors("white", &[vec![ball()], four.collect()].concat()));
    let side = object("mirror", "mirror", &quad([-1.98, 1.2, -0.5], [0.0, 0.0, 0.8], [0.0, 0.8, 0.0]));
    room("a closed room with a mirror on a wall", indoors("white", &[side, bulb([0.7, 2.3, -0.5], 0.1)]));
    let back = object("mirror", "mirror", &quad([0.0, 1.5, -2.48], [1.0, 0.0, 0.0], [0.0, 0.7, 0.0]));
    room("a closed room whose mirror shows the lamp", indoors("tiles", &[back, bulb([0.7, 2.0, -0.5], 0.1)]));
    room("a closed room with a varnished floor", indoors("varnish", &[coated, lamp(0.06)]));
    let table = object("table", "glass", "cube = { center = [0.2, 0.75, -0.6], size = [1.4, 0.04, 0.9] }");
    room("a closed room with a glass table", indoors("tiles", &[table, bulb([-0.4, 2.5, -0.5], 0.12)]));
    rooms
}
