//! Completions for shells, and the manual page.

use clap::{Command, Parser};
use clap_complete::Shell;

const COMPLETIONS: &str = "\
Examples:
  render completions bash > ~/.local/share/bash-completion/completions/render
  render completions fish > ~/.config/fish/completions/render.fish";

/// Write the completions of a shell to standard output.
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

/// What completes the words of a command in a shell.
pub fn completions(query: &Completions, mut command: Command) -> String {
    let mut script = Vec::new();
    clap_complete::generate(query.shell, &mut command, "render", &mut script);
    String::from_utf8_lossy(&script).into_owned()
}

/// The manual page of a command.
pub fn page(command: Command) -> String {
    let mut page = Vec::new();
    // Memory takes all that is written.
    let _ = clap_mangen::Man::new(command).render(&mut page);
    String::from_utf8_lossy(&page).into_owned()
}
