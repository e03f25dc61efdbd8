//! Directions sampled toward a shape are compared with its pdf, integrated over bins of directions.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use abbe::light::{Area, EmissionMap, Light, LightSample, MeshPartsCache, ShownImage};
use abbe::math::{DMat3, DVec3, Frame, Ray, Transform};
use abbe::shape::{
    Attributes, Coordinates, Cube, Density, Disc, Ellipsoid, Intersection, Mesh, Quad, Shape, ShapeSample, Sides,
    Sphere, SurfacePoint, TexturedShape, Triangle, Vertices,
};
use abbe::spectrum::{CurveKind, Image, Placement, TexelFilter, Texture, Wrap};

use crate::support::bodies::{ball, closed_mesh};
use crate::support::chi_squared;
use crate::support::random::Random;

/// Number of calls of `check_samples` by the tests of this file.
const TESTS: u32 = 54;
const DRAWS: usize = 100_000;
/// Number of bins by height and by azimuth.
const BINS: [usize; 2] = [12, 24];
/// Number of quadrature points along each side of most bins.
const POINTS: usize = 64;

/// Directions within a cone, or within the image of a cone under a linear map, divided into bins.
struct Bins {
    axis: DVec3,
    frame: Frame,
    /// 1 - cos of the cone's half angle.
    width: f64,
    map: DMat3,
    inverse: DMat3,
    /// Whether bins become narrower toward the edge of the cone.
    ///
    /// The pdf of a body with an outline like a ball's is infinite along that outline. Its product with the solid angle
    /// is bounded.
    dense: bool,
    /// Number of quadrature points along each side of a bin.
    points: usize,
}

impl Bins {
    /// Returns bins of all directions within `half_angle` of the axis.
    fn new(axis: DVec3, half_angle: f64) -> Self {
        let axis = axis.normalize();
        let sin = libm::sin(0.5 * half_angle);
        let (map, inverse) = (DMat3::IDENTITY, DMat3::IDENTITY);
        Self { axis, frame: Frame::about(axis), width: 2.0 * sin * sin, map, inverse, dense: false, points: POINTS }
    }

    /// Returns bins of the directions in which an ellipsoid is seen: the image of the cone in which the unit ball is
    /// seen.
    fn of_ellipsoid(center: DVec3, axes: DMat3, from: DVec3) -> Self {
        let toward = axes.inverse() * (center - from);
        let half_angle = if toward.length() > 1.0 { libm::asin(1.0 / toward.length()) } else { PI };
        Self { map: axes, inverse: axes.inverse(), dense: true, ..Self::new(toward, half_angle) }
    }

    /// Returns the direction at a point of the unit square, and the density of solid angle there.
    fn direction(&self, [height, around]: [f64; 2]) -> (DVec3, f64) {
        let (share, slope) = if self.dense { (height * (2.0 - height), 2.0 - 2.0 * height) } else { (height, 1.0) };
        let x = self.width * share;
        let (radius, (sin, cos)) = ((x * (2.0 - x)).max(0.0).sqrt(), libm::sincos(TAU * around));
        let image = self.map * self.frame.to_world(DVec3::new(radius * cos, radius * sin, 1.0 - x));
        let length = image.length();
        // A linear map A scales solid angle by |det A| / |A n|^3.
        let growth = self.map.determinant().abs() / (length * length * length);
        (image / length, growth * TAU * self.width * slope)
    }

    fn index(&self, direction: DVec3) -> Option<usize> {
        let local = (self.inverse * direction).normalize();
        // 1 - cos is computed from the chord, which stays accurate in narrow cones.
        let share = 0.5 * (local - self.axis).length_squared() / self.width;
        if share > 1.0 + 1e-9 {
            return None;
        }
        let height = if self.dense { 1.0 - (1.0 - share).max(0.0).sqrt() } else { share };
        let x = local.dot(self.frame.to_world(DVec3::X));
        let y = local.dot(self.frame.to_world(DVec3::Y));
        let around = libm::atan2(y, x) / TAU + if y < 0.0 { 1.0 } else { 0.0 };
        let cell = |x: f64, cells: usize| ((x * cells as f64) as usize).min(cells - 1);
        Some(cell(height, BINS[0]) * BINS[1] + cell(around, BINS[1]))
    }

