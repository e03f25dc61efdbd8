//! The camera projects points to the film where its own rays start, and its importance matches the projected area in
//! pixels.

use abbe::film::Filter;
use abbe::math::{DVec2, DVec3};
use abbe::scene::{Camera, Lens, Projection};

use crate::support::random::Random;

const SIZE: [u32; 2] = [64, 40];

fn cameras() -> Vec<Camera> {
    let new = |projection| {
        Camera::new(DVec3::new(0.3, -0.2, 4.0), DVec3::new(1.0, 0.5, -1.0), DVec3::new(0.1, 1.0, 0.0), projection, SIZE)
            .0
    };
    let perspective = || new(Projection::Perspective { vertical_fov: 47.0 });
    let parallel = || new(Projection::Orthographic { height: 3.0 });
    let lens = |focus| Some(Lens::new(0.3, focus));
    vec![
        perspective(),
        perspective().shifted([0.3, -0.2]).starting_at(0.5),
        perspective().with_lens(lens(3.0)).starting_at(0.2),
        perspective().with_lens(lens(f64::INFINITY)),
        parallel().shifted([-0.1, 0.4]),
        parallel().with_lens(lens(2.0)).starting_at(0.7),
        new(Projection::Equirectangular).starting_at(0.4),
    ]
}

#[test]
fn a_point_is_seen_where_its_ray_comes_from() {
    let mut random = Random::new(1);
    for (number, camera) in cameras().iter().enumerate() {
        for _ in 0..2000 {
            let film = DVec2::new(random.between(0.01, 63.99), random.between(0.01, 39.99));
            let u = random.pair();
            let ray = camera.lens_ray(film, u);
            let distance = random.between(0.1, 9.0);
            let seen = camera.see(ray.at(distance), u).unwrap_or_else(|| panic!("camera {number}: {film} is not seen"));
            // Rounding errors are about 1e-16 of 10 units, times 64 pixels over the smallest distance. They grow once
            // more near the poles.
            assert!((seen.film - film).length() < 1e-9, "camera {number}: {} for {film}", seen.film);
            assert!((seen.direction + ray.direction).length() < 1e-12, "camera {number}: {}", seen.direction);
            assert!((seen.start - ray.origin).length() < 1e-12, "camera {number}: {}", seen.start);
            let before = ray.origin - ray.direction * 0.01;
            if camera.starts_away() && seen.importance > 0.0 && !camera.has_lens() {
                assert!(
                    camera.see(before, u).is_none_or(|_| camera.projection().name() == "orthographic"),
                    "camera {number}"
                );
            }
        }
    }
}

#[test]
fn the_matrix_to_device_coordinates_projects_as_the_camera_sees() {
    let mut random = Random::new(3);
    let mut projected = 0;
    for (number, camera) in cameras().iter().enumerate().filter(|(_, camera)| !camera.has_lens()) {
        let Some(matrix) = camera.world_to_ndc() else {
            assert_eq!(camera.projection(), Projection::Equirectangular);
            continue;
        };
        for _ in 0..500 {
            let film = DVec2::new(random.between(-20.0, 84.0), random.between(-20.0, 60.0));
            let ray = camera.lens_ray(film, [0.5; 2]);
            let at = |distance: f64| {
                let DVec3 { x, y, z } = ray.at(distance);
                let number = |to: usize| x * matrix[0][to] + y * matrix[1][to] + z * matrix[2][to] + matrix[3][to];
                [0, 1, 2].map(|to| number(to) / number(3))
            };
            let (near, far) = (at(random.between(0.1, 3.0)), at(random.between(4.0, 9.0)));
            for [x, y, _] in [near, far] {
                let pixel = DVec2::new(x * f64::from(SIZE[0]), y * f64::from(SIZE[1]));
                assert!((pixel - film).length() < 1e-9, "camera {number}: {pixel} for {film}");
            }
            assert!(near[2] < far[2], "camera {number}: depth grows");
            projected += 1;
        }
    }
    assert_eq!(projected, 3 * 500);
}

#[test]
fn a_small_area_that_faces_the_camera_fills_as_many_pixels_as_its_importance_says() {
    let mut random = Random::new(2);
    for (number, camera) in cameras().iter().enumerate() {
        for _ in 0..500 {
            let (film, u) = (DVec2::new(random.between(5.0, 59.0), random.between(5.0, 35.0)), random.pair());
            let ray = camera.lens_ray(film, u);
            let point = ray.at(random.between(1.0, 9.0));
            let seen = camera.see(point, u).expect("the point is seen");
            let side = abbe::math::Frame::about(ray.direction);
            const STEP: f64 = 1e-5;
            let moved = |axis: DVec3| {
                let at = |step: f64| {
                    camera.see(point + side.to_world(axis) * step, u).expect("a point near by is seen").film
                };
                (at(STEP) - at(-STEP)) / (2.0 * STEP)
            };
            let pixels = moved(DVec3::X).perp_dot(moved(DVec3::Y)).abs();
            // The error of central differences is quadratic in the step.
            assert!((seen.importance / pixels - 1.0).abs() < 1e-6, "camera {number}: {} for {pixels}", seen.importance);
        }
    }
}

#[test]
fn an_image_of_all_directions_shows_a_point_beyond_its_seam_and_its_poles_as_well() {
    let camera = cameras().pop().expect("the last camera sees all around");
    let mut random = Random::new(3);
    for _ in 0..500 {
        let film = DVec2::new(random.between(-8.0, 72.0), random.between(-8.0, 48.0));
        let point = camera.ray(film).at(2.0);
        let seen = camera.see(point, [0.5; 2]).expect("every point is seen").film;
        let places = camera.places(seen, 8.0);
        let found = places.iter().filter(|place| (**place - film).length() < 1e-9).count();
        assert_eq!(found, 1, "{film} is seen at {places:?}");
    }
}

#[test]
fn filters_have_the_density_of_their_samples() {
    let filters = [
        Filter::Box,
        Filter::Tent { radius: 1.3 },
        Filter::Gaussian { sigma: 0.6 },
        Filter::BlackmanHarris { radius: 2.0 },
    ];
    for filter in filters {
        let reach = filter.reach();
        // Means of waves over the samples, and over the density on a grid of midpoints, whose error is about one grid
        // step.
        const SIDE: u32 = 1000;
        let at = |i: u32| (f64::from(i) + 0.5) / f64::from(SIDE);
        let grid = || (0..SIDE).flat_map(|i| (0..SIDE).map(move |j| [at(i), at(j)]));
        let mut sums = [[0.0; 3]; 2];
        for u in grid() {
            let drawn = filter.place(u) - DVec2::splat(0.5);
            assert!(drawn.abs().max_element() <= reach, "{}: {drawn}", filter.name());
            let even = (DVec2::from(u) * 2.0 - 1.0) * reach;
            let density = filter.value(even) * 4.0 * reach * reach;
            for (sum, (offset, weight)) in sums.iter_mut().zip([(drawn, 1.0), (even, density)]) {
                let waves = [1.0, libm::cos(2.0 * offset.x), libm::cos(2.0 * offset.x) * libm::cos(3.0 * offset.y)];
                (0..3).for_each(|i| sum[i] += weight * waves[i] / f64::from(SIDE * SIDE));
            }
        }
        for i in 0..3 {
            assert!((sums[1][i] - sums[0][i]).abs() < 1e-3, "{}: {sums:?}", filter.name());
        }
    }
}
