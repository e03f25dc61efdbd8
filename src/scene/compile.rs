//! From the file as written to a world that can be rendered: all names are looked up and all numbers checked here.

use std::collections::BTreeMap;
use std::sync::Arc;

use sha2::{Digest, Sha256};

use super::compile_shape::{MAX_LENGTH, ShapeCompiler};
use super::description::{CameraText, Description, FilmText, LightText, ModelText, ObjectText, RenderText};
use super::index::Index;
use super::source::{At, Source};
use super::{Camera, FilmSettings, NamedMaterial, Object, Scene};
use crate::error::{Error, Result, nearest};
use crate::light::{Area, Environment, Light, LightId, Point, Sun};
use crate::material::Material;
use crate::shape::Sides;
use crate::spectrum::{Curve, CurveKind, Quantity};

/// The numbers of wavelengths that `render.model` may ask for.
const BANDS: [u32; 4] = [8, 12, 16, 32];
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
    let meters_per_unit = description.render.meters_per_unit;
    let mut compiler = Compiler { source, warnings: Vec::new(), hash, meters_per_unit };
    let film = compiler.film(&description.film)?;
    let camera = compiler.camera(&description.camera, film)?;
    compiler.render(&description.render)?;
    let materials = compiler.materials(&description.material)?;
    let (objects, materials) = compiler.objects(description, &materials)?;
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
    scene.warnings = compiler.warnings;
    scene.hash = compiler.hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect();
    Ok(scene)
}

pub(super) struct Compiler<'a> {
    pub(super) source: &'a Source,
    pub(super) warnings: Vec<String>,
    pub(super) hash: Sha256,
    pub(super) meters_per_unit: Option<f64>,
}

type Materials = BTreeMap<String, Material<Curve>>;

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

    fn materials(&mut self, texts: &Materials) -> Result<Materials> {
        let mut materials = Materials::new();
        for (name, material) in texts {
            let (top, kind) = (At::top("material"), material.kind());
            let named = top.key(name);
            let at = named.key(kind);
            let mut curves = Vec::new();
            material.each(|quantity, key, curve| {
                // A conductor given by name has its mistake where the name stands.
                let metal = matches!(curve.kind, CurveKind::Name(_)) && quantity == Quantity::MetalIndex;
                curves.push(self.curve(&at.key(if metal { "metal" } else { key }), curve, quantity)?);
                Ok(())
            })?;
            let mut curves = curves.into_iter();
            let next = &mut |_, _: &Curve| curves.next().expect("each and map visit the same spectra");
            materials.insert(name.clone(), material.map(next));
        }
        Ok(materials)
    }

    fn objects(
        &mut self,
        description: &Description,
        compiled: &Materials,
    ) -> Result<(Vec<Object>, Vec<NamedMaterial<Curve>>)> {
        let (mut objects, mut materials) = (Vec::new(), Vec::<NamedMaterial<Curve>>::new());
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
            let aimed_at = lamp && object.shape.bounds().is_some();
            let area = Area::new(object.shape.clone(), number as u32, radiance.clone(), sides, aimed_at);
            scene.lights.push(Light::Area(area));
            scene.objects[number].light = Some(light);
        }
    }

    fn lights(&mut self, lights: &[LightText], scene: &mut Scene<Curve>) -> Result<()> {
        for (number, text) in lights.iter().enumerate() {
            let top = At::top("light");
            let at = top.index(number);
            let kinds = [text.environment.is_some(), text.point.is_some(), text.sun.is_some()];
            if kinds.iter().filter(|given| **given).count() != 1 {
                return Err(self.not_one_kind(&at, text));
            }
            let light = self.light(&at, text)?;
            if let (Light::Environment(_), Some(_)) = (&light, scene.environment()) {
                let message = "a scene has at most one environment";
                return Err(self.source.mistake_at(&at.key("environment"), message, None));
            }
            if light.is_sky() {
                scene.skies.push(scene.lights.len());
            }
            scene.lights.push(light);
        }
        Ok(())
    }

    fn not_one_kind(&self, at: &At, text: &LightText) -> Error {
        let kinds =
            [("environment", text.environment.is_some()), ("point", text.point.is_some()), ("sun", text.sun.is_some())];
        let given = kinds.iter().filter(|kind| kind.1).map(|(kind, _)| at.key(kind));
        let (message, place, help) = match given.max_by_key(|place| self.source.span(place).start) {
            None => {
                ("a light needs a kind: `environment`, `point` or `sun`", *at, "such as environment = { radiance = 1 }")
            }
            Some(last) => ("a light has exactly one kind", last, "start another [[light]] for the second"),
        };
        self.source.mistake_at(&place, message, Some(help.into()))
    }

    /// The only kind of light that an entry has.
    fn light(&mut self, at: &At, text: &LightText) -> Result<Light<Curve>> {
        if let Some(environment) = &text.environment {
            let radiance =
                self.curve(&at.key("environment").key("radiance"), &environment.radiance, Quantity::Emission)?;
            return Ok(Light::Environment(Environment { radiance }));
        }
        if let Some(point) = &text.point {
            let here = at.key("point");
            self.point(&here.key("position"), point.position)?;
            let intensity = self.curve(&here.key("intensity"), &point.intensity, Quantity::Emission)?;
            return Ok(Light::Point(Point { intensity, ..point.clone() }));
        }
        let sun = text.sun.as_ref().expect("one kind was counted");
        let here = at.key("sun");
        self.direction(&here.key("toward"), sun.toward)?;
        if !(0.0..=180.0).contains(&sun.angular_diameter) {
            let message = format!("a sun is 0 to 180 degrees across, not {}", sun.angular_diameter);
            return Err(self.source.mistake_at(&here.key("angular_diameter"), message, None));
        }
        let irradiance = self.curve(&here.key("irradiance"), &sun.irradiance, Quantity::Emission)?;
        Ok(Light::Sun(Sun { irradiance, ..sun.clone() }))
    }
}

fn is_dark(radiance: &Curve) -> bool {
    let dark = match &radiance.kind {
        CurveKind::Number(value) => *value == 0.0,
        CurveKind::Rgb(rgb) => rgb.iter().all(|x| *x == 0.0),
        _ => false,
    };
    dark || radiance.scale == 0.0 || radiance.luminance == Some(0.0)
}