    /// Integrates a density over each bin, with one random point in each cell of a grid.
    fn integrate(&self, random: &mut Random, mut density: impl FnMut(DVec3) -> f64) -> Vec<f64> {
        let [rows, columns] = BINS.map(|bins| bins * self.points);
        let mut integrals = vec![0.0; BINS[0] * BINS[1]];
        for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column))) {
            let mut within = |cell: usize, cells: usize| random.between(cell as f64, cell as f64 + 1.0) / cells as f64;
            let (direction, solid_angle) = self.direction([within(row, rows), within(column, columns)]);
            let bin = row / self.points * BINS[1] + column / self.points;
            integrals[bin] += density(direction) * solid_angle / (rows * columns) as f64;
        }
        integrals
    }
}

/// Tests the samples that a shape draws from a point against its `pdf`. A sample that does not hit the part it was
/// drawn on is hidden.
fn check_shape(name: &str, shape: &Shape, from: DVec3, bins: &Bins) {
    let pdf = |ray: &Ray, intersection: &Intersection| shape.pdf(ray, intersection);
    check_samples(name, shape, from, bins, |u| shape.sample(from, u), pdf);
}

/// Converts a light's sample to a sample of its shape.
fn of_light(shape: &Shape, sample: &LightSample) -> ShapeSample {
    let intersection = shape.intersect(&sample.ray, f64::INFINITY).expect("the sample lies on the lamp");
    let density = sample.pdf.map(Density::SolidAngle);
    ShapeSample { direction: sample.ray.direction, part: Some(intersection.part), density }
}

/// Tests the sampling of a shape as a lamp with parts, from a surface with some normal.
fn check_lamp(name: &str, shape: &Shape, from: DVec3, axis: DVec3, half_angle: f64) {
    let normal = (axis.normalize() + DVec3::new(0.5, -0.3, 0.4)).normalize();
    let area = Area::new(Arc::new(shape.clone()), 0, (), Sides::Both, true, None, &mut MeshPartsCache::default());
    let light = Light::Area(area);
    assert!(light.has_parts(), "{name}");
    check_light(name, shape, from, &Bins::new(axis, half_angle), (&light, normal));
}

fn check_light(name: &str, shape: &Shape, from: DVec3, bins: &Bins, (light, normal): (&Light<()>, DVec3)) {
    let sample = |u| Some(of_light(shape, &light.sample_li(&SurfacePoint::in_space(from), normal, u)?));
    let pdf = |ray: &Ray, intersection: &Intersection| light.pdf_li(ray, normal, Some(intersection)).unwrap_or(0.0);
    check_samples(name, shape, from, bins, sample, pdf);
}

fn check_samples(
    name: &str,
    shape: &Shape,
    from: DVec3,
    bins: &Bins,
    sample: impl Fn([f64; 2]) -> Option<ShapeSample>,
    pdf: impl Fn(&Ray, &Intersection) -> f64,
) {
    let mut random = Random::new(name.bytes().map(u64::from).sum());
    let ray = |direction| Ray { origin: from, direction };
    let mut counts = vec![0; BINS[0] * BINS[1]];
    for _ in 0..DRAWS {
        // A missing sample counts as hidden.
        let Some(sample) = sample(random.pair()) else { continue };
        let intersection = shape.intersect(&ray(sample.direction), f64::INFINITY);
        let bin = bins.index(sample.direction).unwrap_or_else(|| panic!("{name}: drawn beside the shape"));
        if let Some(intersection) =
            intersection.filter(|intersection| sample.part.is_none_or(|part| part == intersection.part))
        {
            counts[bin] += 1;
            // The pdf reported by the sample equals the one found for a direction that hits by chance.
            if let Some(density) = sample.density {
                let ray = ray(sample.direction);
                let cos = shape.point(&ray, &intersection).normal.dot(ray.direction).abs();
                let (drawn, met) = (density.toward(intersection.t, cos), pdf(&ray, &intersection));
                assert!((drawn / met - 1.0).abs() < 1e-9, "{name}: drawn with {drawn}, met with {met}");
            }
        }
    }
    let mut probabilities = bins.integrate(&mut random, |direction| {
        let ray = ray(direction);
        shape.intersect(&ray, f64::INFINITY).map_or(0.0, |intersection| pdf(&ray, &intersection))
    });
    let integral: f64 = probabilities.iter().sum();
    let seen = counts.iter().sum::<u64>() as f64 / DRAWS as f64;
    // 4 standard deviations of the visible fraction, plus the quadrature's own error.
    let tolerance = 4.0 * (seen * (1.0 - seen) / DRAWS as f64).sqrt() + 1e-3;
    println!("{name}: seen {seen:.4}, integral {integral:.5}");
    assert!((integral - seen).abs() < tolerance, "{name}: the pdf integrates to {integral}, {seen} is seen");
    probabilities.iter_mut().for_each(|probability| *probability /= integral);
    chi_squared::check(name, &counts, &probabilities, TESTS);
}

