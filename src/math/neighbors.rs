use super::{Bounds, DVec3};

/// Divides items into at most `limit` groups of neighbors, and calls `take` with each group. Groups are cut in half
/// across the longest side of the box around their centers.
pub fn group_neighbors<T>(items: &mut [T], limit: usize, center: &impl Fn(&T) -> DVec3, take: &mut impl FnMut(&[T])) {
    if items.len() <= limit {
        return items.chunks(1).for_each(take);
    }
    if limit == 1 {
        return take(items);
    }
    let size = Bounds::around(items.iter().map(center)).size();
    let axis = (0..3).max_by(|&a, &b| size[a].total_cmp(&size[b])).unwrap_or(0);
    items.sort_by(|a, b| center(a)[axis].total_cmp(&center(b)[axis]));
    let (left, right) = items.split_at_mut(items.len() / 2);
    group_neighbors(left, limit / 2, center, take);
    group_neighbors(right, limit - limit / 2, center, take);
}
