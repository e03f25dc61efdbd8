//! Gathers points of light into a few rectangles that fill their planes.

use std::f64::consts::FRAC_PI_2;

use crate::math::{Bounds, DVec3, Frame};

/// A rectangle, around weighted points or standalone.
#[derive(Clone, Copy, Debug)]
pub struct Rectangle {
    pub center: DVec3,
    /// Perpendicular half edges.
    pub half: [DVec3; 2],
}

/// Weighted points and the rectangle around them.
#[derive(Clone, Debug)]
pub struct Cluster {
    points: Vec<(DVec3, f64)>,
    cost: f64,
    center: DVec3,
    /// Perpendicular half edges, and half of the thickness.
    half: [DVec3; 3],
}

/// Share of the weight that is left out at each end of a rectangle's edge.
const EDGE_TRIM: f64 = 0.02;
/// Share of the weight that may lie beyond each side of a box.
const BOX_TRIM: f64 = 0.01;
/// Edge directions of a rectangle that are tried over a right angle.
const ORIENTATIONS: u32 = 12;
/// Steps that refine the smallest rectangle, each half as large as the one before.
const REFINE_STEPS: u32 = 24;
/// Planes along each axis at which points may be split.
const CUTS_PER_AXIS: usize = 7;
/// Share of the total cost, the sum of weights times areas, that a split must save.
const MIN_SAVING: f64 = 0.05;
/// Most points that are used.
const MAX_POINTS: usize = 2048;
/// Fewest points of a cluster.
const MIN_POINTS: usize = 8;
/// Steps of the iteration that finds the direction in which points vary most.
const POWER_ITERATIONS: u32 = 24;

/// Gathers points into at most `max` rectangles, by repeated splitting in two. Each split minimizes the sum of weights
/// times areas. Of very many points, a subset suffices.
pub fn clusters(points: Vec<(DVec3, f64)>, max: usize) -> Vec<Cluster> {
    let step = points.len().div_ceil(MAX_POINTS).max(1);
    let points = points.into_iter().step_by(step).collect();
    let Some(first) = Cluster::from_points(points) else { return Vec::new() };
    let mut found = vec![(first.split(), first)];
    while found.len() < max {
        let total: f64 = found.iter().map(|(_, cluster)| cluster.cost).sum();
        let saving = |split: &Option<[Cluster; 2]>, cluster: &Cluster| {
            split.as_ref().map_or(0.0, |[a, b]| cluster.cost - a.cost - b.cost)
        };
        let savings: Vec<f64> = found.iter().map(|(split, cluster)| saving(split, cluster)).collect();
        let best = (0..found.len()).max_by(|&a, &b| savings[a].total_cmp(&savings[b])).unwrap_or(0);
        if savings[best] <= MIN_SAVING * total {
            break;
        }
        if let (Some(parts), _) = found.swap_remove(best) {
            found.extend(parts.map(|part| (part.split(), part)));
        }
    }
    found.into_iter().map(|(_, cluster)| cluster).collect()
}

impl Rectangle {
    /// Scales its length and width by a factor.
    pub fn scaled(self, factor: f64) -> Self {
        Self { half: self.half.map(|half| half * factor), ..self }
    }

    /// Returns the product of the half edges.
    pub fn area(&self) -> f64 {
        self.half[0].length() * self.half[1].length()
    }
}

impl Cluster {
    /// Returns the rectangle around most of the points.
    pub fn rectangle(&self) -> Rectangle {
        let [u, v, _] = self.half;
        Rectangle { center: self.center, half: [u, v] }
    }

