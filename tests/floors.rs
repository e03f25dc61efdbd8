//! The house stays a house: a room uses only rooms on lower floors, as the drawing in `src/lib.rs` has them, and files
//! stay short enough to read.
//!
//! ```text
//! cargo test --test all floors::
//! ```

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// Modules of the command, which stands above all floors.
const COMMAND: [&str; 5] = ["main", "catalog", "cli", "messages", "progress"];
/// What `lib.rs` hands on from the room `error`.
const ERRORS: [&str; 5] = ["Diagnostic", "Error", "Result", "nearest", "error"];
/// Most lines of a file, but for tables of data.
const LONGEST: usize = 500;

fn source() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src")
}

/// Every Rust file below a folder with its path inside it.
fn files(folder: &Path) -> Vec<(PathBuf, String)> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            found.extend(files(&path));
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            let text = fs::read_to_string(&path).expect("a text file");
            found.push((path.strip_prefix(source()).expect("a path in src").to_owned(), text));
        }
    }
    found.sort();
    found
}

/// The floor of each room, from lines such as `//! floor 2   material   how ..  |  light   how ..`.
fn floors(drawing: &str) -> BTreeMap<String, u32> {
    let mut floors = BTreeMap::new();
    for line in drawing.lines().filter_map(|line| line.strip_prefix("//! floor ")) {
        let (number, rooms) = line.split_once(' ').expect("a number and rooms");
        let number = number.parse().expect("the number of a floor");
        let names = rooms.split('|').filter_map(|room| room.split_whitespace().next());
        floors.extend(names.map(|room| (room.to_owned(), number)));
    }
    floors
}

/// The modules a file is, from the crate's root: `shape/mesh.rs` is shape, mesh; `shape/mod.rs` is shape.
fn module(path: &Path) -> Vec<String> {
    let mut parts: Vec<String> =
        path.with_extension("").iter().map(|part| part.to_string_lossy().into_owned()).collect();
    if parts.last().is_some_and(|last| last == "mod" || last == "lib") {
        parts.pop();
    }
    parts
}

/// A text without comments and the contents of its strings.
fn code(text: &str) -> String {
    let mut code = String::new();
    for line in text.replace("'\"'", "").lines() {
        let mut quoted = false;
        let mut letters = line.chars().peekable();
        while let Some(letter) = letters.next() {
            match letter {
                '\\' if quoted => drop(letters.next()),
                '"' => quoted = !quoted,
                '/' if !quoted && letters.peek() == Some(&'/') => break,
                _ if quoted => {}
                _ => code.push(letter),
            }
        }
        code.push('\n');
    }
    code
}

/// The first names below the root that a file's paths `crate::..`, `super::..` and groups of them lead to.
fn names_used(module: &[String], text: &str) -> Vec<String> {
    let code: String = code(text).split_whitespace().collect::<Vec<_>>().join(" ");
    let is_name = |letter: char| letter.is_alphanumeric() || letter == '_';
    let mut names = Vec::new();
    for (at, _) in code.match_indices("crate::").chain(code.match_indices("super::")) {
        let before = code[..at].chars().next_back().unwrap_or(' ');
        if is_name(before) || before == ':' {
            continue;
        }
        let mut rest = &code[at..];
        let mut depth = module.len();
        if let Some(after) = rest.strip_prefix("crate::") {
            (rest, depth) = (after, 0);
        }
        while let Some(after) = rest.strip_prefix("super::") {
            (rest, depth) = (after, depth.saturating_sub(1));
        }
        if depth > 0 {
            continue;
        }
        match rest.strip_prefix('{') {
            None => names.push(rest.chars().take_while(|&letter| is_name(letter)).collect()),
            Some(group) => names.extend(first_names(group)),
        }
    }
    names
}

/// The first name of each path in a group, up to its closing brace: `math::{Ray, gamma}, Error}` gives math, Error.
fn first_names(group: &str) -> Vec<String> {
    let (mut names, mut depth, mut name, mut done) = (Vec::new(), 1, String::new(), false);
    for letter in group.chars() {
        match letter {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 1 => {
                names.push(std::mem::take(&mut name));
                done = false;
            }
            ':' if depth == 1 => done = true,
            _ if depth == 1 && !done && !letter.is_whitespace() => name.push(letter),
            _ => {}
        }
        if depth == 0 {
            break;
        }
    }
    names.push(name);
    names.retain(|name| !name.is_empty());
    names
}

