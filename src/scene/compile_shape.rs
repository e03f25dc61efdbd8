//! From a shape as written to a shape that rays can meet.

use super::compile::Compiler;
use super::description::{ObjectText, ShapeText, StepText};
use super::gather::{Gather, all};
use super::source::At;
use crate::error::Result;
use crate::math::{DVec3, Transform};
use crate::shape::{Coordinates, Cube, Disc, Plane, Quad, Shape, Sphere, Triangle};

/// Largest length and coordinate: products of a few of them stay far within f64 and f32.
pub(super) const MAX_LENGTH: f64 = 1e30;
/// Smallest size, for the same reason.
const MIN_LENGTH: f64 = 1e-30;
/// Smallest size relative to the coordinates: some thousand roundings.
const RESOLVED: f64 = 1e-12;

/// Checks and builds the shape of one object.
pub(super) struct ShapeCompiler<'a, 'b> {
    pub(super) compiler: &'a mut Compiler<'b>,
    pub(super) name: &'a str,
    /// Whether a medium fills the shape.
    pub(super) filled: bool,
}

impl Compiler<'_> {
    /// A point that is not too far away.
    pub(super) fn point(&self, at: &At, point: [f64; 3]) -> Result<DVec3> {
        match point.iter().position(|x| !x.is_finite() || x.abs() > MAX_LENGTH) {
            Some(axis) => {
                let message = match point[axis] {
                    x if x.is_finite() => format!("a coordinate is at most {MAX_LENGTH:e}"),
                    x => format!("a coordinate is a finite number, not {x}"),
                };
                Err(self.source.mistake_at(&at.index(axis), message, None))
            }
            None => Ok(point.into()),
        }
    }

    /// A vector of finite length above 0.
    pub(super) fn direction(&self, at: &At, vector: [f64; 3]) -> Result<DVec3> {
        let vector = self.point(at, vector)?;
        match vector.try_normalize() {
            Some(_) => Ok(vector),
            None => Err(self.source.mistake_at(at, "a direction needs a length above 0", None)),
        }
    }

    pub(super) fn length(&self, at: &At, what: &str, length: f64) -> Result<f64> {
        if (MIN_LENGTH..=MAX_LENGTH).contains(&length) {
            return Ok(length);
        }
        let message = if length > 0.0 && length.is_finite() {
            format!("{what} is a length from {MIN_LENGTH:e} to {MAX_LENGTH:e}")
        } else {
            format!("{what} is a length above 0, not {length}")
        };
        Err(self.source.mistake_at(at, message, None))
    }
}

impl ShapeCompiler<'_, '_> {
    /// The shape of an object, or each of its instances, and where its points lie in images.
    pub(super) fn shapes(&mut self, object: &At, text: &ObjectText) -> Result<Vec<(Shape, Option<Coordinates>)>> {
        let place = object.key("transform");
        let shape = self.shape(&object.key("shape"), &text.shape);
        let map = self.compiler.transform(&place, &text.transform, Transform::IDENTITY);
        let (shape, map) = (shape, map).gather()?;
        if self.filled && !shape.is_closed() && matches!(shape, Shape::Mesh(_)) {
            let warning = format!("{}: a dielectric on an open mesh: light may enter it and never leave", self.name);
            self.compiler.warnings.push(warning);
        }
        let Some(instances) = &text.instances else {
            let shared = self.compiler.meshes.is_shared(&text.shape);
            let coordinates = Coordinates::new(&shape, &map);
            let placed = if shared { shape.copied(&map) } else { shape.transformed(&map) };
            self.check_size([&place, &object.key("shape")], (&placed, &text.shape), &map)?;
            return Ok(vec![(placed, coordinates)]);
        };
        let list = object.key("instances");
        if instances.is_empty() {
            return self.refuse(&list, "a list without instances leaves nothing of the object");
        }
        let place = |(number, steps): (usize, &Vec<StepText>)| {
            let at = list.index(number);
            let map = self.compiler.transform(&at, steps, map)?;
            let placed = shape.copied(&map);
            self.check_size([&at; 2], (&placed, &text.shape), &map)?;
            Ok((placed, Coordinates::new(&shape, &map)))
        };
        all(instances.iter().enumerate().map(place))
    }

    /// Refuses a shape whose size or place numbers do not hold.
    fn check_size(&self, [steps, whole]: [&At; 2], (shape, text): (&Shape, &ShapeText), map: &Transform) -> Result<()> {
        let Some(bounds) = shape.bounds() else { return Ok(()) };
        let (far, wide) = (bounds.min.abs().max(bounds.max.abs()).max_element(), bounds.max - bounds.min);
        let thin = thickness(text, map).unwrap_or(wide.max_element());
        if !(thin >= MIN_LENGTH && far <= 2.0 * MAX_LENGTH) {
            return self.refuse(steps, "this makes the shape too small, too large or too far");
        }
        if thin < RESOLVED * far {
            let message = "this is so small or thin that the rounding of its coordinates would distort it";
            return self.refuse(whole, message);
        }
        Ok(())
    }