fn check(name: &str, shape: &Shape, from: DVec3, axis: DVec3, half_angle: f64) {
    check_shape(name, shape, from, &Bins::new(axis, half_angle));
}

fn check_ellipsoid(name: &str, shape: &Shape, center: DVec3, axes: DMat3, from: DVec3) {
    check_shape(name, shape, from, &Bins::of_ellipsoid(center, axes, from));
}

/// Returns a map that rotates, stretches unevenly and rotates again.
fn skew() -> Transform {
    Transform::rotate(DVec3::new(0.2, 1.0, -0.4), 35.0)
        .then(&Transform::scale(DVec3::new(1.5, 0.4, 0.8)))
        .then(&Transform::rotate(DVec3::new(1.0, 0.3, 0.5), 70.0))
}

#[test]
fn directions_toward_a_sphere_follow_their_density() {
    let (center, radius) = (DVec3::new(0.4, -0.2, 1.0), 0.7);
    let sphere = Shape::Sphere(Sphere::new(center, radius));
    let mut random = Random::new(61);
    for (name, distance, half_angle) in [
        ("sphere from outside", 3.0, 0.4),
        ("sphere from nearby", 1.01, 0.5 * PI),
        ("sphere from far away", 1e5, 1.1e-5),
        ("sphere from inside", 0.6, PI),
        ("sphere from its center", 0.0, PI),
    ] {
        let away = random.direction();
        check(name, &sphere, center + away * radius * distance, -away, half_angle);
    }
}

#[test]
fn directions_toward_a_sphere_that_shows_a_cap_follow_their_density() {
    let (center, radius) = (DVec3::new(0.4, -0.2, 1.0), 0.7);
    let mut random = Random::new(62);
    let axis = random.direction();
    for (name, width, distance, toward, half_angle) in [
        ("cap before the eye", 0.3, 3.0, 0.0, 0.4),
        ("cap at the horizon", 0.3, 2.0, 1.2, 0.6),
        ("cap from nearby", 0.6, 1.05, 0.1, 0.5 * PI),
        ("cap from inside", 0.3, 0.5, 0.0, PI),
    ] {
        let sideways = axis.cross(random.direction()).normalize();
        let away = axis * libm::cos(toward) + sideways * libm::sin(toward);
        let from = center + away * radius * distance;
        let mut near = || axis + width * random.number().sqrt() * random.direction().cross(axis).normalize();
        let normals: Vec<DVec3> = (0..2000).map(|_| near().normalize()).collect();
        let shape = Shape::Sphere(Sphere::new(center, radius));
        let mut area =
            Area::new(Arc::new(shape.clone()), 0, (), Sides::Both, true, None, &mut MeshPartsCache::default());
        area.learn_visible_cap(&normals);
        check_light(name, &shape, from, &Bins::new(-away, half_angle), (&Light::Area(area), -away));
    }
}

#[test]
fn directions_toward_an_ellipsoid_follow_their_density() {
    let axes = DMat3::from_diagonal(DVec3::new(1.0, 0.3, 0.6));
    let center = DVec3::new(0.0, 0.1, -0.3);
    let ellipsoid = Shape::Ellipsoid(Ellipsoid::new(center, axes));
    let away = DVec3::new(0.36, 0.48, 0.8);
    check_ellipsoid("ellipsoid from outside", &ellipsoid, center, axes, center + away * 3.0);
    check_ellipsoid("ellipsoid from inside", &ellipsoid, center, axes, center + DVec3::new(0.4, -0.1, 0.2));
    let skewed = Shape::Sphere(Sphere::new(DVec3::ZERO, 1.0)).transformed(&skew());
    assert!(matches!(skewed, Shape::Ellipsoid(_)));
    let axes = DMat3::from_cols(skew().vector(DVec3::X), skew().vector(DVec3::Y), skew().vector(DVec3::Z));
    check_ellipsoid("skew ellipsoid from nearby", &skewed, DVec3::ZERO, axes, away * 1.3);
}

