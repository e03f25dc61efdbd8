//! Every piece of TOML that the words show is TOML, and means what they say.

use std::fs;
use std::path::{Path, PathBuf};

use abbe::Error;
use abbe::scene::Source;

/// What the pieces of a row stand in.
const AROUND: &str = r#"
camera = { position = [0, 0, 9], look_at = [0, 0, 0], vertical_fov = 30 }
film = { width = 4, height = 4 }
render.meters_per_unit = 1
material.a.diffuse = { reflectance = 0.5 }
material.b.mirror = { reflectance = 0.5 }
"#;
const BALL: &str = "[[object]]\nshape.sphere = { center = [0, 0, 0], radius = 1 }\n";

fn readme() -> String {
    fs::read_to_string("README.md").expect("there is a README")
}

/// What is wrong with a scene, but for files that it names and that are not there.
fn mistakes(text: &str) -> Vec<String> {
    let source = Source { path: PathBuf::from("readme.toml"), text: text.to_owned() };
    match source.compile() {
        Ok(_) => Vec::new(),
        Err(Error::Scene(mistakes)) => {
            let known = |message: &String| !message.starts_with("there is no file ");
            mistakes.into_iter().map(|mistake| mistake.message).filter(known).collect()
        }
        Err(other) => panic!("{other}\n{text}"),
    }
}

/// The rows of the tables of all that a scene can hold: the head of each table, and the pieces of TOML in the row.
fn rows(readme: &str) -> Vec<(String, Vec<String>)> {
    let part = readme.split("## What a scene can hold\n").nth(1).and_then(|rest| rest.split("\n## ").next());
    let lines: Vec<&str> = part.expect("there is such a part").lines().collect();
    let (mut rows, mut head) = (Vec::new(), "");
    for (line, next) in lines.iter().zip(&lines[1..]).filter(|(line, _)| line.starts_with('|')) {
        if next.starts_with("|---") {
            head = line.trim_matches(['|', ' ']);
        } else if !line.starts_with("|---") {
            rows.push((head.to_owned(), line.split('`').skip(1).step_by(2).map(str::to_owned).collect()));
        }
    }
    rows
}

/// The scene in which a piece of a row stands, if it is one that can be put into a scene by itself.
fn scene(head: &str, piece: &str) -> Option<String> {
    let on = |material: String| format!("{AROUND}[material.it]\n{material}\n{BALL}material = \"it\"\n");
    let table = piece.contains(" = {") || piece.contains(" = [");
    let value = piece.starts_with(['{', '"']);
    Some(match head {
        "in an `[[object]]`" if piece.starts_with("shape.") => {
            format!("{AROUND}[[object]]\nmaterial = \"a\"\n{piece}\n")
        }
        "in an `[[object]]`" | "in an `[[object]]`, on any material" if table => {
            format!("{AROUND}{BALL}material = \"a\"\n{piece}\n")
        }
        "in a `[material.NAME]`" if table => on(piece.to_owned()),
        "in a `[[light]]`" if piece.contains(" = {") => format!("{AROUND}[[light]]\n{piece}\n"),
        "a spectrum: any reflectance, transmittance, radiance .." => {
            on(format!("diffuse = {{ reflectance = {piece} }}"))
        }
        "besides, for a light" if value => on(format!("emissive = {{ radiance = {piece} }}")),
        "besides, for an index" if value => on(format!("dielectric = {{ index = {piece} }}")),
        "in the image's table" if piece.contains(" = ") => {
            on(format!("diffuse = {{ reflectance = {{ image = \"wood.png\", {piece} }} }}"))
        }
        _ => return None,
    })
}

#[test]
fn every_row_of_the_readme_shows_toml_that_a_scene_takes() {
    let (mut read, mut compiled) = (0, 0);
    for (head, pieces) in rows(&readme()) {
        for piece in pieces.iter().filter(|piece| piece.contains([' ', '{', '[']) && !piece.contains("--")) {
            let text =
                if piece.contains(" = ") && !piece.starts_with('{') { piece.clone() } else { format!("x = {piece}") };
            toml::from_str::<toml::Table>(&text).unwrap_or_else(|error| panic!("{head}: {piece}\n{error}"));
            read += 1;
            if let Some(scene) = scene(&head, piece) {
                assert_eq!(mistakes(&scene), [""; 0], "{head}: {piece}");
                compiled += 1;
            }
        }
    }
    assert!(read > 45 && compiled > 40, "{read} pieces were read, {compiled} compiled");
}

#[test]
fn every_block_of_toml_in_the_readme_is_a_scene() {
    let readme = readme();
    let blocks: Vec<&str> = readme.split("```toml\n").skip(1).filter_map(|rest| rest.split("```").next()).collect();
    assert!(!blocks.is_empty());
    for block in blocks {
        assert_eq!(mistakes(block), [""; 0], "{block}");
    }
}

/// The text of every Rust file below a folder, and where it is.
fn sources(folder: &Path) -> Vec<(PathBuf, String)> {
    let paths = fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path());
    paths
        .flat_map(|path| {
            if path.is_dir() { sources(&path) } else { vec![(path.clone(), fs::read_to_string(path).expect("text"))] }
        })
        .collect()
}

#[test]
fn every_block_of_toml_in_the_documentation_of_a_type_parses() {
    let mut count = 0;
    for (path, text) in sources(Path::new("src")) {
        for block in text.split("/// ```toml\n").skip(1).filter_map(|rest| rest.split("/// ```").next()) {
            let lines: Vec<&str> =
                block.lines().map(|line| line.trim_start().trim_start_matches("///").trim()).collect();
            let parses = |text: &str| text.parse::<toml::Table>().is_ok();
            // Lines that give one key in several ways stand for one each.
            let is_toml = parses(&lines.join("\n")) || lines.iter().all(|line| parses(line));
            assert!(is_toml, "{}:\n{block}", path.display());
            count += 1;
        }
    }
    assert!(count > 20, "only {count} blocks were found");
}