    fn shape(&mut self, at: &At, text: &ShapeText) -> Result<Shape> {
        Ok(match text {
            ShapeText::Plane(plane) => {
                let at = at.key("plane");
                let point = self.compiler.point(&at.key("point"), plane.point);
                let normal = self.compiler.direction(&at.key("normal"), plane.normal);
                let (point, normal) = (point, normal).gather()?;
                Shape::Plane(Plane::new(point, normal))
            }
            ShapeText::Triangle(triangle) => {
                let at = at.key("triangle");
                let points = self.points(&at.key("points"), &triangle.points)?;
                let Ok(points) = <[DVec3; 3]>::try_from(points) else {
                    let message = format!("a triangle has 3 points, not {}", triangle.points.len());
                    return self.refuse(&at.key("points"), &message);
                };
                if Triangle::is_degenerate(points) {
                    return self.refuse(&at.key("points"), "the points of a triangle must not lie on a line");
                }
                Shape::Triangle(Triangle::new(points))
            }
            ShapeText::Sphere(sphere) => {
                let at = at.key("sphere");
                let center = self.compiler.point(&at.key("center"), sphere.center);
                let radius = self.compiler.length(&at.key("radius"), "a radius", sphere.radius);
                let (center, radius) = (center, radius).gather()?;
                Shape::Sphere(Sphere::new(center, radius))
            }
            ShapeText::Disc(disc) => {
                let at = at.key("disc");
                let center = self.compiler.point(&at.key("center"), disc.center);
                let normal = self.compiler.direction(&at.key("normal"), disc.normal);
                let radius = self.compiler.length(&at.key("radius"), "a radius", disc.radius);
                let u = disc.u.map(|u| self.compiler.direction(&at.key("u"), u)).transpose();
                let (center, normal, radius, u) = (center, normal, radius, u).gather()?;
                match Disc::new(center, normal, radius, u) {
                    Some(disc) => Shape::Disc(disc),
                    None => return self.refuse(&at.key("u"), "a disc's u must not be parallel to its normal"),
                }
            }
            ShapeText::Quad(quad) => {
                let at = at.key("quad");
                let center = self.compiler.point(&at.key("center"), quad.center);
                let u = self.compiler.direction(&at.key("u"), quad.u);
                let v = self.compiler.direction(&at.key("v"), quad.v);
                let (center, u, v) = (center, u, v).gather()?;
                if u.normalize().cross(v.normalize()) == DVec3::ZERO {
                    return self.refuse(&at.key("v"), "a quad's u and v must not be parallel");
                }
                Shape::Quad(Quad::new(center, u, v))
            }
            ShapeText::Cube(cube) => {
                let at = at.key("cube");
                let center = self.compiler.point(&at.key("center"), cube.center);
                let edges = cube.size.iter().map(|&edge| self.compiler.length(&at.key("size"), "an edge", edge));
                let edges = edges.collect::<Result<Vec<_>>>();
                let (center, _) = (center, edges).gather()?;
                Shape::Cube(Cube::new(center, cube.size.into()))
            }
            ShapeText::Mesh(mesh) => Shape::Mesh(self.mesh(&at.key("mesh"), mesh)?),
        })
    }

    pub(super) fn refuse<T>(&self, at: &At, message: &str) -> Result<T> {
        Err(self.compiler.source.mistake_at(at, message, None))
    }

    pub(super) fn points(&self, at: &At, points: &[[f64; 3]]) -> Result<Vec<DVec3>> {
        all(points.iter().enumerate().map(|(i, &point)| self.compiler.point(&at.index(i), point)))
    }
}

impl Compiler<'_> {
    /// The map that the steps make, one after another, behind a first one.
    pub(super) fn transform(&self, at: &At, steps: &[StepText], first: Transform) -> Result<Transform> {
        let mut map = first;
        for (number, step) in steps.iter().enumerate() {
            let here = at.index(number);
            let next = match step {
                StepText::Scale(factors) => Transform::scale(self.point(&here.key("scale"), *factors)?),
                StepText::Translate(by) => Transform::translate(self.point(&here.key("translate"), *by)?),
                StepText::Rotate(rotate) => {
                    let here = here.key("rotate");
                    let axis = self.direction(&here.key("axis"), rotate.axis)?;
                    if !rotate.degrees.is_finite() {
                        let message = format!("an angle is a finite number, not {}", rotate.degrees);
                        return Err(self.source.mistake_at(&here.key("degrees"), message, None));
                    }
                    Transform::rotate(axis, rotate.degrees)
                }
            };
            map = map.then(&next);
            if !map.is_invertible() {
                let message = "this step flattens the shape or sends it to infinity";
                return Err(self.source.mistake_at(&here, message, None));
            }
        }
        Ok(map)
    }
}

/// The least distance between two faces of a cube after a transform; none for other shapes.
fn thickness(shape: &ShapeText, map: &Transform) -> Option<f64> {
    let ShapeText::Cube(cube) = shape else { return None };
    let [x, y, z] = cube.size;
    let [a, b, c] = [DVec3::X * x, DVec3::Y * y, DVec3::Z * z].map(|edge| map.vector(edge));
    let height = |edge: DVec3, u: DVec3, v: DVec3| edge.dot(u.normalize().cross(v.normalize()).normalize()).abs();
    Some(height(a, b, c).min(height(b, c, a)).min(height(c, a, b)))
}
