//! Completions for shells, and the manual page.

use clap::{Command, Parser};
use clap_complete::Shell;
use clap_mangen::Man;

const COMPLETIONS: &str = "\
Examples:
  render completions bash > ~/.local/share/bash-completion/completions/render
  render completions fish > ~/.config/fish/completions/render.fish";

/// Write a completion script for a shell to standard output.
#[derive(Parser)]
#[command(name = "render completions", bin_name = "render completions", after_help = COMPLETIONS)]
pub struct Completions {
    /// The shell
    shell: Shell,
}

const MANUAL: &str = "\
Examples:
  render man > ~/.local/share/man/man1/render.1";

/// Write the manual page to standard output, in roff.
#[derive(Parser)]
#[command(name = "render man", bin_name = "render man", after_help = MANUAL)]
pub struct Manual {}

/// Returns the completion script of a command for a shell.
pub fn completions(query: &Completions, mut command: Command) -> String {
    let mut script = Vec::new();
    clap_complete::generate(query.shell, &mut command, "render", &mut script);
    String::from_utf8_lossy(&script).into_owned()
}

/// Returns the manual page of a command and all its subcommands.
pub fn page(command: Command) -> String {
    let subcommands: Vec<Command> = command.get_subcommands().cloned().collect();
    let examples = command.get_after_help().map(ToString::to_string).unwrap_or_default();
    let man = Man::new(command);
    let mut page = Vec::new();
    // Writing to memory cannot fail.
    let _ = man.render_title(&mut page);
    let _ = man.render_name_section(&mut page);
    let _ = man.render_synopsis_section(&mut page);
    let _ = man.render_description_section(&mut page);
    let _ = man.render_options_section(&mut page);
    page.extend(b".SH COMMANDS\n");
    subcommands.into_iter().for_each(|command| add_command(command, &mut page));
    page.extend(b".SH EXAMPLES\n");
    page.extend(after_help(&examples).bytes());
    let _ = man.render_version_section(&mut page);
    String::from_utf8_lossy(&page).into_owned()
}

/// Adds a subcommand to the page.
fn add_command(command: Command, page: &mut Vec<u8>) {
    let name = command.get_bin_name().unwrap_or_else(|| command.get_name()).to_owned();
    let about = command.get_about().map(ToString::to_string).unwrap_or_default();
    let examples = command.get_after_help().map(ToString::to_string).unwrap_or_default();
    let man = Man::new(command);
    let mut section = Vec::new();
    let _ = man.render_synopsis_section(&mut section);
    section.extend(format!(".PP\n{}.\n", escaped(about.trim_end_matches('.'))).bytes());
    let _ = man.render_options_section(&mut section);
    let section = String::from_utf8_lossy(&section);
    // The lines stand in a section already, and need no headings and definitions of their own.
    let lines = section
        .lines()
        .filter(|line| !line.starts_with(".SH ") && !line.starts_with(".ie") && !line.starts_with(".el"));
    page.extend(format!(".SS \"{}\"\n", escaped(&name)).bytes());
    page.extend(lines.flat_map(|line| format!("{line}\n").into_bytes()));
    page.extend(format!(".PP\n{}", after_help(&examples)).bytes());
}

/// Converts the text below the options of a help to roff. What an example does is put below it, at any width.
fn after_help(text: &str) -> String {
    // The commands have a section of their own.
    let text = text.find("Examples:").filter(|_| text.starts_with("Commands:")).map_or(text, |start| &text[start..]);
    let roff = text.lines().map(|line| match line.strip_prefix("  ") {
        Some(example) => {
            let (command, effect) = example.split_once("  ").unwrap_or((example, ""));
            let effect = if effect.is_empty() { String::new() } else { format!("{}\n", escaped(effect.trim())) };
            format!(".TP\n\\fB{}\\fR\n{effect}", escaped(command))
        }
        None if line.is_empty() || line == "Examples:" => ".PP\n".into(),
        None => format!("{}\n", escaped(line)),
    });
    roff.collect()
}

/// Escapes a line of text for roff.
fn escaped(line: &str) -> String {
    let line = line.replace('\\', "\\e").replace('-', "\\-");
    if line.starts_with(['.', '\'']) { format!("\\&{line}") } else { line }
}
