//! From the file as written to a world that can be rendered: all names are looked up and all numbers checked here.

use std::collections::BTreeMap;
use std::sync::Arc;

use sha2::{Digest, Sha256};

use super::compile_image::Images;
use super::compile_mesh::Meshes;
use super::compile_shape::ShapeCompiler;
use super::contact::coinciding;
use super::description::{Description, ModelText, ObjectText, RenderText};
use super::index::Index;
use super::inside_out::inside_out;
use super::source::{At, Source};
use super::unlit::unlit;
use super::{NamedMaterial, Object, Scene};
use crate::error::{Error, Result, nearest};
use crate::light::{Area, Light, LightId};
use crate::material::Material;
use crate::shape::Sides;
use crate::spectrum::Curve;

/// The numbers of wavelengths that `render.model` may ask for.
const BANDS: [u32; 4] = [8, 12, 16, 32];

/// The world that a scene file describes.
///
/// # Errors
/// The first mistake found, with its place in the file.
pub fn compile(description: &Description, source: &Source) -> Result<Scene<Curve>> {
    let mut hash = Sha256::new();
    hash.update(source.text.as_bytes());
    let meters_per_unit = description.render.meters_per_unit;
    let (meshes, images) = (Meshes::of(description), Images::new());
    let mut compiler = Compiler { source, warnings: Vec::new(), hash, meters_per_unit, meshes, images };
    let film = compiler.film(&description.film)?;
    let camera = compiler.camera(&description.camera, film)?;
    compiler.render(&description.render)?;
    let materials = compiler.materials(&description.material)?;
    let (objects, entries, materials) = compiler.objects(description, &materials)?;
    compiler.contacts(&objects, &entries, &materials)?;
    compiler.faces_inward(&objects, &materials);
    let mut scene = Scene {
        camera,
        film,
        render: description.render.clone(),
        index: Index::new(objects.iter().map(|object| &*object.shape)),
        objects,
        materials,
        lights: Vec::new(),
        skies: Vec::new(),
        warnings: Vec::new(),
        hash: String::new(),
    };
    compiler.surfaces_that_shine(&mut scene);
    compiler.lights(&description.light, &mut scene)?;
    if scene.lights.is_empty() {
        compiler.warnings.push("nothing shines, so the image will be black".into());
    }
    compiler.warnings.extend(unlit(&scene));
    scene.warnings = compiler.warnings;
    scene.hash = compiler.hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect();
    Ok(scene)
}

pub(super) struct Compiler<'a> {
    pub(super) source: &'a Source,
    pub(super) warnings: Vec<String>,
    pub(super) hash: Sha256,
    pub(super) meters_per_unit: Option<f64>,
    pub(super) meshes: Meshes,
    /// What was read already.
    pub(super) images: Images,
}

/// Objects, the entry of the file that each comes from, and their materials.
type Objects = (Vec<Object>, Vec<usize>, Vec<NamedMaterial<Curve>>);
pub(super) type Materials = BTreeMap<String, Material<Curve>>;

