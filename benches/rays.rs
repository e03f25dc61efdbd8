//! Rays per second of processor time on a mesh of a million triangles, on one thread.
//!
//! ```text
//! cargo bench --bench rays
//! cargo bench --bench rays -- --write FOLDER    # the mesh and the rays as well, for another program to trace
//! ```
//!
//! All numbers in the files are little-endian and 32 bits long. `mesh`: the number of vertices and that of triangles,
//! the vertices as three floats each, the triangles as three vertex indices each. `primary`, `diffuse` and `shadow`:
//! the number of rays, and the origin, direction and largest t of each.

use std::f64::consts::{PI, TAU};
use std::path::Path;
use std::time::Instant;

use abbe::math::{DVec3, Frame, Ray, sample_cosine_hemisphere};
use abbe::shape::{Mesh, Shape, Vertices};

/// Pixels along each side of the image whose rays are traced.
const SIDE: u32 = 1024;
/// Pixels along each side of a tile.
const TILE: u32 = 16;
/// Number of times that everything is traced; the median counts.
const RUNS: usize = 5;

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let folder = arguments.iter().position(|a| a == "--write").and_then(|i| arguments.get(i + 1));
    let (points, faces) = room();
    if let Some(folder) = folder {
        write_mesh(&Path::new(folder).join("mesh"), &points, &faces);
    }
    let count = faces.len();
    let mut built = None;
    let (_, seconds) = timed(|| built = Mesh::new(Vertices::Single(points.clone()), faces.clone()));
    let mesh = Shape::Mesh(built.expect("the room has triangles").into());
    println!("{count} triangles, built in {seconds:.2} s");
    let primary = primary_rays();
    let mut random = Random(1);
    let seen: Vec<(Ray, f64)> = primary.iter().filter_map(|ray| seen(&mesh, &ray.0)).collect();
    let diffuse: Vec<(Ray, f64)> = seen.iter().map(|(leaving, _)| bounce_ray(leaving, &mut random)).collect();
    let shadow: Vec<(Ray, f64)> = seen.iter().map(|(leaving, _)| ray_toward_lamp(leaving, &mut random)).collect();
    println!("{:<8} {:>9} {:>9} {:>14} {:>9}", "rays", "number", "hits", "sum of t", "million/s");
    for (name, rays, any) in [("primary", &primary, false), ("diffuse", &diffuse, false), ("shadow", &shadow, true)] {
        if let Some(folder) = folder {
            write_rays(&Path::new(folder).join(name), rays);
        }
        let mut speeds = Vec::new();
        let (mut hits, mut sum) = (0, 0.0);
        for _ in 0..RUNS {
            (hits, sum) = (0, 0.0);
            let ((), seconds) = timed(|| {
                for (ray, t_max) in rays {
                    if any {
                        hits += usize::from(mesh.is_crossed(ray, *t_max, None));
                    } else if let Some(intersection) = mesh.intersect(ray, *t_max) {
                        hits += 1;
                        sum += intersection.t;
                    }
                }
            });
            speeds.push(rays.len() as f64 / seconds * 1e-6);
        }
        speeds.sort_by(f64::total_cmp);
        println!("{name:<8} {:>9} {hits:>9} {sum:>14.4} {:>9.2}", rays.len(), speeds[RUNS / 2]);
    }
}

/// Returns the result of a computation, and the seconds of processor time that this thread took for it.
fn timed<T>(compute: impl FnOnce() -> T) -> (T, f64) {
    let start = Instant::now();
    let before = processor_seconds();
    let result = compute();
    let seconds = match (before, processor_seconds()) {
        (Some(before), Some(after)) => after - before,
        _ => start.elapsed().as_secs_f64(),
    };
    (result, seconds)
}

/// Returns the seconds that this thread has run, if the system reports them.
fn processor_seconds() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    Some(text.split_whitespace().next()?.parse::<f64>().ok()? * 1e-9)
}

/// SplitMix64: Steele, Lea & Flood 2014.
struct Random(u64);

