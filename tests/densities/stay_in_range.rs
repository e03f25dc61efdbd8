//! Rows A3 and A4 of the stability catalog: random numbers and strata never reach 1, and what is mapped from the ends
//! of the unit square is on the shape.

use abbe::math::{BranchKey, DVec3, Sampler, ball_surface, cosine_hemisphere, disk, triangle_coordinates};
use abbe::shape::{Cube, Shape};

use crate::bodies::{ball, closed_mesh};

/// The largest number that 24 bits hold below 1: the most that a sampler may give.
const MOST: f64 = 1.0 - 1.0 / (1 << 24) as f64;

#[test]
fn a3_the_sampler_never_gives_1() {
    let (mut least, mut most) = (1f64, 0f64);
    for pixel in 0..64 {
        for sample in 0..1 << 12 {
            let sampler = Sampler::new(5, [pixel, 1], sample * 37);
            let mut branch = BranchKey::CAMERA;
            for purpose in 0..4 {
                for x in sampler.four(branch, purpose) {
                    least = least.min(x);
                    most = most.max(x);
                }
                assert!(sampler.four_plain(branch, purpose).iter().all(|x| (0.0..1.0).contains(x)));
                branch = branch.child(1);
            }
        }
    }
    println!("A3: numbers from {least:e} to 1 - {:e}", 1.0 - most);
    assert!(least >= 0.0 && most <= MOST, "{least:e}, {most}");
    assert!(least < 1e-6 && most > 1.0 - 1e-6, "{least:e}, {most}");
}

#[test]
fn a3_the_numbers_of_a_pixel_fill_their_strata() {
    // 4^6 points of a Sobol sequence: one in each of as many equal intervals, in every dimension.
    const COUNT: usize = 1 << 12;
    for dimension in 0..4 {
        let mut counts = vec![0; COUNT];
        for sample in 0..COUNT {
            let x = Sampler::new(9, [3, 4], sample as u32).four(BranchKey::CAMERA, 2)[dimension];
            counts[(x * COUNT as f64) as usize] += 1;
        }
        assert!(counts.iter().all(|&count| count == 1), "dimension {dimension}");
    }
}

#[test]
fn a4_strata_in_64_bits_never_reach_1() {
    for strata in 2..=4096u32 {
        for stratum in [0, strata / 2, strata - 1] {
            for u in [0.0, MOST, 1.0f64.next_down()] {
                let x = (f64::from(stratum) + u) / f64::from(strata);
                // The largest f64 below 1 rounds up to the next stratum; what a sampler can give does not.
                assert!(u > MOST || (x < 1.0 && (x * f64::from(strata)) as u32 == stratum), "{stratum} of {strata}");
            }
        }
    }
}

#[test]
fn a4_the_ends_of_the_unit_square_are_mapped_onto_the_shape() {
    let ends = [0.0, f64::MIN_POSITIVE, 0.5, MOST, 1.0f64.next_down()];
    let (points, faces) = ball();
    let count = faces.len() as u32;
    let shapes = [(closed_mesh(points, faces), count), (Shape::Cube(Cube::new(DVec3::ZERO, DVec3::ONE)), 6)];
    for u in ends.iter().flat_map(|&a| ends.map(|b| [a, b])) {
        let [a, b] = triangle_coordinates(u);
        assert!(a >= 0.0 && b >= 0.0 && a + b <= 1.0, "{u:?}: ({a}, {b})");
        assert!(disk(u).length() <= 1.0 + 1e-15 && disk(u).is_finite(), "{u:?}");
        for direction in [cosine_hemisphere(u), ball_surface(u)] {
            assert!((direction.length() - 1.0).abs() < 1e-15, "{u:?}: {direction}");
        }
        for (shape, parts) in &shapes {
            let sighting = shape.aim(DVec3::new(3.0, 2.0, 1.0), u).expect("the point is outside");
            assert!(sighting.direction.is_finite() && sighting.part.is_some_and(|part| part < *parts), "{sighting:?}");
        }
    }
}
