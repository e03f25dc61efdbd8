//! Camera rays compared with closed forms.

use std::f64::consts::{PI, TAU};

use abbe::math::{DVec2, DVec3};
use abbe::scene::{Camera, Lens, Projection};

use crate::support::larger::larger;
use crate::support::random::Random;

const SIZE: [u32; 2] = [60, 40];
const PERSPECTIVE: Projection = Projection::Perspective { vertical_fov: 50.0 };

fn camera(target: DVec3, projection: Projection) -> Camera {
    Camera::new(POSITION, POSITION + target, DVec3::Y, projection, SIZE).0
}

const POSITION: DVec3 = DVec3::new(0.3, -0.2, 0.5);

/// Draws a point of the film and a point of the unit square.
fn anywhere(random: &mut Random) -> (DVec2, [f64; 2]) {
    let [x, y] = random.pair();
    (DVec2::new(x * f64::from(SIZE[0]), y * f64::from(SIZE[1])), random.pair())
}

/// Row C2 of the stability catalog.
#[test]
fn c2_all_rays_of_a_film_point_meet_in_the_plane_in_focus() {
    let mut random = Random::new(1);
    for projection in [PERSPECTIVE, Projection::Orthographic { height: 3.0 }] {
        let pinhole = camera(DVec3::new(1.0, 0.4, -2.0), projection).shifted([0.1, -0.3]);
        for focus in [0.1, 1.0, 6.0, 1e3, 1e6, 1e10] {
            let camera = pinhole.clone().with_lens(Some(Lens::new(0.02, focus)));
            let mut worst = 0f64;
            for _ in 0..10_000 {
                let (film, u) = anywhere(&mut random);
                let meet = |ray: abbe::math::Ray| {
                    let ahead = ray.direction.dot(camera.forward());
                    ray.at((focus - (ray.origin - POSITION).dot(camera.forward())) / ahead)
                };
                worst = larger(worst, (meet(camera.lens_ray(film, u)) - meet(camera.ray(film))).length() / focus);
            }
            println!("C2: {} focused at {focus:e}: apart by {worst:.1e} of it", projection.name());
            assert!(worst <= 1e-12, "{projection:?}, F = {focus:e}: {worst:e}");
        }
    }
}

/// Row C2 of the stability catalog.
#[test]
fn c2_a_focus_infinitely_far_away_gives_parallel_rays() {
    let mut random = Random::new(2);
    let camera = camera(DVec3::NEG_Z, PERSPECTIVE).with_lens(Some(Lens::new(0.5, f64::INFINITY)));
    for _ in 0..1000 {
        let (film, u) = anywhere(&mut random);
        let ray = camera.lens_ray(film, u);
        assert!(ray.origin.is_finite() && (ray.origin - POSITION).length() <= 0.5 + 1e-15);
        assert_eq!(ray.direction, camera.ray(film).direction);
    }
}

#[test]
fn a_lens_without_extent_is_a_pinhole() {
    let pinhole = camera(DVec3::NEG_Z, PERSPECTIVE);
    let camera = pinhole.clone().with_lens(Some(Lens::new(0.0, 3.0)));
    assert!(!camera.has_lens());
    assert_eq!(camera.lens_ray(DVec2::new(3.0, 4.0), [0.1, 0.9]), pinhole.ray(DVec2::new(3.0, 4.0)));
}

#[test]
fn rays_of_a_lens_start_at_the_near_plane() {
    let mut random = Random::new(3);
    let camera = camera(DVec3::NEG_Z, PERSPECTIVE).with_lens(Some(Lens::new(0.3, 4.0))).starting_at(1.5);
    for _ in 0..1000 {
        let (film, u) = anywhere(&mut random);
        assert!((camera.depth(camera.lens_ray(film, u).origin) - 1.5).abs() <= 1e-15);
    }
}

#[test]
fn orthographic_rays_are_parallel_and_a_pixel_apart() {
    let camera = camera(DVec3::NEG_Z, Projection::Orthographic { height: 4.0 }).shifted([0.25, 0.5]).starting_at(2.0);
    for (x, y) in [(0.0, 0.0), (30.0, 20.0), (7.5, 31.0), (60.0, 40.0)] {
        let ray = camera.ray(DVec2::new(x, y));
        assert_eq!(ray.direction, DVec3::NEG_Z);
        // A pixel is a tenth of a unit. The center of the view is shifted right by a quarter of 4 and up by half of 4.
        let expected = POSITION + DVec3::new((x - 30.0) * 0.1 + 1.0, (20.0 - y) * 0.1 + 2.0, -2.0);
        assert!((ray.origin - expected).length() <= 1e-14, "{x}, {y}: {} for {expected}", ray.origin);
        assert!((camera.depth(ray.at(3.0)) - 5.0).abs() <= 1e-14);
    }
    assert_eq!(camera.screen_window_center(), [1.0, 2.0]);
    assert_eq!(camera.screen_window_width(), 6.0);
}