impl Random {
    fn number(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let x = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((x ^ (x >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// Returns hills on the floor, bumpy balls above them, and five walls of two triangles each.
fn room() -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
    let (mut points, mut faces) = (Vec::new(), Vec::new());
    let hill = |u: f64, v: f64| {
        let (x, z) = (10.0 * u - 5.0, 10.0 * v - 5.0);
        let waves = libm::sin(1.3 * x) * libm::cos(1.7 * z) + 0.3 * libm::sin(5.1 * x + 2.0 * z);
        DVec3::new(x, 0.3 * waves + 0.05 * libm::sin(23.0 * x) * libm::sin(19.0 * z), z)
    };
    grid(&mut points, &mut faces, [420, 420], hill);
    let mut random = Random(7);
    for _ in 0..24 {
        let center = DVec3::new(random.number() * 8.0 - 4.0, random.number() * 3.0 + 1.2, random.number() * 8.0 - 4.0);
        let radius = 0.3 + 0.4 * random.number();
        let ball = |u: f64, v: f64| {
            let (sin, cos) = libm::sincos(v * PI);
            let bump = 1.0 + 0.05 * libm::sin(40.0 * u * PI) * libm::sin(30.0 * v * PI);
            center + DVec3::new(libm::cos(u * TAU) * sin, cos, libm::sin(u * TAU) * sin) * (radius * bump)
        };
        grid(&mut points, &mut faces, [164, 82], ball);
    }
    let corner = |i: u32| {
        DVec3::new(f64::from(i & 1) * 10.0 - 5.0, f64::from(i >> 1 & 1) * 7.0 - 1.0, f64::from(i >> 2) * 10.0 - 5.0)
    };
    for wall in [[0, 2, 4, 6], [1, 3, 5, 7], [0, 1, 2, 3], [4, 5, 6, 7], [2, 3, 6, 7]] {
        let side = |u: f64, v: f64| corner(wall[usize::from(u > 0.5) + 2 * usize::from(v > 0.5)]);
        grid(&mut points, &mut faces, [1, 1], side);
    }
    (points, faces)
}

/// Appends a surface over the unit square, in cells of two triangles.
fn grid(points: &mut Vec<[f32; 3]>, faces: &mut Vec<[u32; 3]>, cells: [u32; 2], at: impl Fn(f64, f64) -> DVec3) {
    let first = points.len() as u32;
    for j in 0..=cells[1] {
        for i in 0..=cells[0] {
            let point = at(f64::from(i) / f64::from(cells[0]), f64::from(j) / f64::from(cells[1]));
            points.push(point.to_array().map(|x| x as f32));
        }
    }
    for j in 0..cells[1] {
        for i in 0..cells[0] {
            let [a, b] = [0, 1].map(|row| first + (j + row) * (cells[0] + 1) + i);
            faces.extend([[a, a + 1, b], [a + 1, b + 1, b]]);
        }
    }
}

/// Returns a ray with its numbers rounded to 32 bits, so that every program traces the same ray.
fn rounded(origin: DVec3, direction: DVec3, t_max: f64) -> (Ray, f64) {
    let round = |v: DVec3| v.as_vec3().as_dvec3();
    (Ray { origin: round(origin), direction: round(direction) }, f64::from(t_max as f32))
}

/// Returns a ray through each pixel, tile by tile.
fn primary_rays() -> Vec<(Ray, f64)> {
    let mut rays = Vec::new();
    let eye = DVec3::new(0.3, 3.5, -4.8);
    for tile in 0..(SIDE / TILE) * (SIDE / TILE) {
        let (left, top) = (tile % (SIDE / TILE) * TILE, tile / (SIDE / TILE) * TILE);
        for pixel in 0..TILE * TILE {
            let (x, y) = (left + pixel % TILE, top + pixel / TILE);
            let [u, v] = [x, y].map(|x| (f64::from(x) + 0.5) / f64::from(SIDE) * 2.0 - 1.0);
            rays.push(rounded(eye, DVec3::new(u, -0.25 - v, 1.0).normalize(), f64::INFINITY));
        }
    }
    rays
}

/// Returns the ray that leaves the point hit by another ray, along the normal on the side that the other one comes
/// from, and the distance of that point.
fn seen(mesh: &Shape, ray: &Ray) -> Option<(Ray, f64)> {
    let intersection = mesh.intersect(ray, f64::INFINITY)?;
    let point = mesh.point(ray, &intersection);
    let normal = if point.normal.dot(ray.direction) > 0.0 { -point.normal } else { point.normal };
    Some((Ray { origin: point.position + normal * 1e-4, direction: normal }, intersection.t))
}

fn bounce_ray(leaving: &Ray, random: &mut Random) -> (Ray, f64) {
    let local = sample_cosine_hemisphere([random.number(), random.number()]);
    rounded(leaving.origin, Frame::about(leaving.direction).to_world(local), f64::INFINITY)
}

fn ray_toward_lamp(leaving: &Ray, random: &mut Random) -> (Ray, f64) {
    let to_lamp = DVec3::new(random.number() * 2.0 - 1.0, 5.9, random.number() * 2.0 - 1.0) - leaving.origin;
    rounded(leaving.origin, to_lamp.normalize(), to_lamp.length())
}

fn write_mesh(path: &Path, points: &[[f32; 3]], faces: &[[u32; 3]]) {
    let mut bytes: Vec<u8> = [points.len() as u32, faces.len() as u32].map(u32::to_le_bytes).concat();
    bytes.extend(points.iter().flatten().flat_map(|x| x.to_le_bytes()));
    bytes.extend(faces.iter().flatten().flat_map(|x| x.to_le_bytes()));
    std::fs::write(path, bytes).expect("the mesh can be written");
}

fn write_rays(path: &Path, rays: &[(Ray, f64)]) {
    let mut bytes = (rays.len() as u32).to_le_bytes().to_vec();
    for (ray, t_max) in rays {
        let numbers = [ray.origin, ray.direction].map(|v| v.to_array()).concat();
        bytes.extend(numbers.iter().chain([t_max]).flat_map(|&x| (x as f32).to_le_bytes()));
    }
    std::fs::write(path, bytes).expect("the rays can be written");
}
