//! A tree over lights that samples one of many for a point.
//!
//! Conty Estevez & Kulla 2018, *Importance Sampling of Many Lights with Adaptive Tree Splitting*, sections 4 and 5.1,
//! without their splitting: exactly one light is chosen for any point.

use super::LightBounds;
use super::bounds::LightGroup;
use crate::math::{BELOW_ONE, Bounds, DVec3, DiscreteSample, gamma};

/// Lights 0, 1, 2, .. in nested boxes, with the intensity and the orientations of the lights in each box.
#[derive(Clone, Debug)]
pub struct LightTree {
    nodes: Vec<Node>,
    /// Each node's parent. The root is its own parent.
    parents: Vec<u32>,
    /// Each light's leaf; `None` if it does not shine.
    leaves: Vec<Option<u32>>,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    center: DVec3,
    /// Radius of the sphere around the box.
    radius: f64,
    axis: DVec3,
    sin: f64,
    cos: f64,
    two_sided: bool,
    leaf: bool,
    /// The light of a leaf, or the first child of another node. Its sibling follows it.
    first: u32,
    intensity: f64,
}

/// Number of slices along each axis between which a node may be split.
const SLICES: usize = 12;
/// Depth from which on nodes are split in half.
const MEDIAN_SPLIT_DEPTH: u32 = 40;

impl LightTree {
    /// Builds the tree over lights. Lights that do not shine are never drawn.
    pub fn new(lights: &[LightBounds]) -> Self {
        let mut order: Vec<u32> = (0..lights.len() as u32).collect();
        order.retain(|&i| lights[i as usize].intensity > 0.0);
        let count = (2 * order.len()).saturating_sub(1);
        let (nodes, parents) = (Vec::with_capacity(count), Vec::with_capacity(count));
        let mut tree = Self { nodes, parents, leaves: vec![None; lights.len()] };
        if order.is_empty() {
            return tree;
        }
        tree.nodes.push(Node::around(lights, &order[..1]));
        tree.parents.push(0);
        let mut pending = vec![(0, 0..order.len(), 0)];
        while let Some((index, range, depth)) = pending.pop() {
            let items = &mut order[range.clone()];
            let mut node = Node::around(lights, items);
            if let [item] = *items {
                (node.leaf, node.first) = (true, item);
                tree.leaves[item as usize] = Some(index as u32);
            } else {
                let middle = range.start + split(lights, items, depth);
                node.first = tree.nodes.len() as u32;
                for (child, range) in [range.start..middle, middle..range.end].into_iter().enumerate() {
                    tree.nodes.push(node);
                    tree.parents.push(index as u32);
                    pending.push((node.first as usize + child, range, depth + 1));
                }
            }
            tree.nodes[index] = node;
        }
        tree
    }

    /// Samples a light for a point on a surface with the given normal; `None` if no light can reach it.
    ///
    /// With `two_sided`, the backs of all lights are visible, also of those that are not two-sided themselves.
    pub fn sample(&self, from: DVec3, normal: DVec3, two_sided: bool, mut u: f64) -> Option<DiscreteSample> {
        let (mut node, mut probability) = (self.nodes.first()?, 1.0);
        u = u.min(BELOW_ONE);
        while !node.leaf {
            let share = self.share(node.first as usize, from, normal, two_sided)?;
            let second = u >= share;
            u = (if second { (u - share) / (1.0 - share) } else { u / share }).min(BELOW_ONE);
            probability *= if second { 1.0 - share } else { share };
            node = &self.nodes[node.first as usize + usize::from(second)];
        }
        (probability > 0.0).then_some(DiscreteSample { index: node.first as usize, probability, u })
    }

    /// Returns the probability with which `sample` draws a light.
    pub fn probability(&self, light: usize, from: DVec3, normal: DVec3, two_sided: bool) -> f64 {
        let Some(leaf) = self.leaves[light] else { return 0.0 };
        let (mut node, mut probability) = (leaf, 1.0);
        while node != 0 {
            let parent = self.parents[node as usize];
            let first = self.nodes[parent as usize].first;
            let Some(share) = self.share(first as usize, from, normal, two_sided) else { return 0.0 };
            probability *= if node == first { share } else { 1.0 - share };
            node = parent;
        }
        probability
    }

    /// Returns the probability of taking the first of two siblings; `None` if neither can send light.
    fn share(&self, first: usize, from: DVec3, normal: DVec3, two_sided: bool) -> Option<f64> {
        let [a, b] = [0, 1].map(|child| self.nodes[first + child].importance(from, normal, two_sided));
        (a + b > 0.0).then(|| a / (a + b))
    }
}

