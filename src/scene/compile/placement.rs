//! Objects in their places, once all of them have been read.

use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

use super::material_parts::Materials;
use super::object::ObjectDraft;
use super::shape::check_size;
use crate::material::Material;
use crate::math::{DVec3, Transform};
use crate::scene::text::{Spanned, Value};
use crate::scene::{NamedMaterial, Object};
use crate::shape::{Coordinates, Shape};
use crate::spectrum::Curve;

/// The objects of a scene.
#[derive(Default)]
pub(super) struct PlacedObjects<'d> {
    pub(super) objects: Vec<Object>,
    /// Where the shape of each is written.
    pub(super) shapes: Vec<Value<'d>>,
    /// Their materials, in the order in which objects first use them.
    pub(super) materials: Vec<NamedMaterial<Curve>>,
}

impl PlacedObjects<'_> {
    /// Returns the material of an object, with its name.
    pub(super) fn material(&self, object: &Object) -> &NamedMaterial<Curve> {
        &self.materials[object.material as usize]
    }

    /// Returns whether an object is a clear body, or a part of the surface of one.
    pub(super) fn is_clear(&self, object: &Object) -> bool {
        self.material(object).material.medium().is_some()
    }
}

/// Places all objects without mistakes.
pub(super) fn placed<'d>(drafts: Vec<ObjectDraft<'d>>, materials: &Materials<'d>) -> PlacedObjects<'d> {
    let (mut placed, mut numbers) = (PlacedObjects::default(), BTreeMap::<&str, u32>::new());
    // Number of times that each mesh file is placed.
    let mut places = HashMap::<&str, usize>::new();
    for draft in &drafts {
        let count = draft.instances.as_ref().map_or(1, Vec::len);
        draft.shape.value.file.into_iter().for_each(|file| *places.entry(file).or_default() += count);
    }
    for draft in drafts {
        let Some(Some(material)) = materials.get(draft.material) else { continue };
        let number = *numbers.entry(draft.material).or_insert_with(|| {
            let (name, material) = (draft.material.to_owned(), material.clone());
            placed.materials.push(NamedMaterial { name, material });
            placed.materials.len() as u32 - 1
        });
        let maps = match (&draft.instances, material.has_axis()) {
            (Some(instances), true) => instances.iter().map(|map| map.value).collect(),
            (None, true) => vec![draft.map.value],
            (_, false) => Vec::new(),
        };
        let (shape, name) = (draft.shape.place, draft.material);
        let is_shared = draft.shape.value.file.is_some_and(|file| places[file] > 1);
        let objects = build_objects(draft, is_shared, number, material.varies()).unwrap_or_default();
        for (instance, mut object) in objects.into_iter().enumerate() {
            if let Some(map) = maps.get(instance) {
                let (name, material) = (name.to_owned(), material.turned(map));
                if has_axis_along_normal(&material, &object.shape) {
                    let message = format!("the axis of material {name} is along the normal of this surface");
                    shape.advise::<()>(message, "an axis must lie in the surface; both turn with the object");
                    break;
                }
                placed.materials.push(NamedMaterial { name, material });
                object.material = placed.materials.len() as u32 - 1;
            }
            placed.objects.push(object);
            placed.shapes.push(shape);
        }
    }
    placed
}

/// Returns whether the axis of a material favors no direction on a flat shape, because it is along its normal.
fn has_axis_along_normal(material: &Material<Curve>, shape: &Shape) -> bool {
    let axis = material.axis().and_then(DVec3::try_normalize);
    axis.zip(shape.flat_normal()).is_some_and(|(axis, normal)| axis.cross(normal).length() < PARALLEL_SINE)
}

/// Sine of the angle that rounding in a few rotations can leave in place of 0.
const PARALLEL_SINE: f64 = 1e-9;

/// Returns the object, or each of its instances. `is_shared` says that its mesh is placed elsewhere, too.
fn build_objects(draft: ObjectDraft, is_shared: bool, material: u32, varies: bool) -> Option<Vec<Object>> {
    let ObjectDraft {
        name,
        material: material_name,
        shape: Spanned { place, value: written },
        map,
        instances,
        relief,
        ..
    } = draft;
    let (group, visibility) = (draft.group.map(str::to_owned), draft.visibility);
    let asset = name.clone();
    let object = |name: String, shape: Shape, coordinates: Option<Coordinates>| {
        if varies && coordinates.is_none() {
            let message = format!("this mesh has no texture coordinates, which material {material_name} needs");
            return place.advise(message, "give it a material without `image` and `checker`");
        }
        let coordinates = coordinates.map(Arc::new);
        let relief = match &relief {
            Some(relief) => Some(relief.apply_to(coordinates.as_ref())?),
            None => None,
        };
        let (shape, asset, group) = (Arc::new(shape), asset.clone(), group.clone());
        // Later steps know which objects shine, and which share a surface with others.
        let (light, contact) = (None, 0.0);
        Some(Object { name, asset, shape, material, light, coordinates, varies, group, visibility, relief, contact })
    };
    let Some(instances) = instances else {
        let coordinates = Coordinates::new(&written.shape, &map.value);
        let shape = if is_shared { written.shape.copied(&map.value) } else { written.shape.transformed(&map.value) };
        check_size(&written.shape, &shape, map, place)?;
        return Some(vec![object(name, shape, coordinates)?]);
    };
    let instance = |(number, map): (usize, Spanned<Transform>)| {
        let shape = written.shape.copied(&map.value);
        check_size(&written.shape, &shape, map, map.place)?;
        object(format!("{name} [{}]", number + 1), shape, Coordinates::new(&written.shape, &map.value))
    };
    let placed: Vec<_> = instances.into_iter().enumerate().map(instance).collect();
    placed.into_iter().collect()
}
