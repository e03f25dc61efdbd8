//! From a shape as written to a shape that rays can hit.

use super::context::Context;
use super::mesh::mesh;
use super::ranges::{MAX_LENGTH, MIN_LENGTH, direction, length, point, positive_length};
use super::shape_text::ShapeText;
use crate::math::{DVec3, Transform};
use crate::scene::text::{Choice, Fields, Spanned, Value, exactly, spanned};
use crate::shape::{Cube, Disc, Plane, Quad, Shape, Sphere, Triangle};

/// Smallest size relative to the coordinates: several thousand rounding errors.
const MIN_RELATIVE_SIZE: f64 = 1e-12;

/// The reader of a kind of shape. It also receives the name of the object.
type ShapeReader = for<'d> fn(&mut Context, &str, Value<'d>) -> Option<ShapeText<'d>>;

/// The shapes. Each is documented where it is implemented, in `shape`.
pub(super) const SHAPE: Choice<ShapeReader> = Choice {
    name: "a shape",
    word: "shape",
    example: "shape.sphere = { center = [0, 1, 0], radius = 1 }",
    second_kind_help: "start another [[object]] for the second shape",
    outside_keys: &[
        "name",
        "material",
        "transform",
        "instances",
        "group",
        "visible_to_camera",
        "holdout",
        "shadow_catcher",
        "bump_map",
        "normal_map",
    ],
    kinds: &[
        ("plane", |_, _, value| plane(value).map(ShapeText::from)),
        ("triangle", |_, _, value| triangle(value).map(ShapeText::from)),
        ("sphere", |_, _, value| sphere(value).map(ShapeText::from)),
        ("disc", |_, _, value| disc(value).map(ShapeText::from)),
        ("quad", |_, _, value| quad(value).map(ShapeText::from)),
        ("cube", |_, _, value| cube(value).map(ShapeText::from)),
        ("mesh", mesh),
    ],
};

fn plane(value: Value) -> Option<Shape> {
    Fields::read(value, |plane| {
        let point = plane.need("point", point);
        let normal = plane.need("normal", direction);
        Some(Shape::Plane(Plane::new(point?, normal?)))
    })
}

fn triangle(value: Value) -> Option<Shape> {
    Fields::read(value, |triangle| {
        let place = triangle.need("points", Some)?;
        let points = place.list(|entry| point(entry.as_list("a point", "")))?;
        match exactly(points, |count| place.refuse(format!("a triangle has 3 points, not {count}")))? {
            points if Triangle::is_degenerate(points) => {
                place.refuse("the points of a triangle must not lie on a line")
            }
            points => Some(Shape::Triangle(Triangle::new(points))),
        }
    })
}

fn sphere(value: Value) -> Option<Shape> {
    Fields::read(value, |sphere| {
        let center = sphere.need("center", point);
        let radius = sphere.need("radius", |value| length(value, "a radius"));
        Some(Shape::Sphere(Sphere::new(center?, radius?)))
    })
}

fn disc(value: Value) -> Option<Shape> {
    Fields::read(value, |disc| {
        let center = disc.need("center", point);
        let normal = disc.need("normal", direction);
        let radius = disc.need("radius", |value| length(value, "a radius"));
        let u = disc.maybe("u", spanned(direction));
        let (center, normal, radius, u) = (center?, normal?, radius?, u?);
        match Disc::new(center, normal, radius, u.map(|u| u.value)) {
            Some(disc) => Some(Shape::Disc(disc)),
            None => u.map_or(value, |u| u.place).refuse("a disc's u must not be parallel to its normal"),
        }
    })
}

fn quad(value: Value) -> Option<Shape> {
    Fields::read(value, |quad| {
        let center = quad.need("center", point);
        let u = quad.need("u", direction);
        let v = quad.need("v", spanned(direction));
        let (center, u, v) = (center?, u?, v?);
        if u.normalize().cross(v.value.normalize()) == DVec3::ZERO {
            return v.place.refuse("a quad's u and v must not be parallel");
        }
        Some(Shape::Quad(Quad::new(center, u, v.value)))
    })
}

/// Reads a cube, which has one size or three.
fn cube(value: Value) -> Option<Shape> {
    Fields::read(value, |cube| {
        let center = cube.need("center", point);
        let size = cube.need("size", |value| {
            let size: [f64; 3] = value.one_or("[x, y, z]")?;
            size.into_iter().all(|edge| positive_length(value, "an edge", edge).is_some()).then_some(size)
        });
        Some(Shape::Cube(Cube::new(center?, size?.into())))
    })
}

/// Checks that floating-point numbers can hold the size and the place of a shape. `shape` and `placed` are the shape
/// before and after the map; `whole` is where the shape is written.
pub(super) fn check_size(shape: &Shape, placed: &Shape, map: Spanned<Transform>, whole: Value) -> Option<()> {
    let Some(bounds) = placed.bounds() else { return Some(()) };
    let (far, wide) = (bounds.min.abs().max(bounds.max.abs()).max_element(), bounds.size());
    let edges = match shape {
        Shape::Cube(cube) => Some(cube.edges()),
        Shape::Sphere(_) => {
            let around = shape.bounds().map(|around| around.size());
            around.map(|size| [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| axis * size))
        }
        _ => None,
    };
    let thin = edges.map_or(wide.max_element(), |edges| thickness(edges, &map.value));
    if !(thin >= MIN_LENGTH && far <= 2.0 * MAX_LENGTH) {
        return map.place.refuse("this makes the shape too small, too large or too far away");
    }
    if thin < MIN_RELATIVE_SIZE * far {
        return whole.refuse("this is so small or thin that rounding its coordinates would distort it");
    }
    Some(())
}

/// Returns the least distance between two opposite faces of a box with these edges after a map.
fn thickness(edges: [DVec3; 3], map: &Transform) -> f64 {
    let [a, b, c] = edges.map(|edge| map.vector(edge));
    let height = |edge: DVec3, u: DVec3, v: DVec3| edge.dot(u.normalize().cross(v.normalize()).normalize()).abs();
    height(a, b, c).min(height(b, c, a)).min(height(c, a, b))
}
