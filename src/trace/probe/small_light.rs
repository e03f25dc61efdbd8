//! Lights that are looked for on the film because their images may be small.

use super::lamp_part::LampPart;
use crate::light::{Environment, Light, LightId};
use crate::math::{Cone, DVec3};
use crate::shape::Ball;
use crate::spectrum::Table;
use crate::trace::World;

/// Directions that are drawn along each side of a square to find where the bright part of a sky is.
const DRAWS_PER_SIDE: u32 = 16;

/// Most polygons of all lamps that are divided. The first lamps of a scene are, as far as these reach.
const MAX_POLYGONS: u32 = 1 << 17;

/// A light, or a part of one, that is looked for.
#[derive(Clone, Copy)]
pub struct SmallLight {
    pub id: LightId,
    /// Its object, if it has one.
    pub object: Option<u32>,
    pub place: Place,
}

/// Where a light is.
#[derive(Clone, Copy)]
pub enum Place {
    /// In a direction, within a half angle of this sine.
    Far { direction: DVec3, sin: f64 },
    /// In a ball.
    Near(Ball),
}

/// How a light is seen from a point.
pub struct ApparentLight {
    /// The direction of its center.
    pub direction: DVec3,
    /// The sine of its half angle.
    pub sin: f64,
    pub distance: f64,
}

impl SmallLight {
    /// Returns how it is seen from a point.
    pub fn seen_from(&self, point: DVec3) -> ApparentLight {
        match self.place {
            Place::Far { direction, sin } => ApparentLight { direction, sin, distance: f64::INFINITY },
            Place::Near(ball) => {
                let way = ball.center - point;
                let distance = way.length();
                ApparentLight { direction: way / distance, sin: ball.radius / distance, distance }
            }
        }
    }
}

/// All lights whose images may be small.
pub struct SmallLights {
    /// Suns and skies.
    far: Vec<SmallLight>,
    /// The lights that are near, with their objects.
    near: Vec<(LightId, Option<u32>)>,
    /// What each of these is to be divided into.
    lamps: Vec<LampPart>,
}

impl SmallLights {
    /// Finds the lights of a world. If there are `max` or more, none is divided.
    pub fn new(world: &World, max: usize) -> Self {
        let lights = &world.scene.lights;
        let (mut far, mut near, mut lamps) = (Vec::new(), Vec::new(), Vec::new());
        let mut polygons_left = MAX_POLYGONS;
        let mut add_lamp = |id: LightId, object: Option<u32>, lamp: LampPart| {
            near.push((id, object));
            lamps.push(lamp);
        };
        let at = |position: [f64; 3]| LampPart::undivided(Ball { center: position.into(), radius: 0.0 });
        for (id, light) in lights.iter().enumerate() {
            let far_light = |place: Place| SmallLight { id, object: None, place };
            match light {
                Light::Sun(sun) => {
                    let sin = libm::sin(0.5 * sun.angular_diameter.to_radians());
                    far.push(far_light(Place::Far { direction: sun.center_direction(), sin }));
                }
                Light::Environment(sky) => far.extend(bright_part(sky).map(far_light)),
                Light::Area(area) => {
                    let polygons = area.shape.part_count();
                    let is_divided = lights.len() < max && polygons <= polygons_left;
                    polygons_left -= if is_divided { polygons } else { 0 };
                    let in_parts = if is_divided { LampPart::of_polygons(&area.shape) } else { None };
                    let whole = || Some(LampPart::undivided(area.visible_part()?.0));
                    in_parts.or_else(whole).into_iter().for_each(|lamp| add_lamp(id, Some(area.object), lamp));
                }
                Light::Point(point) => add_lamp(id, None, at(point.position)),
                Light::Spot(spot) => add_lamp(id, None, at(spot.position)),
            }
        }
        Self { far, near, lamps }
    }

    /// Returns suns and skies, then lamps or parts of them: as many parts as there are, but at most `max` lights in all
    /// unless there are more lamps.
    pub fn in_parts(&self, max: usize) -> impl Iterator<Item = SmallLight> {
        let far = self.far.iter().copied();
        let parts = LampPart::divided(&self.lamps, max.saturating_sub(self.far.len()));
        let near = parts.into_iter().map(|(lamp, ball)| {
            let (id, object) = self.near[lamp];
            SmallLight { id, object, place: Place::Near(ball) }
        });
        far.chain(near)
    }
}

/// Returns where the bright part of a sky's image is, such as the sun; `None` without one.
fn bright_part(sky: &Environment<Table>) -> Option<Place> {
    let cell_center = |i: u32| (f64::from(i) + 0.5) / f64::from(DRAWS_PER_SIDE);
    let drawn = (0..DRAWS_PER_SIDE * DRAWS_PER_SIDE)
        .map(|i| Some(sky.sample_bright([cell_center(i % DRAWS_PER_SIDE), cell_center(i / DRAWS_PER_SIDE)])?.0));
    let Cone { axis, one_minus_cos } = Cone::around(&drawn.collect::<Option<Vec<DVec3>>>()?)?;
    Some(Place::Far { direction: axis, sin: (one_minus_cos * (2.0 - one_minus_cos)).max(0.0).sqrt() })
}
