//! Meshes that are placed many times and stored once.

use std::sync::Arc;

use abbe::shape::{Mesh, Shape};

use crate::support::bodies::ball;
use crate::support::scenes::{Mean, SPLITTING, environment, first_mistake, render_film_in, scene_in, view};

/// Creates a folder with `ball.obj`, a ball of radius 1, and `same.obj`, which is not shared.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let (points, faces) = ball();
    let vertices: String = points.iter().map(|p| format!("v {} {} {}\n", p.x, p.y, p.z)).collect();
    let faces: String = faces.iter().map(|[a, b, c]| format!("f {} {} {}\n", a + 1, b + 1, c + 1)).collect();
    for name in ["ball.obj", "same.obj"] {
        std::fs::write(folder.path().join(name), vertices.clone() + &faces).expect("the file can be written");
    }
    folder
}

/// Returns an object of a mesh file.
fn object(file: &str, material: &str, steps: &str) -> String {
    format!("[[object]]\nshape.mesh.file = \"{file}\"\nmaterial = \"{material}\"\ntransform = [{steps}]\n")
}

/// Returns the mesh of an object and whether it is an instance.
fn mesh_of(shape: &Shape) -> (Arc<Mesh>, bool) {
    match shape {
        Shape::Mesh(mesh) => (mesh.clone(), false),
        Shape::Instance(instance) => (instance.mesh().clone(), true),
        other => panic!("{other:?}"),
    }
}

const STEPS: &str =
    "{ scale = [1, 0.6, 0.8] }, { rotate = { axis = [1, 2, 0], degrees = 40 } }, { translate = [2, 0, 0] }";

#[test]
fn a_matrix_is_the_map_of_its_columns_and_their_shift() {
    let start = view([0.0, 0.0, 9.0], [0.0; 3], 30.0, 8) + "[material]\ngray.diffuse.reflectance = 0.5\n";
    let ball = |steps: &str| object("ball.obj", "gray", steps);
    let matrix = "{ matrix = [[0, 0, 2, 1], [3, 0, 0, 0], [0, 5, 0, -4], [0, 0, 0, 1]] }";
    let text = start + &ball("{ scale = [3, 5, 2] }, { translate = [0, -4, 1] }") + &ball(matrix);
    let objects = scene_in(folder().path(), &text).objects;
    let [steps, matrix] = [0, 1].map(|i| objects[i].shape.bounds().expect("finite"));
    // The matrix has the rows of the steps, turned by one: x becomes y, y becomes z, and z becomes x.
    for (of_steps, of_matrix) in [(steps.min, matrix.min), (steps.max, matrix.max)] {
        assert!((of_matrix - abbe::math::DVec3::new(of_steps.z, of_steps.x, of_steps.y)).length() < 1e-6);
    }
}

#[test]
fn objects_of_one_mesh_file_share_it_in_memory() {
    let start = view([0.0, 0.0, 9.0], [0.0; 3], 30.0, 8) + "[material]\ngray.diffuse.reflectance = 0.5\n";
    let text = start
        + &object("ball.obj", "gray", "")
        + &object("ball.obj", "gray", STEPS)
        + &object("same.obj", "gray", STEPS)
        + &object("ball.obj", "gray", "{ translate = [0, 5, 0] }")
        + "instances = [[], [{ scale = 2 }, { translate = [0, 3, 0] }]]\n[[object]]\nname = \"pea\"\n\
           shape.sphere = { center = [1, 0, 0], radius = 0.5 }\nmaterial = \"gray\"\n\
           transform = [{ scale = 2 }]\ninstances = [[], [{ translate = [0, 0, 4] }]]\n";
    let objects = scene_in(folder().path(), &text).objects;
    let names: Vec<&str> = objects.iter().map(|object| object.name.as_str()).collect();
    assert_eq!(names, ["object 1", "object 2", "object 3", "object 4 [1]", "object 4 [2]", "pea [1]", "pea [2]"]);
    let [first, second, alone, third, fourth] = [0, 1, 2, 3, 4].map(|i| mesh_of(&objects[i].shape));
    assert_eq!([first.1, second.1, alone.1, third.1, fourth.1], [false, true, false, true, true]);
    assert!([&second, &third, &fourth].iter().all(|other| Arc::ptr_eq(&first.0, &other.0)));
    assert!(!Arc::ptr_eq(&first.0, &alone.0));
    let center = |i: usize| objects[i].shape.bounds().expect("finite").center();
    assert!((center(3) - abbe::math::DVec3::new(0.0, 5.0, 0.0)).length() < 0.02);
    assert!((center(4) - abbe::math::DVec3::new(0.0, 13.0, 0.0)).length() < 0.04);
    assert!((center(6) - abbe::math::DVec3::new(2.0, 0.0, 4.0)).length() < 1e-9);
}

