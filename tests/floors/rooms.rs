//! The dependencies between rooms and floors.

use std::collections::{BTreeMap, BTreeSet};

use super::house::{SourceTree, source_texts};
use super::source::Source;

/// The command and the crate of the Python package, which stand above all floors.
const COMMAND: [&str; 3] = ["main", "command", "python"];
/// The names that `lib.rs` re-exports from the room `error`.
const ERRORS: [&str; 5] = ["Diagnostic", "Error", "Result", "nearest", "error"];

type Floors = BTreeMap<String, u32>;

/// Returns the floor of each room, from lines such as `//! floor 2   material   how ..  |  light   how ..`.
fn floors() -> Floors {
    let mut floors = BTreeMap::new();
    for line in source_texts()["lib.rs"].lines().filter_map(|line| line.strip_prefix("//! floor ")) {
        let (number, rooms) = line.split_once(' ').expect("a number and rooms");
        let number = number.parse().expect("the number of a floor");
        let names = rooms.split('|').filter_map(|room| room.split_whitespace().next());
        floors.extend(names.map(|room| (room.to_owned(), number)));
    }
    floors
}

/// Returns the first name below the crate root of each path in a file.
fn names_used(source: &Source) -> BTreeSet<&str> {
    source.paths.iter().chain(&source.globs).filter_map(|path| path.first()).map(String::as_str).collect()
}

/// Returns why a file may not use a name, or none if it may.
fn objection(floors: &Floors, source: &Source, name: &str) -> Option<String> {
    let room = if ERRORS.contains(&name) { "error" } else { name };
    let own_room = source.module.first().map_or("lib", String::as_str);
    if own_room == room || own_room == "lib" || COMMAND.contains(&own_room) {
        return None;
    }
    let (Some(from), Some(to)) = (floors.get(own_room), floors.get(room)) else {
        return Some(format!("src/{} uses {name}: one of them is not drawn in src/lib.rs", source.path));
    };
    (to >= from).then(|| format!("src/{} on floor {from} uses {name} on floor {to}", source.path))
}

fn objections(floors: &Floors, source: &Source) -> Vec<String> {
    names_used(source).into_iter().filter_map(|name| objection(floors, source, name)).collect()
}

#[test]
fn every_room_uses_only_rooms_on_lower_floors() {
    let floors = floors();
    let house = SourceTree::new(source_texts());
    let uses: usize = house.files.iter().map(|source| names_used(source).len()).sum();
    assert!(uses > 60, "only {uses} uses were found");
    let objections: Vec<String> = house.files.iter().flat_map(|source| objections(&floors, source)).collect();
    assert!(objections.is_empty(), "{}", objections.join("\n"));
}

#[test]
fn the_drawing_shows_every_room_and_no_other() {
    let house = SourceTree::new(source_texts());
    let rooms: BTreeSet<&String> = house.files.iter().filter_map(|source| source.module.first()).collect();
    let rooms: Vec<&String> = rooms.into_iter().filter(|room| !COMMAND.contains(&room.as_str())).collect();
    assert_eq!(floors().keys().collect::<Vec<_>>(), rooms);
}

#[test]
fn paths_that_go_up_or_sideways_are_noticed() {
    let floors = floors();
    let refused = [
        ("light/point.rs", "use crate::trace::World;"),
        ("light/point.rs", "use crate::material::Arrival;"),
        ("light/point.rs", "use crate::material::*;"),
        ("shape/mesh.rs", "fn f(x: crate::spectrum::Lanes<4>) {}"),
        ("shape/mesh.rs", "fn f() { debug_assert!(crate::spectrum::MOST > 1); }"),
        ("math/ray.rs", "use crate::{error::Error, math::DVec3};"),
        ("math/ray.rs", "use crate::{\n    math::DVec3,\n    shape::{Shape, Sides},\n};"),
        ("spectrum/data/glass.rs", "use super::super::super::film::Film;"),
        ("film/exr.rs", "use super::super::scene::Scene;"),
        ("scene/mod.rs", "fn f() { let plan = super::plan::plan(scene); }"),
        ("trace/world.rs", "use crate::attic::Attic;"),
    ];
    for (path, text) in refused {
        assert_eq!(objections(&floors, &Source::new(path, text)).len(), 1, "{path}: {text}");
    }
    let allowed = [
        ("trace/world.rs", "use crate::{light::{Light, LightId}, scene::Scene};"),
        ("trace/world.rs", "use super::media::Media; use crate::Error;"),
        ("film/exr.rs", "// use crate::trace::World;\nconst X: &str = \"crate::trace::World\";"),
        ("command/cli.rs", "use crate::command::messages::say;"),
        ("spectrum/data/glass.rs", "use super::super::Lanes;"),
        ("math/ray.rs", "#[cfg(test)]\nmod tests {\n    use crate::shape::Shape;\n}"),
    ];
    for (path, text) in allowed {
        let objections = objections(&floors, &Source::new(path, text));
        assert!(objections.is_empty(), "{path}: {text}: {objections:?}");
    }
}
