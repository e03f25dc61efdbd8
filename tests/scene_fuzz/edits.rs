//! Changes to the text of a scene.

use proptest::prelude::*;

/// A change to a text. Its numbers select what is changed, modulo the number of candidates.
#[derive(Clone, Debug)]
pub enum Edit {
    DropLine(usize),
    RepeatLine(usize, usize),
    SwapLines(usize, usize),
    DropCharacter(usize),
    InsertText(usize, String),
    ReplaceNumber(usize, String),
    /// Another value for a key, mostly one that suits it.
    ReplaceValue(usize, usize),
    AddLight(usize),
    SwapWords(usize, usize),
}

/// Values by the keys that they suit. Files are read from `tests/messages`.
const VALUES: [(&[&str], &[&str]); 6] = [
    (
        &["reflectance", "transmittance"],
        &[
            "\"dark skin\"",
            "\"colorchecker/neutral 5 (.70 D)\"",
            "{ rgb = [0.9, 0, 0.1], scale = 0.5 }",
            "{ samples = [[400, 0.2], [550, 1], [700, 0]] }",
            "{ samples = [[550, 0.5]], scale = 0.5 }",
            "{ file = \"paint.csv\" }",
            "{ file = \"paint.csv\", column = 3, scale = 0.01 }",
            "{ image = \"dots.png\", repeat = 3, wrap = \"mirror\" }",
            "{ image = \"dots.png\", channel = \"red\", filter = \"nearest\", repeat = [0.5, 7] }",
            "{ checker = [0.2, \"dark skin\"], repeat = 2 }",
            "{ checker = [{ image = \"dots.png\", encoding = \"linear\" }, { rgb = [1, 0, 0] }], scale = 0.5 }",
        ],
    ),
    (
        &["index"],
        &[
            "\"N-SF11\"",
            "\"diamond\"",
            "\"water\"",
            "{ cauchy = [1.5, 0.01] }",
            "{ abbe = { nd = 1.78, vd = 25.8 } }",
            "{ sellmeier = { b = [1.03, 0.23, 1.01], c = [0.006, 0.02, 103] } }",
            "{ samples = [[400, 1.5], [700, 1.4]], scale = 1.1 }",
        ],
    ),
    (&["absorption"], &["\"N-BK7\"", "\"water\"", "{ samples = [[400, 0], [700, 3]] }", "{ rgb = [0, 1, 20] }"]),
    (&["n", "k"], &["{ samples = [[400, 1.2], [700, 0.9]] }", "{ file = \"paint.csv\" }", "\"Cu\""]),
    (
        &["radiance", "intensity", "irradiance", "emission"],
        &[
            "{ illuminant = \"D65\" }",
            "{ illuminant = \"FL11\", luminance = 3 }",
            "{ illuminant = \"LED-B3\", scale = 2 }",
            "{ blackbody = 5600 }",
            "{ blackbody = 1900, luminance = 1 }",
            "{ lines = [[589, 2], [589.6, 1]] }",
            "{ lines = [[404.7, 1], [546.1, 3]], luminance = 2 }",
            "{ samples = [[500, 0], [510, 3], [520, 0]], luminance = 1 }",
            "{ file = \"paint.csv\", luminance = 0.5 }",
            "{ rgb = [1, 0.5, 0], luminance = 2 }",
            "{ image = \"dots.png\", scale = 4 }",
            "{ checker = [0, { rgb = [4, 1, 0] }], repeat = 4 }",
        ],
    ),
    (&["model"], &["\"auto\"", "\"rgb\"", "\"hero\"", "{ bands = 8 }", "{ bands = 12 }", "{ bands = 32 }"]),
];

const LIGHTS: [&str; 4] = [
    "sun = { toward = [1, 2, 1], irradiance = 3 }",
    "sun = { toward = [0, 1, 0.1], angular_diameter = 0, irradiance = { blackbody = 5772 } }",
    "sun = { toward = [-1, 1, 0], angular_diameter = 180, irradiance = { illuminant = \"A\" } }",
    "point = { position = [0, 2, 2], intensity = { lines = [[546.1, 3]] } }",
];

