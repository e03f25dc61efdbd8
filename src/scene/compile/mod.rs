//! Compiles a scene's text to a world that can be rendered. The functions that read a scene define what it may contain,
//! here and nowhere else. They resolve all names, check all numbers, and continue after a mistake.

mod area_lights;
mod camera;
mod coating;
mod contact;
mod context;
mod curve;
mod curve_name;
mod curve_range;
mod curve_text;
mod film;
mod fluorescence;
mod format;
mod hidden_bodies;
mod image;
mod image_file;
mod image_numbers;
mod inside_out;
mod light;
mod material;
mod material_parts;
mod mesh;
mod near_pairs;
mod normal_perturbation;
mod object;
mod placement;
mod radiometry;
mod ranges;
mod render;
mod shape;
mod shape_text;
mod spectrum_draft;
mod spectrum_file;
mod transform;

use std::collections::{BTreeMap, BTreeSet};

use sha2::Digest;
use toml::de::DeValue;

use self::area_lights::add_area_lights;
use self::context::Context;
use self::material::MaterialDrafts;
use self::object::{Names, ObjectDraft};
use self::placement::PlacedObjects;
use super::checks::check;
use super::index::Index;
use super::text::{Document, Fields, INCLUDE, SET, Value};
use super::{ModelText, NamedMaterial, PolarizationText, RenderText, Scene};
use crate::film::Format;
use crate::spectrum::Curve;

/// The sections that a scene may have.
pub(super) const SECTIONS: [&str; 6] = ["camera", "film", "render", "material", "object", "light"];

/// Compiles the world that a document describes. Returns none if there is a mistake, which the document keeps.
pub(super) fn compile<'d>(document: &'d Document<'d>) -> Option<Scene<Curve>> {
    let mut context = Context::new(&document.texts.whole);
    document.texts.rows.iter().for_each(|rows| rows.digest(|bytes| context.hash.update(bytes)));
    let scene = Fields::of_document(document, |sections| scene(&mut context, sections));
    if document.reported() > 0 {
        return None;
    }
    let mut scene = scene?;
    scene.warnings = context.warnings(document);
    check(&mut scene);
    scene.files = context.files;
    scene.hash = context.hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect();
    Some(scene)
}

/// Reads the sections of a scene.
fn scene<'d>(context: &mut Context, sections: &mut Fields<'d>) -> Option<Scene<Curve>> {
    let [camera, film, render, materials, objects, lights] = SECTIONS.map(|key| sections.get(key));
    // Their values have already been put in their places.
    let _ = [SET, INCLUDE].map(|key| sections.get(key));
    check_required_sections(sections);
    let (film, format) = film.and_then(section).and_then(film::film).unzip();
    context.white_luminance = format.as_ref().and_then(|format| format.white_luminance);
    let camera = camera.and_then(section).and_then(|camera| camera::camera(context, camera, film.as_ref()));
    let render = render.map_or(Some(RenderText::default()), |render| render::render(section(render)?));
    // If [render] has a mistake, the unit is not reported as missing as well.
    context.meters_per_unit = render.as_ref().map_or(Some(1.0), |render| render.meters_per_unit);
    // Where a path may not bounce, only light sampling finds light.
    let bounces = render.as_ref().and_then(|render| render.diffuse_bounces);
    context.few_bounces = bounces.is_some_and(|bounces| bounces <= 1);
    let drafts = materials.map(|materials| material::drafts(context, materials));
    // The names in a section that is misspelled are not known.
    let has_unnamed = sections.is_misspelled("material");
    let drafts = drafts.unwrap_or_else(|| MaterialDrafts { by_name: BTreeMap::new(), has_unnamed });
    let materials = material_parts::resolve_parts(&drafts);
    let mut names = Names { materials: &materials, has_unnamed: drafts.has_unnamed, unknown: BTreeSet::new() };
    let objects = objects.map(|objects| {
        let mut numbers = 0..;
        entries(objects, |entry| object::object(context, &mut names, entry, numbers.next().unwrap_or_default()))
    });
    context.meshes.clear();
    let objects = objects.unwrap_or_default();
    warn_about_namesakes(context, &objects);
    let mut placed = placement::placed(objects, &materials);
    warn_about_unused(context, &placed, &drafts);
    contact::contacts(context, &mut placed);
    let body_warnings = [inside_out::inside_out(&placed), hidden_bodies::swallowed(&placed)];
    body_warnings.into_iter().flatten().for_each(|warning| context.warn(warning));
    let mut has_environment = false;
    let lights = lights.map(|lights| entries(lights, |light| light::light(context, light, &mut has_environment)));
    let PlacedObjects { objects, materials, .. } = placed;
    let index = Index::new(objects.iter().map(|object| &*object.shape));
    let (camera, film, format, render) = (camera?, film?, format?, render?);
    check_stokes(sections, &format, &render).and(check_fluorescence(sections, &materials, &render))?;
    let mut scene = Scene {
        camera,
        film,
        format,
        render,
        objects: objects.into(),
        materials,
        lights: Vec::new(),
        infinite_lights: Vec::new(),
        light_groups: Vec::new(),
        hidden_lights: Vec::new(),
        warnings: Vec::new(),
        hash: String::new(),
        files: Vec::new(),
        settings: Vec::new(),
        has_dark_warning: false,
        index: index.into(),
    };
    add_area_lights(&mut scene);
    light::add_lights(&mut scene, lights.unwrap_or_default());
    Some(scene)
}

