//! No text makes the scene reader panic, and what it accepts can be rendered.
//!
//! The cases are the same in every run. For a longer hunt: `PROPTEST_CASES=100000 PROPTEST_RNG_SEED=5 cargo test --test
//! scene_fuzz`.

use std::fs;
use std::path::{Path, PathBuf};

use abbe::Error;
use abbe::plan::plan;
use abbe::scene::{Scene, Source, compile};
use abbe::spectrum::Curve;
use abbe::trace::{World, render};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

fn cases(cases: u32) -> ProptestConfig {
    let given = ProptestConfig::default();
    let chosen = |name: &str| std::env::var_os(name).is_some();
    ProptestConfig {
        cases: if chosen("PROPTEST_CASES") { given.cases } else { cases },
        rng_seed: if chosen("PROPTEST_RNG_SEED") { given.rng_seed } else { RngSeed::Fixed(1) },
        failure_persistence: None,
        ..given
    }
}

/// Every scene that comes with Abbe, and one that uses every feature.
fn scenes() -> Vec<(PathBuf, String)> {
    let shipped = fs::read_dir("scenes").expect("there are scenes").map(|entry| entry.expect("readable").path());
    let mut paths: Vec<PathBuf> = shipped.filter(|path| path.extension().is_some_and(|e| e == "toml")).collect();
    paths.push(Path::new("tests/messages/everything.toml").into());
    paths.sort();
    paths.into_iter().map(|path| (path.clone(), fs::read_to_string(path).expect("a scene is text"))).collect()
}

/// The scene, if the text is one; checks that a refusal can be shown.
fn read(path: &Path, text: String) -> Option<Scene<Curve>> {
    let source = Source { path: path.to_owned(), text };
    // The image is made small: its size decides nothing but the time it takes.
    let scene = source.parse().and_then(|mut description| {
        (description.film.width, description.film.height) =
            (description.film.width.min(4), description.film.height.min(3));
        description.render.samples = description.render.samples.map(|samples| samples.min(1));
        compile(&description, &source)
    });
    match scene {
        Ok(scene) => Some(scene),
        Err(Error::Scene(mistake)) => {
            assert!(!mistake.message.is_empty() && !mistake.message.contains('\n'), "{mistake:?}");
            assert!(mistake.span.start <= mistake.span.end && mistake.span.end <= source.text.len(), "{mistake:?}");
            let whole = |at| source.text.is_char_boundary(at);
            assert!(whole(mistake.span.start) && whole(mistake.span.end), "{mistake:?}");
            let (line, column) = mistake.line_and_column();
            assert!(line >= 1 && column >= 1 && line <= source.text.lines().count() + 1, "{mistake:?}");
            None
        }
        Err(other) => panic!("a text is refused with its place, not with {other:?}"),
    }
}

/// A change to a text; numbers choose what is changed, modulo how much there is.
#[derive(Clone, Debug)]
enum Edit {
    DropLine(usize),
    RepeatLine(usize, usize),
    SwapLines(usize, usize),
    DropCharacter(usize),
    InsertText(usize, String),
    ReplaceNumber(usize, String),
    SwapWords(usize, usize),
}

const NUMBERS: [&str; 24] = [
    "nan",
    "inf",
    "-inf",
    "0",
    "-0.0",
    "1",
    "-1",
    "2.5",
    "1e-320",
    "1e-200",
    "1e-31",
    "1e-29",
    "1e-15",
    "1e15",
    "1e29",
    "1e31",
    "1e200",
    "-1e308",
    "1e999",
    "4294967296",
    "-9223372036854775808",
    "99999999999999999999",
    "0x7f",
    "true",
];

fn edit() -> impl Strategy<Value = Edit> {
    let number = || prop::sample::select(NUMBERS.as_slice()).prop_map(str::to_owned);
    let at = any::<usize>;
    prop_oneof![
        1 => at().prop_map(Edit::DropLine),
        1 => (at(), at()).prop_map(|(from, to)| Edit::RepeatLine(from, to)),
        1 => (at(), at()).prop_map(|(a, b)| Edit::SwapLines(a, b)),
        1 => at().prop_map(Edit::DropCharacter),
        1 => (at(), "[\\[\\]{}=,.\"#a-z0-9é色\u{202e} \n]{1,3}").prop_map(|(at, text)| Edit::InsertText(at, text)),
        6 => (at(), number()).prop_map(|(at, number)| Edit::ReplaceNumber(at, number)),
        1 => (at(), at()).prop_map(|(a, b)| Edit::SwapWords(a, b)),
    ]
}