#[test]
fn directions_toward_a_disc_follow_their_density() {
    let normal = DVec3::new(0.3, 1.0, -0.2);
    let disc = Shape::Disc(Disc::new(DVec3::ZERO, normal, 0.8, None).expect("no direction is asked for"));
    check("disc from its front", &disc, DVec3::new(0.5, 1.0, 0.3), DVec3::new(-0.5, -1.0, -0.3), 0.8);
    check("disc from its back", &disc, DVec3::new(1.5, -0.6, 0.3), DVec3::new(-1.5, 0.6, -0.3), 0.6);
    let ellipse = disc.transformed(&skew());
    check("ellipse", &ellipse, DVec3::new(0.5, 1.4, 0.3), DVec3::new(-0.5, -1.4, -0.3), 0.9);
}

#[test]
fn directions_toward_a_quad_follow_their_density() {
    let quad = Shape::Quad(Quad::new(DVec3::ZERO, DVec3::new(1.0, 0.0, 0.2), DVec3::new(0.4, 0.1, -0.7)));
    check("quad from nearby", &quad, DVec3::new(0.2, 0.3, 0.1), -DVec3::Y, 0.5 * PI);
    check("quad from very near", &quad, DVec3::new(0.2, -1e-3, 0.1), DVec3::new(0.0, 1.0, 0.1), PI);
    check("quad nearly edge-on", &quad, DVec3::new(1.7, 0.05, -0.4), DVec3::new(-1.7, -0.05, 0.4), 1.1);
    check("quad from far away", &quad, DVec3::new(9.0, 8.0, 7.0), DVec3::new(-9.0, -8.0, -7.0), 0.15);
    check("quad from the side", &quad, DVec3::new(2.6, 1.1, 1.0), DVec3::new(-2.6, -1.1, -1.0), 0.55);
}

#[test]
fn directions_toward_a_triangle_follow_their_density() {
    let points = [DVec3::new(0.0, 0.0, 1.0), DVec3::new(1.0, 0.2, 0.0), DVec3::new(-0.5, 0.4, -0.6)];
    let triangle = Shape::Triangle(Triangle::new(points));
    check("triangle", &triangle, DVec3::new(0.2, 1.2, 0.3), DVec3::new(0.0, -1.0, -0.1), 1.1);
    check("triangle from very near", &triangle, DVec3::new(0.1, 0.26, 0.2), DVec3::new(0.0, -1.0, -0.1), PI);
    check("triangle from far away", &triangle, DVec3::new(5.0, 9.0, 4.0), DVec3::new(-5.0, -9.0, -4.0), 0.2);
    check("triangle from below", &triangle, DVec3::new(-1.0, -0.4, 0.5), DVec3::new(1.0, 0.5, -0.4), 0.8);
}

#[test]
fn directions_toward_a_cube_follow_their_density() {
    let cube = Shape::Cube(Cube::new(DVec3::new(0.1, 0.0, 0.2), DVec3::new(1.0, 0.5, 1.6)));
    let from = DVec3::new(1.2, 0.9, 1.4);
    check("cube from outside", &cube, from, -from, 0.6);
    check("cube from inside", &cube, DVec3::new(0.3, -0.1, 0.5), DVec3::Y, PI);
    check_lamp("faces of a cube from outside", &cube, from, -from, 0.6);
    check_lamp("faces of a cube from inside", &cube, DVec3::new(0.3, -0.1, 0.5), DVec3::Y, PI);
}

#[test]
fn directions_toward_a_skew_cube_follow_their_density() {
    let cube = Shape::Cube(Cube::new(DVec3::ZERO, DVec3::ONE)).transformed(&skew());
    check("skew cube from nearby", &cube, DVec3::new(0.5, 0.8, 0.6), DVec3::new(-0.5, -0.8, -0.6), 2.0);
}

#[test]
fn directions_toward_a_mesh_follow_their_density() {
    let (points, faces) = ball();
    let mesh = closed_mesh(points, faces).transformed(&skew());
    let from = DVec3::new(1.0, 1.2, 0.9);
    check("mesh from outside", &mesh, from, -from, 1.0);
    check("mesh from inside", &mesh, DVec3::new(0.1, 0.05, 0.1), DVec3::Y, PI);
    check_lamp("triangles of a mesh from outside", &mesh, from, -from, 1.0);
    check_lamp("triangles of a mesh from inside", &mesh, DVec3::new(0.1, 0.05, 0.1), DVec3::Y, PI);
}

