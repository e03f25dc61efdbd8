//! What people meant who gave arguments that there are not.

use std::ffi::OsString;

use abbe::film::Layer;
use clap::error::{ContextKind, ErrorKind};

/// What may be taken for a command, and the flag that is meant.
const FLAGS: [(&str, &str); 4] = [("plan", "--plan"), ("check", "--check"), ("help", "--help"), ("render", "--exr")];

/// Arguments of other renderers, and what does the same here.
const ELSEWHERE: [(&[&str], &str); 9] = [
    (&["--spp"], "--samples 64"),
    (&["--output", "-o"], "--exr frame.exr"),
    (&["--width"], "--set film.width=640"),
    (&["--height"], "--set film.height=360"),
    (&["--resolution", "--res", "--size"], "--set film.width=640 --set film.height=360"),
    (&["--noise"], "--error 0.01"),
    (&["--aov", "--aovs"], "--layers albedo,N"),
    (&["--frames"], "--frame 1-24"),
    (&["--denoise"], "--layers albedo,N, and then denoise the image: python tools/denoise.py frame.exr"),
];

/// Most letters that are wrong in a command.
const WRONG: usize = 2;

/// A message on an argument that there is not, and what to write in place of it; none where that is not known. The
/// `commands` are those that there are.
pub fn meant(said: &clap::Error, words: &[OsString], commands: &[&str]) -> Option<(String, String)> {
    let given = match said.kind() {
        ErrorKind::UnknownArgument => said.get(ContextKind::InvalidArg)?.to_string(),
        _ => return None,
    };
    if let Some((_, here)) = ELSEWHERE.iter().find(|(there, _)| there.contains(&given.as_str())) {
        return Some((format!("there is no argument {given}"), format!("write {here}")));
    }
    if let Some(layers) = apart(&given, words) {
        let message = "names of layers are joined by commas, without spaces".to_owned();
        return Some((message, format!("write --layers {layers}")));
    }
    let first = words.get(1)?.to_str()?;
    if first.starts_with('-') || first.contains('.') {
        return match commands.iter().find(|command| words.iter().any(|word| word == *command)) {
            Some(command) => {
                let whole = format!("render {command}");
                let help = format!("write {whole}, and what belongs to it after that; {whole} --help tells it");
                Some((format!("the command {command} stands before all other arguments"), help))
            }
            None => out_of_place(&given),
        };
    }
    let wrong = |command: &str| strsim::damerau_levenshtein(first, command);
    let known = commands.iter().map(|&command| (command, command)).chain(FLAGS);
    let (_, here) = known.min_by_key(|(word, _)| wrong(word)).filter(|(near, _)| wrong(near) <= WRONG)?;
    Some((format!("there is no command `{first}`"), format!("did you mean render {here}?")))
}

/// The names of layers behind `--layers`, if each stands alone: joined as they are to be.
fn apart(given: &str, words: &[OsString]) -> Option<String> {
    let from = words.iter().position(|word| word == "--layers")? + 1;
    let names: Vec<&str> = words[from..].iter().map_while(|word| word.to_str()).collect();
    let count = names.iter().take_while(|name| !name.starts_with('-') && !name.contains('.')).count();
    let names: Vec<&str> = names[..count].iter().map(|name| name.trim_matches(',')).collect();
    let (given, known) = (given.trim_matches(','), Layer::NAMES.map(|(name, _)| name));
    (names.len() > 1 && names.contains(&given) && known.contains(&given)).then(|| names.join(","))
}

/// The same of the arguments of a command, whose name is the first word.
pub fn meant_below(said: &clap::Error, words: &[OsString]) -> Option<(String, String)> {
    let given = match said.kind() {
        ErrorKind::UnknownArgument => said.get(ContextKind::InvalidArg)?.to_string(),
        _ => return None,
    };
    let is_image = words.first()? == "merge" && matches!(&*given, "--exr" | "--output" | "-o");
    let help = "the image to write comes first: render merge frame.exr frame.*.part";
    is_image.then(|| (format!("merge has no argument {given}"), help.to_owned()))
}

/// What was meant by a file that no argument names.
fn out_of_place(given: &str) -> Option<(String, String)> {
    match given.rsplit_once('.')?.1 {
        "toml" => {
            let message = format!("one scene is rendered at a time, and {given} is another");
            Some((message, "render each by a command of its own".into()))
        }
        ending @ ("exr" | "png") => Some((format!("{given} is no scene"), format!("write --{ending} {given}"))),
        _ => None,
    }
}
