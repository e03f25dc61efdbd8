//! A tree over things that shine, by which one of many is chosen for a point.
//!
//! Conty Estevez & Kulla 2018, *Importance Sampling of Many Lights with Adaptive Tree Splitting*, sections 4 and 5.1, without
//! their splitting: from any point exactly one is chosen.

use std::f64::consts::PI;

use crate::math::{Bounds, DVec3};

/// What a tree knows of something that shines.
#[derive(Clone, Copy, Debug)]
pub struct Emitter {
    /// The box it fills.
    pub bounds: Bounds,
    /// The directions its front faces.
    pub facing: Facing,
    /// Whether its back shines as well.
    pub both: bool,
    /// Radiance times the area seen from where it is seen best.
    pub intensity: f64,
}

/// All directions within an angle of an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Facing {
    axis: DVec3,
    angle: f64,
}

impl Facing {
    /// Every direction.
    pub const ALL: Self = Self { axis: DVec3::Z, angle: PI };

    /// One direction.
    pub fn one(normal: DVec3) -> Self {
        Self { axis: normal, angle: 0.0 }
    }

    /// The middle of the directions.
    pub fn axis(&self) -> DVec3 {
        self.axis
    }

    /// The narrowest cone around both that contains their axes' great circle: algorithm 1 of the paper.
    pub fn union(self, other: Self) -> Self {
        let (wide, narrow) = if self.angle >= other.angle { (self, other) } else { (other, self) };
        if wide.angle >= PI {
            return Self::ALL;
        }
        let sin = wide.axis.cross(narrow.axis).length();
        let between = libm::atan2(sin, wide.axis.dot(narrow.axis));
        if between + narrow.angle <= wide.angle {
            return wide;
        }
        // A little wider, so that rounding leaves no axis out.
        let angle = 0.5 * (wide.angle + between + narrow.angle) + 1e-12;
        if angle >= PI || sin == 0.0 && between > 1.0 {
            return Self::ALL;
        }
        if sin == 0.0 {
            return Self { angle, ..wide };
        }
        let turn = angle - wide.angle;
        let axis = wide.axis * (libm::sin(between - turn) / sin) + narrow.axis * (libm::sin(turn) / sin);
        match axis.try_normalize() {
            Some(axis) => Self { axis, angle },
            None => Self::ALL,
        }
    }

    /// The paper's measure of orientations, for lights that shine by the cosine.
    fn measure(&self) -> f64 {
        let widest = (self.angle + 0.5 * PI).min(PI);
        let (sin, cos) = libm::sincos(self.angle);
        let beyond = 2.0 * widest * sin - libm::cos(self.angle - 2.0 * widest) - 2.0 * self.angle * sin + cos;
        2.0 * PI * (1.0 - cos) + 0.5 * PI * beyond
    }
}

/// The tree.
#[derive(Clone, Debug)]
pub struct Emitters {
    nodes: Vec<Node>,
    /// Each node's parent; the root is its own.
    parents: Vec<u32>,
    /// Each emitter's leaf, if it shines.
    leaves: Vec<Option<u32>>,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    center: DVec3,
    /// Of the sphere around the box.
    radius: f64,
    axis: DVec3,
    sin: f64,
    cos: f64,
    both: bool,
    leaf: bool,
    /// The emitter of a leaf, or the first child, whose sibling follows it.
    first: u32,
    intensity: f64,
}

/// An emitter chosen at random.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// Its number.
    pub emitter: u32,
    /// How likely it was.
    pub probability: f64,
    /// What is left of the random number, again uniform in [0, 1).
    pub u: f64,
}

/// The largest number below 1.
const BELOW_ONE: f64 = 1.0 - f64::EPSILON / 2.0;
/// Slices along each axis between which a node is split.
const SLICES: usize = 12;
/// Depth below which nodes are split by halves.
const DEEP: u32 = 40;