fn edited(text: &str, edit: &Edit) -> String {
    let mut lines: Vec<&str> = text.lines().collect();
    let starts: Vec<usize> = text.char_indices().map(|(at, _)| at).collect();
    if lines.is_empty() || starts.is_empty() {
        return text.to_owned();
    }
    let (line, place) = (|n: usize| n % text.lines().count(), |n: usize| starts[n % starts.len()]);
    match edit {
        Edit::DropLine(at) => drop(lines.remove(line(*at))),
        Edit::RepeatLine(from, to) => lines.insert(line(*to), lines[line(*from)]),
        Edit::SwapLines(a, b) => lines.swap(line(*a), line(*b)),
        Edit::DropCharacter(at) => {
            let mut text = text.to_owned();
            text.remove(place(*at));
            return text;
        }
        Edit::InsertText(at, inserted) => {
            let (before, after) = text.split_at(place(*at));
            return format!("{before}{inserted}{after}");
        }
        Edit::ReplaceNumber(at, number) => {
            let numbers = words(text, |c| c.is_ascii_digit() || "+-.".contains(c));
            return replaced(text, &numbers, *at, number);
        }
        Edit::SwapWords(a, b) => {
            let words = words(text, |c| c.is_ascii_alphabetic() || c == '_');
            let Some((start, end)) = words.get(*b % words.len().max(1)) else { return text.to_owned() };
            return replaced(text, &words, *a, &text[*start..*end]);
        }
    }
    lines.join("\n")
}

/// Start and end of the runs of such characters.
fn words(text: &str, belongs: impl Fn(char) -> bool) -> Vec<(usize, usize)> {
    let mut words: Vec<(usize, usize)> = Vec::new();
    for (at, c) in text.char_indices().filter(|(_, c)| belongs(*c)) {
        match words.last_mut() {
            Some((_, end)) if *end == at => *end = at + c.len_utf8(),
            _ => words.push((at, at + c.len_utf8())),
        }
    }
    words
}

fn replaced(text: &str, words: &[(usize, usize)], at: usize, by: &str) -> String {
    match words.get(at % words.len().max(1)) {
        Some((start, end)) => format!("{}{by}{}", &text[..*start], &text[*end..]),
        None => text.to_owned(),
    }
}

#[test]
fn the_scenes_themselves_are_valid() {
    for (path, text) in scenes() {
        assert!(read(&path, text).is_some(), "{}", path.display());
    }
}

proptest! {
    #![proptest_config(cases(4000))]

    #[test]
    fn random_bytes_are_refused_without_a_panic(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        read(Path::new("random.toml"), String::from_utf8_lossy(&bytes).into_owned());
    }

    #[test]
    fn random_pieces_of_scenes_are_refused_without_a_panic(pieces in prop::collection::vec(piece(), 0..60)) {
        read(Path::new("pieces.toml"), pieces.concat());
    }
}

fn piece() -> impl Strategy<Value = &'static str> {
    prop::sample::select(
        [
            "[",
            "]",
            "[[",
            "]]",
            "{",
            "}",
            "=",
            ".",
            ",",
            "\n",
            " ",
            "\"",
            "'''",
            "#",
            "\\",
            "1",
            "-",
            "e",
            "nan",
            "camera",
            "film",
            "render",
            "material",
            "object",
            "light",
            "shape",
            "sphere",
            "transform",
            "diffuse",
            "position",
            "width",
            "scale",
            "rgb",
            "[camera]\n",
            "[[object]]\n",
            "[material.a]\n",
            " = { ",
            " }\n",
            "\u{feff}",
        ]
        .as_slice(),
    )
}

proptest! {
    #![proptest_config(cases(3000))]

    #[test]
    fn edited_scenes_are_read_or_refused_without_a_panic(
        scene in any::<prop::sample::Index>(),
        edits in prop::collection::vec(edit(), 1..8),
    ) {
        let scenes = scenes();
        let (path, text) = scene.get(&scenes);
        read(path, edits.iter().fold(text.clone(), |text, edit| edited(&text, edit)));
    }
}

proptest! {
    #![proptest_config(cases(500))]

    #[test]
    fn what_is_accepted_renders_to_finite_light(
        scene in any::<prop::sample::Index>(),
        changes in prop::collection::vec((any::<usize>(), prop::sample::select(NUMBERS.as_slice())), 1..3),
    ) {
        let scenes = scenes();
        let (path, text) = scene.get(&scenes);
        let change = |text: String, (at, number): &(usize, &str)| {
            edited(&text, &Edit::ReplaceNumber(*at, (*number).into()))
        };
        if let Some(scene) = read(path, changes.iter().fold(text.clone(), change)) {
            let (_, report) = render(&World::new(&scene, plan(&scene).method), &|_| {});
            prop_assert_eq!(report.non_finite, 0);
        }
    }
}
