//! Laws that each file obeys by itself.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use super::exceptions::{ABROAD, LONG, SHARED, TUPLES, WIDE};
use super::house::{SourceTree, assert_exactly, source_texts};
use crate::support::repository::texts;

/// Maximum number of lines of a file.
const MAX_FILE_LINES: usize = 500;
/// Maximum number of lines of a function, and how many functions may have more.
const MAX_FUNCTION_LINES: usize = 60;
const MAX_LONG_FUNCTIONS: usize = 3;
/// Maximum number of columns of a comment, the same as for code.
const MAX_COLUMNS: usize = 120;

fn one_file(path: &str, text: &str) -> BTreeMap<String, String> {
    several_files([(path, text)])
}

fn several_files<const N: usize>(texts: [(&str, &str); N]) -> BTreeMap<String, String> {
    texts.map(|(path, text)| (path.to_owned(), text.to_owned())).into()
}

fn long_files(texts: &BTreeMap<String, String>) -> BTreeSet<String> {
    let lines = texts.iter().map(|(path, text)| (path, text.lines().count()));
    lines.filter(|(_, lines)| *lines > MAX_FILE_LINES).map(|(path, lines)| format!("{path}: {lines} lines")).collect()
}

#[test]
fn every_source_file_is_short_enough_to_read() {
    assert_exactly("LONG_FILES", &[], long_files(source_texts()), "a file has more than 500 lines");
    assert_eq!(long_files(&one_file("a.rs", &"\n".repeat(501))).len(), 1);
    assert!(long_files(&one_file("a.rs", &"\n".repeat(500))).is_empty());
}

fn long_functions(texts: &BTreeMap<String, String>) -> BTreeSet<String> {
    let mut long = BTreeSet::new();
    for source in SourceTree::new(texts).files {
        let functions = source.functions.iter().filter(|function| function.lines > MAX_FUNCTION_LINES);
        long.extend(functions.map(|function| format!("{}: {}", source.path, function.name)));
    }
    long
}

#[test]
fn few_functions_are_longer_than_a_page() {
    let long = long_functions(source_texts());
    if long.len() > MAX_LONG_FUNCTIONS {
        assert_exactly("LONG", LONG, long, "functions have more than 60 lines");
    } else {
        assert!(LONG.is_empty(), "the exceptions LONG are no longer needed");
    }
}

#[test]
fn a_long_function_is_noticed() {
    for lines in [60, 61] {
        let body = "\n".repeat(lines - 1);
        for text in [
            format!("/// Words.\n#[inline]\npub fn f() {{{body}}}"),
            format!("impl A {{\n    fn f(\n) -> u8 {{{}}}\n}}", &body[1..]),
            format!("trait A {{ fn f() {{{body}}} }}"),
            format!("fn g() {{ fn f() {{{body}}} }}"),
            format!("mod inner {{ impl A for B {{ fn f() {{{body}}} }} }}"),
        ] {
            let found = long_functions(&one_file("a.rs", &text)).contains("a.rs: f");
            assert_eq!(found, lines == 61, "{lines}: {}", text.trim());
        }
    }
}

fn tuples(texts: &BTreeMap<String, String>) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    for source in SourceTree::new(texts).files {
        let functions = source.functions.iter().filter(|function| function.takes_tuple);
        found.extend(functions.map(|function| format!("{}: {}", source.path, function.name)));
    }
    found
}

#[test]
fn no_function_takes_a_tuple_without_a_name() {
    assert_exactly("TUPLES", TUPLES, tuples(source_texts()), "a function takes a tuple, whose parts have no names");
}

#[test]
fn a_tuple_as_a_parameter_is_noticed() {
    let refused = [
        "fn f(x: (f64, f64)) {}",
        "fn f((x, y): (f64, f64)) {}",
        "fn f(x: &mut (f64, f64)) {}",
        "impl A { fn f(&self, x: &(f64, (f64, f64))) {} }",
        "trait A { fn f(x: (f64, f64)) {} }",
        "trait A { fn f(x: (f64, f64)); }",
        "fn g() { fn f(x: (u8, u8)) {} }",
    ];
    for text in refused {
        assert_eq!(tuples(&one_file("a.rs", text)).into_iter().collect::<Vec<_>>(), ["a.rs: f"], "{text}");
    }
    let allowed = [
        "fn f(x: [f64; 2], then: &dyn Fn()) -> (f64, f64) { g(|(x, y)| x) }",
        "fn f(x: ()) {}",
        "fn f(points: &[(f64, f64)], each: impl Fn((f64, f64)) -> f64) {}",
    ];
    for text in allowed {
        assert!(tuples(&one_file("a.rs", text)).is_empty(), "{text}");
    }
}

