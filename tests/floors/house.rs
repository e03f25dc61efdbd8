//! Which files use which, and the cycles among them.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::LazyLock;

use super::source::{Names, Source};
use crate::support::repository::texts;

/// All files, and the file of each module.
pub struct SourceTree {
    pub files: Vec<Source>,
    modules: BTreeMap<Names, usize>,
}

/// The files that each file uses, with one used name for each.
pub type Graph = Vec<BTreeMap<usize, String>>;

impl SourceTree {
    pub fn new(texts: &BTreeMap<String, String>) -> Self {
        let mut files: Vec<Source> = texts.iter().map(|(path, text)| Source::new(path, text)).collect();
        let declared: BTreeSet<Names> = files
            .iter()
            .flat_map(|file| file.items.iter().map(|item| [&file.module[..], std::slice::from_ref(item)].concat()))
            .collect();
        files.retain(|file| file.module.len() < 2 || declared.contains(&file.module));
        let modules = files.iter().enumerate().map(|(index, file)| (file.module.clone(), index)).collect();
        Self { files, modules }
    }

    /// Returns the file that defines the item at a path, following re-exports by `use`. Returns none if the path leads
    /// to a module.
    pub fn defining_file(&self, path: &[String]) -> Option<usize> {
        let inside = (0..path.len())
            .rev()
            .find_map(|length| self.modules.get(&path[..length]).map(|file| (*file, &path[length..])));
        let (file, rest) = inside?;
        let (name, after) = rest.split_first()?;
        let source = &self.files[file];
        let is_module = self.modules.contains_key(&[&source.module[..], std::slice::from_ref(name)].concat());
        if source.items.contains(name) && !is_module {
            return Some(file);
        }
        let own_path = &path[..path.len() - after.len()];
        let handed = source.uses.get(name).filter(|handed| handed[..] != *own_path)?;
        self.defining_file(&[handed, after].concat())
    }

    pub fn graph(&self) -> Graph {
        let edges = |(index, source): (usize, &Source)| {
            let mut edges = BTreeMap::new();
            for path in &source.paths {
                if let Some(defining_file) = self.defining_file(path).filter(|defining_file| *defining_file != index) {
                    edges.entry(defining_file).or_insert_with(|| path.join("::"));
                }
            }
            edges
        };
        self.files.iter().enumerate().map(edges).collect()
    }
}

/// Returns the files that can be reached from a file.
fn reach(graph: &Graph, from: usize) -> BTreeSet<usize> {
    let (mut reached, mut pending) = (BTreeSet::new(), vec![from]);
    while let Some(file) = pending.pop() {
        pending.extend(graph[file].keys().filter(|next| reached.insert(**next)));
    }
    reached
}

/// Returns the largest sets of files in which each file uses all the others, directly or indirectly.
pub fn cycles(graph: &Graph) -> Vec<BTreeSet<usize>> {
    let reached: Vec<BTreeSet<usize>> = (0..graph.len()).map(|file| reach(graph, file)).collect();
    let cycle = |file: usize| -> BTreeSet<usize> {
        reached[file].iter().copied().filter(|other| reached[*other].contains(&file)).collect()
    };
    let found: BTreeSet<BTreeSet<usize>> = (0..graph.len()).map(cycle).filter(|cycle| !cycle.is_empty()).collect();
    found.into_iter().collect()
}

/// Returns the texts of `src`, which are read once.
pub fn source_texts() -> &'static BTreeMap<String, String> {
    static TEXTS: LazyLock<BTreeMap<String, String>> =
        LazyLock::new(|| texts(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src")));
    &TEXTS
}

/// Asserts that a law's findings are exactly its listed exceptions.
pub fn assert_exactly(name: &str, exceptions: &[&str], found: BTreeSet<String>, why: &str) {
    let lines: Vec<String> = found.iter().map(|one| format!("    {one:?},\n")).collect();
    let equal = found.iter().eq(exceptions);
    assert!(equal, "{why}\nThe exceptions would have to be\n\nconst {name}: &[&str] = &[\n{}];\n", lines.concat());
}
