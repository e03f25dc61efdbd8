//! A mesh's triangles in the order of its tree's leaves, tested against a ray four at a time.

use super::triangle::Sheared;
use super::{Bvh, Crossing, Vertices, Visitor};
use crate::math::{DVec3, Ray};

/// Copies of all corners, in the precision of the vertices.
#[derive(Clone, Debug)]
pub(super) enum Packed {
    Single(Vec<Block<f32>>),
    Double(Vec<Block<f64>>),
}

/// Four triangles side by side: for each corner and coordinate, four numbers. Absent triangles have NaN.
#[derive(Clone, Debug)]
pub(super) struct Block<T>([[[T; Packed::GROUP]; 3]; 3]);

impl Packed {
    /// Triangles in a block, and items in a group of the tree.
    pub const GROUP: usize = 4;

    /// The blocks of triangles listed in the order of a tree.
    pub fn new(vertices: &Vertices, triangles: &[[u32; 3]], items: &[u32]) -> Self {
        match vertices {
            Vertices::Single(points) => Self::Single(blocks(points, triangles, items, f32::NAN)),
            Vertices::Double(points) => Self::Double(blocks(points, triangles, items, f64::NAN)),
        }
    }

    /// The nearest crossing with 0 < t <= `t_max`; of equally near ones, that of the triangle listed first.
    pub fn nearest(&self, bvh: &Bvh, ray: &Ray, t_max: f64) -> Option<Crossing> {
        match self {
            Self::Single(blocks) => nearest(blocks, bvh, ray, t_max),
            Self::Double(blocks) => nearest(blocks, bvh, ray, t_max),
        }
    }

    /// Whether there is a crossing with 0 < t <= `t_max`.
    pub fn any(&self, bvh: &Bvh, ray: &Ray, t_max: f64) -> bool {
        match self {
            Self::Single(blocks) => any(blocks, bvh, ray, t_max),
            Self::Double(blocks) => any(blocks, bvh, ray, t_max),
        }
    }
}

fn blocks<P: Copy + Into<[T; 3]>, T: Copy>(
    points: &[P],
    triangles: &[[u32; 3]],
    items: &[u32],
    absent: T,
) -> Vec<Block<T>> {
    let block = |items: &[u32]| {
        let mut block = Block([[[absent; Packed::GROUP]; 3]; 3]);
        for (lane, &item) in items.iter().enumerate().filter(|&(_, &item)| item != Bvh::NONE) {
            for (corner, &vertex) in triangles[item as usize].iter().enumerate() {
                let point: [T; 3] = points[vertex as usize].into();
                for (axis, &x) in point.iter().enumerate() {
                    block.0[corner][axis][lane] = x;
                }
            }
        }
        block
    };
    items.chunks_exact(Packed::GROUP).map(block).collect()
}

fn nearest<T: Copy + Into<f64>>(blocks: &[Block<T>], bvh: &Bvh, ray: &Ray, t_max: f64) -> Option<Crossing> {
    let visitor = Nearest { blocks, items: bvh.items(), sheared: Sheared::new(ray), found: None };
    bvh.walk_in_order(ray, t_max, visitor).found
}

fn any<T: Copy + Into<f64>>(blocks: &[Block<T>], bvh: &Bvh, ray: &Ray, t_max: f64) -> bool {
    bvh.walk(ray, t_max, Any { blocks, sheared: Sheared::new(ray), found: false }).found
}

struct Nearest<'a, T> {
    blocks: &'a [Block<T>],
    items: &'a [u32],
    sheared: Sheared,
    found: Option<Crossing>,
}

impl<T: Copy + Into<f64>> Visitor for Nearest<'_, T> {
    #[inline(always)]
    fn visit(&mut self, first: usize, groups: usize, mut t_max: f64) -> Option<f64> {
        for group in first..first + groups {
            let block = &self.blocks[group];
            let mut inside = block.inside(&self.sheared);
            while inside != 0 {
                let lane = (inside.trailing_zeros() & 3) as usize;
                inside &= inside - 1;
                if let Some(crossing) = block.crossing(lane, &self.sheared, t_max) {
                    let item = self.items[group * Packed::GROUP + lane];
                    if self.found.is_none_or(|found| crossing.t < found.t || item < found.part) {
                        self.found = Some(Crossing { part: item, ..crossing });
                    }
                    t_max = crossing.t;
                }
            }
        }
        Some(t_max)
    }
}

struct Any<'a, T> {
    blocks: &'a [Block<T>],
    sheared: Sheared,
    found: bool,
}

impl<T: Copy + Into<f64>> Visitor for Any<'_, T> {
    #[inline(always)]
    fn visit(&mut self, first: usize, groups: usize, t_max: f64) -> Option<f64> {
        for block in &self.blocks[first..first + groups] {
            let mut inside = block.inside(&self.sheared);
            while inside != 0 {
                let lane = (inside.trailing_zeros() & 3) as usize;
                inside &= inside - 1;
                if block.crossing(lane, &self.sheared, t_max).is_some() {
                    self.found = true;
                    return None;
                }
            }
        }
        Some(t_max)
    }
}

impl<T: Copy + Into<f64>> Block<T> {
    /// A bit for each triangle that the line of a ray may run through, edges and corners included.
    ///
    /// The edge functions are rounded as in `Sheared::intersect`. One that is not 0 has the right sign, for rounding
    /// keeps the order of products; so what has two of opposite signs is refused there as well, and nothing else is here.
    #[inline(always)]
    fn inside(&self, sheared: &Sheared) -> u32 {
        const N: usize = Packed::GROUP;
        let [x, y, z] = sheared.order;
        let origin = sheared.origin.to_array();
        let mut corners = [[[0.0; N]; 2]; 3];
        for (corner, [across, up]) in self.0.iter().zip(&mut corners) {
            for i in 0..N {
                let along = corner[z][i].into() - origin[z];
                across[i] = (corner[x][i].into() - origin[x]) - sheared.shear.x * along;
                up[i] = (corner[y][i].into() - origin[y]) - sheared.shear.y * along;
            }
        }
        let [a, b, c] = corners;
        let mut inside = 0;
        for i in 0..N {
            let u = c[0][i] * b[1][i] - c[1][i] * b[0][i];
            let v = a[0][i] * c[1][i] - a[1][i] * c[0][i];
            let w = b[0][i] * a[1][i] - b[1][i] * a[0][i];
            let least = if u < v { u } else { v };
            let least = if w < least { w } else { least };
            let most = if u > v { u } else { v };
            let most = if w > most { w } else { most };
            inside |= u32::from(least >= 0.0 || most <= 0.0) << i;
        }
        inside
    }

    /// The crossing of one of the triangles with 0 < t <= `t_max`.
    #[inline]
    fn crossing(&self, lane: usize, sheared: &Sheared, t_max: f64) -> Option<Crossing> {
        let corner = |corner: &[[T; Packed::GROUP]; 3]| DVec3::from(corner.map(|x| x[lane].into()));
        sheared.intersect([corner(&self.0[0]), corner(&self.0[1]), corner(&self.0[2])], t_max)
    }
}
