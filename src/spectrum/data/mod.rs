//! Measured optical data, looked up by name.

mod glasses;
mod metals;

pub use glasses::{GLASSES, Glass};
pub use metals::{METALS, Metal};

/// The glass of that name or alias, whatever the case of its letters.
pub fn glass(name: &str) -> Option<&'static Glass> {
    GLASSES.iter().find(|glass| is_called(name, glass.name, glass.aliases))
}

/// The metal of that name or alias, whatever the case of its letters.
pub fn metal(name: &str) -> Option<&'static Metal> {
    METALS.iter().find(|metal| is_called(name, metal.name, metal.aliases))
}

/// The names of all glasses.
pub fn glass_names() -> impl Iterator<Item = &'static str> {
    GLASSES.iter().map(|glass| glass.name)
}

/// The names of all metals.
pub fn metal_names() -> impl Iterator<Item = &'static str> {
    METALS.iter().map(|metal| metal.name)
}

fn is_called(asked: &str, name: &str, aliases: &[&str]) -> bool {
    name.eq_ignore_ascii_case(asked) || aliases.iter().any(|alias| alias.eq_ignore_ascii_case(asked))
}
