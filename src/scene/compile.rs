//! From the file as written to a world that can be rendered: all names are looked up and all numbers checked here.

use std::collections::BTreeMap;
use std::sync::Arc;

use sha2::{Digest, Sha256};

use super::compile_shape::{MAX_LENGTH, ShapeCompiler};
use super::description::{CameraText, Description, FilmText, LightText, ObjectText};
use super::index::Index;
use super::source::{At, Source};
use super::{Camera, FilmSettings, NamedMaterial, Object, Scene};
use crate::error::{Error, Result, nearest};
use crate::light::{Area, Light, LightId};
use crate::material::Material;
use crate::shape::Sides;
use crate::spectrum::{Curve, CurveKind, Quantity, Refusal};

/// Most pixels in a row or column.
const MAX_SIDE: u32 = 65_536;
/// Most pixels in an image: at 20 bytes each, and as many again while the file is written, 10 GB.
const MAX_PIXELS: u64 = 1 << 28;

/// The world that a scene file describes.
///
/// # Errors
/// The first mistake found, with its place in the file.
pub fn compile(description: &Description, source: &Source) -> Result<Scene<Curve>> {
    let mut hash = Sha256::new();
    hash.update(source.text.as_bytes());
    let mut compiler = Compiler { source, warnings: Vec::new(), hash };
    let film = compiler.film(&description.film)?;
    let camera = compiler.camera(&description.camera, film)?;
    if let Some(0) = description.render.samples {
        let render = At::top("render");
        return Err(source.mistake_at(&render.key("samples"), "a pixel needs at least 1 sample", None));
    }
    compiler.materials(&description.material)?;
    let (objects, materials) = compiler.objects(description)?;
    let mut scene = Scene {
        camera,
        film,
        render: description.render.clone(),
        index: Index::new(objects.iter().map(|object| &*object.shape)),
        objects,
        materials,
        lights: Vec::new(),
        environment: None,
        warnings: Vec::new(),
        hash: String::new(),
    };
    compiler.surfaces_that_shine(&mut scene);
    compiler.lights(&description.light, &mut scene)?;
    if scene.lights.is_empty() {
        compiler.warnings.push("nothing shines, so the image will be black".into());
    }
    scene.warnings = compiler.warnings;
    scene.hash = compiler.hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect();
    Ok(scene)
}

pub(super) struct Compiler<'a> {
    pub(super) source: &'a Source,
    pub(super) warnings: Vec<String>,
    pub(super) hash: Sha256,
}

