//! `render catalog`: which glasses, metals, illuminants and reflectances a scene can name.

use abbe::spectrum::data::{self, GLASS_MAKERS, Glass};
use abbe::{Error, Result};
use clap::Parser;

use super::messages::align_columns;

const HELP: &str = "\
Words are searched for in names, other names and makers, ignoring case; an entry must contain all of them. \
Among the makers' glasses, flint finds those with V_d below 50, and crown the others.

The columns of a glass: name, n_d, V_d, known wavelengths, whether absorption is known, source. \
Of a metal: name, other names, measured wavelengths, source. Of all others: name, tabulated wavelengths, source. \
On a terminal the columns have titles.

Examples:
  render catalog glass                 list every glass
  render catalog glass schott flint    the flints of one maker
  render catalog metal silver          one metal
  render catalog d65                   everything of that name

Exit codes: 0 something was found, 2 nothing was.";

/// List or search the glasses, metals, illuminants and reflectances that a scene can name.
#[derive(Parser)]
#[command(name = "render catalog", bin_name = "render catalog", after_help = HELP)]
pub struct Query {
    /// glass, metal, illuminant or reflectance to list only those, then words to search for
    words: Vec<String>,
}

/// A kind of entry.
struct Kind {
    /// The name of the kind, and the title of the column of names.
    name: &'static str,
    /// Other words for all entries of the kind.
    all: &'static [&'static str],
    /// The titles of the other columns.
    titles: &'static [&'static str],
    lines: fn(&[String]) -> Vec<Vec<String>>,
    /// The names of all entries.
    names: fn() -> Vec<&'static str>,
}

const KINDS: [Kind; 4] = [
    Kind {
        name: "glass",
        all: &["glasses"],
        titles: &["n_d", "V_d", "known", "absorption", "source"],
        lines: glass_lines,
        names: || data::known_as().collect(),
    },
    Kind {
        name: "metal",
        all: &["metals"],
        titles: &["also", "measured", "source"],
        lines: metal_lines,
        names: || data::metals().flat_map(|metal| [vec![metal.name], metal.aliases].concat()).collect(),
    },
    Kind {
        name: "illuminant",
        all: &["illuminants", "lights"],
        titles: &["tabulated", "source"],
        lines: |words| grid_lines(data::illuminants(), words),
        names: || data::illuminants().map(|light| light.name).collect(),
    },
    Kind {
        name: "reflectance",
        all: &["reflectances", "colors"],
        titles: &["tabulated", "source"],
        lines: |words| grid_lines(data::reflectances(), words),
        names: || data::reflectances().map(|chip| chip.name).collect(),
    },
];

impl Kind {
    /// Returns the lines of the entries that match, below the titles of their columns if requested.
    fn matching_lines(&self, words: &[String], titled: bool) -> Vec<String> {
        let mut lines = (self.lines)(words);
        if titled && !lines.is_empty() {
            lines.insert(0, std::iter::once(&self.name).chain(self.titles).map(ToString::to_string).collect());
        }
        align_columns(&lines)
    }
}

/// Returns the lines that answer a query, below the titles of their columns if requested.
///
/// # Errors
/// If nothing is found. The help contains the nearest names.
pub fn lines(query: &Query, titled: bool) -> Result<Vec<String>> {
    let mut words: Vec<_> = query.words.iter().map(|word| word.to_lowercase()).collect();
    let kind_index =
        words.first().and_then(|word| KINDS.iter().position(|kind| kind.name == word || kind.all.contains(&&**word)));
    let kinds = kind_index.map_or(&KINDS[..], |i| &KINDS[i..=i]);
    words.drain(..usize::from(kind_index.is_some()));
    let found: Vec<_> = kinds.iter().flat_map(|kind| kind.matching_lines(&words, titled)).collect();
    if !found.is_empty() {
        return Ok(found);
    }
    let kind_name = kind_index.map_or("entry", |i| KINDS[i].name);
    let phrase = words.join(" ");
    let near = nearest(&phrase, kinds.iter().flat_map(|kind| (kind.names)()).collect());
    let message = format!("the catalog has no {kind_name} that matches {phrase:?}");
    let help = match near.as_str() {
        "" => "render catalog --help says how to search".into(),
        near if !near.contains(',') => format!("the nearest name is {near}"),
        near => format!("the nearest names are {near}"),
    };
    Error::refuse(message, help)
}