/// A mesh that is placed by an angle-preserving map has the parts of the original mesh. Any other copy has its own.
#[test]
fn directions_toward_the_triangles_of_copies_of_a_mesh_follow_their_density_and_miss_none() {
    let (points, faces) = ball();
    let mesh = closed_mesh(points, faces).transformed(&skew());
    let placed = Transform::scale(DVec3::splat(3.0))
        .then(&Transform::rotate(DVec3::new(1.0, 2.0, -0.5), 77.0))
        .then(&Transform::translate(DVec3::new(40.0, -7.0, 3.0)));
    let mirrored = Transform::scale(DVec3::new(-1.0, 1.0, 1.0)).then(&placed);
    let stretched = Transform::scale(DVec3::new(1.0, 2.0, 1.0)).then(&placed);
    let mut random = Random::new(67);
    for (name, map, keeps_angles) in
        [("placed", placed, true), ("mirrored", mirrored, true), ("stretched", stretched, false)]
    {
        let copy = mesh.copied(&map);
        let Shape::Instance(instance) = &copy else { panic!("{name}: it shares no triangles") };
        assert_eq!(instance.similarity().is_some(), keeps_angles, "{name}");
        let [from, inside] = [DVec3::new(1.0, 1.2, 0.9), DVec3::new(0.1, 0.05, 0.1)].map(|point| map.point(point));
        let toward = map.point(DVec3::ZERO) - from;
        check_lamp(&format!("triangles of a copy, {name}, from outside"), &copy, from, toward, 1.0);
        check_lamp(&format!("triangles of a copy, {name}, from inside"), &copy, inside, DVec3::Y, PI);
        let (known_parts, copy) = (&mut MeshPartsCache::default(), Arc::new(copy));
        let lamp = Light::Area(Area::new(copy.clone(), 0, (), Sides::Front, true, None, known_parts));
        let mut seen = 0;
        for _ in 0..2000 {
            let origin = map.point(4.0 * random.direction());
            let direction = (map.point(0.8 * random.direction()) - origin).normalize();
            let ray = Ray { origin, direction };
            let normal = random.direction();
            let Some(intersection) = copy.intersect(&ray, f64::INFINITY) else { continue };
            if copy.normal(&ray, &intersection).dot(ray.direction) < 0.0 && normal.dot(ray.direction) > 0.0 {
                seen += 1;
                let density = lamp.pdf_li(&ray, normal, Some(&intersection));
                assert!(density.is_some_and(|density| density > 0.0), "{name}: {density:?} along {ray:?}");
            }
        }
        assert!(seen > 200, "{name}: {seen}");
    }
}

/// Returns a dim image with one bright and one brighter texel.
fn picture(repeat: [f64; 2], filter: TexelFilter) -> CurveKind {
    let mut texels = vec![0.05; 7 * 5];
    [texels[9], texels[23], texels[24], texels[12]] = [3.0, 10.0, 0.0, 0.0];
    let placement = Placement { repeat, wrap: Wrap::Repeat, filter };
    CurveKind::Texture(Texture { image: Arc::new(Image::of_floats(7, 1, texels)), placement })
}

/// Tests the sampling of a shape that shows an image as a lamp after a transform, from a point whose normal faces it.
fn check_image(name: &str, written: &Shape, map: &Transform, from: DVec3, bins: &Bins) {
    let coordinates = Coordinates::new(written, map).expect("it has coordinates");
    let picture =
        picture([1.5, 1.0], if name.len().is_multiple_of(2) { TexelFilter::Linear } else { TexelFilter::Nearest });
    let shape = written.transformed(map);
    let seen = EmissionMap::new(&picture, TexturedShape { shape: &shape, coordinates: &coordinates })
        .expect("the image varies");
    let shapes = if written.part_count() > 0 { vec![shape.clone(), written.copied(map)] } else { vec![shape.clone()] };
    for shape in shapes {
        let image = ShownImage { coordinates: Arc::new(coordinates), map: Some(Arc::new(seen.clone())) };
        let lamp =
            Area::new(Arc::new(shape.clone()), 0, (), Sides::Both, true, Some(image), &mut MeshPartsCache::default());
        let lamp = Light::Area(lamp);
        assert!(lamp.has_parts(), "{name}");
        let normal = (bins.axis + DVec3::new(0.1, -0.2, 0.1)).normalize();
        check_light(name, &shape, from, bins, (&lamp, normal));
    }
}

