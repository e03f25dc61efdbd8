//! The files of `src` as the compiler reads them: the items that each one defines and the paths that it uses. Unit
//! tests inside them do not count.

use std::collections::{BTreeMap, BTreeSet};

use proc_macro2::{TokenStream, TokenTree};
use syn::visit::{self, Visit};
use syn::{Attribute, Item, UseTree};

/// The names of a path.
pub type Names = Vec<String>;

/// The properties of a function that the laws check.
pub struct Function {
    pub name: String,
    /// Number of lines from the signature to the closing brace; 0 without a body.
    pub lines: usize,
    /// Whether a parameter is a tuple, or a reference to one.
    pub takes_tuple: bool,
}

/// A file of `src`. Its paths begin at the crate root.
pub struct Source {
    /// Path relative to `src`, such as `shape/mesh.rs`.
    pub path: String,
    /// Module path: shape, mesh for `shape/mesh.rs`; shape for `shape/mod.rs`.
    pub module: Names,
    /// Names of the items at the top level.
    pub items: BTreeSet<String>,
    /// Names that `use` brings into scope, with the paths that they stand for.
    pub uses: BTreeMap<String, Names>,
    /// Modules of this crate that are imported with a glob.
    pub globs: Vec<Names>,
    /// Every path that the file mentions.
    pub paths: BTreeSet<Names>,
    /// Types that have an inherent `impl` here.
    pub impls: BTreeSet<Names>,
    pub functions: Vec<Function>,
}

impl Source {
    pub fn new(path: &str, text: &str) -> Self {
        let syntax = syn::parse_file(text).unwrap_or_else(|error| panic!("{path}: {error}"));
        let mut module: Names = path.trim_end_matches(".rs").split('/').map(str::to_owned).collect();
        if module.last().is_some_and(|last| last == "mod" || last == "lib") {
            module.pop();
        }
        let mut reader = Reader { module: module.clone(), ..Reader::default() };
        reader.visit_file(&syntax);
        let mut source = Self {
            path: path.to_owned(),
            items: syntax.items.iter().filter(|item| !is_test(attributes(item))).filter_map(name_of).collect(),
            globs: reader.globs,
            module,
            uses: BTreeMap::new(),
            paths: BTreeSet::new(),
            impls: BTreeSet::new(),
            functions: reader.functions,
        };
        for (alias, written) in reader.uses {
            if let Some(path) = source.absolute(&written) {
                source.paths.insert(path.clone());
                source.uses.insert(alias, path);
            }
        }
        source.paths.extend(
            reader
                .paths
                .iter()
                .filter(|path| path.names.len() > 1)
                .filter_map(|path| source.absolute(path))
                .collect::<Vec<_>>(),
        );
        source.impls.extend(reader.impls.iter().filter_map(|path| source.absolute(path)).collect::<Vec<_>>());
        source
    }

    /// Returns a path from the crate root. Returns none for paths of other crates, of generics and of the prelude.
    fn absolute(&self, written: &WrittenPath) -> Option<Names> {
        let names = &written.names;
        let ups = names.iter().take_while(|name| *name == "super").count();
        let (start, rest) = match names[0].as_str() {
            "crate" | "abbe" => (Names::new(), &names[1..]),
            "self" => (written.module.clone(), &names[1..]),
            "super" => (written.module[..written.module.len().saturating_sub(ups)].to_vec(), &names[ups..]),
            name if self.uses.contains_key(name) => (self.uses[name].clone(), &names[1..]),
            name if self.items.contains(name) => (self.module.clone(), &names[..]),
            _ => return None,
        };
        Some([&start, rest].concat())
    }
}

/// A path as written, with the module that it appears in.
struct WrittenPath {
    module: Names,
    names: Names,
}

/// Collects the paths, imports, impls and functions of a file.
#[derive(Default)]
struct Reader {
    module: Names,
    globs: Vec<Names>,
    uses: Vec<(String, WrittenPath)>,
    paths: Vec<WrittenPath>,
    impls: Vec<WrittenPath>,
    functions: Vec<Function>,
}

impl Reader {
    fn written(&self, names: Names) -> WrittenPath {
        WrittenPath { module: self.module.clone(), names }
    }

    fn collect_imports(&mut self, tree: &UseTree, before: &Names) {
        let (name, alias) = match tree {
            UseTree::Group(group) => return group.items.iter().for_each(|tree| self.collect_imports(tree, before)),
            UseTree::Path(path) => {
                return self.collect_imports(&path.tree, &[&before[..], &[path.ident.to_string()]].concat());
            }
            UseTree::Glob(_) if ["crate", "super", "self", "abbe"].contains(&before[0].as_str()) => {
                return self.globs.push(before.clone());
            }
            UseTree::Glob(_) => return,
            UseTree::Name(name) => (name.ident.to_string(), name.ident.to_string()),
            UseTree::Rename(rename) => (rename.ident.to_string(), rename.rename.to_string()),
        };
        let mut names = before.clone();
        if name != "self" {
            names.push(name.clone());
        }
        let alias = if alias == "self" { names.last().expect("a name").clone() } else { alias };
        let written = self.written(names);
        self.uses.push((alias, written));
    }

