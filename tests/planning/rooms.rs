//! Random rooms with painted walls, solved exactly by radiosity for every wavelength and in the lanes of every model.

use std::f64::consts::PI;

use abbe::plan::{Candidate, plan};
use abbe::scene::Scene;
use abbe::spectrum::{Basis, Curve, Draw, Emission, Lanes, MAX_LANES, Quantity, data, visible};

use crate::support::larger::larger;
use crate::support::random::Random;
use crate::support::scenes::scene;

/// Reflectance of a wall at a wavelength in nm.
type Paint = Box<dyn Fn(f64) -> f64>;

/// Returns the form factors between the walls of a closed box, numbered -x +x -y +y -z +z.
///
/// Howell, *A Catalog of Radiation Heat Transfer Configuration Factors*, C-11 (opposite) and C-14 (adjacent
/// rectangles).
fn form_factors(size: [f64; 3]) -> [[f64; 6]; 6] {
    let mut factors = [[0.0; 6]; 6];
    for i in 0..6 {
        let (axis, others) = (i / 2, [(i / 2 + 1) % 3, (i / 2 + 2) % 3]);
        let opposite = opposite(size[others[0]] / size[axis], size[others[1]] / size[axis]);
        factors[i][i ^ 1] = opposite;
        for side in [0, 1] {
            // The neighbor across `others[side]` shares the edge along the other direction.
            let (across, along) = (others[side], others[1 - side]);
            let adjacent = adjacent(size[axis] / size[along], size[across] / size[along]);
            factors[i][2 * across] = adjacent;
            factors[i][2 * across + 1] = adjacent;
        }
    }
    factors
}

fn opposite(x: f64, y: f64) -> f64 {
    let (x2, y2) = (1.0 + x * x, 1.0 + y * y);
    let log = (x2 * y2 / (x2 + y * y)).sqrt().ln();
    let arcs = x * y2.sqrt() * (x / y2.sqrt()).atan() + y * x2.sqrt() * (y / x2.sqrt()).atan();
    2.0 / (PI * x * y) * (log + arcs - x * x.atan() - y * y.atan())
}

/// Returns the form factor from a wall of height w to one of height h. They share an edge of length 1.
fn adjacent(h: f64, w: f64) -> f64 {
    let (h2, w2) = (h * h, w * w);
    let arcs = w * (1.0 / w).atan() + h * (1.0 / h).atan() - (h2 + w2).sqrt() * (1.0 / (h2 + w2).sqrt()).atan();
    let a = (1.0 + w2) * (1.0 + h2) / (1.0 + w2 + h2);
    let b = (w2 * (1.0 + w2 + h2) / ((1.0 + w2) * (w2 + h2))).powf(w2);
    let c = (h2 * (1.0 + w2 + h2) / ((1.0 + h2) * (w2 + h2))).powf(h2);
    (arcs + 0.25 * (a * b * c).ln()) / (PI * w)
}

#[test]
fn every_wall_sees_all_others() {
    for size in [[1.0, 1.0, 1.0], [1.0, 2.0, 3.0], [5.0, 0.7, 2.0]] {
        for (wall, row) in form_factors(size).iter().enumerate() {
            assert!((row.iter().sum::<f64>() - 1.0).abs() < 1e-12, "wall {wall} of {size:?}: {row:?}");
        }
    }
}

/// Returns the radiosities of six walls from their reflectances and from the light that each of them receives directly.
fn solve(reflectances: [f64; 6], factors: &[[f64; 6]; 6], direct: [f64; 6]) -> [f64; 6] {
    let mut radiosity = [0.0; 6];
    for _ in 0..400 {
        radiosity = std::array::from_fn(|i| {
            let received: f64 = (0..6).map(|j| factors[i][j] * radiosity[j]).sum();
            reflectances[i] * (direct[i] + received)
        });
    }
    radiosity
}

/// A room in which everything is known.
struct Room {
    scene: Scene<Curve>,
    paints: Vec<Paint>,
    names: Vec<usize>,
    factors: [[f64; 6]; 6],
    direct: [f64; 6],
}

