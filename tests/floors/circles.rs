//! Files form no cycles: everything that a file needs can be read before it.
//!
//! A `mod.rs` that defines a contract and dispatches over its variants forms a cycle with them. Moving the contract
//! into a file of its own, which `mod.rs` re-exports with `pub use`, breaks the cycle.

use std::collections::{BTreeMap, BTreeSet};

use super::exceptions::CIRCLES;
use super::house::{self, House, exactly, here};

/// Returns the folder of a file inside a room, or the file's own path if it is in no such folder.
fn part(path: &str) -> &str {
    let folder = path.rsplit_once('/').map_or("", |(folder, _)| folder);
    if folder.contains('/') { folder } else { path }
}

/// Returns the cycles among folders inside rooms and the files beside them.
fn circles_of_folders(texts: &BTreeMap<String, String>) -> Vec<Vec<String>> {
    let house = House::new(texts);
    let of_file: Vec<&str> = house.files.iter().map(|file| part(&file.path)).collect();
    let parts: Vec<&str> = of_file.iter().copied().collect::<BTreeSet<_>>().into_iter().collect();
    let number = |file: usize| parts.binary_search(&of_file[file]).expect("every file has a part");
    let mut graph = vec![BTreeMap::new(); parts.len()];
    for (from, edges) in house.graph().into_iter().enumerate() {
        let edges = edges.into_iter().map(|(to, name)| (number(to), name));
        graph[number(from)].extend(edges.filter(|(to, _)| *to != number(from)));
    }
    let named = |circle: &BTreeSet<usize>| circle.iter().map(|part| parts[*part].to_owned()).collect();
    house::circles(&graph).iter().map(named).collect()
}

/// Returns each cycle as its files in order, with an explanation: one used name for each dependency inside the cycle.
fn circles(texts: &BTreeMap<String, String>) -> Vec<(String, String)> {
    let all = House::new(texts);
    let graph = all.graph();
    let path = |file: usize| all.files[file].path.as_str();
    let described = |circle: &BTreeSet<usize>| {
        let files: Vec<&str> = circle.iter().map(|file| path(*file)).collect();
        let inside =
            |(from, to, name): &(usize, usize, &String)| format!("  {} uses {} of {}", path(*from), name, path(*to));
        let edges = circle.iter().flat_map(|from| graph[*from].iter().map(|(to, name)| (*from, *to, name)));
        let why: Vec<String> = edges.filter(|(_, to, _)| circle.contains(to)).map(|edge| inside(&edge)).collect();
        (files.join(" "), why.join("\n"))
    };
    house::circles(&graph).iter().map(described).collect()
}

#[test]
fn no_files_stand_in_a_circle() {
    let circles = circles(here());
    let found = circles.iter().map(|(files, _)| files.clone()).collect();
    let new = circles.iter().filter(|(files, _)| !CIRCLES.contains(&files.as_str()));
    let why: Vec<&str> = new.map(|(_, why)| why.as_str()).collect();
    exactly("CIRCLES", CIRCLES, found, &why.join("\n\n"));
}

#[test]
fn no_folders_stand_in_a_circle() {
    assert_eq!(circles_of_folders(here()), [[""; 0]; 0]);
    let both = |one: &str| {
        let files = [
            ("room/one/a.rs", one),
            ("room/one/b.rs", "pub struct B;"),
            ("room/two/a.rs", "use super::super::one::b::B; pub struct A;"),
            ("room/one/mod.rs", "pub mod a; pub mod b;"),
            ("room/two/mod.rs", "pub mod a;"),
            ("room/mod.rs", "pub mod one; pub mod two;"),
            ("lib.rs", "pub mod room;"),
        ];
        circles_of_folders(&files.map(|(path, text)| (path.to_owned(), text.to_owned())).into())
    };
    assert_eq!(both("use super::super::two::a::A;"), [["room/one", "room/two"]]);
    assert!(both("use super::b::B;").is_empty());
}

fn circle_of(files: &[(&str, &str)]) -> Vec<String> {
    let texts = files.iter().map(|(path, text)| ((*path).to_owned(), (*text).to_owned())).collect();
    circles(&texts).into_iter().map(|(files, _)| files).collect()
}

#[test]
fn a_circle_is_noticed_however_its_paths_are_written() {
    const ROOT: (&str, &str) = ("lib.rs", "pub mod room; pub mod other;");
    let uses_b = [
        "use super::b::B;",
        "use crate::room::b::B as Renamed;",
        "use super::B;",
        "use crate::room::{self, A as _}; fn f() { room::B; }",
        "fn f(x: super::b::B) {}",
        "fn f() { debug_assert!(super::b::B::new().is_good()); }",
        "impl From<crate::room::B> for u8 {}",
        "use crate::other::Handed;",
        "mod inner { use super::super::b::B; }",
    ];
    for text in uses_b {
        let a = format!("{text} pub struct A;");
        let files = [
            ROOT,
            ("other.rs", "pub use crate::room::B as Handed;"),
            ("room/mod.rs", "mod a; mod b; pub use a::A; pub use b::B;"),
            ("room/a.rs", &a),
            ("room/b.rs", "use super::A; pub struct B;"),
        ];
        assert_eq!(circle_of(&files), ["room/a.rs room/b.rs"], "{text}");
    }
}

#[test]
fn long_circles_are_noticed_and_files_beside_them_are_not() {
    let files = [
        ("lib.rs", "mod a; mod b; mod c; mod d; mod room;"),
        ("a.rs", "use crate::b::B; pub struct A;"),
        ("b.rs", "use crate::c::C; pub struct B;"),
        ("c.rs", "use crate::a::A; pub struct C;"),
        ("d.rs", "use crate::a::A; pub struct D;"),
        ("room/mod.rs", "mod leaf; pub struct Contract; pub enum All { Leaf(leaf::Leaf) }"),
        ("room/leaf.rs", "use super::Contract; pub struct Leaf;"),
    ];
    assert_eq!(circle_of(&files), ["a.rs b.rs c.rs", "room/leaf.rs room/mod.rs"]);
}

#[test]
fn names_that_are_handed_on_are_no_circle() {
    let files = [
        ("lib.rs", "mod room;"),
        ("room/mod.rs", "mod a; mod b; mod contract; pub use a::A; pub use b::b; pub use contract::Contract;"),
        ("room/a.rs", "use super::{Contract, b}; pub struct A;"),
        ("room/b.rs", "use super::Contract; pub fn b() {} #[cfg(test)] mod tests { use super::super::A; }"),
        ("room/contract.rs", "// super::A\npub struct Contract;"),
    ];
    assert!(circle_of(&files).is_empty());
}
