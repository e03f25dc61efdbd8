//! `render info`, `render view` and `render diff`: inspecting, viewing and comparing images.
//!
//! ```text
//! cargo test --test all look::
//! ```

mod damaged;
mod diff;
pub mod files;
mod info;
mod mattes;
mod view;

use crate::support::run::{Folder, render};

#[test]
fn each_has_help_with_examples_and_exit_codes() {
    for command in ["info", "view", "diff"] {
        let help = render(&Folder::new(), &[command, "--help"]);
        assert_eq!((help.code, &*help.stderr), (Some(0), ""));
        let examples = help.stdout.split("Examples:\n").nth(1).expect("there are examples");
        assert!(examples.contains(&format!("  render {command} ")), "{examples}");
        assert!(examples.contains("\nExit codes: 0 "), "{examples}");
        assert!(help.stdout.contains(&format!("Usage: render {command} ")), "{}", help.stdout);
    }
}
