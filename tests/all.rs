//! All tests except those that need a process of their own: `command`, `fuzz` and `plan_memory`. They form one program,
//! so the renderer is linked once and no processor waits for the last test of a file.
//!
//! ```text
//! cargo test --test all              # all of them
//! cargo test --test all windows::    # those of tests/windows.rs
//! ```

mod support;

mod adaptive;
mod camera;
mod catalog;
mod caustics;
mod checkpoints;
mod colors;
mod densities;
mod determinism;
mod film_layers;
mod films;
mod floors;
mod fluorescence;
mod highlights;
mod lanes;
mod layers;
mod lens_lights;
mod light_vertices;
mod look;
mod meshes;
mod messages;
mod outputs;
mod pipeline;
mod planning;
mod polarization;
mod prisms;
mod radiometry;
mod rainbow;
mod readme;
mod relief;
mod rough_glass;
mod rough_metals;
mod scene_fuzz;
mod scenes;
mod settings;
mod skies;
mod smooth_meshes;
mod spectral;
mod stability_catalog;
mod stability_extremes;
mod stability_lights;
mod stability_optics;
mod stability_scale;
mod stability_shapes;
mod stability_spectra;
mod stability_transport;
mod stopping;
mod textures;
mod white_furnace;
mod windows;