#[test]
fn directions_toward_flat_lamps_with_images_follow_their_density() {
    let map = Transform::scale(DVec3::new(-1.0, 1.2, 0.8)).then(&Transform::rotate(DVec3::new(1.0, 0.3, 0.5), 70.0));
    let (from, far) = (DVec3::new(0.3, 0.4, 0.2), DVec3::new(2.0, 3.0, 2.5));
    let quad = Shape::Quad(Quad::new(DVec3::ZERO, DVec3::new(1.0, 0.0, 0.2), DVec3::new(0.4, 0.1, -0.7)));
    let toward =
        |normal: DVec3| -map.normal(normal.normalize()) * map.normal(normal.normalize()).dot(map.point(from)).signum();
    let below = |normal: DVec3| Bins::new(toward(normal), 0.5 * PI);
    check_image("image on a quad", &quad, &map, map.point(from), &below(DVec3::new(-0.02, 0.78, 0.1)));
    check_image("image on a far quad", &quad, &map, map.point(far), &Bins::new(-map.point(far), 0.35));
    let disc = Shape::Disc(Disc::new(DVec3::ZERO, DVec3::new(0.3, 1.0, -0.2), 0.8, None).expect("it has a normal"));
    check_image("image on a disc", &disc, &map, map.point(from), &below(DVec3::new(0.3, 1.0, -0.2)));
    let points = [DVec3::new(0.0, 0.0, 1.0), DVec3::new(1.0, 0.2, 0.0), DVec3::new(-0.5, 0.4, -0.6)];
    let triangle = Shape::Triangle(Triangle::new(points));
    check_image("image on a triangle", &triangle, &map, map.point(far), &Bins::new(-map.point(far), 0.4));
    check_image("image on it, nearby", &triangle, &Transform::IDENTITY, from, &Bins::new(-DVec3::Y, PI));
}

#[test]
fn directions_toward_round_lamps_with_images_follow_their_density() {
    let turned = Transform::rotate(DVec3::new(1.0, 0.3, 0.5), 70.0).then(&Transform::translate(DVec3::X));
    let sphere = Shape::Sphere(Sphere::new(DVec3::new(0.1, 0.2, 0.0), 0.7));
    let center = turned.point(DVec3::new(0.1, 0.2, 0.0));
    let away = DVec3::new(0.36, 0.48, 0.8);
    let cone = |distance: f64| Bins::new(-away, 1.01 * libm::asin(0.7 / distance));
    check_image("image on a sphere", &sphere, &turned, center + away * 2.0, &cone(2.0));
    check_image("image on a sphere nearby", &sphere, &turned, center + away * 0.75, &cone(0.75));
    check_image("image around", &sphere, &turned, center - away * 0.4, &Bins::new(DVec3::Y, PI));
    let unit = Shape::Sphere(Sphere::new(DVec3::ZERO, 1.0));
    let axes = DMat3::from_cols(skew().vector(DVec3::X), skew().vector(DVec3::Y), skew().vector(DVec3::Z));
    for (name, from) in [("image on an ellipsoid", away * 2.0), ("image around, skew", away * 0.2)] {
        check_image(name, &unit, &skew(), from, &Bins::of_ellipsoid(DVec3::ZERO, axes, from));
    }
}

#[test]
fn directions_toward_lamps_of_parts_with_images_follow_their_density() {
    let cube = Shape::Cube(Cube::new(DVec3::new(0.1, 0.0, 0.2), DVec3::new(1.0, 0.5, 1.6)));
    let from = DVec3::new(1.2, 0.9, 1.4);
    check_image("image on a cube", &cube, &Transform::IDENTITY, from, &Bins::new(-from, 0.6));
    let (points, faces) = ball();
    let coordinates = points.iter().map(|point| [point.x as f32, 0.5 * point.y as f32]).collect();
    let mesh = Mesh::new(Vertices::Double(points), faces).expect("it has triangles");
    let mesh = Shape::Mesh(Arc::new(mesh.with(Attributes { coordinates, ..Default::default() })));
    // Its density is steep, so the quadrature is finer.
    check_image("image on a mesh", &mesh, &skew(), from, &Bins { points: 2 * POINTS, ..Bins::new(-from, 1.0) });
}
