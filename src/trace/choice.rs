//! Which of many lights is aimed at from a point.

use crate::light::{Light, LightId};
use crate::math::DVec3;
use crate::shape::{self, Emitter, Emitters};
use crate::spectrum::Table;

/// Lights by what they may send to a point. The sky, whose power depends on the scene's size, gets as much as all others
/// together, divided by the irradiance of its parts.
#[derive(Clone, Debug)]
pub(super) struct Choice {
    near: Emitters,
    /// How often one of the near lights is chosen.
    share: f64,
    /// The light that each emitter of the tree is.
    lights: Vec<LightId>,
    /// Place among `lights`.
    places: Vec<Option<usize>>,
    /// How often each sky is chosen.
    skies: Vec<(LightId, f64)>,
}

impl Choice {
    pub(super) fn new(lights: &[Light<Table>]) -> Self {
        let (mut places, mut near, mut emitters) = (vec![None; lights.len()], Vec::new(), Vec::<Emitter>::new());
        let mut skies = Vec::new();
        for (light, id) in lights.iter().zip(0..).filter(|(light, _)| light.is_aimed_at()) {
            match light.emitter() {
                Some(emitter) if emitter.intensity > 0.0 => {
                    places[id] = Some(near.len());
                    near.push(id);
                    emitters.push(emitter);
                }
                None if light.irradiance() > 0.0 => skies.push((id, light.irradiance())),
                _ => {}
            }
        }
        let share = match (near.is_empty(), skies.is_empty()) {
            (true, _) => 0.0,
            (false, false) => 0.5,
            (false, true) => 1.0,
        };
        let all: f64 = skies.iter().map(|sky| sky.1).sum();
        skies.iter_mut().for_each(|sky| sky.1 *= (1.0 - share) / all);
        Self { near: Emitters::new(&emitters), share, lights: near, places, skies }
    }

    /// Lights that are chosen from anywhere.
    pub(super) fn targets(&self) -> Vec<LightId> {
        let mut targets: Vec<LightId> = self.lights.iter().copied().chain(self.skies.iter().map(|sky| sky.0)).collect();
        targets.sort_unstable();
        targets
    }

    /// A light for a point on a surface of the given unit normal, and how likely it was.
    pub(super) fn choose(&self, from: DVec3, normal: DVec3, u: f64) -> Option<(LightId, f64)> {
        if u < self.share {
            let shape::Choice { emitter, probability, .. } = self.near.choose(from, normal, false, u / self.share)?;
            return Some((self.lights[emitter as usize], probability * self.share));
        }
        let mut left = u - self.share;
        let chosen = self.skies.iter().find(|sky| {
            left -= sky.1;
            left < 0.0
        });
        chosen.or(self.skies.last()).copied()
    }

    /// How likely `choose` chooses a light.
    pub(super) fn probability(&self, light: LightId, from: DVec3, normal: DVec3) -> f64 {
        match self.places[light] {
            Some(place) => self.share * self.near.probability(place, from, normal, false),
            None => self.skies.iter().find(|sky| sky.0 == light).map_or(0.0, |sky| sky.1),
        }
    }
}
