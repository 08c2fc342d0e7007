//! Circles of files: modules of a crate that use each other, directly or through others.
//!
//! The nodes are the files of a crate's `src`, without tests. File A uses file B if A names an item that B defines, in a `use` or in
//! a path. A re-export is followed to the file that defines the item. A parent module that declares (`mod`) or re-exports (`pub use`)
//! its children lists them and does not use them. A private `use` of a child is a use, and so is a child's `super::Item`: a parent
//! that uses its child and a child that uses its parent are a circle.

use proc_macro2::{Delimiter, TokenStream, TokenTree};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// A module by the names that lead to it from the root of its crate, which is empty.
type ModulePath = Vec<String>;

/// One file.
#[derive(Default)]
struct Module {
    file: PathBuf,
    /// Names of the items that it defines.
    items: BTreeSet<String>,
    /// Names that it imports, with their full paths. `*` cannot be a key: globs are apart.
    imports: BTreeMap<String, Vec<String>>,
    globs: Vec<Vec<String>>,
    /// Paths that it names: imports that are no re-exports, and all others.
    paths: Vec<Vec<String>>,
    /// Child modules that are files of their own.
    children: Vec<String>,
}

/// All files of a crate.
struct Crate {
    modules: BTreeMap<ModulePath, Module>,
}

/// Reads the tokens of a file into a [`Module`].
struct Reader<'a> {
    module: &'a mut Module,
    /// Only items at the top level of the file are its items.
    depth: usize,
}

const ITEM_KEYWORDS: [&str; 8] = ["fn", "struct", "enum", "trait", "type", "const", "static", "union"];

fn ident(token: Option<&TokenTree>) -> Option<String> {
    match token? {
        TokenTree::Ident(ident) => Some(ident.to_string()),
        _ => None,
    }
}

fn is_punct(token: Option<&TokenTree>, wanted: char) -> bool {
    matches!(token, Some(TokenTree::Punct(punct)) if punct.as_char() == wanted)
}

fn is_path_separator(tokens: &[TokenTree]) -> bool {
    is_punct(tokens.first(), ':') && is_punct(tokens.get(1), ':')
}

fn group(token: Option<&TokenTree>) -> Option<(Delimiter, TokenStream)> {
    match token? {
        TokenTree::Group(group) => Some((group.delimiter(), group.stream())),
        _ => None,
    }
}

