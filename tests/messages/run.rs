//! The `render` command, run in a folder of its own.

use std::fs;
use std::path::Path;

use assert_cmd::Command;

/// A folder that is empty at first and gone at last.
pub struct Folder(tempfile::TempDir);

/// What the command answered.
pub struct Answer {
    pub code: Option<i32>,
    pub stdout: String,
    pub stderr: String,
}

impl Folder {
    pub fn new() -> Self {
        Self(tempfile::tempdir().expect("a temporary folder can be made"))
    }

    pub fn path(&self) -> &Path {
        self.0.path()
    }

    pub fn write(&self, name: &str, text: &str) {
        fs::write(self.path().join(name), text).expect("files can be written");
    }

    /// The names in the folder, in order.
    pub fn listing(&self) -> Vec<String> {
        let entries = fs::read_dir(self.path()).expect("the folder can be read");
        let name = |entry: fs::DirEntry| entry.file_name().to_string_lossy().into_owned();
        let mut names: Vec<String> = entries.map(|entry| name(entry.expect("an entry can be read"))).collect();
        names.sort();
        names
    }
}

/// Runs `render` in a folder, its stderr no terminal.
pub fn render(folder: &Folder, arguments: &[&str]) -> Answer {
    let mut command = Command::new(env!("CARGO_BIN_EXE_render"));
    let output = command.current_dir(folder.path()).args(arguments).output().expect("the command can be started");
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("messages are UTF-8");
    Answer { code: output.status.code(), stdout: text(output.stdout), stderr: text(output.stderr) }
}
