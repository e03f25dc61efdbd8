//! The parts of a lamp: one if it is compact, several if it is long or lies in pieces, such as a string of bulbs.

use std::f64::consts::PI;

use crate::math::{Bounds, DVec3};
use crate::shape::{Ball, Shape};

/// A lamp, or a part of it.
pub struct LampPart {
    /// The ball around it.
    ball: Ball,
    /// The least area that its ball or those of its parts cover, divided by pi.
    covered: f64,
    /// Its parts, if their balls cover clearly less.
    halves: Option<Box<[LampPart; 2]>>,
}

/// Largest share of a ball's area that the balls of both halves may cover.
const MAX_SHARE: f64 = 0.7;
/// How often a lamp is halved at most.
const MAX_HALVINGS: u32 = 10;
/// Most pieces of a lamp that is halved.
const MAX_PIECES: usize = 1 << 18;
/// Surface area of pieces that fill their ball well, in multiples of the area that the ball covers. A sphere has 4.
const FULL: f64 = 2.0;

/// A flat piece of a lamp.
#[derive(Clone, Copy, Debug)]
struct Piece {
    /// Its corners, some of which may be the same.
    corners: [DVec3; 5],
    area: f64,
}

impl LampPart {
    /// Returns a lamp that is looked for as a whole.
    pub fn undivided(ball: Ball) -> Self {
        Self { ball, covered: ball.radius * ball.radius, halves: None }
    }

    /// Returns a lamp of a flat shape, or of one that consists of flat polygons; `None` if these are too many, or long
    /// and very many.
    pub fn of_polygons(shape: &Shape) -> Option<Self> {
        let bounds = shape.bounds()?;
        if shape.part_count() as usize > MAX_PIECES {
            return None;
        }
        let shortest = bounds.size().max_element() / f64::from(1 << MAX_HALVINGS);
        let mut pieces = Vec::new();
        for polygon in shape.polygons() {
            for corners in polygon.triangles() {
                cut(corners, shortest, &mut pieces);
            }
            if pieces.len() > MAX_PIECES {
                return None;
            }
        }
        (!pieces.is_empty()).then(|| Self::of_pieces(pieces, MAX_HALVINGS))
    }

    fn of_pieces(pieces: Vec<Piece>, halvings: u32) -> Self {
        let bounds = Bounds::around(pieces.iter().flat_map(|piece| piece.corners));
        let whole = Self::undivided(ball_around(&pieces, bounds.center()));
        if halvings == 0 || pieces.iter().map(|piece| piece.area).sum::<f64>() > FULL * PI * whole.covered {
            return whole;
        }
        let axis = bounds.size().max_position();
        let plane = gap_near(&pieces, axis, bounds.center()[axis]);
        let is_low = |piece: &Piece| {
            let [from, to] = span(piece, axis);
            0.5 * (from + to) < plane
        };
        let (low, high): (Vec<_>, Vec<_>) = pieces.into_iter().partition(is_low);
        if low.is_empty() || high.is_empty() {
            return whole;
        }
        let halves = [low, high].map(|half| Self::of_pieces(half, halvings - 1));
        let covered = halves.iter().map(|half| half.covered).sum::<f64>();
        if covered > MAX_SHARE * whole.covered {
            return whole;
        }
        Self { covered, halves: Some(Box::new(halves)), ..whole }
    }

    /// Returns the parts of some lamps, each with the number of its lamp, in order of these. There are at most `max`
    /// unless there are more lamps: those are divided first whose parts cover the smallest share of their ball.
    pub fn divided(lamps: &[Self], max: usize) -> Vec<(usize, Ball)> {
        let mut parts: Vec<(usize, &Self)> = lamps.iter().enumerate().collect();
        let gain =
            |part: &Self| part.halves.as_ref().map_or(1.0, |_| part.ball.radius * part.ball.radius / part.covered);
        while parts.len() < max
            && let Some(number) = (0..parts.len()).max_by(|&a, &b| gain(parts[a].1).total_cmp(&gain(parts[b].1)))
            && let (lamp, Self { halves: Some(halves), .. }) = parts[number]
        {
            parts.splice(number..=number, halves.iter().map(|half| (lamp, half)));
        }
        parts.into_iter().map(|(lamp, part)| (lamp, part.ball)).collect()
    }
}

/// Returns the smallest ball around a center that contains some pieces.
fn ball_around(pieces: &[Piece], center: DVec3) -> Ball {
    let corners = pieces.iter().flat_map(|piece| piece.corners);
    let squared = corners.map(|corner| corner.distance_squared(center)).fold(0.0, f64::max);
    Ball { center, radius: squared.sqrt() }
}