    /// Returns the smallest rectangle around all of the points, seen along the cluster's thickness.
    pub fn bounding_rectangle(&self) -> Rectangle {
        let [u, v, normal] = self.half.map(DVec3::normalize_or_zero);
        let normal = if normal == DVec3::ZERO { u.cross(v) } else { normal };
        let along = normal * self.center.dot(normal);
        let rectangle_at = |angle: f64| {
            let (sin, cos) = libm::sincos(angle);
            let axes = [u * cos + v * sin, v * cos - u * sin];
            let spans = axes.map(|axis| self.full_span(axis));
            let middle = |i: usize| axes[i] * (0.5 * (spans[i][0] + spans[i][1]));
            let half = |i: usize| axes[i] * (0.5 * (spans[i][1] - spans[i][0]));
            Rectangle { center: along + middle(0) + middle(1), half: [half(0), half(1)] }
        };
        let (mut angle, mut smallest) = (0.0, rectangle_at(0.0));
        let mut step = FRAC_PI_2 / f64::from(ORIENTATIONS);
        for _ in 0..REFINE_STEPS {
            for next in [angle - step, angle + step] {
                let other = rectangle_at(next);
                if other.area() < smallest.area() {
                    (angle, smallest) = (next, other);
                }
            }
            step *= 0.5;
        }
        smallest
    }

    fn full_span(&self, axis: DVec3) -> [f64; 2] {
        let along = self.points.iter().map(|point| point.0.dot(axis));
        along.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)])
    }

    /// Returns the cluster of the points of both.
    pub fn merged(&self, other: &Self) -> Option<Self> {
        Self::from_points([self.points.as_slice(), &other.points].concat())
    }

    fn from_points(points: Vec<(DVec3, f64)>) -> Option<Self> {
        let weight: f64 = points.iter().map(|point| point.1).sum();
        if points.len() < MIN_POINTS || weight <= 0.0 {
            return None;
        }
        let normal = normal_of(&points, weight);
        let frame = Frame::about(normal);
        let mut best: Option<(f64, DVec3, [DVec3; 3])> = None;
        for turn in 0..ORIENTATIONS {
            let (sin, cos) = libm::sincos(FRAC_PI_2 * f64::from(turn) / f64::from(ORIENTATIONS));
            let axes = [DVec3::new(cos, sin, 0.0), DVec3::new(-sin, cos, 0.0), DVec3::Z].map(|x| frame.to_world(x));
            let spans = axes.map(|axis| span(&points, weight, axis, EDGE_TRIM));
            let [x, y, z] = spans.map(|[low, high]| high - low);
            let area = (x + z) * (y + z);
            if best.as_ref().is_none_or(|best| area < best.0) {
                let middle = |i: usize| axes[i] * (0.5 * (spans[i][0] + spans[i][1]));
                let half = |i: usize| axes[i] * (0.5 * (spans[i][1] - spans[i][0]));
                best = Some((area, middle(0) + middle(1) + middle(2), [half(0), half(1), half(2)]));
            }
        }
        let (_, center, half) = best?;
        let cost = PointSpread::of(&points).cost();
        Some(Self { points, cost, center, half })
    }

    /// Returns the best split into two parts.
    fn split(&self) -> Option<[Self; 2]> {
        let mut best: Option<(f64, DVec3, f64)> = None;
        for axis in self.half {
            for cut in 0..CUTS_PER_AXIS {
                let place = 2.0 * (cut as f64 + 1.0) / (CUTS_PER_AXIS as f64 + 1.0) - 1.0;
                let level = axis.dot(self.center) + place * axis.length_squared();
                let mut sides = [PointSpread::default(); 2];
                self.points
                    .iter()
                    .for_each(|point| sides[usize::from(point.0.dot(axis) > level)].add(point.0, point.1));
                let cost = sides[0].cost() + sides[1].cost();
                let are_populated = sides.iter().all(|side| side.count >= MIN_POINTS);
                if are_populated && best.is_none_or(|best| cost < best.0) {
                    best = Some((cost, axis, level));
                }
            }
        }
        let (_, axis, level) = best?;
        let (above, below) = self.points.iter().partition(|point| point.0.dot(axis) > level);
        Some([Self::from_points(above)?, Self::from_points(below)?])
    }
}

/// Moments of weighted points, which tell how far they are spread.
#[derive(Clone, Copy, Default)]
struct PointSpread {
    count: usize,
    weight: f64,
    sum: DVec3,
    squares: DVec3,
    /// Sums of y z, z x and x y.
    products: DVec3,
}