/// Returns the inherent `impl` blocks outside the file of their type. Blocks in `shape/bvh` are allowed: its tree is
/// one concept in many files.
fn foreign_impls(texts: &BTreeMap<String, String>) -> BTreeSet<String> {
    let house = SourceTree::new(texts);
    let mut found = BTreeSet::new();
    for (index, source) in house.files.iter().enumerate().filter(|(_, source)| !source.path.starts_with("shape/bvh/")) {
        let away = source.impls.iter().filter(|of| house.defining_file(of) != Some(index));
        found.extend(away.map(|of| format!("{}: {}", source.path, of.last().expect("a name"))));
    }
    found
}

/// Returns the names that several files of a room use for types of their own.
fn shared_names(texts: &BTreeMap<String, String>) -> BTreeSet<String> {
    let mut homes: BTreeMap<String, u32> = BTreeMap::new();
    for source in SourceTree::new(texts).files {
        let room = source.path.split('/').next().unwrap_or_default();
        let is_type = |item: &&String| item.starts_with(char::is_uppercase) && item.contains(char::is_lowercase);
        for item in source.items.iter().filter(is_type) {
            *homes.entry(format!("{room}: {item}")).or_default() += 1;
        }
    }
    homes.into_iter().filter(|(_, files)| *files > 1).map(|(name, _)| name).collect()
}

#[test]
fn a_name_stands_for_one_type_in_a_room() {
    assert_exactly("SHARED", SHARED, shared_names(source_texts()), "types of a room share a name");
}

#[test]
fn a_name_of_two_types_is_noticed() {
    let files = |room: &str| {
        several_files([
            ("a/mod.rs", "mod one; mod two;"),
            ("b/mod.rs", "mod two;"),
            ("a/one.rs", "struct Mirror; const B: u8 = 1; fn c() {}"),
            (room, "enum Mirror {} const B: u8 = 2; fn c() {}"),
        ])
    };
    assert_eq!(shared_names(&files("a/two.rs")), BTreeSet::from(["a: Mirror".to_owned()]));
    assert!(shared_names(&files("b/two.rs")).is_empty());
}

#[test]
fn a_type_keeps_its_own_methods_in_its_own_file() {
    assert_exactly(
        "ABROAD",
        ABROAD,
        foreign_impls(source_texts()),
        "a type's inherent impl stands in another file than the type",
    );
}

#[test]
fn an_impl_away_from_its_type_is_noticed() {
    let files = |text: &str| {
        let root = ("lib.rs", "mod room;");
        let room = ("room/mod.rs", "mod a; mod b; pub use a::A; pub struct Own;");
        several_files([root, room, ("room/a.rs", "pub struct A<T>(T);"), ("room/b.rs", text)])
    };
    for text in [
        "use super::A; impl<T> A<T> {}",
        "impl super::a::A<u8> {}",
        "use super::A as Z; mod inner { impl super::Z<u8> {} }",
    ] {
        assert_eq!(foreign_impls(&files(text)).len(), 1, "{text}");
    }
    for text in [
        "use super::A; impl<T> Clone for A<T> {}",
        "struct B; impl B {}",
        "struct A; impl A {}",
        "mod inner { struct B; impl B {} }",
    ] {
        assert!(foreign_impls(&files(text)).is_empty(), "{text}");
    }
}

/// Returns whether a comment extends beyond the last column.
fn is_wide(line: &str) -> bool {
    let marks = line.match_indices("//").map(|(at, _)| &line[..at]);
    let mut comments = marks.filter(|before| before.trim().is_empty() || before.matches('"').count() % 2 == 0);
    line.chars().count() > MAX_COLUMNS && comments.next().is_some()
}

fn wide_comments(texts: &BTreeMap<String, String>) -> BTreeSet<String> {
    let counts = texts.iter().map(|(path, text)| (path, text.lines().filter(|line| is_wide(line)).count()));
    counts.filter(|(_, count)| *count > 0).map(|(path, count)| format!("{path}: {count}")).collect()
}

#[test]
fn comments_end_within_the_columns_of_code() {
    let mut all = BTreeMap::new();
    for folder in ["src", "tests", "benches", "examples"] {
        let inside = texts(&Path::new(env!("CARGO_MANIFEST_DIR")).join(folder));
        all.extend(inside.into_iter().map(|(path, text)| (format!("{folder}/{path}"), text)));
    }
    assert_exactly("WIDE", WIDE, wide_comments(&all), "a comment ends beyond column 120");
}

#[test]
fn a_wide_comment_is_noticed() {
    let words = "wörds ".repeat(20);
    for line in [
        format!("//! {words}"),
        format!("    /// {words}"),
        format!("f(); // {words}"),
        format!("f(\"//\"); // {words}"),
    ] {
        assert!(is_wide(&line), "{line}");
        assert!(!is_wide(&line[..100]), "{line}");
    }
    assert!(!is_wide(&format!("let address = \"https://{words}\";")));
    assert!(!is_wide(&"é".repeat(120).replacen("éé", "//", 1)));
}
