//! Rows A3 and A4 of the stability catalog: random numbers and strata never reach 1, and the edges of the unit square
//! are mapped onto the shape.

use abbe::math::{BranchKey, DVec3, Sampler, sample_cosine_hemisphere, sample_disk, sample_sphere, sample_triangle};
use abbe::shape::{Cube, Shape};

use crate::support::bodies::{ball, closed_mesh};
use crate::support::larger::larger;
use crate::support::random::Random;

/// The largest number below 1 with 24 bits, which is the most that a sampler of f32 may return.
const LARGEST_BELOW_1: f64 = 1.0 - 1.0 / (1 << 24) as f64;

/// Returns the smallest and the largest of very many numbers of the sampler.
fn extremes() -> [f64; 2] {
    let [mut smallest, mut largest] = [1f64, 0f64];
    for pixel in 0..64 {
        for sample in 0..1 << 16 {
            let sampler = Sampler::new(5, [pixel, 1], sample);
            let mut branch = BranchKey::CAMERA;
            for purpose in 0..4 {
                for x in sampler.get_4d(branch, purpose) {
                    smallest = smallest.min(x);
                    largest = larger(largest, x);
                }
                assert!(sampler.get_random_4d(branch, purpose).iter().all(|x| (0.0..1.0).contains(x)));
                branch = branch.child(1);
            }
        }
    }
    [smallest, largest]
}

#[test]
fn a3_and_a4_neither_the_sampler_nor_a_stratum_ever_gives_1() {
    let [smallest, largest] = extremes();
    println!("A3: numbers from {smallest:e} to 1 - {:e}", 1.0 - largest);
    assert!(smallest >= 0.0 && largest <= LARGEST_BELOW_1, "{smallest:e}, {largest}");
    assert!(smallest < 2e-7 && largest > 1.0 - 2e-7, "{smallest:e}, {largest}");
    for strata in 2..=4096u32 {
        for stratum in 0..strata {
            let x = (f64::from(stratum) + largest) / f64::from(strata);
            assert!(x < 1.0, "{stratum} of {strata}: {x}");
        }
    }
}

#[test]
fn a3_the_numbers_of_a_pixel_fill_their_strata() {
    // 4^6 points of a Sobol sequence: each of 4^6 equal intervals contains one, in every dimension.
    const COUNT: usize = 1 << 12;
    for dimension in 0..4 {
        let mut counts = vec![0; COUNT];
        for sample in 0..COUNT {
            let x = Sampler::new(9, [3, 4], sample as u32).get_4d(BranchKey::CAMERA, 2)[dimension];
            counts[(x * COUNT as f64) as usize] += 1;
        }
        assert!(counts.iter().all(|&count| count == 1), "dimension {dimension}");
    }
}

#[test]
fn a4_the_sides_of_the_unit_square_are_mapped_onto_the_shape() {
    let mut random = Random::new(81);
    let ends = [0.0, f64::MIN_POSITIVE, 0.5, LARGEST_BELOW_1, 1.0f64.next_down()];
    let corners: Vec<[f64; 2]> = ends.iter().flat_map(|&a| ends.map(|b| [a, b])).collect();
    let sides = (0..10_000).flat_map(|_| [0.0, LARGEST_BELOW_1, 1.0f64.next_down()].map(|end| (end, random.number())));
    let sides: Vec<[f64; 2]> = sides.flat_map(|(end, other)| [[end, other], [other, end]]).collect();
    let (points, faces) = ball();
    let count = faces.len() as u32;
    let shapes = [(closed_mesh(points, faces), count), (Shape::Cube(Cube::new(DVec3::ZERO, DVec3::ONE)), 6)];
    for u in corners.into_iter().chain(sides) {
        let [a, b] = sample_triangle(u);
        assert!(a >= 0.0 && b >= 0.0 && a + b <= 1.0, "{u:?}: ({a}, {b})");
        assert!(sample_disk(u).length() <= 1.0 + 1e-15 && sample_disk(u).is_finite(), "{u:?}");
        for direction in [sample_cosine_hemisphere(u), sample_sphere(u)] {
            assert!((direction.length() - 1.0).abs() < 1e-15, "{u:?}: {direction}");
        }
        for (shape, parts) in &shapes {
            let sample = shape.sample(DVec3::new(3.0, 2.0, 1.0), u).expect("the point is outside");
            assert!(sample.direction.is_finite() && sample.part.is_some_and(|part| part < *parts), "{sample:?}");
        }
    }
}
