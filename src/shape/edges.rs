//! Whether triangles enclose a volume.

use super::Vertices;

/// Edges that keep triangles from enclosing a volume, vertices at the same place counting as one.
pub(super) fn open_edges(vertices: &Vertices, triangles: &[[u32; 3]]) -> usize {
    // Where every edge has its counterpart, it also has one after vertices have become one.
    match unbalanced(vertices.count(), triangles, |corner| corner) {
        0 => 0,
        _ => {
            let merged = vertices.merged();
            unbalanced(vertices.count(), triangles, |corner| merged[corner as usize])
        }
    }
}

/// Edges that do not run as often one way as the other.
///
/// The ends of the edges that leave each vertex are gathered side by side, 12 bytes for a triangle.
fn unbalanced(vertices: usize, triangles: &[[u32; 3]], corner: impl Fn(u32) -> u32) -> usize {
    let edges = || triangles.iter().flat_map(|t| [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])]);
    let edges = || edges().map(|(a, b)| (corner(a), corner(b)));
    // Counted in advance, then filled in backward: at the end, `first` is where each vertex's ends begin.
    let mut first = vec![0usize; vertices + 1];
    edges().for_each(|(a, _)| first[a as usize] += 1);
    let mut sum = 0;
    for count in &mut first {
        sum += *count;
        *count = sum;
    }
    let mut ends = vec![0u32; sum];
    for (a, b) in edges() {
        first[a as usize] -= 1;
        ends[first[a as usize]] = b;
    }
    for vertex in 0..vertices {
        ends[first[vertex]..first[vertex + 1]].sort_unstable();
    }
    let leaving = |a: u32| &ends[first[a as usize]..first[a as usize + 1]];
    let of_vertex = |a: u32| {
        let bad = leaving(a).chunk_by(|b, c| b == c).filter(|same| {
            let ends = leaving(same[0]);
            let back = ends.partition_point(|&end| end <= a) - ends.partition_point(|&end| end < a);
            // Seen from both ends where it runs both ways: counted at the lower one.
            back != same.len() && (back == 0 || a < same[0])
        });
        bad.count()
    };
    (0..vertices as u32).map(of_vertex).sum()
}
