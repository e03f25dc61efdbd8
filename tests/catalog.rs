//! `render catalog`: what it lists, what it finds, and what it says if it finds nothing.

use std::process::Stdio;

use crate::support::run::{Answer, Folder, render};

fn catalog(arguments: &[&str]) -> Answer {
    let folder = Folder::with("unused.toml", "");
    let answer = render(&folder, &[&["catalog"], arguments].concat());
    assert_eq!(folder.file_names(), ["unused.toml"]);
    answer
}

/// Returns the lines found and asserts that stderr is empty.
fn found_lines(arguments: &[&str]) -> Vec<String> {
    let answer = catalog(arguments);
    assert_eq!((answer.code, &*answer.stderr), (Some(0), ""), "{arguments:?}");
    answer.stdout.lines().map(str::to_owned).collect()
}

fn names(arguments: &[&str]) -> Vec<String> {
    found_lines(arguments).iter().map(|line| line.split("  ").next().unwrap_or_default().to_owned()).collect()
}

#[test]
fn a_glass_is_a_line_of_aligned_columns() {
    let source = "SCHOTT Zemax catalog 2017-01-20b";
    let expected = [
        format!("schott/N-BK7     1.51680   64.17  300-2500 nm  absorption  {source}"),
        format!("schott/N-BK7HT   1.51680   64.17  300-2500 nm  absorption  {source}"),
        format!("schott/N-BK7HTi  1.51680   64.17  300-2500 nm  absorption  {source}"),
    ];
    assert_eq!(found_lines(&["glass", "n-bk7"])[..3], expected);
    let diamond = "gem/diamond  2.41749   55.30  226-760 nm  -  Peter, Zeitschrift für Physik 15, 358 (1923)";
    assert_eq!(found_lines(&["glass", "diamond"]), [diamond]);
}

#[test]
fn everything_is_listed() {
    assert!(found_lines(&["glass"]).len() > 1700);
    assert!(found_lines(&["metal"]).len() > 40);
    assert_eq!((found_lines(&["illuminant"]).len(), found_lines(&["reflectance"]).len()), (49, 24));
    assert_eq!(
        (found_lines(&["lights"]), found_lines(&["colors"])),
        (found_lines(&["illuminant"]), found_lines(&["reflectance"]))
    );
    assert_eq!(
        (found_lines(&["glasses", "sf11"]), found_lines(&["metals"])),
        (found_lines(&["glass", "sf11"]), found_lines(&["metal"]))
    );
    let all: usize =
        ["glass", "metal", "illuminant", "reflectance"].iter().map(|kind| found_lines(&[kind]).len()).sum();
    assert_eq!(found_lines(&[]).len(), all);
}

#[test]
fn all_words_are_found_in_names_other_names_makers_and_families() {
    assert_eq!(names(&["glass", "FLUORITE"]), ["crystal/CaF2"]);
    assert_eq!(names(&["glass", "schott", "sf11"]), ["schott/N-SF11", "schott/SF11"]);
    assert_eq!(names(&["glass", "flint", "schott/f"])[..2], ["schott/F2", "schott/F2G12"]);
    assert_eq!(names(&["glass", "crown", "schott/n-bk7ht"]), ["schott/N-BK7HT", "schott/N-BK7HTi"]);
    assert!(names(&["glass", "flint"]).len() + names(&["glass", "crown"]).len() < names(&["glass"]).len());
    assert_eq!(found_lines(&["metal", "gold"])[0].split_whitespace().next(), Some("Au"));
    assert_eq!(names(&["d65"]), ["hoya/TAFD65", "D65"]);
    assert_eq!(names(&["reflectance", "dark"]), ["colorchecker/dark skin"]);
}

#[test]
fn a_failed_search_suggests_the_nearest_names() {
    let answer = catalog(&["metal", "golt"]);
    let expected = "error: the catalog has no metal that matches \"golt\"\nhelp: the nearest name is gold\n";
    assert_eq!((answer.code, &*answer.stdout, &*answer.stderr), (Some(2), "", expected));
    let answer = catalog(&["glass", "N-BK8"]);
    assert!(answer.stderr.starts_with("error: the catalog has no glass that matches \"n-bk8\"\nhelp: "));
    assert!(answer.stderr.contains("N-BK7"), "{}", answer.stderr);
    // Names that share no letters with the query are not suggested.
    let answer = catalog(&["@@"]);
    assert_eq!(answer.stderr.lines().last(), Some("help: render catalog --help says how to search"));
}

#[test]
fn help_has_an_example() {
    let answer = catalog(&["--help"]);
    assert_eq!(answer.code, Some(0));
    assert!(answer.stdout.contains("render catalog glass schott flint"), "{}", answer.stdout);
    assert!(answer.stdout.contains("Usage: render catalog [WORDS]..."), "{}", answer.stdout);
    assert!(render(&Folder::new(), &["--help"]).stdout.contains("render catalog --help"));
}

#[test]
fn a_reader_that_stops_reading_ends_it_silently() {
    let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_render"));
    command.args(["catalog", "glass"]).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().expect("the command can be started");
    drop(child.stdout.take());
    let output = child.wait_with_output().expect("the command ends");
    assert_eq!((output.status.code(), &*output.stderr), (Some(0), [].as_slice()));
}