impl Emitters {
    /// The tree over emitters 0, 1, 2, ..; those that do not shine are never chosen.
    pub fn new(emitters: &[Emitter]) -> Self {
        let mut order: Vec<u32> = (0..emitters.len() as u32).collect();
        order.retain(|&i| emitters[i as usize].intensity > 0.0);
        let mut tree = Self { nodes: Vec::new(), parents: Vec::new(), leaves: vec![None; emitters.len()] };
        if order.is_empty() {
            return tree;
        }
        tree.nodes.push(Node::around(&emitters[order[0] as usize]));
        tree.parents.push(0);
        let mut open = vec![(0, 0..order.len(), 0)];
        while let Some((index, range, depth)) = open.pop() {
            let items = &mut order[range.clone()];
            let all = items.iter().map(|&i| emitters[i as usize]).reduce(|a, b| a.with(&b)).expect("no range is empty");
            let mut node = Node::around(&all);
            if let [item] = *items {
                (node.leaf, node.first) = (true, item);
                tree.leaves[item as usize] = Some(index as u32);
            } else {
                let middle = range.start + split(emitters, items, &all, depth);
                node.first = tree.nodes.len() as u32;
                for (child, range) in [range.start..middle, middle..range.end].into_iter().enumerate() {
                    tree.nodes.push(node);
                    tree.parents.push(index as u32);
                    open.push((node.first as usize + child, range, depth + 1));
                }
            }
            tree.nodes[index] = node;
        }
        tree
    }

    /// Chooses an emitter for a point on a surface of the given normal; none where no light can come from any.
    ///
    /// `both`: whether backs are seen of emitters that do not say so themselves.
    pub fn choose(&self, from: DVec3, normal: DVec3, both: bool, mut u: f64) -> Option<Choice> {
        let (mut node, mut probability) = (self.nodes.first()?, 1.0);
        u = u.min(BELOW_ONE);
        while !node.leaf {
            let share = self.share(node.first as usize, from, normal, both)?;
            let second = u >= share;
            u = (if second { (u - share) / (1.0 - share) } else { u / share }).min(BELOW_ONE);
            probability *= if second { 1.0 - share } else { share };
            node = &self.nodes[node.first as usize + usize::from(second)];
        }
        (probability > 0.0).then_some(Choice { emitter: node.first, probability, u })
    }

    /// How likely `choose` chooses an emitter.
    pub fn probability(&self, emitter: usize, from: DVec3, normal: DVec3, both: bool) -> f64 {
        let Some(leaf) = self.leaves[emitter] else { return 0.0 };
        let (mut node, mut probability) = (leaf, 1.0);
        while node != 0 {
            let parent = self.parents[node as usize];
            let first = self.nodes[parent as usize].first;
            let Some(share) = self.share(first as usize, from, normal, both) else { return 0.0 };
            probability *= if node == first { share } else { 1.0 - share };
            node = parent;
        }
        probability
    }

    /// How often the first of two siblings is taken; none where neither can send light.
    fn share(&self, first: usize, from: DVec3, normal: DVec3, both: bool) -> Option<f64> {
        let [a, b] = [0, 1].map(|child| self.nodes[first + child].importance(from, normal, both));
        (a + b > 0.0).then(|| a / (a + b))
    }
}

impl Emitter {
    /// Both as one.
    pub fn with(&self, other: &Self) -> Self {
        Self {
            bounds: self.bounds.union(other.bounds),
            facing: self.facing.union(other.facing),
            both: self.both || other.both,
            intensity: self.intensity + other.intensity,
        }
    }

    fn cost(&self) -> f64 {
        let edges = self.bounds.max - self.bounds.min;
        let area = edges.x * edges.y + edges.y * edges.z + edges.z * edges.x;
        // Lamps on a line or in a point have no area; their length tells them apart.
        self.intensity * (area + 1e-6 * edges.length_squared()) * self.facing.measure()
    }
}

