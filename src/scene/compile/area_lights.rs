//! Surfaces that emit light.

use std::sync::Arc;

use crate::light::{Area, EmissionMap, Light, LightId, MeshPartsCache, ShownImage};
use crate::material::Material;
use crate::scene::{Object, Scene};
use crate::shape::{Coordinates, Shape, Sides, TexturedShape};
use crate::spectrum::{Curve, CurveKind};

/// Gives a light to every object whose material emits.
pub(super) fn add_area_lights(scene: &mut Scene<Curve>) {
    let (mut maps, mut known) = (EmissionMaps::default(), MeshPartsCache::default());
    for number in 0..scene.objects.len() {
        let object = &scene.objects[number];
        let (radiance, sides, is_lamp) = match &scene.materials[object.material as usize].material {
            Material::Emissive(emissive) => (&emissive.radiance, emissive.sides, true),
            Material::Dielectric(dielectric) => (&dielectric.emission, Sides::Both, false),
            _ => continue,
        };
        if radiance.is_dark() {
            continue;
        }
        let light: LightId = scene.lights.len();
        let is_sampled = is_lamp && object.shape.is_bounded();
        let image = object.coordinates.clone().filter(|_| radiance.varies()).map(|coordinates| {
            let map = if is_sampled { maps.get_or_create(object, &coordinates, &radiance.kind) } else { None };
            ShownImage { coordinates, map }
        });
        let area =
            Area::new(object.shape.clone(), number as u32, radiance.clone(), sides, is_sampled, image, &mut known);
        scene.light_groups.push(object.group.as_ref().unwrap_or(&object.asset).clone());
        scene.lights.push(Light::Area(area));
        Arc::make_mut(&mut scene.objects)[number].light = Some(light);
    }
}

/// The emission maps of lamps that show images. Lamps on which the same image lies in the same way share one.
#[derive(Default)]
struct EmissionMaps {
    known: Vec<KnownMap>,
}

struct KnownMap {
    shape: Arc<Shape>,
    coordinates: Arc<Coordinates>,
    kind: CurveKind,
    map: Arc<EmissionMap>,
}

impl EmissionMaps {
    fn get_or_create(
        &mut self,
        object: &Object,
        coordinates: &Arc<Coordinates>,
        kind: &CurveKind,
    ) -> Option<Arc<EmissionMap>> {
        let surface = TexturedShape { shape: &object.shape, coordinates };
        let is_like = |known: &&KnownMap| known.kind == *kind && surface.is_like(&known.surface());
        if let Some(known) = self.known.iter().rev().find(is_like) {
            return Some(known.map.clone());
        }
        let map = Arc::new(EmissionMap::new(kind, surface)?);
        let (shape, coordinates) = (object.shape.clone(), coordinates.clone());
        self.known.push(KnownMap { shape, coordinates, kind: kind.clone(), map: map.clone() });
        Some(map)
    }
}

impl KnownMap {
    fn surface(&self) -> TexturedShape<'_> {
        TexturedShape { shape: &self.shape, coordinates: &self.coordinates }
    }
}
