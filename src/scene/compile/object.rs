//! Objects, each read by itself.

use std::collections::BTreeSet;
use std::sync::Arc;

use super::context::Context;
use super::material_parts::{Materials, list_materials, unknown_material};
use super::normal_perturbation::{ReliefText, relief};
use super::shape::SHAPE;
use super::shape_text::ShapeText;
use super::transform::{compose_steps, steps};
use crate::material::Material;
use crate::math::Transform;
use crate::scene::Visibility;
use crate::scene::text::{Fields, Spanned, Value, spanned};
use crate::shape::{Mesh, Shape};
use crate::spectrum::Curve;

/// ```toml
/// [[object]]
/// shape.sphere = { center = [0, 1, 0], radius = 1 }
/// material = "glass"
/// # transform = [{ scale = 2 }]
/// # visible_to_camera = false     # or holdout = true, or shadow_catcher = true
/// # group = "key"                 # the layer of its light
/// # bump_map = { image = "dents.png", depth = 0.02 }
/// # instances = [[{ translate = [1, 0, 0] }], [{ translate = [3, 0, 0] }, { scale = [-1, 1, 1] }]]
/// ```
pub(super) struct ObjectDraft<'d> {
    /// Its name, or `object N` counted from 1.
    pub(super) name: String,
    pub(super) material: &'d str,
    pub(super) shape: Spanned<'d, ShapeText<'d>>,
    /// The transform of the shape, and its place in the text.
    pub(super) map: Spanned<'d, Transform>,
    /// The transforms of the instances of the shape, `map` included; one shape if absent.
    pub(super) instances: Option<Vec<Spanned<'d, Transform>>>,
    pub(super) relief: Option<ReliefText<'d>>,
    /// The light group that it belongs to.
    pub(super) group: Option<&'d str>,
    pub(super) visibility: Visibility,
}

/// The names by which objects find their materials.
pub(super) struct Names<'m, 'd> {
    pub(super) materials: &'m Materials<'d>,
    /// Whether there are materials whose names are not known.
    pub(super) has_unnamed: bool,
    /// Names of materials that do not exist. Each is reported where it is first used.
    pub(super) unknown: BTreeSet<&'d str>,
}

/// Reads an object. `number` is its position in the list.
pub(super) fn object<'d>(
    context: &mut Context,
    names: &mut Names<'_, 'd>,
    entry: Value<'d>,
    number: usize,
) -> Option<ObjectDraft<'d>> {
    Fields::read(entry, |object| {
        let name = object.maybe("name", name);
        let shape = object.need("shape", Some);
        let is_material_inside = shape.is_some_and(|shape| shape.node().get("material").is_some());
        let named = match object.get("material") {
            Some(value) => spanned(|value: Value<'d>| names.find(value))(value),
            None if is_material_inside => None,
            None if entry.has_many_mistakes() => object.report_missing("material", None),
            None => object.report_missing("material", names.help(name.flatten()).as_deref()),
        };
        let map = object.or(
            "transform",
            Spanned { place: entry, value: Transform::IDENTITY },
            spanned(|value| compose_steps(&steps(value)?, Transform::IDENTITY)),
        );
        let instances = object.get("instances");
        let relief = relief(context, object);
        let group = object.maybe("group", group);
        let visibility = visibility(object);
        for (kind, _) in SHAPE.kinds {
            object.refuse_misplaced(kind, format!("`{kind}` is a shape"), format!("write shape.{kind} = {{ .. }}"));
        }
        let name = name?.map_or_else(|| format!("object {}", number + 1), str::to_owned);
        let shape = shape.and_then(spanned(|value| {
            let (read, kind) = SHAPE.of(value)?;
            read(context, &name, kind)
        }));
        let instances = instances.map_or(Some(None), |value| instance_maps(value, map?.value).map(Some));
        let (shape, map, named, instances) = (shape?, map?, named?, instances?);
        let (group, visibility, relief) = (group?, visibility?, relief?);
        let written = &shape.value.shape;
        if let (Some(_), Shape::Mesh(mesh)) = (named.value.medium(), written) {
            glass_mesh_warnings(mesh, context.averaged_meshes.contains(&Arc::as_ptr(mesh)))
                .into_iter()
                .for_each(|problem| context.warn(format!("{name}: {problem}")));
        }
        if let (Shape::Mesh(mesh), Some(file)) = (written, shape.value.file)
            && mesh.bare() > 0
            && (named.value.varies() || relief.is_some())
        {
            let problem = match mesh.bare() {
                1 => format!("1 triangle of {file} has no texture coordinates: it shows"),
                bare => format!("{bare} triangles of {file} have no texture coordinates: they show"),
            };
            context.warn(format!("{name}: {problem} the image where u and v are 0"));
        }
        Some(ObjectDraft { name, material: named.place.text()?, shape, map, instances, relief, group, visibility })
    })
}