impl PointSpread {
    fn of(points: &[(DVec3, f64)]) -> Self {
        let mut all = Self::default();
        points.iter().for_each(|point| all.add(point.0, point.1));
        all
    }

    fn add(&mut self, point: DVec3, weight: f64) {
        self.count += 1;
        self.weight += weight;
        self.sum += point * weight;
        self.squares += point * point * weight;
        self.products += DVec3::new(point.y * point.z, point.z * point.x, point.x * point.y) * weight;
    }

    /// Returns weight times area, a measure of how much of the aiming is in vain.
    ///
    /// The sum of the products of two eigenvalues of the covariance, its second invariant, grows as the squared area.
    fn cost(&self) -> f64 {
        if self.weight <= 0.0 {
            return 0.0;
        }
        let mean = self.sum / self.weight;
        let squares = self.squares / self.weight - mean * mean;
        let mean_products = DVec3::new(mean.y * mean.z, mean.z * mean.x, mean.x * mean.y);
        let products = self.products / self.weight - mean_products;
        let DVec3 { x, y, z } = squares;
        self.weight * (x * y + y * z + z * x - products.length_squared()).max(0.0).sqrt()
    }
}

/// Returns the direction in which points vary least. First finds the direction in which they vary most by power
/// iteration; if they vary equally in a whole plane, this may be any direction of that plane. A 2 x 2 matrix is left,
/// so that a narrow slit has its own plane.
fn normal_of(points: &[(DVec3, f64)], weight: f64) -> DVec3 {
    let middle = points.iter().fold(DVec3::ZERO, |sum, (point, share)| sum + *point * (share / weight));
    let covariance_times = |x: DVec3| {
        points.iter().fold(DVec3::ZERO, |sum, (point, share)| {
            let offset = *point - middle;
            sum + offset * (offset.dot(x) * share / weight)
        })
    };
    let columns = [DVec3::X, DVec3::Y, DVec3::Z].map(covariance_times);
    let step = |x: DVec3| columns[0] * x.x + columns[1] * x.y + columns[2] * x.z;
    let mut major_axis = DVec3::new(0.36, 0.48, 0.8);
    for _ in 0..POWER_ITERATIONS {
        major_axis = step(step(major_axis)).try_normalize().unwrap_or(major_axis);
    }
    let frame = Frame::about(major_axis);
    let [a, b] = [DVec3::X, DVec3::Y].map(|axis| frame.to_world(axis));
    let angle = 0.5 * libm::atan2(2.0 * a.dot(step(b)), a.dot(step(a)) - b.dot(step(b)));
    let (sin, cos) = libm::sincos(angle);
    b * cos - a * sin
}

/// Returns a box around weighted points, except for a few beyond each of its sides.
pub fn trimmed_bounds(points: &[(DVec3, f64)], weight: f64) -> Bounds {
    let [x, y, z] = DVec3::AXES.map(|axis| span(points, weight, axis, BOX_TRIM));
    Bounds { min: DVec3::new(x[0], y[0], z[0]), max: DVec3::new(x[1], y[1], z[1]) }
}

/// Returns the interval that weighted points span along an axis, without the given share of the weight at each end.
fn span(points: &[(DVec3, f64)], weight: f64, axis: DVec3, trim: f64) -> [f64; 2] {
    let mut along: Vec<(f64, f64)> = points.iter().map(|(point, share)| (point.dot(axis), *share)).collect();
    along.sort_by(|a, b| a.0.total_cmp(&b.0));
    [trimmed_end(along.iter(), trim * weight), trimmed_end(along.iter().rev(), trim * weight)]
}

fn trimmed_end<'a>(mut along: impl Iterator<Item = &'a (f64, f64)>, mut weight_left: f64) -> f64 {
    let beyond = along.find(|point| {
        weight_left -= point.1;
        weight_left < 0.0
    });
    beyond.map_or(0.0, |point| point.0)
}