const NUMBERS: [&str; 27] = [
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
    "0.589",
    "360",
    "12",
    "true",
];

/// Returns edits of any kind.
pub fn edit() -> impl Strategy<Value = Edit> {
    let number = || prop::sample::select(NUMBERS.as_slice()).prop_map(str::to_owned);
    let at = any::<usize>;
    prop_oneof![
        1 => at().prop_map(Edit::DropLine),
        1 => (at(), at()).prop_map(|(from, to)| Edit::RepeatLine(from, to)),
        1 => (at(), at()).prop_map(|(a, b)| Edit::SwapLines(a, b)),
        1 => at().prop_map(Edit::DropCharacter),
        1 => (at(), "[\\[\\]{}=,.\"#a-z0-9é色\u{202e} \n]{1,3}").prop_map(|(at, text)| Edit::InsertText(at, text)),
        6 => (at(), number()).prop_map(|(at, number)| Edit::ReplaceNumber(at, number)),
        4 => (at(), at()).prop_map(|(at, value)| Edit::ReplaceValue(at, value)),
        1 => at().prop_map(Edit::AddLight),
        1 => (at(), at()).prop_map(|(a, b)| Edit::SwapWords(a, b)),
    ]
}

/// Returns edits that leave many scenes valid.
pub fn change() -> impl Strategy<Value = Edit> {
    let number = || prop::sample::select(NUMBERS.as_slice()).prop_map(str::to_owned);
    let at = any::<usize>;
    prop_oneof![
        4 => (at(), number()).prop_map(|(at, number)| Edit::ReplaceNumber(at, number)),
        4 => (at(), at()).prop_map(|(at, value)| Edit::ReplaceValue(at, value)),
        1 => at().prop_map(Edit::AddLight),
    ]
}

/// Returns a text after an edit.
pub fn apply_edit(text: &str, edit: &Edit) -> String {
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
        Edit::ReplaceValue(at, value) => {
            let places = values(text);
            let Some((key, start, end)) = places.get(*at % places.len().max(1)) else { return text.to_owned() };
            let all = || VALUES.iter().flat_map(|(_, values)| values.iter()).copied().collect::<Vec<_>>();
            let own = VALUES.iter().find(|(keys, _)| keys.contains(key)).map(|(_, values)| values.to_vec());
            let choices = own.filter(|_| value % 8 > 0).unwrap_or_else(all);
            return format!("{}{}{}", &text[..*start], choices[(value / 8) % choices.len()], &text[*end..]);
        }
        Edit::AddLight(light) => return format!("{text}\n[[light]]\n{}\n", LIGHTS[light % LIGHTS.len()]),
        Edit::SwapWords(a, b) => {
            let words = words(text, |c| c.is_ascii_alphabetic() || c == '_');
            let Some((start, end)) = words.get(*b % words.len().max(1)) else { return text.to_owned() };
            return replaced(text, &words, *a, &text[*start..*end]);
        }
    }
    lines.join("\n")
}

/// Returns the start and end of each run of matching characters.
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

/// Returns the values whose key is in `VALUES`: the key, and the start and end of its value.
fn values(text: &str) -> Vec<(&str, usize, usize)> {
    let mut found = Vec::new();
    for (at, mark) in text.match_indices(" = ") {
        let key = text[..at].rsplit(|c: char| !c.is_ascii_alphabetic()).next().unwrap_or_default();
        if !VALUES.iter().any(|(keys, _)| keys.contains(&key)) {
            continue;
        }
        let (start, mut depth) = (at + mark.len(), 0);
        let end = text[start..].find(|c: char| {
            depth += i32::from("[{".contains(c)) - i32::from("]}".contains(c));
            depth < 0 || (depth == 0 && ",\n".contains(c))
        });
        found.push((key, start, end.map_or(text.len(), |length| start + length)));
    }
    found
}

fn replaced(text: &str, words: &[(usize, usize)], at: usize, by: &str) -> String {
    match words.get(at % words.len().max(1)) {
        Some((start, end)) => format!("{}{by}{}", &text[..*start], &text[*end..]),
        None => text.to_owned(),
    }
}