impl Compiler<'_> {
    fn render(&self, render: &RenderText) -> Result<()> {
        let at = At::top("render");
        let refuse = |key, message: String, help: Option<&str>| {
            Err(self.source.mistake_at(&at.key(key), message, help.map(str::to_owned)))
        };
        if let Some(0) = render.samples {
            return refuse("samples", "a pixel needs at least 1 sample".into(), None);
        }
        if let Some(error) = render.error.filter(|error| !(1e-6..=1.0).contains(error)) {
            let help = "0.01 asks for one percent";
            return refuse("error", format!("a relative error lies between 0.000001 and 1, not {error}"), Some(help));
        }
        if let Some(meters) = render.meters_per_unit.filter(|meters| !(1e-12..=1e12).contains(meters)) {
            let help = "0.01 if the scene is in centimeters";
            return refuse(
                "meters_per_unit",
                format!("a scene unit is 1e-12 to 1e12 meters, not {meters}"),
                Some(help),
            );
        }
        match render.model {
            ModelText::Bands(bands) if !BANDS.contains(&bands) => {
                let message = format!("the model has 8, 12, 16 or 32 bands, not {bands}");
                Err(self.source.mistake_at(&at.key("model").key("bands"), message, None))
            }
            _ => Ok(()),
        }
    }

    /// The objects, the entry of the file that each comes from, and their materials.
    fn objects(&mut self, description: &Description, compiled: &Materials) -> Result<Objects> {
        let (mut objects, mut entries, mut materials) = (Vec::new(), Vec::new(), Vec::<NamedMaterial<Curve>>::new());
        for (number, text) in description.object.iter().enumerate() {
            let top = At::top("object");
            let at = top.index(number);
            let known = materials.iter().position(|material| material.name == text.material);
            let material = match (known, compiled.get(&text.material)) {
                (Some(id), _) => id,
                (None, Some(material)) => {
                    materials.push(NamedMaterial { name: text.material.clone(), material: material.clone() });
                    materials.len() - 1
                }
                (None, None) => return Err(self.unknown_material(&at, text, description)),
            };
            let name = text.name.clone().unwrap_or_else(|| format!("object {}", number + 1));
            let filled = materials[material].material.medium().is_some();
            let varies = materials[material].material.varies();
            let relief = self.relief(&at, text)?;
            let mut compiler = ShapeCompiler { compiler: self, name: &name, filled };
            for (instance, (shape, coordinates)) in compiler.shapes(&at, text)?.into_iter().enumerate() {
                let name = match text.instances {
                    Some(_) => format!("{name} [{}]", instance + 1),
                    None => name.clone(),
                };
                if varies && coordinates.is_none() {
                    return Err(self.no_coordinates(&at, &text.material));
                }
                let (shape, coordinates) = (Arc::new(shape), coordinates.map(Arc::new));
                let relief = relief.as_ref().map(|relief| self.relief_on(&at, relief, coordinates.as_ref()));
                let (relief, coordinates) = (relief.transpose()?, coordinates.filter(|_| varies));
                objects.push(Object { name, shape, material: material as u32, light: None, coordinates, relief });
                entries.push(number);
            }
        }
        for name in description.material.keys() {
            let used = |used: &NamedMaterial<Curve>| &used.name == name || used.material.is_made_of(name);
            if !materials.iter().any(used) {
                self.warnings.push(format!("material {name} is not used by any object"));
            }
        }
        Ok((objects, entries, materials))
    }

    /// Clear bodies may overlap but not share a surface: rounding would decide which of the two a ray meets.
    fn contacts(&mut self, objects: &[Object], entries: &[usize], materials: &[NamedMaterial<Curve>]) -> Result<()> {
        let is_clear = |object: &Object| materials[object.material as usize].material.medium().is_some();
        for (first, second) in coinciding(objects, is_clear) {
            let (later, top) = (entries[first.max(second)], At::top("object"));
            let [body, other] = [first, second].map(|number| &objects[number].name);
            if is_clear(&objects[second]) {
                let message = format!("a part of the surfaces of {body} and {other} lies in one place");
                let help =
                    "let one reach a little into the other: there the one of higher `priority` is; or leave a gap";
                return Err(self.source.mistake_at(&top.index(later).key("shape"), message, Some(help.into())));
            }
            self.warnings.push(format!(
                "a part of the surface of {body} lies exactly in {other}, where light may pass by it: move it a little, \
                 apart or into the other"
            ));
        }
        Ok(())
    }

    /// A clear body whose faces look inward fills all that is outside of it, and light that meets it is lost.
    fn faces_inward(&mut self, objects: &[Object], materials: &[NamedMaterial<Curve>]) {
        let is_clear = |object: &Object| materials[object.material as usize].material.medium().is_some();
        let found = inside_out(objects, is_clear);
        let Some(&first) = found.first() else { return };
        let others = if found.len() > 1 { format!(" and {} more", found.len() - 1) } else { String::new() };
        self.warnings.push(format!(
            "{}{others}: the faces of this closed mesh look inward, so its outside is taken for its inside: reverse the order of \
             each face's corners",
            objects[first].name
        ));
    }

    fn no_coordinates(&self, at: &At, material: &str) -> Error {
        let message = format!("this mesh has no texture coordinates, by which {material} would lie on it");
        let help = "give it a material without `image` and `checker`";
        self.source.mistake_at(&at.key("shape"), message, Some(help.into()))
    }

    fn unknown_material(&self, at: &At, text: &ObjectText, description: &Description) -> Error {
        let names = || description.material.keys().map(String::as_str);
        let help = match nearest(&text.material, names()) {
            Some(near) => format!("did you mean {near:?}?"),
            None if description.material.is_empty() => format!("define it: [material.{}]", text.material),
            None => format!("the scene defines {}", names().collect::<Vec<_>>().join(", ")),
        };
        let message = format!("there is no material named {:?}", text.material);
        self.source.mistake_at(&at.key("material"), message, Some(help))
    }

    /// Gives every object whose material emits its light.
    fn surfaces_that_shine(&mut self, scene: &mut Scene<Curve>) {
        for number in 0..scene.objects.len() {
            let object = &scene.objects[number];
            let (radiance, sides, lamp) = match &scene.materials[object.material as usize].material {
                Material::Emissive(emissive) => (&emissive.radiance, emissive.sides, true),
                Material::Dielectric(dielectric) => (&dielectric.emission, Sides::Both, false),
                _ => continue,
            };
            if radiance.is_dark() {
                continue;
            }
            let light: LightId = scene.lights.len();
            let aimed_at = lamp && object.shape.bounds().is_some();
            let mut area = Area::new(object.shape.clone(), number as u32, radiance.clone(), sides, aimed_at);
            area.coordinates = object.coordinates.clone().filter(|_| radiance.varies());
            scene.lights.push(Light::Area(area));
            scene.objects[number].light = Some(light);
        }
    }
}
