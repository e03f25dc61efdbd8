//! From the file as written to a world that can be rendered: all names are looked up and all numbers checked here.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use sha2::{Digest, Sha256};

use super::compile_image::Images;
use super::compile_mesh::Meshes;
use super::compile_shape::ShapeCompiler;
use super::contact::coinciding;
use super::description::{Description, ModelText, ObjectText, RenderText};
use super::gather::{Gather, told_elsewhere};
use super::index::Index;
use super::inside_out::inside_out;
use super::source::{At, Located, Source};
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
/// All mistakes that can be found, in the order of the file, each with its place.
pub fn compile(description: &Description, source: &Source) -> Result<Scene<Curve>> {
    let mut hash = Sha256::new();
    hash.update(source.text.as_bytes());
    let meters_per_unit = description.render.meters_per_unit;
    let (meshes, images) = (Meshes::of(description), Images::new());
    let source = Located::new(source);
    let mut compiler =
        Compiler { source: &source, warnings: Vec::new(), mistakes: Vec::new(), hash, meters_per_unit, meshes, images };
    compiler.mistakes = description.mistakes.iter().map(|mistake| source.mistake(mistake.clone())).collect();
    match compiler.scene(description) {
        Some(scene) if compiler.mistakes.is_empty() => Ok(scene),
        _ => Err(in_order(compiler.mistakes)),
    }
}

/// All mistakes as one error, in the order of the file, none twice.
fn in_order(mistakes: Vec<Error>) -> Error {
    let told = Error::Scene(Vec::new());
    match mistakes.into_iter().fold(told, Error::and) {
        Error::Scene(mut mistakes) => {
            mistakes.sort_by_key(|mistake| mistake.span.start);
            mistakes.dedup_by(|a, b| (&a.span, &a.message) == (&b.span, &b.message));
            Error::Scene(mistakes)
        }
        other => other,
    }
}

pub(super) struct Compiler<'a> {
    pub(super) source: &'a Located<'a>,
    pub(super) warnings: Vec<String>,
    mistakes: Vec<Error>,
    pub(super) hash: Sha256,
    pub(super) meters_per_unit: Option<f64>,
    pub(super) meshes: Meshes,
    /// What was read already.
    pub(super) images: Images,
}

/// Objects, the entry of the file that each comes from, and their materials.
type Objects = (Vec<Object>, Vec<usize>, Vec<NamedMaterial<Curve>>);
/// Materials by name; those that are wrong are known but not there.
pub(super) type Materials = BTreeMap<String, Option<Material<Curve>>>;

