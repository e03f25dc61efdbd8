//! What breaks a law today. Each list shrinks to nothing; a failing law prints it as it would have to be.

/// The circles of today, each as its files in order.
pub const CIRCLES: &[&str] = &[
    "light/mod.rs light/sampler.rs",
    "material/coat.rs material/conductor.rs material/degree.rs material/dielectric.rs material/diffuse.rs material/facet.rs material/lobes.rs material/mask.rs material/mirror.rs material/mix.rs material/mod.rs material/part.rs material/plastic.rs material/rough_interface.rs material/roughness.rs material/straight.rs material/thin.rs",
    "scene/compile.rs scene/compile_image.rs scene/compile_mesh.rs scene/compile_shape.rs scene/contact.rs scene/inside_out.rs scene/mod.rs scene/sight.rs scene/source.rs scene/unlit.rs",
    "scene/description.rs scene/description_light.rs",
    "spectrum/bands.rs spectrum/basis.rs spectrum/curve.rs spectrum/curve_check.rs spectrum/curve_name.rs spectrum/curve_range.rs spectrum/draw.rs spectrum/emission.rs spectrum/mixture.rs spectrum/palette.rs spectrum/pattern.rs spectrum/response.rs spectrum/table.rs spectrum/upsample.rs",
    "spectrum/data/color.rs spectrum/data/glass.rs spectrum/data/metal.rs spectrum/data/mod.rs",
];

/// Functions of today that are longer, while there are more than may be.
pub const LONG: &[&str] = &[];

/// Functions of today that take a tuple without a name.
pub const TUPLES: &[&str] = &[
    "material/mix.rs: beside_other",
    "scene/compile_relief.rs: relief_on",
    "scene/compile_shape.rs: check_size",
    "scene/image_file.rs: possible",
    "spectrum/matching.rs: alone",
];

/// Types of today with an inherent `impl` outside of the file that defines them.
pub const ABROAD: &[&str] = &[
    "material/arrival.rs: Arrival",
    "material/degree.rs: Material",
    "material/lobes.rs: Material",
    "material/mix.rs: Branch",
    "material/part.rs: Material",
    "material/rough_dielectric.rs: Dielectric",
    "material/straight.rs: Material",
    "scene/camera_sees.rs: Camera",
    "scene/compile_curve.rs: Compiler",
    "scene/compile_image.rs: Compiler",
    "scene/compile_light.rs: Compiler",
    "scene/compile_material.rs: Compiler",
    "scene/compile_mesh.rs: ShapeCompiler",
    "scene/compile_parts.rs: Compiler",
    "scene/compile_relief.rs: Compiler",
    "scene/compile_shape.rs: Compiler",
    "scene/compile_view.rs: Compiler",
    "scene/source.rs: Scene",
    "spectrum/matching.rs: Basis",
    "spectrum/pattern.rs: Basis",
    "spectrum/pattern.rs: Curve",
    "spectrum/pattern.rs: CurveKind",
    "spectrum/pattern.rs: Draw",
    "spectrum/pattern.rs: Table",
    "spectrum/slope.rs: Texture",
];

/// Files of today with comments that are wider, and how many.
pub const WIDE: &[&str] = &[
    "src/cli.rs: 1",
    "src/error.rs: 1",
    "src/film/filter.rs: 1",
    "src/material/arrival.rs: 3",
    "src/material/by_cosine.rs: 4",
    "src/material/coat.rs: 2",
    "src/material/degree.rs: 3",
    "src/material/dielectric.rs: 2",
    "src/material/facet.rs: 2",
    "src/material/facets.rs: 6",
    "src/material/fresnel.rs: 3",
    "src/material/lobes.rs: 2",
    "src/material/mod.rs: 2",
    "src/material/plastic.rs: 1",
    "src/material/rough_dielectric.rs: 6",
    "src/material/rough_interface.rs: 14",
    "src/material/roughness.rs: 1",
    "src/material/straight.rs: 1",
    "src/material/thin.rs: 3",
    "src/scene/camera.rs: 1",
    "src/scene/camera_sees.rs: 3",
    "src/scene/contact.rs: 1",
    "src/scene/description.rs: 2",
    "src/scene/description_relief.rs: 1",
    "src/scene/image_file.rs: 2",
    "src/scene/index.rs: 2",
    "src/scene/inside_out.rs: 2",
    "src/scene/relief.rs: 2",
    "src/scene/repair.rs: 2",
    "src/scene/spectrum_file.rs: 1",
    "src/scene/unlit.rs: 1",
    "src/shape/mesh.rs: 1",
    "src/spectrum/advice.rs: 1",
    "src/spectrum/bands.rs: 2",
    "src/spectrum/basis.rs: 5",
    "src/spectrum/curve.rs: 2",
    "src/spectrum/draw.rs: 5",
    "src/spectrum/image.rs: 1",
    "src/spectrum/matching.rs: 3",
    "src/spectrum/palette.rs: 5",
    "src/spectrum/pattern.rs: 1",
    "src/spectrum/slope.rs: 1",
    "src/spectrum/table.rs: 1",
    "src/spectrum/texture.rs: 2",
    "src/spectrum/upsample.rs: 1",
    "tests/fuzz.rs: 2",
];
