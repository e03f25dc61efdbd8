//! Where dispersive objects are, and the smooth objects in or through which they may be seen.

use super::color_walk::{ColorWalk, Colors};
use crate::material::Material;
use crate::math::{Bounds, DVec3, Ray, group_neighbors};
use crate::shape::Ball;

/// Dispersion over fewer pixels is not seen.
pub const SEEN_PIXELS: f64 = 0.2;
/// Maximum number of boxes of either kind. If there are more objects, neighbors share a box.
const MAX_BOXES: usize = 48;
/// How much wider than the rays around it a beam is taken to be: what they enclose may bulge out between them.
const BEAM_MARGIN: f64 = 1.25;

/// A box around an object, or around neighbors.
pub struct SearchTarget {
    bounds: Bounds,
    pub dispersive: bool,
}

impl SearchTarget {
    pub fn ball(&self) -> Ball {
        Ball::of_box(&self.bounds)
    }
}

pub struct Targets {
    /// The targets, dispersive ones first.
    pub all: Vec<SearchTarget>,
    /// The target that each object belongs to, if any.
    target_of_object: Vec<Option<usize>>,
}

impl Targets {
    pub fn new(colors: &Colors) -> Self {
        let scene = &colors.world.scene;
        let mut kinds: [Vec<(u32, Bounds)>; 2] = Default::default();
        for (object, bounds) in (0..).zip(scene.objects.iter()).filter_map(|(i, o)| Some((i, o.shape.bounds()?))) {
            match scene.material_of(object) {
                Material::Dielectric(glass) => kinds[usize::from(!colors.is_dispersive(glass))].push((object, bounds)),
                Material::Mirror(_) | Material::Thin(_) | Material::Conductor(_) => kinds[1].push((object, bounds)),
                _ => {}
            }
        }
        let (mut all, mut target_of_object) = (Vec::new(), vec![None; scene.objects.len()]);
        for (mut objects, dispersive) in kinds.into_iter().zip([true, false]) {
            let mut add = |group: &[(u32, Bounds)]| {
                group.iter().for_each(|(object, _)| target_of_object[*object as usize] = Some(all.len()));
                let bounds = group.iter().map(|object| object.1).fold(Bounds::EMPTY, Bounds::union);
                all.push(SearchTarget { bounds, dispersive });
            };
            group_neighbors(&mut objects, MAX_BOXES, &|object| object.1.center(), &mut add);
        }
        Self { all, target_of_object }
    }

    /// Returns the first target that a beam may touch and that not all of its rays have hit; `None` if there is none.
    ///
    /// Rays that passed the same objects are one beam on their next segment, as wide as they are apart. For a ray that
    /// goes its own way, only the width of a beam that nothing has bent is known: `width` is its angle.
    pub fn touched(&self, walks: &[ColorWalk], width: f64) -> Option<usize> {
        let has_hit = |walk: &ColorWalk, target: usize| {
            walk.crossed_objects
                .iter()
                .chain(walk.end.iter().map(|end| &end.1))
                .any(|&object| self.target_of_object[object as usize] == Some(target))
        };
        let candidates: Vec<usize> =
            (0..self.all.len()).filter(|&i| !walks.iter().all(|walk| has_hit(walk, i))).collect();
        if candidates.is_empty() {
            return None;
        }
        let beams = beams(walks, width);
        candidates.into_iter().find(|&target| beams.iter().any(|beam| beam.touches(&self.all[target].bounds)))
    }
}

/// A ray, and how far from it other rays lie that go along with it.
struct Beam {
    ray: Ray,
    length: f64,
    /// Radius at its start, and its increase per unit of length.
    radius: f64,
    slope: f64,
}

/// Returns the beams of rays that start together.
fn beams(walks: &[ColorWalk], width: f64) -> Vec<Beam> {
    let mut beams = Vec::new();
    let longest = walks.iter().map(|walk| walk.legs.len()).max().unwrap_or(0);
    for leg in 0..longest {
        let on_leg: Vec<&ColorWalk> = walks.iter().filter(|walk| walk.legs.len() > leg).collect();
        for (number, walk) in on_leg.iter().enumerate() {
            let shares_beam = |other: &&&ColorWalk| other.crossed_objects[..leg] == walk.crossed_objects[..leg];
            if on_leg[..number].iter().any(|other| shares_beam(&other)) {
                continue;
            }
            let ray = walk.legs[leg].0;
            let mut beam = Beam { ray, length: 0.0, radius: 0.0, slope: 0.0 };
            let mut count = 0;
            for (other, length) in on_leg[number..].iter().filter(shares_beam).map(|other| other.legs[leg]) {
                beam.radius = beam.radius.max(BEAM_MARGIN * (other.origin - ray.origin).length());
                beam.slope = beam.slope.max(BEAM_MARGIN * (other.direction - ray.direction).length());
                beam.length = beam.length.max(length);
                count += 1;
            }
            if count == 1 {
                beam.radius = width * walk.legs[..leg].iter().map(|leg| leg.1).sum::<f64>();
                beam.slope = width;
            }
            beams.push(beam);
        }
    }
    beams
}

impl Beam {
    /// Returns whether a box may lie partly within the beam.
    fn touches(&self, bounds: &Bounds) -> bool {
        let (half, middle) = (0.5 * bounds.size().length(), bounds.center() - self.ray.origin);
        let farthest = (middle.dot(self.ray.direction) + half).clamp(0.0, self.length);
        let radius = DVec3::splat(self.radius + self.slope * farthest);
        let (low, high) = (bounds.min - radius - self.ray.origin, bounds.max + radius - self.ray.origin);
        let (mut from, mut to) = (0.0, self.length);
        for axis in 0..3 {
            let speed = self.ray.direction[axis];
            if speed == 0.0 {
                if low[axis] > 0.0 || high[axis] < 0.0 {
                    return false;
                }
                continue;
            }
            let (a, b) = (low[axis] / speed, high[axis] / speed);
            (from, to) = (f64::max(from, a.min(b)), f64::min(to, a.max(b)));
        }
        from <= to
    }
}