/// Reorders items so that the first of two groups comes first, and tells how many it has: the split of least cost.
fn split(emitters: &[Emitter], items: &mut [u32], all: &Emitter, depth: u32) -> usize {
    let center = |item: u32| emitters[item as usize].bounds.center();
    let centers = Bounds::around(items.iter().map(|&item| center(item)));
    let (low, size) = (centers.min, centers.max - centers.min);
    let longest = (all.bounds.max - all.bounds.min).max_element();
    let slice = |item: u32, axis: usize| {
        (((center(item)[axis] - low[axis]) / size[axis] * SLICES as f64) as usize).min(SLICES - 1)
    };
    let mut best: Option<(f64, usize, usize)> = None;
    for axis in (0..3).filter(|&axis| size[axis] > 0.0 && depth < DEEP) {
        let mut slices: [Option<Emitter>; SLICES] = [None; SLICES];
        let join = |a: Option<Emitter>, b: Option<Emitter>| match (a, b) {
            (Some(a), Some(b)) => Some(a.with(&b)),
            (a, b) => a.or(b),
        };
        for &item in items.iter() {
            let slice = &mut slices[slice(item, axis)];
            *slice = join(*slice, Some(emitters[item as usize]));
        }
        let mut after = [None; SLICES];
        (0..SLICES - 1).rev().for_each(|i| after[i] = join(slices[i + 1], after[i + 1]));
        let mut before = None;
        for (i, after) in after.iter().enumerate() {
            before = join(before, slices[i]);
            if let (Some(before), Some(after)) = (&before, after) {
                // Thin boxes are split along their length.
                let cost = (before.cost() + after.cost()) * longest / size[axis];
                if best.is_none_or(|best| cost < best.0) {
                    best = Some((cost, axis, i));
                }
            }
        }
    }
    match best {
        Some((_, axis, last)) => {
            items.sort_by_key(|&item| slice(item, axis) > last);
            items.partition_point(|&item| slice(item, axis) <= last)
        }
        None => {
            let axis = size.max_position();
            items.sort_by(|&a, &b| center(a)[axis].total_cmp(&center(b)[axis]));
            items.len() / 2
        }
    }
}

impl Node {
    fn around(emitter: &Emitter) -> Self {
        let Emitter { bounds, facing, both, intensity } = *emitter;
        let (sin, cos) = libm::sincos(facing.angle);
        let radius = (0.5 * (bounds.max - bounds.min)).length();
        let center = bounds.center();
        Self { center, radius, axis: facing.axis, sin, cos, both, leaf: false, first: 0, intensity }
    }

    /// About the light that reaches a point but for what hides it: equation 3 of the paper, times the cosine at the
    /// surface, and 0 exactly where those are.
    ///
    /// Of a sphere of radius r at distance d whose center has the cosine c, the brightest point has a cosine above 0 where
    /// c > -r / d; (c + r / d) / (1 + r / d) is that without roots.
    fn importance(&self, from: DVec3, normal: DVec3, both: bool) -> f64 {
        let way = self.center - from;
        let squared = way.length_squared();
        let lit = normal.dot(way) + self.radius;
        if lit <= 0.0 {
            return 0.0;
        }
        let distance = squared.sqrt();
        let along = -self.axis.dot(way);
        let along = if both || self.both { along.abs() } else { along };
        // The largest cosine to a direction faced: max(0, a - b) of two angles.
        let largest = if along >= self.cos * distance {
            distance
        } else {
            along * self.cos + (squared - along * along).max(0.0).sqrt() * self.sin
        };
        let seen = largest + self.radius;
        if seen <= 0.0 {
            return 0.0;
        }
        let whole = distance + self.radius;
        let spread = squared.max(self.radius * self.radius).max(NEAREST) * (whole * whole).max(NEAREST);
        self.intensity * (seen * lit / spread)
    }
}

/// Keeps importances finite.
const NEAREST: f64 = 1e-100;
