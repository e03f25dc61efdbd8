//! Files form no cycles: everything that a file needs can be read before it.
//!
//! A `mod.rs` that defines a contract and dispatches over its variants forms a cycle with them. Moving the contract
//! into a file of its own, which `mod.rs` re-exports with `pub use`, breaks the cycle.

use std::collections::{BTreeMap, BTreeSet};

use super::exceptions::CIRCLES;
use super::house::{self, SourceTree, assert_exactly, source_texts};

/// Returns the folder of a file inside a room, or the file's own path if it is in no such folder.
fn part(path: &str) -> &str {
    let folder = path.rsplit_once('/').map_or("", |(folder, _)| folder);
    if folder.contains('/') { folder } else { path }
}

/// Returns the cycles among folders inside rooms and the files beside them.
fn folder_cycles(texts: &BTreeMap<String, String>) -> Vec<Vec<String>> {
    let house = SourceTree::new(texts);
    let part_of_file: Vec<&str> = house.files.iter().map(|file| part(&file.path)).collect();
    let parts: Vec<&str> = part_of_file.iter().copied().collect::<BTreeSet<_>>().into_iter().collect();
    let number = |file: usize| parts.binary_search(&part_of_file[file]).expect("every file has a part");
    let mut graph = vec![BTreeMap::new(); parts.len()];
    for (from, edges) in house.graph().into_iter().enumerate() {
        let edges = edges.into_iter().map(|(to, name)| (number(to), name));
        graph[number(from)].extend(edges.filter(|(to, _)| *to != number(from)));
    }
    let named = |cycle: &BTreeSet<usize>| cycle.iter().map(|part| parts[*part].to_owned()).collect();
    house::cycles(&graph).iter().map(named).collect()
}

/// Returns each cycle as its files in order, with an explanation: one used name for each dependency inside the cycle.
fn cycles(texts: &BTreeMap<String, String>) -> Vec<(String, String)> {
    let all = SourceTree::new(texts);
    let graph = all.graph();
    let path = |file: usize| all.files[file].path.as_str();
    let described = |cycle: &BTreeSet<usize>| {
        let files: Vec<&str> = cycle.iter().map(|file| path(*file)).collect();
        let inside =
            |(from, to, name): &(usize, usize, &String)| format!("  {} uses {} of {}", path(*from), name, path(*to));
        let edges = cycle.iter().flat_map(|from| graph[*from].iter().map(|(to, name)| (*from, *to, name)));
        let why: Vec<String> = edges.filter(|(_, to, _)| cycle.contains(to)).map(|edge| inside(&edge)).collect();
        (files.join(" "), why.join("\n"))
    };
    house::cycles(&graph).iter().map(described).collect()
}

#[test]
fn no_files_form_a_cycle() {
    let cycles = cycles(source_texts());
    let found = cycles.iter().map(|(files, _)| files.clone()).collect();
    let new = cycles.iter().filter(|(files, _)| !CIRCLES.contains(&files.as_str()));
    let why: Vec<&str> = new.map(|(_, why)| why.as_str()).collect();
    assert_exactly("CIRCLES", CIRCLES, found, &why.join("\n\n"));
}

#[test]
fn no_folders_form_a_cycle() {
    assert_eq!(folder_cycles(source_texts()), [[""; 0]; 0]);
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
        folder_cycles(&files.map(|(path, text)| (path.to_owned(), text.to_owned())).into())
    };
    assert_eq!(both("use super::super::two::a::A;"), [["room/one", "room/two"]]);
    assert!(both("use super::b::B;").is_empty());
}

fn cycle_of(files: &[(&str, &str)]) -> Vec<String> {
    let texts = files.iter().map(|(path, text)| ((*path).to_owned(), (*text).to_owned())).collect();
    cycles(&texts).into_iter().map(|(files, _)| files).collect()
}

#[test]
fn a_cycle_is_noticed_however_its_paths_are_written() {
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
        assert_eq!(cycle_of(&files), ["room/a.rs room/b.rs"], "{text}");
    }
}

#[test]
fn long_cycles_are_noticed_and_files_beside_them_are_not() {
    let files = [
        ("lib.rs", "mod a; mod b; mod c; mod d; mod room;"),
        ("a.rs", "use crate::b::B; pub struct A;"),
        ("b.rs", "use crate::c::C; pub struct B;"),
        ("c.rs", "use crate::a::A; pub struct C;"),
        ("d.rs", "use crate::a::A; pub struct D;"),
        ("room/mod.rs", "mod leaf; pub struct Contract; pub enum All { Leaf(leaf::Leaf) }"),
        ("room/leaf.rs", "use super::Contract; pub struct Leaf;"),
    ];
    assert_eq!(cycle_of(&files), ["a.rs b.rs c.rs", "room/leaf.rs room/mod.rs"]);
}

#[test]
fn reexported_names_are_no_cycle() {
    let files = [
        ("lib.rs", "mod room;"),
        ("room/mod.rs", "mod a; mod b; mod contract; pub use a::A; pub use b::b; pub use contract::Contract;"),
        ("room/a.rs", "use super::{Contract, b}; pub struct A;"),
        ("room/b.rs", "use super::Contract; pub fn b() {} #[cfg(test)] mod tests { use super::super::A; }"),
        ("room/contract.rs", "// super::A\npub struct Contract;"),
    ];
    assert!(cycle_of(&files).is_empty());
}