impl Reader<'_> {
    fn read(&mut self, stream: TokenStream) {
        let tokens: Vec<TokenTree> = stream.into_iter().collect();
        let mut at = 0;
        while at < tokens.len() {
            at += self.read_one(&tokens, at);
        }
    }

    /// Reads what begins at `at` and returns the number of its tokens.
    fn read_one(&mut self, tokens: &[TokenTree], at: usize) -> usize {
        let rest = &tokens[at..];
        if is_punct(rest.first(), '#') && group(rest.get(1)).is_some_and(|(_, attribute)| is_test_only(attribute)) {
            return 2 + item_length(&rest[2..]);
        }
        if let Some((_, inner)) = group(rest.first()) {
            self.depth += 1;
            self.read(inner);
            self.depth -= 1;
            return 1;
        }
        let Some(word) = ident(rest.first()) else { return 1 };
        if word == "use" {
            return self.read_use(tokens, at);
        }
        if word == "mod" && is_punct(rest.get(2), ';') {
            self.module.children.extend(ident(rest.get(1)));
            return 3;
        }
        if self.depth == 0
            && ITEM_KEYWORDS.contains(&word.as_str())
            && let Some(name) = ident(rest.get(1))
        {
            self.module.items.insert(name);
            return 2;
        }
        let before = at.checked_sub(1).and_then(|before| tokens.get(before));
        self.read_path(rest, before)
    }

    fn read_path(&mut self, tokens: &[TokenTree], before: Option<&TokenTree>) -> usize {
        let (mut path, mut length) = (vec![], 0);
        while let Some(name) = ident(tokens.get(length)) {
            path.push(name);
            length += 1;
            if !is_path_separator(&tokens[length..]) {
                break;
            }
            length += 2;
        }
        let [first, rest @ ..] = &path[..] else { return 1 };
        let is_called = matches!(group(tokens.get(length)), Some((Delimiter::Parenthesis, _)));
        let is_item = !rest.is_empty() || first.starts_with(char::is_uppercase) || is_called;
        // `$crate::invariants::x` is a path of the crate that calls the macro, as far as files are concerned; `.x()` is a method.
        let is_other = is_punct(before, '$') || is_punct(before, '.') || ident(before).is_some_and(|word| word == "fn");
        if is_item && !is_other {
            self.module.paths.push(path);
        }
        length
    }

    /// Reads `use a::{b, c as d, e::*};`.
    fn read_use(&mut self, tokens: &[TokenTree], at: usize) -> usize {
        let end = tokens[at..].iter().position(|token| is_punct(Some(token), ';')).unwrap_or(tokens.len() - at - 1);
        let before = at.checked_sub(1).and_then(|before| tokens.get(before));
        let restricted = matches!(group(before), Some((Delimiter::Parenthesis, _)));
        let is_public = restricted || ident(before).is_some_and(|word| word == "pub");
        self.read_tree(&tokens[at + 1..at + end], &[], is_public);
        end + 1
    }

    fn read_tree(&mut self, tokens: &[TokenTree], prefix: &[String], is_public: bool) {
        let (mut path, mut at) = (prefix.to_vec(), 0);
        while let Some(name) = ident(tokens.get(at)) {
            path.push(name);
            at += 1;
            if !is_path_separator(&tokens[at..]) {
                break;
            }
            at += 2;
        }
        if let Some((_, inner)) = group(tokens.get(at)) {
            let inner: Vec<TokenTree> = inner.into_iter().collect();
            inner.split(|token| is_punct(Some(token), ',')).for_each(|tree| self.read_tree(tree, &path, is_public));
            return;
        }
        if path.is_empty() {
            return;
        }
        if path.last().is_some_and(|name| name == "self") {
            path.pop();
        }
        if !is_public {
            self.module.paths.push(path.clone());
        }
        if is_punct(tokens.get(at), '*') {
            self.module.globs.push(path);
        } else {
            let renamed = ident(tokens.get(at)).filter(|word| word == "as").and_then(|_| ident(tokens.get(at + 1)));
            let name = renamed.or_else(|| path.last().cloned()).unwrap_or_default();
            self.module.imports.insert(name, path);
        }
    }
}

fn is_test_only(attribute: TokenStream) -> bool {
    matches!(attribute.to_string().replace(' ', "").as_str(), "[cfg(test)]" | "cfg(test)")
}

/// Tokens of the item that comes first: up to its braces or semicolon.
fn item_length(tokens: &[TokenTree]) -> usize {
    let ends = |token: &TokenTree| is_punct(Some(token), ';') || matches!(group(Some(token)), Some((Delimiter::Brace, _)));
    tokens.iter().position(ends).map_or(tokens.len(), |last| last + 1)
}

impl Crate {
    fn read(source: &Path) -> Self {
        let mut modules = BTreeMap::new();
        let root = ["lib.rs", "main.rs"].map(|name| source.join(name)).into_iter().find(|path| path.exists());
        if let Some(root) = root {
            Self::read_module(&root, source, vec![], &mut modules);
        }
        Self { modules }
    }

    /// Reads a module and its children, which lie in `folder`.
    fn read_module(file: &Path, folder: &Path, path: ModulePath, modules: &mut BTreeMap<ModulePath, Module>) {
        let tokens: TokenStream = crate::invariants::read(file).parse().unwrap_or_else(|e| panic!("{}: {e}", file.display()));
        let mut module = Module { file: file.to_owned(), ..Module::default() };
        Reader { module: &mut module, depth: 0 }.read(tokens);
        for child in module.children.clone() {
            let inner = folder.join(&child);
            let candidates = [folder.join(format!("{child}.rs")), inner.join("mod.rs")];
            if let Some(file) = candidates.iter().find(|path| path.exists()) {
                Self::read_module(file, &inner, [path.clone(), vec![child]].concat(), modules);
            }
        }
        modules.insert(path, module);
    }