/// Returns a random room like those of the measurements behind the safety factors: a third of the rooms are pale, a
/// third nearly gray.
fn room(number: usize) -> Room {
    let mut random = Random::new(number as u64 + 40);
    let patches: Vec<_> = data::reflectances().collect();
    let lights = ["D65", "A", "FL11", "LED-B3", "LED-RGB1"];
    let light = lights[number % lights.len()];
    let (mut text, mut paints, mut names) = (String::new(), Vec::<Paint>::new(), Vec::new());
    let size = [0; 3].map(|_| 1.0 + 2.0 * random.number());
    for wall in 0..6 {
        let patch = patches[(random.number() * 24.0) as usize].clone();
        let samples: Vec<f64> = visible::wavelengths().map(|nm| patch.at(nm)).collect();
        let (mean, most) = (samples.iter().sum::<f64>() / 471.0, samples.iter().fold(0.0, |m: f64, x| larger(m, *x)));
        let (from, factor) = match number % 3 {
            0 => (0.5, 0.35 / most),
            1 => (0.5 * mean, 0.15),
            _ => (0.0, 1.0),
        };
        let values: Vec<f64> = samples.iter().map(|x| from + factor * x).collect();
        let pairs: Vec<String> =
            visible::wavelengths().zip(&values).map(|(nm, value)| format!("[{nm}, {value}]")).collect();
        text +=
            &format!("[material.wall{wall}]\ndiffuse = {{ reflectance = {{ samples = [{}] }} }}\n", pairs.join(", "));
        text +=
            &format!("[[object]]\nshape.cube = {{ center = [{wall}, 0, 0], size = 0.1 }}\nmaterial = \"wall{wall}\"\n");
        paints.push(Box::new(move |nm| {
            let (below, fraction) = visible::grid_position(nm);
            values[below] + fraction * (values[below + 1] - values[below])
        }));
        names.push(wall);
    }
    text += &format!("[[light]]\npoint = {{ position = [0, 5, 0], intensity = {{ illuminant = \"{light}\" }} }}\n");
    text += "[camera]\nposition = [0, 0, 9]\nlook_at = [0, 0, 0]\nvertical_fov = 40\n[film]\nwidth = 8\nheight = 8\n";
    let direct = [0; 6].map(|_| random.number() * random.number());
    Room { scene: scene(&text), paints, names, factors: form_factors(size), direct }
}

/// Returns the largest relative error of a wall's color under a model.
fn true_error(room: &Room, basis: &Basis) -> f64 {
    let curve = room.scene.lights[0].emission();
    let light = Emission::new(curve, basis.color_space());
    let mut exact = [[0.0; 3]; 6];
    for (nm, column) in visible::wavelengths().zip(light.columns()) {
        let radiosity = solve(std::array::from_fn(|wall| room.paints[wall](nm)), &room.factors, room.direct);
        (0..6).for_each(|wall| (0..3).for_each(|c| exact[wall][c] += radiosity[wall] * column[c]));
    }
    let reflectance = |wall: usize| match &room.scene.materials[room.names[wall]].material {
        abbe::material::Material::Diffuse(diffuse) => basis.tabulate(Quantity::Reflectance, &diffuse.reflectance),
        _ => unreachable!("all walls are diffuse"),
    };
    let tables: Vec<_> = (0..6).map(reflectance).collect();
    let draw = Draw::<MAX_LANES>::fixed(basis.fixed_lanes());
    let emission = draw.read(&basis.tabulate(Quantity::Emission, curve));
    let response = basis.response(curve);
    let lanes: Vec<[f64; 6]> = (0..basis.fixed_lanes())
        .map(|lane| solve(std::array::from_fn(|wall| tables[wall].bins()[lane]), &room.factors, room.direct))
        .collect();
    let mut worst: f64 = 0.0;
    for wall in 0..6 {
        let filter = Lanes::<MAX_LANES>::from_fn(|lane| lanes.get(lane).map_or(0.0, |walls| walls[wall] as f32));
        let color = response.film_rgb(&draw, emission * filter, false);
        let strongest = exact[wall].iter().fold(0.0, |most: f64, x| larger(most, x.abs()));
        worst = (0..3).fold(worst, |worst, c| larger(worst, (color[c] - exact[wall][c]).abs() / strongest));
    }
    worst
}

const ROOMS: usize = 300;

#[test]
fn errors_of_color_are_as_predicted() {
    let mut by_model: Vec<(String, Vec<[f64; 3]>)> = Vec::new();
    for number in 0..ROOMS {
        let room = room(number);
        for candidate in plan(&room.scene).candidates {
            let Candidate { basis, error, .. } = &candidate;
            let found = [true_error(&room, basis), *error, candidate.bound()];
            match by_model.iter_mut().find(|(name, _)| *name == basis.name()) {
                Some((_, list)) => list.push(found),
                None => by_model.push((basis.name(), vec![found])),
            }
        }
    }
    assert_eq!(by_model.len(), 5, "three bands and 8, 12, 16, 32 lanes");
    for (name, mut rooms) in by_model {
        assert_eq!(rooms.len(), ROOMS);
        let within = rooms.iter().filter(|[found, _, bound]| found <= bound).count();
        rooms.sort_by(|a, b| (a[0] / a[1]).total_cmp(&(b[0] / b[1])));
        let p95 =
            rooms[ROOMS * 95 / 100].iter().take(2).copied().reduce(|found, predicted| found / predicted).unwrap_or(0.0);
        let mut found: Vec<f64> = rooms.iter().map(|room| room[0]).collect();
        found.sort_by(f64::total_cmp);
        println!(
            "{name:40} true error, median {:.3} %; true / predicted p95 {p95:.2}; {within} of {ROOMS} within the bound",
            100.0 * found[ROOMS / 2]
        );
        let most = if name.starts_with("rgb") { 1.9 } else { 1.5 };
        assert!(p95 <= most, "{name}: true over predicted error {p95:.2}");
        assert!(within * 100 >= 95 * ROOMS, "{name}: {within} of {ROOMS} rooms within the promised error");
    }
}
