//! Sampling one of many lights: each is chosen with its stated probability, and none that contributes is left out.

use abbe::light::{LightBounds, LightTree};
use abbe::math::{Bounds, DVec3};

use crate::support::chi_squared;
use crate::support::random::Random;

const DRAWS: u32 = 200_000;

fn crowd(random: &mut Random, count: u32, size: f64) -> Vec<LightBounds> {
    let mut one = |number: u32| {
        let mut place = || random.between(-1.0, 1.0);
        let center = DVec3::new(4.0 * place(), 4.0 * place(), 4.0 * place());
        let half = DVec3::new(place(), place(), place()).abs() * size;
        let normal = (!number.is_multiple_of(4)).then(|| random.direction());
        let bounds = Bounds { min: center - half, max: center + half };
        LightBounds { bounds, normal, two_sided: number % 4 == 1, intensity: random.number() }
    };
    (0..count).map(&mut one).collect()
}

#[test]
fn lights_are_chosen_as_often_as_they_say() {
    let mut random = Random::new(5);
    for (name, count, size) in [("few", 6, 0.1), ("points", 50, 0.0), ("boxes", 60, 0.3), ("large boxes", 40, 2.0)] {
        let lights = crowd(&mut random, count, size);
        let tree = LightTree::new(&lights);
        let (from, normal) = (DVec3::new(0.5, -0.7, 0.2), random.direction());
        let probability = |i: u32| tree.probability(i as usize, from, normal, false);
        let probabilities: Vec<f64> = (0..count).map(probability).collect();
        let sum: f64 = probabilities.iter().sum();
        let (mut counts, mut chosen) = (vec![0; count as usize], 0u32);
        for _ in 0..DRAWS {
            let Some(drawn) = tree.sample(from, normal, false, random.number()) else { continue };
            let found = probabilities[drawn.index];
            assert!((drawn.probability / found - 1.0).abs() < 1e-12 && (0.0..1.0).contains(&drawn.u), "{drawn:?}");
            counts[drawn.index] += 1;
            chosen += 1;
        }
        // The search ends without a light in a branch whose bound promised light that none of its lights can send.
        let share = f64::from(chosen) / f64::from(DRAWS);
        assert!(sum <= 1.0 + 1e-12 && (share - sum).abs() < 4.0 * (0.25 / f64::from(DRAWS)).sqrt(), "{sum} {share}");
        let among: Vec<f64> = probabilities.iter().map(|p| p / sum).collect();
        chi_squared::check(name, &counts, &among, 4);
    }
}

#[test]
fn no_light_is_left_out_that_sends_light() {
    let mut random = Random::new(6);
    for size in [0.0, 0.2, 1.5] {
        let lights = crowd(&mut random, 200, size);
        let tree = LightTree::new(&lights);
        for _ in 0..200 {
            let (from, normal) = (DVec3::from([(); 3].map(|()| random.between(-5.0, 5.0))), random.direction());
            for (i, light) in lights.iter().enumerate() {
                let Bounds { min, max } = light.bounds;
                let share = DVec3::from([(); 3].map(|()| random.number()));
                let way = min + (max - min) * share - from;
                let lit = way.dot(normal) > 1e-9;
                let facing = light.normal.is_none_or(|normal| faces(normal, light.two_sided, way));
                let probability = tree.probability(i, from, normal, false);
                assert!(probability > 0.0 || !(lit && facing), "{size}: {light:?} from {from}");
            }
        }
    }
}

/// Returns whether the front, or the back of a two-sided light, faces the start of a ray.
fn faces(normal: DVec3, two_sided: bool, way: DVec3) -> bool {
    let cos = -normal.dot(way);
    cos > 1e-9 || (two_sided && cos < -1e-9)
}

#[test]
fn lights_in_one_place_and_in_growing_distances_are_all_chosen() {
    let at = |x: f64, intensity| {
        let bounds = Bounds { min: DVec3::splat(x), max: DVec3::splat(x) };
        LightBounds { bounds, normal: None, two_sided: false, intensity }
    };
    let one_place: Vec<LightBounds> = (0..3000).map(|_| at(1.0, 1.0)).collect();
    let growing: Vec<LightBounds> = (0..3000).map(|i| at(libm::exp2(f64::from(i) / 20.0), 1.0)).collect();
    for lights in [one_place, growing] {
        let tree = LightTree::new(&lights);
        let normal = DVec3::ONE.normalize();
        let sum: f64 = (0..lights.len()).map(|i| tree.probability(i, DVec3::ZERO, normal, false)).sum();
        assert!((sum - 1.0).abs() < 1e-9, "{sum}");
        // Also from almost exactly the position of a light.
        let found = tree.sample(DVec3::splat(1.0 - 1e-15), normal, false, 0.3).expect("there is light");
        assert!(found.probability.is_finite() && found.probability > 0.0);
    }
    let dark = LightTree::new(&[at(1.0, 0.0)]);
    assert!(dark.sample(DVec3::ZERO, DVec3::X, false, 0.5).is_none());
    assert_eq!(dark.probability(0, DVec3::ZERO, DVec3::X, false), 0.0);
}
