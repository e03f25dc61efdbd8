//! Triangles that face the other way than those around them.

use super::Vertices;

/// One side of a triangle, given by two vertices with the lower one first, and whether it runs in this order.
struct Side {
    ends: [u32; 2],
    is_ascending: bool,
    triangle: u32,
}

/// Returns how many triangles must be flipped for all of them to enclose a volume, where vertices at the same place
/// count as one. In each piece, the smaller of the two possible numbers is counted. Returns 0 if some edge is not
/// shared by two triangles, or if no flipping closes the mesh.
pub(super) fn turned(vertices: &Vertices, triangles: &[[u32; 3]]) -> usize {
    let welded = vertices.welded();
    let side = |triangle: usize, [a, b]: [u32; 2]| {
        let [a, b] = [a, b].map(|corner| welded[corner as usize]);
        Side { ends: [a.min(b), a.max(b)], is_ascending: a < b, triangle: triangle as u32 }
    };
    let sides = triangles.iter().enumerate();
    let sides = sides.flat_map(|(at, t)| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]].map(|ends| side(at, ends)));
    let mut sides: Vec<Side> = sides.collect();
    sides.sort_unstable_by_key(|side| side.ends);
    let mut neighbors = vec![Vec::<Neighbor>::new(); triangles.len()];
    for edge in sides.chunk_by(|a, b| a.ends == b.ends) {
        let [a, b] = edge else { return 0 };
        let is_opposed = a.is_ascending == b.is_ascending;
        neighbors[a.triangle as usize].push(Neighbor { triangle: b.triangle, is_opposed });
        neighbors[b.triangle as usize].push(Neighbor { triangle: a.triangle, is_opposed });
    }
    count_flipped(&neighbors).unwrap_or_default()
}

/// A triangle on the other side of an edge.
#[derive(Clone, Copy)]
struct Neighbor {
    triangle: u32,
    /// Whether one of the two triangles is flipped.
    is_opposed: bool,
}

/// Counts the flipped triangles of all pieces. Returns `None` if a piece has only one side.
fn count_flipped(neighbors: &[Vec<Neighbor>]) -> Option<usize> {
    let (mut is_flipped, mut all) = (vec![None; neighbors.len()], 0);
    for first in 0..neighbors.len() {
        if is_flipped[first].is_some() {
            continue;
        }
        is_flipped[first] = Some(false);
        let (mut open, mut count, mut turned) = (vec![first], 0, 0);
        while let Some(triangle) = open.pop() {
            let is_this_flipped = is_flipped[triangle] == Some(true);
            (count, turned) = (count + 1, turned + usize::from(is_this_flipped));
            for neighbor in &neighbors[triangle] {
                let (other, should_flip) = (neighbor.triangle as usize, is_this_flipped != neighbor.is_opposed);
                match is_flipped[other] {
                    None => {
                        is_flipped[other] = Some(should_flip);
                        open.push(other);
                    }
                    Some(known) if known != should_flip => return None,
                    Some(_) => {}
                }
            }
        }
        all += turned.min(count - turned);
    }
    Some(all)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::DVec3;

    #[test]
    fn triangles_of_a_tetrahedron_that_are_turned_over_are_counted() {
        let vertices = Vertices::Double(vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z]);
        let closed = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        assert_eq!(turned(&vertices, &closed), 0);
        for at in 0..4 {
            let mut one = closed;
            one[at].swap(0, 1);
            assert_eq!(turned(&vertices, &one), 1);
        }
        assert_eq!(turned(&vertices, &closed[..3]), 0);
    }

    #[test]
    fn a_strip_with_one_side_only_has_no_triangle_that_is_turned_over() {
        // The projective plane with six vertices: each edge is shared by two triangles.
        let plane = [
            [0, 1, 2],
            [0, 2, 3],
            [0, 3, 4],
            [0, 4, 5],
            [0, 5, 1],
            [1, 2, 4],
            [2, 3, 5],
            [3, 4, 1],
            [4, 5, 2],
            [5, 1, 3],
        ];
        let at = |index: u32| DVec3::new(f64::from(index), f64::from(index * index), f64::from(index % 2));
        assert_eq!(turned(&Vertices::Double((0..6).map(at).collect()), &plane), 0);
    }
}
