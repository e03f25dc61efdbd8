//! Suggestions for arguments that do not exist.

use std::ffi::OsString;
use std::path::Path;

use abbe::film::Layer;
use clap::error::{ContextKind, ErrorKind};

/// Words that people may take for commands, and the flags that they mean.
const FLAGS: [(&str, &str); 8] = [
    ("plan", "--plan"),
    ("check", "--check"),
    ("help", "--help"),
    ("version", "--version"),
    ("render", "--exr"),
    ("frames", "--frame 1-24"),
    ("sequence", "--frame 1-24"),
    ("animation", "--frame 1-24"),
];

/// Arguments of other renderers, and what does the same here.
const FOREIGN_FLAGS: [(&[&str], &str); 12] = [
    (&["--spp"], "--samples 64"),
    (&["--output", "-o"], "--exr frame.exr"),
    (&["--width"], "--set film.width=640"),
    (&["--height"], "--set film.height=360"),
    (&["--resolution", "--res", "--size", "--scale", "--percentage"], "--set film.width=640 --set film.height=360"),
    (
        &["--alpha", "--transparent", "--background"],
        "visible_to_camera = false beside the sky, in the scene, to hide it: A is 0 where no object is",
    ),
    (&["--noise"], "--error 0.01"),
    (&["--aov", "--aovs"], "--layers albedo,N"),
    (&["--frames"], "--frame 1-24"),
    (&["--start", "--end", "--frame-start", "--frame-end"], "--frame 1-24"),
    (&["--gpu", "--device", "--cpu"], "--threads 8, or nothing: it renders on all processors, and on them alone"),
    (&["--denoise"], "--layers albedo,N, and then denoise the image: python tools/denoise.py frame.exr"),
];

/// The maximum number of wrong letters in a misspelled command.
const MAX_WRONG_LETTERS: usize = 2;

/// Returns a message on an argument that does not exist, and what to write instead, if that is known. `commands` are
/// those that exist. If clap accepts the words, `complaint` is none, but the scene may still be a misspelled command.
pub fn suggest(complaint: Option<&clap::Error>, words: &[OsString], commands: &[&str]) -> Option<(String, String)> {
    let first = || words.get(1)?.to_str().filter(|first| !first.starts_with('-'));
    let Some(complaint) = complaint else {
        // A name of three letters is close to half of all commands, so a short name must match more closely.
        let is_file = |name: &str| [name.into(), format!("{name}.toml")].iter().any(|name| Path::new(name).exists());
        return first().filter(|name| !is_file(name)).and_then(|name| similar_command(name, commands, name.len() / 4));
    };
    let given = match complaint.kind() {
        ErrorKind::UnknownArgument => complaint.get(ContextKind::InvalidArg)?.to_string(),
        _ => return None,
    };
    if let Some((_, here)) = FOREIGN_FLAGS.iter().find(|(there, _)| there.contains(&given.as_str())) {
        return Some((format!("there is no argument {given}"), format!("write {here}")));
    }
    if let Some(complaint) = unjoined_list(&given, words).or_else(|| missing_set_flag(&given, words)) {
        return Some(complaint);
    }
    let Some(first) = first().filter(|first| !first.contains('.')) else {
        return match commands.iter().find(|command| words.iter().any(|word| word == *command)) {
            Some(command) => {
                let whole = format!("render {command}");
                let help = format!("write {whole}, and its arguments after that; {whole} --help lists them");
                Some((format!("the command {command} comes before all other arguments"), help))
            }
            None => misplaced_file(&given),
        };
    };
    similar_command(first, commands, MAX_WRONG_LETTERS)
}

/// Returns a message on a word, with the command that it resembles, if at most `max_distance` letters are wrong.
fn similar_command(word: &str, commands: &[&str], max_distance: usize) -> Option<(String, String)> {
    let distance = |command: &str| strsim::damerau_levenshtein(word, command);
    let candidates = commands.iter().map(|&command| (command, command)).chain(FLAGS);
    let (_, here) =
        candidates.min_by_key(|(near, _)| distance(near)).filter(|(near, _)| distance(near) <= max_distance)?;
    Some((format!("there is no command `{word}`"), format!("did you mean render {here}?")))
}

/// Flags that take a list, and what the list contains.
const LISTS: [(&str, &str); 3] = [
    ("--layers", "names of layers"),
    ("--crop", "the numbers of a crop"),
    ("--overscan", "the numbers of an overscan"),
];

/// Returns a message on a list whose entries are separate arguments, and how to join them.
fn unjoined_list(given: &str, words: &[OsString]) -> Option<(String, String)> {
    let (start, (flag, what)) = words.iter().enumerate().find_map(|(place, word)| {
        let list = LISTS.iter().find(|(flag, _)| word == flag)?;
        Some((place + 1, list))
    })?;
    let entries: Vec<&str> = words[start..].iter().map_while(|word| word.to_str()).collect();
    let count = entries.iter().take_while(|name| !name.starts_with('-') && !name.contains('.')).count();
    let entries: Vec<&str> = entries[..count].iter().map(|entry| entry.trim_matches(',')).collect();
    let given = given.trim_matches(',');
    let is_entry = given.parse::<u32>().is_ok() || Layer::NAMES.iter().any(|(name, _)| *name == given);
    (entries.len() > 1 && entries.contains(&given) && is_entry).then(|| {
        (format!("{what} are joined by commas, without spaces"), format!("write {flag} {}", entries.join(",")))
    })
}

/// Returns a message on a setting that is not a single word after its own `--set`.
fn missing_set_flag(given: &str, words: &[OsString]) -> Option<(String, String)> {
    let is_setting = |word: &OsString| word.to_str().is_some_and(|word| word.contains('='));
    if words.windows(2).any(|pair| pair[0] == "--set" && !is_setting(&pair[1])) {
        let message = "a setting is one word: a key, `=` and a value".to_owned();
        return Some((message, "for instance: --set film.width=320".into()));
    }
    let follows = |pair: &[OsString]| pair[1] == given && is_setting(&pair[0]) && is_setting(&pair[1]);
    let complaint = || (format!("{given} needs --set before it"), format!("write --set {given}"));
    words.windows(2).any(follows).then(complaint)
}

/// Returns what to write instead of an argument that a subcommand does not have. The first word is its name.
pub fn suggest_for_subcommand(complaint: &clap::Error, words: &[OsString]) -> Option<(String, String)> {
    let given = match complaint.kind() {
        ErrorKind::UnknownArgument => complaint.get(ContextKind::InvalidArg)?.to_string(),
        _ => return None,
    };
    let is_image = words.first()? == "merge" && matches!(&*given, "--exr" | "--output" | "-o");
    let help = "the image to write comes first: render merge frame.exr frame.*.part";
    is_image.then(|| (format!("merge has no argument {given}"), help.to_owned()))
}

/// Returns a message on a file name that belongs to no argument, and what was meant.
fn misplaced_file(given: &str) -> Option<(String, String)> {
    match given.rsplit_once('.')?.1 {
        "toml" => {
            let message = format!("one scene is rendered at a time, and {given} is another");
            Some((message, "render each with its own command".into()))
        }
        ending @ ("exr" | "png") => Some((format!("{given} is not a scene"), format!("write --{ending} {given}"))),
        _ => None,
    }
}