#[test]
fn equirectangular_rays_follow_longitude_and_latitude() {
    let camera = camera(DVec3::Z, Projection::Equirectangular);
    // OpenEXR, ImfEnvmap.h: +z in the middle, +x at a longitude of a quarter turn, +y at the top.
    for (film, expected) in [
        ([30.0, 20.0], DVec3::Z),
        ([15.0, 20.0], DVec3::X),
        ([45.0, 20.0], DVec3::NEG_X),
        ([0.0, 20.0], DVec3::NEG_Z),
        ([60.0, 20.0], DVec3::NEG_Z),
        ([11.0, 0.0], DVec3::Y),
        ([52.0, 40.0], DVec3::NEG_Y),
    ] {
        assert!((camera.ray(film.into()).direction - expected).length() <= 1e-15, "{film:?}");
    }
    let mut random = Random::new(4);
    for _ in 0..1000 {
        let (film, _) = anywhere(&mut random);
        let ray = camera.ray(film);
        let longitude = PI - TAU * film.x / 60.0;
        let latitude = PI / 2.0 - PI * film.y / 40.0;
        assert!((libm::atan2(ray.direction.x, ray.direction.z) - longitude).abs() <= 1e-12);
        assert!((libm::asin(ray.direction.y) - latitude).abs() <= 1e-7);
        assert_eq!(ray.origin, POSITION);
        assert!((camera.depth(ray.at(7.0)) - 7.0).abs() <= 1e-14);
    }
}

#[test]
fn a_shift_keeps_verticals_parallel() {
    let camera = camera(DVec3::new(1.0, 0.0, -2.0), PERSPECTIVE).shifted([0.3, 0.8]);
    for x in [0.0, 13.0, 60.0] {
        // The rays of a column lie in one plane, which contains the vertical through the camera.
        let heading = |y: f64| {
            let direction = camera.ray(DVec2::new(x, y)).direction;
            direction.x / direction.z
        };
        for y in [0.0, 17.0, 40.0] {
            assert!((heading(y) / heading(20.0) - 1.0).abs() <= 1e-14, "column {x}, row {y}");
        }
    }
}

#[test]
fn a_shift_shows_a_part_of_a_larger_image() {
    let part = camera(DVec3::NEG_Z, PERSPECTIVE).shifted([0.0, 0.5]);
    let vertical_fov = 2.0 * libm::atan(2.0 * libm::tan(25f64.to_radians())).to_degrees();
    let whole = Projection::Perspective { vertical_fov };
    let whole = Camera::new(POSITION, POSITION + DVec3::NEG_Z, DVec3::Y, whole, [60, 80]).0;
    let mut random = Random::new(5);
    for _ in 0..1000 {
        // A shift by half an image upward shows the upper half of an image of twice the height.
        let (film, _) = anywhere(&mut random);
        assert!((part.ray(film).direction - whole.ray(film).direction).length() <= 1e-14);
    }
}

#[test]
fn the_angle_of_a_pixel_is_that_between_neighbors() {
    for projection in [PERSPECTIVE, Projection::Equirectangular] {
        let camera = Camera::new(POSITION, DVec3::ZERO, DVec3::Y, projection, [800, 400]).0;
        let [here, beside] = [0.0, 1.0].map(|x| camera.ray(DVec2::new(400.0 + x, 200.0)).direction);
        let angle = libm::acos(here.dot(beside).min(1.0));
        assert!((camera.pixel_angle() / angle - 1.0).abs() <= 1e-5, "{projection:?}: {angle}");
    }
    let camera =
        Camera::new(POSITION, POSITION + DVec3::X * 500.0, DVec3::Y, Projection::Orthographic { height: 2.0 }, SIZE).0;
    assert!((camera.pixel_angle() / (2.0 / 40.0 / 500.0) - 1.0).abs() <= 1e-12);
}
