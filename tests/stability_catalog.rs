//! The table of `tests/STABILITY.md` is true: its tests exist, and it lists the tests that are named after its rows.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use crate::support::repository::texts;

/// Number of rows that there must be for each letter.
const ROWS: [(&str, u32); 16] = [
    ("S", 7),
    ("P", 4),
    ("T", 6),
    ("B", 6),
    ("X", 8),
    ("D", 17),
    ("M", 6),
    ("W", 10),
    ("A", 7),
    ("O", 1),
    ("L", 13),
    ("G", 6),
    ("C", 2),
    ("K", 5),
    ("H", 13),
    ("F", 3),
];

fn repository() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Returns the rows of the table: what is done, and the tests as `file::name`.
fn table() -> BTreeMap<String, (String, Vec<String>)> {
    let text = fs::read_to_string(repository().join("tests/STABILITY.md")).expect("the table");
    let mut rows = BTreeMap::new();
    for line in text.lines().filter(|line| line.starts_with("| ") && !line.starts_with("| row")) {
        let cells: Vec<&str> = line.trim_matches('|').split('|').map(str::trim).collect();
        let [id, fails, does, tests] = cells[..] else { panic!("four cells: {line}") };
        assert!(!fails.is_empty() && !does.is_empty(), "{line}");
        let tests = tests.split("<br>").map(|test| test.trim_matches('`').to_owned()).filter(|test| test != "-");
        let before = rows.insert(id.to_owned(), (does.to_owned(), tests.collect()));
        assert!(before.is_none(), "{id} stands there twice");
    }
    rows
}

/// Returns the names of the tests in a file.
fn tests_in(text: &str) -> Vec<&str> {
    let mut names = Vec::new();
    let mut is_test = false;
    for line in text.lines().map(str::trim) {
        match line.strip_prefix("fn ") {
            Some(rest) if is_test => names.extend(rest.split('(').next()),
            _ => {}
        }
        is_test = line == "#[test]" || (is_test && line.starts_with("#["));
    }
    names
}

/// Returns the rows that a test is named after: two for `a3_and_a4_...`.
fn rows_of(name: &str) -> Vec<String> {
    let is_row = |word: &&str| {
        let digits = word.get(1..).unwrap_or_default();
        word.starts_with(|c: char| c.is_ascii_lowercase())
            && !digits.is_empty()
            && digits.chars().all(|c| c.is_ascii_digit())
    };
    let words = name.split('_').take_while(|word| is_row(word) || *word == "and");
    words.filter(is_row).map(str::to_uppercase).collect()
}

#[test]
fn every_row_of_the_stability_catalog_names_tests_that_exist_or_says_why_there_is_none() {
    for (id, (does, tests)) in table() {
        assert!(!tests.is_empty() || does.starts_with("does not apply: "), "{id} has no test");
        for test in tests {
            let (file, name) = test.split_once("::").unwrap_or_else(|| panic!("{id}: {test} is no file::name"));
            let path = repository().join("tests").join(file);
            let text = fs::read_to_string(&path).unwrap_or_else(|error| panic!("{id}: {file}: {error}"));
            assert!(tests_in(&text).contains(&name), "{id}: there is no test {name} in {file}");
        }
    }
}

#[test]
fn no_row_of_the_stability_catalog_is_missing() {
    let expected: BTreeSet<String> =
        ROWS.iter().flat_map(|(letter, count)| (1..=*count).map(move |number| format!("{letter}{number}"))).collect();
    let found: BTreeSet<String> = table().into_keys().collect();
    assert_eq!(found, expected);
}

#[test]
fn every_test_that_is_named_after_a_row_stands_in_the_stability_catalog() {
    let table = table();
    let of = |folder: &'static str| {
        texts(&repository().join(folder)).into_iter().map(move |(path, text)| (folder, path, text))
    };
    let mut count = 0;
    for (folder, path, text) in ["tests", "src"].into_iter().flat_map(of) {
        let path = repository().join(folder).join(path);
        for name in tests_in(&text) {
            for row in rows_of(name) {
                let listed = table.get(&row).map_or(&[][..], |(_, tests)| tests);
                let ending = format!("::{name}");
                let is_listed = listed.iter().any(|test| {
                    let file = test.strip_suffix(&ending).map(|file| repository().join("tests").join(file));
                    file.is_some_and(|file| file.canonicalize().ok() == path.canonicalize().ok())
                });
                // A test may cover two rows at once, so it may be listed in a row that it is not named after.
                let elsewhere = table.values().flat_map(|(_, tests)| tests).any(|test| test.ends_with(&ending));
                assert!(is_listed || elsewhere, "{row}: {name} of {} is not in the table", path.display());
                count += 1;
            }
        }
    }
    assert!(count > 90, "{count} tests are named after rows");
}