    /// The module that defines the item of a path named in module `from`; `None` for the items of other crates.
    fn definer(&self, from: &ModulePath, path: &[String], depth: usize) -> Option<ModulePath> {
        // Imports may name each other in a circle by way of globs.
        let (first, rest) = path.split_first().filter(|_| depth < 32)?;
        let module = &self.modules[from];
        match first.as_str() {
            "crate" => return self.definer_or_self(&vec![], rest, depth),
            "self" => return self.definer_or_self(from, rest, depth),
            "super" => return self.definer_or_self(&from[..from.len().checked_sub(1)?].to_vec(), rest, depth),
            _ => {}
        }
        let child = [from.clone(), vec![first.clone()]].concat();
        if self.modules.contains_key(&child) {
            return self.definer_or_self(&child, rest, depth);
        }
        if module.items.contains(first) {
            return Some(from.clone());
        }
        if let Some(import) = module.imports.get(first).filter(|import| import.first() != Some(first)) {
            return self.definer(from, &[import.as_slice(), rest].concat(), depth + 1);
        }
        let in_globs = module.globs.iter().filter(|glob| glob.as_slice() != path);
        in_globs.filter_map(|glob| self.definer(from, &[glob.as_slice(), path].concat(), depth + 1)).next()
    }

    /// As [`Self::definer`]; the module itself if nothing is named in it, or if what is named cannot be found, as after a macro.
    fn definer_or_self(&self, module: &ModulePath, rest: &[String], depth: usize) -> Option<ModulePath> {
        if rest.is_empty() {
            return Some(module.clone());
        }
        self.definer(module, rest, depth + 1).or_else(|| Some(module.clone()))
    }

    /// The modules that each module uses, each with one of the paths that name it.
    fn uses(&self) -> Uses<'_> {
        let used = |from: &ModulePath, module: &Module| {
            let definers = module.paths.iter().filter_map(|path| Some((self.definer(from, path, 0)?, path.join("::"))));
            let others = definers.filter(|(used, _)| used != from);
            others.filter_map(|(used, path)| Some((self.modules.get_key_value(&used)?.0, path))).collect()
        };
        self.modules.iter().map(|(path, module)| (path, used(path, module))).collect()
    }

    fn file(&self, module: &ModulePath, source: &Path) -> String {
        self.modules[module].file.strip_prefix(source).unwrap_or(source).display().to_string()
    }
}

type Uses<'a> = BTreeMap<&'a ModulePath, BTreeMap<&'a ModulePath, String>>;

/// Modules that can be reached from one, by use.
fn reach<'a>(uses: &Uses<'a>, from: &'a ModulePath) -> BTreeSet<&'a ModulePath> {
    let (mut found, mut left) = (BTreeSet::new(), vec![from]);
    while let Some(module) = left.pop() {
        left.extend(uses[module].keys().filter(|used| found.insert(**used)));
    }
    found
}

/// The circles of a crate whose sources lie in `source`: for each strongly connected component of more than one file, a text that
/// lists which of its files uses which, and by which path.
pub fn circles(source: &Path) -> BTreeSet<String> {
    let sources = Crate::read(source);
    let uses = sources.uses();
    let reached: BTreeMap<&ModulePath, _> = uses.keys().map(|module| (*module, reach(&uses, module))).collect();
    let circle_of = |module: &ModulePath| -> BTreeSet<&ModulePath> {
        reached[module].iter().copied().filter(|other| reached[*other].contains(module)).collect()
    };
    let components: BTreeSet<_> = sources.modules.keys().map(circle_of).filter(|circle| circle.len() > 1).collect();
    let edges = |circle: &BTreeSet<&ModulePath>| -> String {
        let inside = |from: &ModulePath| uses[from].clone().into_iter().filter(|(to, _)| circle.contains(to)).collect::<Vec<_>>();
        let line = |from: &ModulePath, to: &ModulePath, path: &str| {
            format!("\n  {} uses {}: {path}", sources.file(from, source), sources.file(to, source))
        };
        circle.iter().flat_map(|from| inside(from).into_iter().map(|(to, path)| line(from, to, &path))).collect()
    };
    components.iter().map(edges).collect()
}