/// Compares the mean colors of a scene's images with a shared mesh and with baked ones.
fn compare_means(text: impl Fn(&str) -> String, what: &str) {
    let folder = folder();
    let means = [("ball.obj", 3), ("same.obj", 4)].map(|(file, seed)| {
        let (film, report) = render_film_in(folder.path(), &text(file).replace("SEED", &seed.to_string()), SPLITTING);
        assert_eq!((report.non_finite, report.unmatched), (0, 0));
        Mean::of(&film)
    });
    for band in 0..3 {
        let off = means[0].value[band] - means[1].value[band];
        let error = means[0].with_joint_error(&means[1]).error[band];
        assert!(means[1].value[band] > 0.01 && off.abs() <= 3.5 * error, "{what}: {off} with an error of {error}");
    }
}

#[test]
fn a_shared_mesh_shines_as_a_baked_one_does() {
    // A floor under a lamp: every pixel sees the same point, by next-event estimation and by random hits.
    compare_means(
        |file| {
            let elsewhere = object("ball.obj", "black", "{ translate = [0, -50, 0] }");
            let lamp = "{ scale = [0.7, 0.3, -0.5] }, { rotate = { axis = [1, 2, 0], degrees = 40 } }, { translate = [0.3, 1, 0] }";
            view([0.0, 0.5, 2.0], [0.0; 3], 1e-6, 40)
                + "[render]\nsamples = 16\nseed = SEED\n[material]\nblack.diffuse.reflectance = 0\n\
                   floor.diffuse.reflectance = 0.8\nlamp.emissive = { radiance = 3, sides = \"front\" }\n[[object]]\n\
                   shape.plane = { point = [0, 0, 0], normal = [0, 1, 0] }\nmaterial = \"floor\"\n"
                + &object(file, "lamp", lamp)
                + &elsewhere
        },
        "lamp",
    );
}

#[test]
fn nested_glass_of_instances_loses_no_light() {
    let glass = |steps: &str| object("ball.obj", "glass", steps);
    let text = view([0.0, 0.4, 6.0], [0.0; 3], 18.0, 60)
        + "[render]\nsamples = 16\n[material]\nglass.dielectric.index = 1.5\n\
           water.dielectric = { index = 1.33, priority = 1 }\nflint.dielectric = { index = 1.8, priority = 2 }\n"
        + &environment(1.0)
        + &glass("{ scale = [1.1, 0.8, -1] }, { rotate = { axis = [1, 2, 0], degrees = 40 } }")
        + &object("ball.obj", "water", "{ scale = [0.7, 0.5, 0.6] }, { rotate = { axis = [1, 2, 0], degrees = 40 } }")
        + &object("ball.obj", "flint", "{ scale = 0.4 }, { translate = [0.4, 0.1, 0.2] }");
    let (film, report) = render_film_in(folder().path(), &text, SPLITTING);
    assert_eq!((report.non_finite, report.unmatched), (0, 0));
    let mean = Mean::of(&film);
    assert!(mean.worst_relative_error([1.0; 3]) <= 1e-3, "{mean:?}");
    mean.assert_near([1.0; 3], 3, "nested glass");
}

#[test]
fn instances_that_touch_are_refused_by_their_names() {
    let text = view([0.0, 0.0, 9.0], [0.0; 3], 30.0, 8)
        + &environment(1.0)
        + "[material]\nglass.dielectric.index = 1.5\n"
        + &object("ball.obj", "glass", "{ scale = 0.5 }").replace("[[object]]", "[[object]]\nname = \"bead\"")
        + "instances = [[], [{ translate = [3, 0, 0] }], [{ translate = [3, 0, 0] }]]\n";
    let error = first_mistake(folder().path(), &text).message;
    assert!(error.contains("bead [2] and bead [3] partly coincide"), "{error}");
}
