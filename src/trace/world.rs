use super::media::Media;
use super::{Method, Transport};
use crate::light::{Light, LightId};
use crate::scene::Scene;
use crate::spectrum::{Curve, Response, Table};

/// A scene on the lanes of one method: everything the tracer reads.
#[derive(Clone, Debug)]
pub struct World {
    pub(super) scene: Scene<Table>,
    pub(super) method: Method,
    /// What each light's lanes are worth to the sensor.
    pub(super) responses: Vec<Response>,
    /// Lights that next-event estimation aims at.
    pub(super) targets: Vec<LightId>,
    /// How often each light is chosen where only one is aimed at; 0 for lights that are never aimed at.
    pub(super) probabilities: Vec<f64>,
    /// The bodies around the camera.
    pub(super) camera_media: Media,
    pub(super) has_media: bool,
}

impl World {
    /// The scene, tabulated for the method.
    pub fn new(scene: &Scene<Curve>, method: Method) -> Self {
        let responses = scene.lights.iter().map(|light| method.basis.response(light.emission())).collect();
        let has_media = scene.materials.iter().any(|m| m.material.medium().is_some());
        let scene = scene.map(|quantity, curve| method.basis.tabulate(quantity, curve));
        let probabilities = probabilities(&scene.lights);
        let targets = (0..scene.lights.len()).filter(|&light| probabilities[light] > 0.0).collect();
        let camera_media = Media::default();
        let mut world = Self { responses, targets, probabilities, scene, method, camera_media, has_media };
        if has_media {
            let (position, forward) = (world.scene.camera.position(), world.scene.camera.forward());
            world.camera_media = Media::around(&world, position, forward);
        }
        world
    }

    /// The same world with what each light's lanes are worth replaced, for tests that look at single lanes.
    pub fn with_responses(mut self, replace: impl Fn(&Response) -> Response) -> Self {
        self.responses = self.responses.iter().map(replace).collect();
        self
    }

    /// The scene as the tracer sees it.
    pub fn scene(&self) -> &Scene<Table> {
        &self.scene
    }

    /// How it is rendered.
    pub fn method(&self) -> &Method {
        &self.method
    }

    /// Whether next-event estimation at a vertex of the given weight aims at every light, or at one.
    pub(super) fn aims_at_all(&self, weight: f64) -> bool {
        /// Lights that may all be aimed at from one vertex.
        const MANY: usize = 8;
        match self.method.transport {
            Transport::Deterministic { .. } => true,
            Transport::Random { split, .. } => {
                self.targets.len() == 1 || (weight > split && self.targets.len() <= MANY)
            }
        }
    }
}

/// Lights by their power. The sky, whose power depends on the scene's size, gets as much as all others together, divided
/// by the irradiance of its parts.
fn probabilities(lights: &[Light<Table>]) -> Vec<f64> {
    let strength = |light: &Light<Table>| if light.is_aimed_at() { light.strength().max(0.0) } else { 0.0 };
    let sum = |sky: bool| lights.iter().filter(|light| light.is_sky() == sky).map(strength).sum::<f64>();
    let (near, sky) = (sum(false), sum(true));
    let half = if near > 0.0 && sky > 0.0 { 0.5 } else { 1.0 };
    let share = |light: &Light<Table>| {
        let total = if light.is_sky() { sky } else { near };
        if total > 0.0 { half * strength(light) / total } else { 0.0 }
    };
    lights.iter().map(share).collect()
}