impl Compiler<'_> {
    fn film(&mut self, film: &FilmText) -> Result<FilmSettings> {
        let at = At::top("film");
        for (key, size) in [("width", film.width), ("height", film.height)] {
            if size == 0 || size > MAX_SIDE {
                let message = format!("an image has 1 to {MAX_SIDE} pixels along each side, not {size}");
                return Err(self.source.mistake_at(&at.key(key), message, None));
            }
        }
        let pixels = u64::from(film.width) * u64::from(film.height);
        if pixels > MAX_PIXELS {
            let message = format!("{} x {} pixels are {pixels}; at most {MAX_PIXELS} fit", film.width, film.height);
            return Err(self.source.mistake_at(&at.key("height"), message, None));
        }
        let FilmText { width, height, filter, color_space } = *film;
        Ok(FilmSettings { width, height, filter, color_space })
    }

    fn camera(&mut self, camera: &CameraText, film: FilmSettings) -> Result<Camera> {
        let at = At::top("camera");
        let position = self.point(&at.key("position"), camera.position)?;
        let target = self.point(&at.key("look_at"), camera.look_at)?;
        if (target - position).try_normalize().is_none() {
            let message = "the camera looks at the very point where it stands";
            return Err(self.source.mistake_at(&at.key("look_at"), message, None));
        }
        let up = self.direction(&at.key("up"), camera.up)?;
        if !(camera.vertical_fov > 0.0 && camera.vertical_fov < 180.0) {
            let message = format!("a field of view lies between 0 and 180 degrees, not {}", camera.vertical_fov);
            return Err(self.source.mistake_at(&at.key("vertical_fov"), message, None));
        }
        if !(0.0..=MAX_LENGTH).contains(&camera.near) {
            let message = format!("near is a distance from 0 to {MAX_LENGTH:e}, not {}", camera.near);
            return Err(self.source.mistake_at(&at.key("near"), message, None));
        }
        let size = [film.width, film.height];
        let (camera, parallel) = Camera::new(position, target, up, camera.vertical_fov, camera.near, size);
        if parallel {
            self.warnings.push("camera.up is parallel to the viewing direction; another direction is taken".into());
        }
        Ok(camera)
    }

    fn materials(&mut self, materials: &BTreeMap<String, Material<Curve>>) -> Result<()> {
        for (name, material) in materials {
            let (top, kind) = (At::top("material"), material.kind());
            let named = top.key(name);
            let at = named.key(kind);
            material.each(|quantity, key, curve| {
                // A conductor given by name has its mistake where the name stands.
                let metal = matches!(curve.kind, CurveKind::Name(_)) && quantity == Quantity::MetalIndex;
                self.curve(&at.key(if metal { "metal" } else { key }), curve, quantity)
            })?;
        }
        Ok(())
    }

    fn curve(&self, at: &At, curve: &Curve, quantity: Quantity) -> Result<()> {
        curve.check(quantity).map_err(|refusal| self.refuse_curve(at, refusal.keys, refusal))
    }

    fn refuse_curve(&self, at: &At, keys: &[&str], refusal: Refusal) -> Error {
        match (keys, refusal.entry) {
            ([key, inner @ ..], _) => self.refuse_curve(&at.key(key), inner, refusal),
            ([], Some(entry)) => self.source.mistake_at(&at.index(entry), refusal.message, refusal.help),
            ([], None) => self.source.mistake_at(at, refusal.message, refusal.help),
        }
    }

    fn objects(&mut self, description: &Description) -> Result<(Vec<Object>, Vec<NamedMaterial<Curve>>)> {
        let (mut objects, mut materials) = (Vec::new(), Vec::<NamedMaterial<Curve>>::new());
        for (number, text) in description.object.iter().enumerate() {
            let top = At::top("object");
            let at = top.index(number);
            let known = materials.iter().position(|material| material.name == text.material);
            let material = match (known, description.material.get(&text.material)) {
                (Some(id), _) => id,
                (None, Some(material)) => {
                    materials.push(NamedMaterial { name: text.material.clone(), material: material.clone() });
                    materials.len() - 1
                }
                (None, None) => return Err(self.unknown_material(&at, text, description)),
            };
            let name = text.name.clone().unwrap_or_else(|| format!("object {}", number + 1));
            let filled = materials[material].material.medium().is_some();
            let shape = Arc::new(ShapeCompiler { compiler: self, name: &name, filled }.shape(&at, text)?);
            objects.push(Object { name, shape, material: material as u32, light: None });
        }
        for name in description.material.keys() {
            if !materials.iter().any(|material| &material.name == name) {
                self.warnings.push(format!("material {name} is not used by any object"));
            }
        }
        Ok((objects, materials))
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
            if is_dark(radiance) {
                continue;
            }
            let light: LightId = scene.lights.len();
            scene.lights.push(Light::Area(Area {
                shape: object.shape.clone(),
                object: number as u32,
                radiance: radiance.clone(),
                sides,
                aimed_at: lamp && object.shape.bounds().is_some(),
            }));
            scene.objects[number].light = Some(light);
        }
    }

    fn lights(&mut self, lights: &[LightText], scene: &mut Scene<Curve>) -> Result<()> {
        for (number, text) in lights.iter().enumerate() {
            let top = At::top("light");
            let at = top.index(number);
            match (&text.environment, &text.point) {
                (Some(environment), None) => {
                    let here = at.key("environment");
                    self.curve(&here.key("radiance"), &environment.radiance, Quantity::Emission)?;
                    if scene.environment.is_some() {
                        return Err(self.source.mistake_at(&here, "a scene has at most one environment", None));
                    }
                    scene.environment = Some(scene.lights.len());
                    scene.lights.push(Light::Environment(environment.clone()));
                }
                (None, Some(point)) => {
                    let here = at.key("point");
                    self.point(&here.key("position"), point.position)?;
                    self.curve(&here.key("intensity"), &point.intensity, Quantity::Emission)?;
                    scene.lights.push(Light::Point(point.clone()));
                }
                (None, None) => {
                    let message = "a light is an `environment` or a `point`";
                    return Err(self.source.mistake_at(&at, message, None));
                }
                (Some(_), Some(_)) => {
                    let help = Some("start another [[light]] for the second".into());
                    return Err(self.source.mistake_at(&at.key("point"), "a light has exactly one kind", help));
                }
            }
        }
        Ok(())
    }
}

fn is_dark(radiance: &Curve) -> bool {
    match &radiance.kind {
        CurveKind::Number(value) => value * radiance.scale == 0.0,
        CurveKind::Rgb(rgb) => rgb.iter().all(|x| x * radiance.scale == 0.0),
        _ => false,
    }
}