    /// Collects the paths in a macro, which has a grammar of its own.
    fn tokens(&mut self, tokens: TokenStream) {
        let (mut names, mut colons) = (Names::new(), 0);
        for token in tokens.into_iter().map(Some).chain([None]) {
            match token {
                Some(TokenTree::Punct(mark)) if mark.as_char() == ':' && !names.is_empty() => colons += 1,
                Some(TokenTree::Ident(name)) if colons == 2 => {
                    names.push(name.to_string());
                    colons = 0;
                }
                token => {
                    if names.len() > 1 {
                        let written = self.written(std::mem::take(&mut names));
                        self.paths.push(written);
                    }
                    (names, colons) = (Names::new(), 0);
                    match token {
                        Some(TokenTree::Ident(name)) => names.push(name.to_string()),
                        Some(TokenTree::Group(group)) => self.tokens(group.stream()),
                        _ => {}
                    }
                }
            }
        }
    }

    fn function(&mut self, signature: &syn::Signature, block: Option<&syn::Block>) {
        let lines = block
            .map_or(0, |block| block.brace_token.span.close().end().line + 1 - signature.fn_token.span.start().line);
        let takes_tuple = signature.inputs.iter().any(is_tuple);
        self.functions.push(Function { name: signature.ident.to_string(), lines, takes_tuple });
    }
}

impl Visit<'_> for Reader {
    fn visit_item(&mut self, item: &Item) {
        if !is_test(attributes(item)) {
            visit::visit_item(self, item);
        }
    }

    fn visit_item_mod(&mut self, module: &syn::ItemMod) {
        self.module.push(module.ident.to_string());
        visit::visit_item_mod(self, module);
        self.module.pop();
    }

    fn visit_item_use(&mut self, item: &syn::ItemUse) {
        self.collect_imports(&item.tree, &Names::new());
    }

    fn visit_path(&mut self, path: &syn::Path) {
        let written = self.written(names(path));
        self.paths.push(written);
        visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, call: &syn::Macro) {
        self.visit_path(&call.path);
        self.tokens(call.tokens.clone());
    }

    fn visit_item_impl(&mut self, item: &syn::ItemImpl) {
        if let (None, syn::Type::Path(of)) = (&item.trait_, &*item.self_ty) {
            let written = self.written(names(&of.path));
            self.impls.push(written);
        }
        visit::visit_item_impl(self, item);
    }

    fn visit_item_fn(&mut self, item: &syn::ItemFn) {
        self.function(&item.sig, Some(&item.block));
        visit::visit_item_fn(self, item);
    }

    fn visit_impl_item_fn(&mut self, item: &syn::ImplItemFn) {
        if !is_test(&item.attrs) {
            self.function(&item.sig, Some(&item.block));
            visit::visit_impl_item_fn(self, item);
        }
    }

    fn visit_trait_item_fn(&mut self, item: &syn::TraitItemFn) {
        self.function(&item.sig, item.default.as_ref());
        visit::visit_trait_item_fn(self, item);
    }
}

fn is_tuple(input: &syn::FnArg) -> bool {
    let syn::FnArg::Typed(input) = input else { return false };
    let mut of = &*input.ty;
    while let syn::Type::Reference(reference) = of {
        of = &reference.elem;
    }
    matches!(of, syn::Type::Tuple(tuple) if !tuple.elems.is_empty())
}

fn names(path: &syn::Path) -> Names {
    path.segments.iter().map(|segment| segment.ident.to_string()).collect()
}

fn attributes(item: &Item) -> &[Attribute] {
    match item {
        Item::Fn(item) => &item.attrs,
        Item::Impl(item) => &item.attrs,
        Item::Mod(item) => &item.attrs,
        Item::Use(item) => &item.attrs,
        _ => &[],
    }
}

/// Returns whether `#[cfg(test)]` is among the attributes.
fn is_test(attributes: &[Attribute]) -> bool {
    let is_test_cfg = |one: &Attribute| one.parse_args::<syn::Path>().is_ok_and(|condition| condition.is_ident("test"));
    attributes.iter().any(|one| one.path().is_ident("cfg") && is_test_cfg(one))
}

fn name_of(item: &Item) -> Option<String> {
    let ident = match item {
        Item::Const(item) => &item.ident,
        Item::Enum(item) => &item.ident,
        Item::Fn(item) => &item.sig.ident,
        Item::Macro(item) => item.ident.as_ref()?,
        Item::Mod(item) => &item.ident,
        Item::Static(item) => &item.ident,
        Item::Struct(item) => &item.ident,
        Item::Trait(item) => &item.ident,
        Item::Type(item) => &item.ident,
        Item::Union(item) => &item.ident,
        _ => return None,
    };
    Some(ident.to_string())
}