/// Reports required sections that are missing, unless they are misspelled.
fn check_required_sections(sections: &mut Fields) {
    let needed = ["camera", "film"].into_iter();
    let missing = needed.filter(|key| sections.get(key).is_none() && !sections.is_misspelled(key));
    let missing: Vec<String> = missing.map(|key| format!("no [{key}]")).collect();
    if !missing.is_empty() {
        let message = format!("the scene has {}", missing.join(" and "));
        sections.refuse::<()>(message, Some("every scene needs [camera] and [film]"));
    }
}

/// Refuses Stokes vectors without polarization.
fn check_stokes(sections: &Fields, format: &Format, render: &RenderText) -> Option<()> {
    if !format.has_stokes() || render.polarization != PolarizationText::Off {
        return Some(());
    }
    let help = "leave `polarization` out of [render], or leave out the layers S1, S2, S3 and polarization";
    sections.refuse("Stokes vectors are requested, but polarization is off", Some(help))
}

/// Refuses dyes with the model of three bands, which has no wavelengths that a dye could absorb.
fn check_fluorescence(sections: &Fields, materials: &[NamedMaterial<Curve>], render: &RenderText) -> Option<()> {
    let dyed = materials.iter().find(|named| !named.material.dyes().is_empty());
    let Some(NamedMaterial { name, .. }) = dyed.filter(|_| render.model == ModelText::Rgb) else { return Some(()) };
    let message = format!("material {name} fluoresces, but the model \"rgb\" has no wavelengths for it");
    sections.refuse(message, Some("leave `model` out of [render], or write { bands = 16 }"))
}

/// Refuses a section that is a list.
fn section(value: Value) -> Option<Value> {
    match value.node() {
        DeValue::Array(_) => {
            let key = value.key();
            value.advise(format!("`{key}` is a table, not a list"), format!("write [{key}]"))
        }
        _ => Some(value),
    }
}

/// Reads the entries of a section that is a list of tables, and returns those without mistakes.
fn entries<'d, T>(value: Value<'d>, mut read: impl FnMut(Value<'d>) -> Option<T>) -> Vec<T> {
    if let DeValue::Table(_) = value.node() {
        let key = value.key();
        value.advise::<()>(format!("`{key}` is a list of tables"), format!("write [[{key}]] for each"));
        return Vec::new();
    }
    let entries = value.list(|entry| Some(read(entry)));
    entries.into_iter().flatten().flatten().collect()
}

/// Warns about objects of the same name.
fn warn_about_namesakes(context: &mut Context, objects: &[ObjectDraft]) {
    let mut counts = BTreeMap::<&str, usize>::new();
    objects.iter().for_each(|object| *counts.entry(&object.name).or_default() += 1);
    for (name, count) in counts.into_iter().filter(|&(_, count)| count > 1) {
        context
            .warn(format!("{count} objects are named {name}: they share one matte, and --set cannot tell them apart"));
    }
}

/// Warns about materials that no object uses.
fn warn_about_unused(context: &mut Context, placed: &PlacedObjects, drafts: &MaterialDrafts) {
    // Scenes may have many materials, so most are looked up by name rather than compared with each one.
    let used: BTreeSet<&str> = placed.materials.iter().map(|used| used.name.as_str()).collect();
    for name in drafts.by_name.keys().filter(|name| !used.contains(*name)) {
        if !placed.materials.iter().any(|used| used.material.is_made_of(name)) {
            context.warn(format!("material {name} is not used by any object"));
        }
    }
}