/// Angle in degrees between a face and its normals above which an edge is sharp: larger than that of an icosahedron,
/// and smaller than that of a box.
const SHARP_DEGREES: f64 = 40.0;

/// Returns what is wrong with a mesh as the surface of a clear body. `is_averaged` says that its normals are averages
/// of those of its faces.
fn glass_mesh_warnings(mesh: &Mesh, is_averaged: bool) -> Vec<String> {
    let mut found = Vec::new();
    if !mesh.is_closed() {
        let reverse = "reverse the order of the corners, or recalculate the normals in the program that made it";
        found.push(match mesh.turned() {
            0 => "a dielectric on an open mesh: light may enter it and never leave".into(),
            1 => format!("1 triangle of this closed mesh is flipped: {reverse}"),
            turned => format!("{turned} triangles of this closed mesh are flipped: {reverse}"),
        });
    }
    let bend = if is_averaged { mesh.bend() } else { 0.0 };
    if bend > SHARP_DEGREES {
        found.push(format!(
            "this mesh has no normals, and `smooth` bends those of its faces by up to {bend:.0} degrees, so that \
             sharp edges look round and glass may trap light: leave it out, or save the mesh with normals"
        ));
    }
    found
}

/// Reads what the camera sees of an object.
fn visibility(object: &mut Fields) -> Option<Visibility> {
    let visible = object.or("visible_to_camera", true, Value::yes_or_no);
    let mut kind = |key| object.maybe(key, spanned(Value::yes_or_no)).map(|value| value.filter(|value| value.value));
    let (holdout, catcher) = (kind("holdout"), kind("shadow_catcher"));
    let both = |key: Spanned<'_, bool>, other: &str| {
        let help = "an object is hidden, or cuts a hole, or shows the shadows on it: keep one of these";
        key.place.advise(format!("`{}` cannot be combined with `{other}`", key.place.key()), help)
    };
    match (visible?, holdout?, catcher?) {
        (false, Some(key), _) | (false, _, Some(key)) => both(key, "visible_to_camera = false"),
        (true, Some(_), Some(key)) => both(key, "holdout"),
        (false, None, None) => Some(Visibility::Hidden),
        (true, Some(_), None) => Some(Visibility::Holdout),
        (true, None, Some(_)) => Some(Visibility::ShadowCatcher),
        (true, None, None) => Some(Visibility::Shown),
    }
}

/// Reads the name of an object or a light.
pub(super) fn name(value: Value<'_>) -> Option<&str> {
    non_empty_text(value, "a name cannot be empty", "leave `name` out if there is none")
}

/// Reads the name of a group of lights.
pub(super) fn group(value: Value<'_>) -> Option<&str> {
    non_empty_text(value, "the name of a light group cannot be empty", "such as group = \"key\"")
}

fn non_empty_text<'d>(value: Value<'d>, message: &str, help: &str) -> Option<&'d str> {
    let text = value.text()?;
    if text.is_empty() { value.advise(message, help) } else { Some(text) }
}

impl<'m, 'd> Names<'m, 'd> {
    /// Returns which materials an object that has none could use, if there are any.
    fn help(&self, object: Option<&str>) -> Option<String> {
        let known = self.materials.keys().copied();
        let (first, object) = (known.clone().next()?, object.unwrap_or("it"));
        Some(format!("give {object} one, as in material = {first:?}; {}", list_materials(known)))
    }

    /// Looks up the material of a name.
    fn find(&mut self, value: Value<'d>) -> Option<&'m Material<Curve>> {
        let name = value.text()?;
        if let Some(material) = self.materials.get(name) {
            return material.as_ref();
        }
        if self.has_unnamed || !self.unknown.insert(name) {
            return None;
        }
        unknown_material(value, name, self.materials.keys().copied())
    }
}

/// Reads the transforms of instances, each applied after that of the whole object.
fn instance_maps(value: Value, first: Transform) -> Option<Vec<Spanned<Transform>>> {
    let instance_maps = value.list(spanned(|value| compose_steps(&steps(value)?, first)))?;
    match instance_maps.is_empty() {
        true => value.refuse("an empty list of instances leaves nothing of the object"),
        false => Some(instance_maps),
    }
}
