//! Whether triangles enclose a volume.

use super::Vertices;

/// Counts the edges that keep triangles from enclosing a volume. Vertices at the same place count as one.
pub(super) fn open_edges(vertices: &Vertices, triangles: &[[u32; 3]]) -> usize {
    // If every edge has its counterpart, it also has one after vertices are merged.
    match count_unbalanced(vertices.count(), triangles, |corner| corner) {
        0 => 0,
        _ => {
            let welded = vertices.welded();
            count_unbalanced(vertices.count(), triangles, |corner| welded[corner as usize])
        }
    }
}

/// Counts the edges that do not run equally often in both directions.
///
/// The ends of the edges that leave each vertex are stored side by side, in 12 bytes per triangle.
fn count_unbalanced(vertices: usize, triangles: &[[u32; 3]], corner: impl Fn(u32) -> u32) -> usize {
    let edges = || triangles.iter().flat_map(|t| [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])]);
    let edges = || edges().map(|(a, b)| (corner(a), corner(b)));
    // The ends are counted in advance, then filled in backward. In the end, `first` is where the ends of each vertex
    // begin.
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
    let ends_from = |a: u32| &ends[first[a as usize]..first[a as usize + 1]];
    let count_at = |a: u32| {
        let bad = ends_from(a).chunk_by(|b, c| b == c).filter(|same| {
            let ends = ends_from(same[0]);
            let backward_count = ends.partition_point(|&end| end <= a) - ends.partition_point(|&end| end < a);
            // An edge that runs both ways is seen from both ends. It is counted at the lower one.
            backward_count != same.len() && (backward_count == 0 || a < same[0])
        });
        bad.count()
    };
    (0..vertices as u32).map(count_at).sum()
}