/// Why a file may not use a name, if it may not.
fn objection(floors: &BTreeMap<String, u32>, module: &[String], name: &str) -> Option<String> {
    let room = if ERRORS.contains(&name) { "error" } else { name };
    let own = module.first().map_or("lib", String::as_str);
    if own == room || own == "lib" || COMMAND.contains(&own) {
        return None;
    }
    let (Some(from), Some(to)) = (floors.get(own), floors.get(room)) else {
        return Some(format!("{} uses {name}: one of them is not drawn in src/lib.rs", module.join("::")));
    };
    (to >= from).then(|| format!("{} on floor {from} uses {name} on floor {to}", module.join("::")))
}

#[test]
fn every_room_uses_only_rooms_on_lower_floors() {
    let files = files(&source());
    let drawing = &files.iter().find(|(path, _)| path == Path::new("lib.rs")).expect("src/lib.rs").1;
    let floors = floors(drawing);
    let mut uses = 0;
    let mut objections = Vec::new();
    for (path, text) in &files {
        let module = module(path);
        for name in names_used(&module, text) {
            uses += 1;
            objections.extend(objection(&floors, &module, &name));
        }
    }
    assert!(uses > 60, "only {uses} paths were found");
    assert!(objections.is_empty(), "{}", objections.join("\n"));
}

#[test]
fn the_drawing_shows_every_room_and_no_other() {
    let files = files(&source());
    let drawing = &files.iter().find(|(path, _)| path == Path::new("lib.rs")).expect("src/lib.rs").1;
    let drawn: Vec<String> = floors(drawing).into_keys().collect();
    let mut rooms: Vec<String> = files.iter().filter_map(|(path, _)| module(path).into_iter().next()).collect();
    rooms.dedup();
    rooms.retain(|room| !COMMAND.contains(&room.as_str()));
    rooms.sort();
    rooms.dedup();
    assert_eq!(drawn, rooms);
}

#[test]
fn paths_that_go_up_or_sideways_are_noticed() {
    let floors = floors(&fs::read_to_string(source().join("lib.rs")).expect("src/lib.rs"));
    let refused = [
        ("light/point.rs", "use crate::trace::World;"),
        ("light/point.rs", "use crate::material::Arrival;"),
        ("shape/mesh.rs", "fn f(x: crate::spectrum::Lanes<4>) {}"),
        ("math/ray.rs", "use crate::{error::Error, math::DVec3};"),
        ("math/ray.rs", "use crate::{\n    math::DVec3,\n    shape::{Shape, Sides},\n};"),
        ("spectrum/data/glass.rs", "use super::super::super::film::Film;"),
        ("film/exr.rs", "use super::super::scene::Scene;"),
        ("scene/mod.rs", "let plan = super::plan::plan(scene);"),
        ("trace/world.rs", "use crate::attic::Attic;"),
    ];
    for (path, text) in refused {
        let module = module(Path::new(path));
        let objections = names_used(&module, text).iter().filter_map(|name| objection(&floors, &module, name)).count();
        assert_eq!(objections, 1, "{path}: {text}");
    }
    let allowed = [
        ("trace/world.rs", "use crate::{light::{Light, LightId}, scene::Scene};"),
        ("trace/world.rs", "use super::media::Media; use crate::Error;"),
        ("film/exr.rs", "// use crate::trace::World;\nlet x = \"crate::trace::World\";"),
        ("cli.rs", "use crate::messages::say;"),
        ("spectrum/data/glass.rs", "use super::super::Lanes;"),
    ];
    for (path, text) in allowed {
        let module = module(Path::new(path));
        let objections: Vec<_> =
            names_used(&module, text).iter().filter_map(|name| objection(&floors, &module, name)).collect();
        assert!(objections.is_empty(), "{path}: {text}: {objections:?}");
    }
}

#[test]
fn every_source_file_is_short_enough_to_read() {
    for (path, text) in files(&source()) {
        let lines = text.lines().count();
        assert!(lines <= LONGEST, "src/{} has {lines} lines", path.display());
    }
}
