//! Every piece of TOML in the pages is valid and means what they say. Every link leads somewhere.

mod limits;

use std::fs;
use std::path::{Path, PathBuf};

use abbe::Error;
use abbe::scene::Source;

use crate::support::repository::texts;

/// The pages that show pieces of scenes.
const PAGES: [&str; 2] = ["README.md", "scenes/REFERENCE.md"];
/// The beginnings of the tables whose pieces are TOML.
const HEADS: [&str; 10] = [
    "in an `[[object]]`",
    "in a `[material.NAME]`",
    "in a `[[light]]`",
    "a spectrum: any reflectance, transmittance, radiance ..",
    "besides, for a light",
    "besides, for an index",
    "in the image's table",
    "in `[camera]`",
    "in `[film]`",
    "in `[render]`",
];

const VIEW: &str = "position = [0, 0, 9], look_at = [0, 0, 0]";
const FILM: &str = "width = 640, height = 360";
const MATERIALS: &str = r#"
material.a.diffuse = { reflectance = 0.5 }
material.b.mirror = { reflectance = 0.5 }
"#;
const BALL: &str = "[[object]]\nshape.sphere = { center = [0, 0, 0], radius = 1 }\n";

fn page(name: &str) -> String {
    fs::read_to_string(name).expect("there is such a page")
}

/// Returns what is wrong with a scene, apart from missing files that it names.
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

/// Returns the rows of the tables of everything that a scene can hold: the head of the table, and the pieces of TOML in
/// the row.
fn rows(page: &str) -> Vec<(&str, Vec<&str>)> {
    let lines: Vec<&str> = page.lines().collect();
    let (mut rows, mut head) = (Vec::new(), "");
    for (line, next) in lines.iter().zip(&lines[1..]).filter(|(line, _)| line.starts_with('|')) {
        if next.starts_with("|---") {
            head = line.trim_matches(['|', ' ']);
        } else if !line.starts_with("|---") && HEADS.contains(&head) {
            rows.push((head, line.split('`').skip(1).step_by(2).collect()));
        }
    }
    rows
}

/// Returns a scene around a part of it.
fn scene_around(view: &str, film: &str, render: &str, rest: &str) -> String {
    format!("camera = {{ {view} }}\nfilm = {{ {film} }}\nrender = {{ {render} }}\n{MATERIALS}{rest}")
}

/// Returns a scene in which only `rest` matters.
fn scene_with(rest: &str) -> String {
    scene_around(&format!("{VIEW}, vertical_fov = 30"), FILM, "meters_per_unit = 1", rest)
}

/// Returns a scene that contains a piece of a row, or none if the piece cannot be put into a scene by itself.
fn scene(head: &str, piece: &str) -> Option<String> {
    let on = |material: &str| scene_with(&format!("[material.it]\n{material}\n{BALL}material = \"it\"\n"));
    let (key, _) = piece.split_once(" = ").unwrap_or_default();
    let is_value = piece.starts_with(['{', '"']);
    // Neither a value in place of another nor a part of something.
    let is_alone = !key.is_empty() && !is_value;
    Some(match head {
        "in an `[[object]]`" if key.starts_with("shape.") => {
            scene_with(&format!("[[object]]\nmaterial = \"a\"\n{piece}\n"))
        }
        "in an `[[object]]`" if is_alone && key != "material" => {
            scene_with(&format!("{BALL}material = \"a\"\n{piece}\n"))
        }
        "in a `[material.NAME]`" if piece.contains(" = {") => on(piece),
        "in a `[[light]]`" if is_alone && piece.contains(" = {") => scene_with(&format!("[[light]]\n{piece}\n")),
        "in a `[[light]]`" if ["name", "group", "visible_to_camera"].contains(&key) => {
            scene_with(&format!("[[light]]\nenvironment = {{ radiance = 1 }}\n{piece}\n"))
        }
        "a spectrum: any reflectance, transmittance, radiance .." => {
            on(&format!("diffuse = {{ reflectance = {piece} }}"))
        }
        "besides, for a light" if is_value => on(&format!("emissive = {{ radiance = {piece} }}")),
        "besides, for an index" if is_value => on(&format!("dielectric = {{ index = {piece} }}")),
        "in the image's table" if is_alone => {
            on(&format!("diffuse = {{ reflectance = {{ image = \"wood.png\", {piece} }} }}"))
        }
        "in `[camera]`" if is_alone => {
            let others = match piece {
                "projection = \"orthographic\"" => format!("{VIEW}, height = 2"),
                "projection = \"equirectangular\"" => VIEW.into(),
                _ => format!("{VIEW}, vertical_fov = 30"),
            };
            scene_around(&replaced_key(&others, key, piece), FILM, "", "")
        }
        "in `[film]`" if is_alone && key != "white_luminance" => {
            scene_around(&format!("{VIEW}, vertical_fov = 30"), &replaced_key(FILM, key, piece), "", "")
        }
        "in `[render]`" if is_alone => scene_around(&format!("{VIEW}, vertical_fov = 30"), FILM, piece, ""),
        _ => return None,
    })
}