impl Compiler<'_> {
    /// What was checked, if it is right; its mistakes are kept if not.
    pub(super) fn kept<T>(&mut self, checked: Result<T>) -> Option<T> {
        checked.map_err(|error| self.mistakes.push(error)).ok()
    }

    /// The scene, if nothing that it is made of is wrong.
    fn scene(&mut self, description: &Description) -> Option<Scene<Curve>> {
        let film = description.film.as_ref().and_then(|film| {
            let film = self.film(film);
            self.kept(film)
        });
        let camera = description.camera.as_ref().and_then(|camera| {
            let camera = self.camera(camera, film.as_ref());
            self.kept(camera)
        });
        let render = self.render(&description.render);
        self.kept(render);
        let materials = self.materials(&description.material);
        let (objects, entries, materials) = self.objects(description, &materials);
        self.contacts(&objects, &entries, &materials);
        self.faces_inward(&objects, &materials);
        let (lights, skies) = self.lights(&description.light);
        let mut scene = Scene {
            camera: camera?,
            film: film?,
            render: description.render.clone(),
            index: Index::new(objects.iter().map(|object| &*object.shape)),
            objects,
            materials,
            lights: Vec::new(),
            skies: Vec::new(),
            warnings: Vec::new(),
            hash: String::new(),
        };
        self.surfaces_that_shine(&mut scene);
        scene.skies = skies.into_iter().map(|sky| sky + scene.lights.len()).collect();
        scene.lights.extend(lights);
        if scene.lights.is_empty() {
            self.warnings.push("nothing shines, so the image will be black".into());
        }
        if self.mistakes.is_empty() {
            self.warnings.extend(unlit(&scene));
        }
        scene.warnings = std::mem::take(&mut self.warnings);
        scene.hash = self.hash.finalize_reset().iter().map(|byte| format!("{byte:02x}")).collect();
        Some(scene)
    }

    fn render(&self, render: &RenderText) -> Result<()> {
        let at = At::top("render");
        let refuse = |key, message: String, help: Option<&str>| {
            Err(self.source.mistake_at(&at.key(key), message, help.map(str::to_owned)))
        };
        let samples = match render.samples {
            Some(0) => refuse("samples", "a pixel needs at least 1 sample".into(), None),
            _ => Ok(()),
        };
        let error = match render.error.filter(|error| !(1e-6..=1.0).contains(error)) {
            Some(error) => {
                let help = "0.01 asks for one percent";
                refuse("error", format!("a relative error lies between 0.000001 and 1, not {error}"), Some(help))
            }
            None => Ok(()),
        };
        let meters = match render.meters_per_unit.filter(|meters| !(1e-12..=1e12).contains(meters)) {
            Some(meters) => {
                let help = "0.01 if the scene is in centimeters";
                refuse("meters_per_unit", format!("a scene unit is 1e-12 to 1e12 meters, not {meters}"), Some(help))
            }
            None => Ok(()),
        };
        let model = match render.model {
            ModelText::Bands(bands) if !BANDS.contains(&bands) => {
                let message = format!("the model has 8, 12, 16 or 32 bands, not {bands}");
                Err(self.source.mistake_at(&at.key("model").key("bands"), message, None))
            }
            _ => Ok(()),
        };
        (samples, error, meters, model).gather().map(|_| ())
    }

    /// The objects that are right, the entry of the file that each comes from, and their materials.
    fn objects(&mut self, description: &Description, compiled: &Materials) -> Objects {
        let (mut objects, mut entries, mut materials) = (Vec::new(), Vec::new(), Vec::<NamedMaterial<Curve>>::new());
        // Of a material that is not there it is told where it is named first.
        let mut unknown = BTreeSet::new();
        let mut numbers = BTreeMap::<&str, usize>::new();
        for (number, text) in description.object.iter().enumerate() {
            let Some(text) = text else { continue };
            let top = At::top("object");
            let known = compiled.contains_key(&text.material);
            let material = match known || !description.nameless && unknown.insert(&text.material) {
                true => self.material_of(&top.index(number), text, compiled),
                false => told_elsewhere(),
            };
            let known = material.as_ref().ok().map(|material| {
                *numbers.entry(&text.material).or_insert_with(|| {
                    materials.push(NamedMaterial { name: text.material.clone(), material: (*material).clone() });
                    materials.len() - 1
                })
            });
            let placed = self.object(number, text, material);
            if let (Some(placed), Some(material)) = (self.kept(placed), known) {
                entries.extend(placed.iter().map(|_| number));
                objects.extend(placed.into_iter().map(|object| Object { material: material as u32, ..object }));
            }
        }
        let of_others: Vec<&NamedMaterial<Curve>> =
            materials.iter().filter(|named| matches!(named.material, Material::Mix(_) | Material::Mask(_))).collect();
        for name in description.material.keys() {
            if !numbers.contains_key(name.as_str()) && !of_others.iter().any(|used| used.material.is_made_of(name)) {
                self.warnings.push(format!("material {name} is not used by any object"));
            }
        }
        (objects, entries, materials)
    }

    /// The material that an object names.
    fn material_of<'m>(&self, at: &At, text: &ObjectText, materials: &'m Materials) -> Result<&'m Material<Curve>> {
        match materials.get(&text.material) {
            Some(Some(material)) => Ok(material),
            Some(None) => told_elsewhere(),
            None => Err(self.unknown_material(at, text, materials)),
        }
    }

    /// An object, or each of its instances; which material is theirs is not yet said.
    fn object(&mut self, number: usize, text: &ObjectText, material: Result<&Material<Curve>>) -> Result<Vec<Object>> {
        let top = At::top("object");
        let at = top.index(number);
        let name = text.name.clone().unwrap_or_else(|| format!("object {}", number + 1));
        let filled = material.as_ref().is_ok_and(|material| material.medium().is_some());
        let varies = material.as_ref().is_ok_and(|material| material.varies());
        let relief = self.relief(&at, text);
        let shapes = ShapeCompiler { compiler: self, name: &name, filled }.shapes(&at, text);
        let (_, relief, shapes) = (material, relief, shapes).gather()?;
        let placed = shapes.into_iter().enumerate().map(|(instance, (shape, coordinates))| {
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
            Ok(Object { name, shape, material: 0, light: None, coordinates, relief })
        });
        placed.collect()
    }

    /// Clear bodies may overlap but not share a surface: rounding would decide which of the two a ray meets.
    fn contacts(&mut self, objects: &[Object], entries: &[usize], materials: &[NamedMaterial<Curve>]) {
        let is_clear = |object: &Object| materials[object.material as usize].material.medium().is_some();
        for (first, second) in coinciding(objects, is_clear) {
            let (later, top) = (entries[first.max(second)], At::top("object"));
            let [body, other] = [first, second].map(|number| &objects[number].name);
            if is_clear(&objects[second]) {
                let message = format!("a part of the surfaces of {body} and {other} lies in one place");
                let help =
                    "let one reach a little into the other: there the one of higher `priority` is; or leave a gap";
                let place = top.index(later);
                self.mistakes.push(self.source.mistake_at(&place.key("shape"), message, Some(help.into())));
                continue;
            }
            self.warnings.push(format!(
                "a part of the surface of {body} lies exactly in {other}, where light may pass by it: move it a little, \
                 apart or into the other"
            ));
        }
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

    fn unknown_material(&self, at: &At, text: &ObjectText, materials: &Materials) -> Error {
        let names = || materials.keys().map(String::as_str);
        let help = match nearest(&text.material, names()) {
            Some(near) => format!("did you mean {near:?}?"),
            None if materials.is_empty() => format!("define it: [material.{}]", text.material),
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