/// Returns up to three nearest names, of those whose edit distance from `phrase` is at most half the shorter length.
fn nearest(phrase: &str, mut names: Vec<&str>) -> String {
    let edit_distance = |name: &str| strsim::damerau_levenshtein(phrase, &name.to_lowercase());
    names.retain(|name| 2 * edit_distance(name) <= name.chars().count().min(phrase.chars().count()));
    names.sort_by_cached_key(|name| (edit_distance(name), *name));
    names.dedup();
    names[..names.len().min(3)].join(", ")
}

/// Returns whether every word is part of a name, or equal to `family`, the family of the entry.
fn matches(words: &[String], names: &[&str], family: &str) -> bool {
    let names: Vec<_> = names.iter().map(|name| name.to_lowercase()).collect();
    words.iter().all(|word| word == family || names.iter().any(|name| name.contains(word)))
}

/// Returns the optical family of a maker's glass, flint or crown, or an empty text for any other glass.
fn family(glass: &Glass) -> &'static str {
    let maker = glass.key.split('/').next().unwrap_or_default();
    match glass.v_d().filter(|_| GLASS_MAKERS.contains(&maker)) {
        None => "",
        Some(vd) if vd < 50.0 => "flint",
        Some(_) => "crown",
    }
}

fn glass_lines(words: &[String]) -> Vec<Vec<String>> {
    let found = data::glasses().filter(|glass| {
        let names = [vec![glass.key], glass.aliases.clone()].concat();
        matches(words, &names, family(glass))
    });
    let line = |glass: Glass| {
        let absorption = if glass.extinction.is_empty() { "-" } else { "absorption" };
        vec![
            glass.key.into(),
            format!("{:.5}", glass.n_d()),
            glass.v_d().map_or("     -".into(), |vd| format!("{vd:6.2}")),
            range(glass.range_nm.0, glass.range_nm.1),
            absorption.into(),
            glass.source.into(),
        ]
    };
    found.map(line).collect()
}

fn metal_lines(words: &[String]) -> Vec<Vec<String>> {
    let found = data::metals().filter(|metal| matches(words, &[vec![metal.name], metal.aliases.clone()].concat(), ""));
    let line = |metal: data::Metal| {
        let (first, last) = (metal.samples[0][0], metal.samples[metal.samples.len() - 1][0]);
        vec![metal.name.into(), metal.aliases.join(", "), range(first, last), metal.source.into()]
    };
    found.map(line).collect()
}

fn grid_lines(grids: impl Iterator<Item = data::Grid>, words: &[String]) -> Vec<Vec<String>> {
    let line = |grid: data::Grid| {
        let [first, last] = grid.range_nm();
        vec![grid.name.into(), range(first, last), grid.source.into()]
    };
    grids.filter(|grid| matches(words, &[grid.name], "")).map(line).collect()
}

fn range(low: f64, high: f64) -> String {
    format!("{low:.0}-{high:.0} nm")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_have_titles_on_a_terminal() {
        let query = |words: &[&str]| Query { words: words.iter().map(ToString::to_string).collect() };
        for kind in &KINDS {
            let [plain, titled] =
                [false, true].map(|titled| lines(&query(&[kind.name]), titled).expect("there are some"));
            assert!(titled[0].starts_with(kind.name) && titled[0].ends_with("source"), "{}", titled[0]);
            assert_eq!(titled.len(), plain.len() + 1);
            let at = titled[0].rfind("source").expect("it ends so");
            assert!(
                titled[1..].iter().all(|line| line.is_char_boundary(at) && line[..at].ends_with(' ')),
                "{titled:?}"
            );
        }
    }
}