/// Finds the split of least cost, reorders items so that the first group comes first, and returns its size.
fn split(lights: &[LightBounds], items: &mut [u32], depth: u32) -> usize {
    if items.len() == 2 {
        return 1;
    }
    let center = |item: u32| lights[item as usize].bounds.center();
    let centers = Bounds::around(items.iter().map(|&item| center(item)));
    let (low, size) = (centers.min, centers.size());
    let slice = |item: u32, axis: usize| {
        (((center(item)[axis] - low[axis]) / size[axis] * SLICES as f64) as usize).min(SLICES - 1)
    };
    let mut best: Option<(f64, usize, usize)> = None;
    for axis in (0..3).filter(|&axis| size[axis] > 0.0 && depth < MEDIAN_SPLIT_DEPTH) {
        let mut slices = [LightGroup::EMPTY; SLICES];
        for &item in items.iter() {
            let slice = &mut slices[slice(item, axis)];
            *slice = slice.with_light(&lights[item as usize]);
        }
        let mut after = [LightGroup::EMPTY; SLICES];
        (0..SLICES - 1).rev().for_each(|i| after[i] = slices[i + 1].union(&after[i + 1]));
        let mut before = LightGroup::EMPTY;
        for (i, (slice, after)) in slices.iter().zip(&after).enumerate() {
            if slice.intensity == 0.0 || after.intensity == 0.0 {
                continue;
            }
            before = before.union(slice);
            // Thin boxes are split along their length.
            let cost = (before.cost() + after.cost()) / size[axis];
            if best.is_none_or(|best| cost < best.0) {
                best = Some((cost, axis, i));
            }
        }
    }
    match best {
        Some((_, axis, last)) => {
            let (first, second): (Vec<u32>, Vec<u32>) = items.iter().partition(|&&item| slice(item, axis) <= last);
            items[..first.len()].copy_from_slice(&first);
            items[first.len()..].copy_from_slice(&second);
            first.len()
        }
        None => {
            let axis = size.max_position();
            items.sort_by(|&a, &b| center(a)[axis].total_cmp(&center(b)[axis]));
            items.len() / 2
        }
    }
}

impl Node {
    /// Creates the node around one or several lights.
    fn around(lights: &[LightBounds], items: &[u32]) -> Self {
        let each = || items.iter().map(|&item| &lights[item as usize]);
        let all = each().fold(LightGroup::EMPTY, |all, light| all.with_light(light));
        let axis = all.axis();
        let cosine = |light: &LightBounds| light.normal.zip(axis).map_or(-1.0, |(normal, axis)| normal.dot(axis));
        let min_cosine = each().map(cosine).fold(1.0, f64::min);
        // Rounding must leave no normal out: each of two unit vectors has six roundings, and their product three.
        let padded_cosine = (min_cosine - gamma(15)).max(-1.0);
        let cos = if items.len() == 1 && axis.is_some() { 1.0 } else { padded_cosine };
        let radius = (0.5 * all.bounds.size()).length();
        Self {
            center: all.bounds.center(),
            radius,
            axis: axis.unwrap_or(DVec3::Z),
            sin: (1.0 - cos * cos).max(0.0).sqrt(),
            cos,
            two_sided: all.two_sided,
            leaf: false,
            first: 0,
            intensity: all.intensity,
        }
    }

    /// Estimates the unoccluded light that reaches a point: equation 3 of the paper, times the cosine at the surface.
    /// The estimate is 0 exactly where the light is 0.
    ///
    /// For a sphere of radius r at distance d whose center has the cosine c, the brightest point has a positive cosine
    /// where c > -r / d. The expression (c + r / d) / (1 + r / d) captures this without roots.
    fn importance(&self, from: DVec3, normal: DVec3, two_sided: bool) -> f64 {
        let to_center = self.center - from;
        let distance_squared = to_center.length_squared();
        let receiver = normal.dot(to_center) + self.radius;
        if receiver <= 0.0 {
            return 0.0;
        }
        let distance = distance_squared.sqrt();
        let along = -self.axis.dot(to_center);
        let along = if two_sided || self.two_sided { along.abs() } else { along };
        // The largest cosine to a direction that the lights face: max(0, a - b) of two angles.
        let largest = if along >= self.cos * distance {
            distance
        } else {
            along * self.cos + (distance_squared - along * along).max(0.0).sqrt() * self.sin
        };
        let emitter = largest + self.radius;
        if emitter <= 0.0 {
            return 0.0;
        }
        let farthest = distance + self.radius;
        let denominator = distance_squared.max(self.radius * self.radius).max(MIN_DISTANCE_SQUARED)
            * (farthest * farthest).max(MIN_DISTANCE_SQUARED);
        self.intensity * (emitter * receiver / denominator)
    }
}

/// Keeps importances finite.
const MIN_DISTANCE_SQUARED: f64 = 1e-100;
