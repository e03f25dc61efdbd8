//! The `render` command, run in a folder of its own.

use std::fs;
use std::path::{Path, PathBuf};

use assert_cmd::Command;

/// A temporary folder: empty at first, deleted in the end.
pub struct Folder(tempfile::TempDir);

/// The exit code and the output of the command.
pub struct Answer {
    pub code: Option<i32>,
    pub stdout: String,
    pub stderr: String,
}

impl Folder {
    pub fn new() -> Self {
        Self(tempfile::tempdir().expect("a temporary folder can be made"))
    }

    /// Creates a folder with a file in it.
    pub fn with(name: &str, content: impl AsRef<[u8]>) -> Self {
        let folder = Self::new();
        folder.write(name, content);
        folder
    }

    pub fn path(&self) -> &Path {
        self.0.path()
    }

    pub fn path_of(&self, name: impl AsRef<Path>) -> PathBuf {
        self.path().join(name)
    }

    /// Writes a file and creates missing parent folders.
    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        let path = self.path_of(name);
        fs::create_dir_all(path.parent().expect("a file stands in a folder")).expect("folders can be made");
        fs::write(path, content).expect("files can be written");
    }

    pub fn read(&self, name: &str) -> Vec<u8> {
        fs::read(self.path_of(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    /// Returns the sorted names in the folder.
    pub fn file_names(&self) -> Vec<String> {
        let entries = fs::read_dir(self.path()).expect("the folder can be read");
        let name = |entry: fs::DirEntry| entry.file_name().to_string_lossy().into_owned();
        let mut names: Vec<String> = entries.map(|entry| name(entry.expect("an entry can be read"))).collect();
        names.sort();
        names
    }
}

impl Answer {
    /// Asserts that the command failed with this text on stderr and nothing on stdout.
    pub fn assert_refused(&self, code: i32, stderr: &str) {
        assert_eq!(self.stderr, stderr);
        assert_eq!((self.code, &*self.stdout), (Some(code), ""));
    }
}

/// Runs `render` in a folder, with a stderr that is not a terminal.
pub fn render(folder: &Folder, arguments: &[&str]) -> Answer {
    let mut command = Command::new(env!("CARGO_BIN_EXE_render"));
    let output = command.current_dir(folder.path()).args(arguments).output().expect("the command can be started");
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("messages are UTF-8");
    Answer { code: output.status.code(), stdout: text(output.stdout), stderr: text(output.stderr) }
}