/// Returns where a piece begins and ends along an axis.
fn span(piece: &Piece, axis: usize) -> [f64; 2] {
    let along = piece.corners.map(|corner| corner[axis]);
    [along.into_iter().fold(f64::INFINITY, f64::min), along.into_iter().fold(f64::NEG_INFINITY, f64::max)]
}

/// Returns the middle of that gap between pieces along an axis which is nearest to a place, or the place itself if
/// there is no gap.
fn gap_near(pieces: &[Piece], axis: usize, place: f64) -> f64 {
    let mut spans: Vec<[f64; 2]> = pieces.iter().map(|piece| span(piece, axis)).collect();
    spans.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let (mut end, mut nearest) = (f64::INFINITY, None);
    for [from, to] in spans {
        if from > end {
            let gap = 0.5 * (end + from);
            nearest = nearest.filter(|other: &f64| (other - place).abs() < (gap - place).abs()).or(Some(gap));
        }
        end = if end.is_finite() { end.max(to) } else { to };
    }
    nearest.unwrap_or(place)
}

/// Cuts a long triangle across its longest edge into compact pieces, as far as they are longer than `shortest`.
fn cut(corners: [DVec3; 3], shortest: f64, pieces: &mut Vec<Piece>) {
    let squared_edge = |i: usize| corners[i].distance_squared(corners[(i + 1) % 3]);
    let longest = (0..3).max_by(|&i, &j| squared_edge(i).total_cmp(&squared_edge(j))).unwrap_or(0);
    let [a, b, c] = [0, 1, 2].map(|i| corners[(longest + i) % 3]);
    let (length, area) = ((b - a).length(), 0.5 * (b - a).cross(c - a).length());
    if length == 0.0 {
        return pieces.push(Piece { corners: [a; 5], area });
    }
    let height = 2.0 * area / length;
    // In a right angle with equal legs, the height is half the length.
    let count = (length / (2.0 * height).max(shortest)).round().max(1.0);
    // The place of the third corner along the edge.
    let top = ((c - a).dot(b - a) / (length * length)).clamp(0.0, 1.0);
    let other_side = |t: f64| match t {
        t if t < top => a + (c - a) * (t / top),
        t if t > top => b + (c - b) * ((1.0 - t) / (1.0 - top)),
        _ => c,
    };
    // The share of the area up to a place along the edge.
    let share = |t: f64| match t {
        t if t < top => t * t / top,
        t if t > top => 1.0 - (1.0 - t) * (1.0 - t) / (1.0 - top),
        t => t,
    };
    for i in 0..count as u32 {
        let [from, to] = [0, 1].map(|end| f64::from(i + end) / count);
        let peak = if from < top && top < to { c } else { other_side(from) };
        let corners = [a + (b - a) * from, a + (b - a) * to, other_side(to), peak, other_side(from)];
        pieces.push(Piece { corners, area: area * (share(to) - share(from)) });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::sample_sphere;
    use crate::shape::{Cube, Mesh, Quad, Vertices};

    fn parts(shape: &Shape, max: usize) -> Vec<Ball> {
        let lamp = LampPart::of_polygons(shape).expect("it has polygons");
        LampPart::divided(&[lamp], max).into_iter().map(|part| part.1).collect()
    }

    fn covered(parts: &[Ball]) -> f64 {
        parts.iter().map(|ball| ball.radius * ball.radius).sum()
    }

    fn bulbs(centers: &[DVec3], radius: f64) -> Shape {
        let (mut vertices, mut faces) = (Vec::new(), Vec::new());
        for &center in centers {
            let first = vertices.len() as u32;
            let corner = |axis: usize, sign: f64| center + DVec3::AXES[axis] * (sign * radius);
            vertices.extend((0..3).flat_map(|axis| [corner(axis, 1.0), corner(axis, -1.0)]));
            let face = |i: u32| [0, 1, 2].map(|axis| first + 2 * axis + (i >> axis & 1));
            faces.extend((0..8).map(face));
        }
        Shape::Mesh(Mesh::new(Vertices::Double(vertices), faces).expect("it has triangles").into())
    }

    #[test]
    fn a_compact_lamp_is_one_part_and_a_long_one_has_parts_nearly_as_long_as_wide() {
        let quad = |length: f64| Shape::Quad(Quad::new(DVec3::ONE, DVec3::new(0.6, 0.0, 0.8) * length, DVec3::Y));
        let cube = |length: f64| Shape::Cube(Cube::new(DVec3::ONE, DVec3::new(2.0 * length, 2.0, 2.0)));
        for shape in [quad(1.0), quad(2.0), cube(1.0), cube(2.0), bulbs(&[DVec3::X], 1.0)] {
            assert_eq!(parts(&shape, 1000).len(), 1, "{shape:?}");
        }
        for shape in [quad(100.0), cube(100.0)] {
            let found = parts(&shape, 1000);
            assert!((30..=140).contains(&found.len()), "{} parts", found.len());
            assert!(found.iter().all(|ball| ball.radius < 4.5), "{found:?}");
            // A square of that width has a ball of radius sqrt(2), and there are 100.
            assert!(covered(&found) < 2.5 * 200.0, "{}", covered(&found));
            assert_eq!(parts(&shape, 5).len(), 5);
        }
    }

    #[test]
    fn bulbs_that_lie_apart_are_parts_wherever_they_are() {
        let corners: Vec<_> =
            (0..8).map(|i| DVec3::new((i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2) as f64)).collect();
        let scattered = |i: u32| sample_sphere([(f64::from(i) + 0.5) / 40.0, (f64::from(i) * 0.618_034).fract()]);
        let scattered: Vec<_> = (0..40).map(scattered).collect();
        for centers in [corners, scattered] {
            let found = parts(&bulbs(&centers, 1e-3), 1000);
            assert_eq!(found.len(), centers.len());
            for center in centers {
                let is_bulb = |ball: &Ball| ball.center.distance(center) < 1e-12 && (ball.radius - 1e-3).abs() < 1e-12;
                assert!(found.iter().any(is_bulb), "{center}");
            }
        }
    }

    #[test]
    fn thin_triangles_are_cut_into_pieces_that_fill_them_and_are_not_too_many() {
        let corners = |far: f64, top: f64, height: f64| {
            [DVec3::ZERO, DVec3::new(far, 0.0, 0.0), DVec3::new(far * top, height, 0.0)]
        };
        for (height, most) in [(1.0, 4), (0.1, 40), (1e-3, 1024), (1e-9, 1024), (0.0, 1024)] {
            for top in [0.0, 0.3, 0.5, 1.0] {
                let mut pieces = Vec::new();
                let triangle = corners(4.0, top, height);
                cut(triangle, 4.0 / 1024.0, &mut pieces);
                assert!((1..=most).contains(&pieces.len()), "{} pieces of height {height}", pieces.len());
                let area: f64 = pieces.iter().map(|piece| piece.area).sum();
                assert!((area - 2.0 * height).abs() <= 1e-12 * height, "{area} of height {height}");
                for corner in triangle {
                    assert!(pieces.iter().any(|piece| piece.corners.contains(&corner)), "{corner} of {pieces:?}");
                }
                let pairs = pieces.windows(2);
                assert!(pairs.into_iter().all(|pair| pair[0].corners[1] == pair[1].corners[0]));
            }
        }
        let mut pieces = Vec::new();
        cut([DVec3::ONE; 3], 0.0, &mut pieces);
        assert_eq!(pieces.len(), 1);
        // All of a mesh of needles is one part if it would have too many pieces.
        let needle = |i: u32| [3 * i, 3 * i + 1, 3 * i + 2];
        let place = |i: u32| DVec3::new(0.0, 1e-4 * f64::from(i), 0.0);
        let vertices = (0..1000).flat_map(|i| corners(4.0, 0.5, 1e-9).map(|corner| place(i) + corner)).collect();
        let mesh = Mesh::new(Vertices::Double(vertices), (0..1000).map(needle).collect()).expect("it has triangles");
        assert!(LampPart::of_polygons(&Shape::Mesh(mesh.into())).is_none());
    }

    #[test]
    fn parts_contain_all_of_a_lamp() {
        let quad = Quad::new(DVec3::ONE, DVec3::new(3.0, 0.1, 2.0), DVec3::new(0.0, 0.02, 0.01));
        for max in [1, 3, 10, 100] {
            let found = parts(&Shape::Quad(quad.clone()), max);
            for i in 0..1000 {
                let at = [f64::from(i) / 500.0 - 1.0, 2.0 * (f64::from(i) * 0.618_034).fract() - 1.0];
                let point = DVec3::ONE + DVec3::new(3.0, 0.1, 2.0) * at[0] + DVec3::new(0.0, 0.02, 0.01) * at[1];
                let is_inside = |ball: &Ball| ball.center.distance(point) <= ball.radius * (1.0 + 1e-12);
                assert!(found.iter().any(is_inside), "{point} of {max}");
            }
        }
    }
}