/// Returns keys and values, with a piece in place of the one with its key.
fn replaced_key(others: &str, key: &str, piece: &str) -> String {
    let mut table: toml::Table = toml::from_str(&format!("it = {{ {others} }}")).expect("TOML");
    let it = table.get_mut("it").and_then(toml::Value::as_table_mut).expect("a table");
    it.remove(key);
    let rest: Vec<String> = it.iter().map(|(key, value)| format!("{key} = {value}")).collect();
    [rest.join(", "), piece.to_owned()].join(", ")
}

#[test]
fn every_row_of_the_tables_shows_toml_that_a_scene_takes() {
    for (name, least) in PAGES.into_iter().zip([[40, 40], [85, 80]]) {
        let page = page(name);
        let rows = rows(&page);
        let (mut read, mut compiled) = (0, 0);
        for &(head, ref pieces) in &rows {
            for piece in pieces.iter().filter(|piece| piece.contains([' ', '{', '[']) && !piece.contains("--")) {
                let is_entry = piece.contains(" = ") && !piece.starts_with('{');
                let text = if is_entry { (*piece).to_owned() } else { format!("x = {piece}") };
                toml::from_str::<toml::Table>(&text).unwrap_or_else(|error| panic!("{head}: {piece}\n{error}"));
                read += 1;
                if let Some(scene) = scene(head, piece) {
                    assert_eq!(mistakes(&scene), [""; 0], "{head}: {piece}\n{scene}");
                    compiled += 1;
                }
            }
        }
        assert!(read >= least[0] && compiled >= least[1], "{name}: {read} pieces were read, {compiled} compiled");
        if name == "scenes/REFERENCE.md" {
            assert!(HEADS.iter().all(|head| rows.iter().any(|row| row.0 == *head)), "a table is missing");
        }
    }
}

#[test]
fn every_block_of_toml_on_the_pages_is_a_scene() {
    for name in PAGES {
        let page = page(name);
        let blocks: Vec<&str> = page.split("```toml\n").skip(1).filter_map(|rest| rest.split("```").next()).collect();
        assert!(!blocks.is_empty());
        for block in blocks {
            assert_eq!(mistakes(block), [""; 0], "{block}");
        }
    }
}

/// Returns every page of text in the repository.
fn pages(folder: &Path) -> Vec<PathBuf> {
    let paths = fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path());
    let is_ours = |path: &PathBuf| {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        !name.starts_with('.') && !["target", "node_modules", "generated"].contains(&&*name)
    };
    paths
        .filter(is_ours)
        .flat_map(|path| match path.is_dir() {
            true => pages(&path),
            false => {
                Some(path).filter(|path| path.extension().is_some_and(|ending| ending == "md")).into_iter().collect()
            }
        })
        .collect()
}

/// Returns the text of a page without its code blocks.
fn prose(path: &Path) -> String {
    let text = fs::read_to_string(path).expect("text");
    let mut is_code = false;
    let lines = text.lines().filter(|line| {
        let fence = line.trim_start().starts_with("```");
        is_code ^= fence;
        !is_code && !fence
    });
    lines.collect::<Vec<_>>().join("\n")
}

/// Returns the anchors of a page's headings, as GitHub and other sites make them.
fn anchors(path: &Path) -> Vec<String> {
    let anchor = |heading: &str| {
        // A link counts by its text.
        let mut parts = heading.trim_start_matches('#').trim().split("](");
        let first = parts.next().unwrap_or_default().to_owned();
        let words = parts.fold(first, |words, part| words + part.split_once(')').map_or("", |(_, rest)| rest));
        let kept =
            words.to_lowercase().chars().filter(|c| c.is_alphanumeric() || " -_".contains(*c)).collect::<String>();
        kept.replace(' ', "-")
    };
    prose(path).lines().filter(|line| line.starts_with('#')).map(anchor).collect()
}

#[test]
fn every_link_of_a_page_leads_to_a_file_and_to_a_heading_of_it() {
    let mut count = 0;
    for page in pages(Path::new(".")) {
        let text = prose(&page);
        let links = text.split("](").skip(1).filter_map(|rest| rest.split(')').next());
        for link in links.filter(|link| !link.contains("://") && !link.contains(char::is_whitespace)) {
            let (file, anchor) = link.split_once('#').unwrap_or((link, ""));
            let target = if file.is_empty() { page.clone() } else { page.with_file_name(file) };
            assert!(target.exists(), "{}: there is no {file}", page.display());
            let is_known = anchor.is_empty() || anchors(&target).iter().any(|known| known == anchor);
            assert!(is_known, "{}: there is no heading for {link}", page.display());
            count += 1;
        }
    }
    assert!(count > 100, "only {count} links were found");
}

#[test]
fn every_block_of_toml_in_the_documentation_of_a_type_parses() {
    let mut count = 0;
    for (path, text) in texts(Path::new("src")) {
        for block in text.split("/// ```toml\n").skip(1).filter_map(|rest| rest.split("/// ```").next()) {
            let lines: Vec<&str> =
                block.lines().map(|line| line.trim_start().trim_start_matches("///").trim()).collect();
            let parses = |text: &str| text.parse::<toml::Table>().is_ok();
            // Lines that give one key in several ways are alternatives.
            let is_toml = parses(&lines.join("\n")) || lines.iter().all(|line| parses(line));
            assert!(is_toml, "src/{path}:\n{block}");
            count += 1;
        }
    }
    assert!(count > 20, "only {count} blocks were found");
}
