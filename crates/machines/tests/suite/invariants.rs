//! Invariants of absence: what must not be in the tree. ARCHITECTURE.md lists them.

use std::path::{Path, PathBuf};

mod circles;

/// The folder of the unit crates, in `crates`; in the drawing of ARCHITECTURE.md, all of them.
const UNITS: &str = "units";

/// Crates that compute: no I/O, no clock, no global state, nothing printed. So do the units.
const PURE: &[&str] = &["parameters", "kernel", "signals", "shading", "machines"];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// Crates directly in this folder, by name.
fn packages_in(folder: &Path) -> Vec<String> {
    let folders = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap());
    let mut names: Vec<String> =
        folders.filter(|f| f.path().join("Cargo.toml").exists()).map(|f| f.file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// All unit crates.
fn units() -> Vec<String> {
    packages_in(&root().join("crates").join(UNITS))
}

/// All crates of the workspace.
fn crates() -> Vec<String> {
    [packages_in(&root().join("crates")), units()].concat()
}

/// Those that compute.
fn pure() -> Vec<String> {
    PURE.iter().map(|name| (*name).to_owned()).chain(units()).collect()
}

/// Returns the folder of a crate.
fn folder(name: &str) -> PathBuf {
    let unit = root().join("crates").join(UNITS).join(name);
    if unit.exists() { unit } else { root().join("crates").join(name) }
}

/// Our own crates that a crate depends on.
fn dependencies(name: &str) -> Vec<String> {
    let manifest: toml::Table = read(&folder(name).join("Cargo.toml")).parse().unwrap();
    let keys = manifest.get("dependencies").and_then(|d| d.as_table()).into_iter().flat_map(|d| d.keys());
    keys.filter_map(|key| key.strip_prefix("basrelief-")).map(str::to_owned).collect()
}

/// The boxes of the drawing of crates in ARCHITECTURE.md, lowest first, each with its words. Tests, which ship nothing, may use
/// any crate that the graph allows.
fn floors() -> Vec<Vec<String>> {
    let text = read(&root().join("ARCHITECTURE.md"));
    let boxes = text.lines().filter_map(|line| line.strip_prefix(" | ")?.rsplit_once('|'));
    let words = |(inside, _): (&str, &str)| inside.split([' ', '|']).map(str::to_owned).collect();
    boxes.map(words).collect::<Vec<_>>().into_iter().rev().collect()
}

fn floor(name: &str) -> usize {
    let is_unit = units().iter().any(|unit| unit == name);
    let word = if is_unit { format!("{UNITS}/*") } else { name.to_owned() };
    let found = floors().iter().position(|floor| floor.contains(&word));
    found.unwrap_or_else(|| panic!("`{name}` is missing in the drawing of ARCHITECTURE.md"))
}

fn rust_files(folder: &Path, files: &mut Vec<PathBuf>) {
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    for path in entries.map(|entry| entry.unwrap().path()) {
        if path.is_dir() {
            rust_files(&path, files);
        } else if path.extension().is_some_and(|e| e == "rs") {
            files.push(path);
        }
    }
}

/// Sources of a crate without their tests: lines with their places, comments left out.
fn code(name: &str) -> Vec<(String, String)> {
    let mut files = Vec::new();
    rust_files(&folder(name).join("src"), &mut files);
    let of_tests = |path: &Path| path.file_stem().is_some_and(|s| s == "tests" || s.to_string_lossy().ends_with("_tests"));
    files.retain(|path| !of_tests(path));
    files.iter().flat_map(|path| lines(path)).collect()
}

/// A file up to its module of tests.
fn lines(path: &Path) -> Vec<(String, String)> {
    let text = read(path);
    let end = text.find("#[cfg(test)]\nmod tests {").unwrap_or(text.len());
    // A cursor over bytes in memory does no I/O.
    let says_nothing = |line: &str| line.trim_start().starts_with("//") || line == "use std::io::Cursor;";
    let code = (1..).zip(text[..end].lines()).filter(|(_, line)| !says_nothing(line));
    code.map(|(n, line)| (format!("{}:{n}", path.display()), line.to_owned())).collect()
}

/// Fails if a crate's code says any of these.
fn absent(crates: &[String], words: &[&str]) {
    for (place, line) in crates.iter().flat_map(|name| code(name)) {
        if let Some(word) = words.iter().find(|word| line.contains(**word)) {
            panic!("{place}: `{word}` must not be here: {line}");
        }
    }
}

#[test]
fn crates_depend_only_on_lower_floors() {
    for name in crates() {
        for used in dependencies(&name) {
            assert!(floor(&used) < floor(&name), "`{name}` uses `{used}`, which is not on a lower floor");
        }
    }
}

#[test]
fn no_files_use_each_other_in_a_circle() {
    let circles_of = |name: &String| circles::circles(&folder(name).join("src"));
    let found = crates().into_iter().flat_map(|name| circles_of(&name).into_iter().map(move |text| (name.clone(), text)));
    let text: String = found.map(|(name, circle)| format!("\n`{name}` has a circle of files:{circle}")).collect();
    assert!(text.is_empty(), "{text}\nMove the shared items into a file that both use.");
}

#[test]
fn no_unit_crate_depends_on_another() {
    let units = units();
    assert!(units.len() >= 10, "{units:?}");
    for name in &units {
        for used in dependencies(name) {
            assert!(!units.contains(&used), "unit `{name}` uses unit `{used}`");
        }
    }
}

#[test]
fn reference_shares_no_code_with_the_units() {
    assert_eq!(dependencies("reference"), ["signals", "threads"]);
}

#[test]
fn the_kernel_knows_no_graphics() {
    assert_eq!(dependencies("kernel"), ["parameters"]);
    // Nor do its words, comments and documentation included.
    let words = [
        "texel", "pixel", "fragment", "frame", "video", "z-test", "early z", " mip", "clut", "scene", "light", "picture",
        "polygon", "triangle", "vertex", "shad",
    ];
    let mut files = Vec::new();
    rust_files(&folder("kernel").join("src"), &mut files);
    for path in files {
        for (n, line) in (1..).zip(read(&path).lines()) {
            // Steps in flight are no light.
            let said = line.to_lowercase().replace("flight", "");
            let word = words.iter().find(|word| said.contains(**word));
            let allowed = ["knows no graphics"].iter().any(|words| line.contains(words));
            assert!(word.is_none() || allowed, "{}:{n}: `{}` is graphics: {line}", path.display(), word.unwrap_or(&""));
        }
    }
}

#[test]
fn pure_crates_have_no_io_clock_or_global_state() {
    let io = ["std::fs", "std::net", "std::io", "std::time", "std::env", "std::process", "std::thread", "println!", "eprintln!"];
    let state =
        ["thread_local!", "static mut", "OnceLock", "OnceCell", "LazyLock", "LazyCell", "Mutex", "Atomic", "print!", "dbg!"];
    absent(&pure(), &io);
    absent(&pure(), &state);
}

#[test]
fn nothing_is_iterated_in_the_order_of_a_hash() {
    absent(&crates(), &["HashMap", "HashSet"]);
}

#[test]
fn every_platform_computes_the_same_bits() {
    let functions = [
        "sin", "cos", "tan", "sin_cos", "asin", "acos", "atan", "atan2", "sinh", "cosh", "tanh", "exp", "exp2", "exp_m1", "ln",
        "ln_1p", "log", "log2", "log10", "powf", "powi", "cbrt", "hypot", "mul_add",
    ];
    let words: Vec<String> =
        functions.iter().flat_map(|f| [format!(".{f}("), format!("f32::{f}("), format!("f64::{f}(")]).collect();
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let importers = ["trace", "scene", "reference", "report", "timeline", "dse"].map(str::to_owned);
    absent(&[pure(), importers.to_vec()].concat(), &words);
}

/// A function that renames a file to its final name syncs it first, or a power cut can leave an empty file. A rename within a hidden
/// folder is not final.
#[test]
fn functions_that_rename_files_sync_them_first() {
    let mut found = 0;
    for name in crates() {
        let shipped = code(&name).into_iter().filter(|(place, _)| !place.contains("/tests/"));
        let all: Vec<String> = shipped.map(|(_, line)| line).collect();
        let text = all.join("\n").replace("pub fn ", "fn ");
        for function in text.split("fn ").filter(|f| f.contains("fs::rename(") || f.contains(".persist(")) {
            let is_hidden = function.contains("self.partial.join(new_name)");
            let (before, _) = function.split_once("fs::rename(").or_else(|| function.split_once(".persist(")).unwrap();
            assert!(is_hidden || before.contains("sync"), "`{name}`: fn {function}");
            found += 1;
        }
    }
    assert!(found >= 4, "{found}");
}

#[test]
fn only_the_command_line_decides_exit_codes() {
    let libraries: Vec<String> = crates().into_iter().filter(|name| name != "cli").collect();
    absent(&libraries, &["process::exit", "ExitCode", "process::abort"]);
}

#[test]
fn no_test_is_ignored_and_nothing_is_left_to_do() {
    let mut files = Vec::new();
    rust_files(&root().join("crates"), &mut files);
    // Written apart, so that this file does not find itself.
    let words = [["#[ign", "ore"], ["to", "do!("], ["unimpl", "emented!("], ["TO", "DO"], ["FIX", "ME"]].map(|w| w.concat());
    for path in files {
        let text = read(&path);
        for word in &words {
            assert!(!text.contains(word.as_str()), "{}: `{word}`", path.display());
        }
    }
}

/// Without `expecting`, serde reports an internal type name for a value that no variant accepts.
#[test]
fn every_untagged_enum_states_its_expectation() {
    let files = crates().into_iter().flat_map(|name| code(&name));
    let untagged: Vec<String> =
        files.map(|(place, line)| format!("{place}: {line}")).filter(|l| l.contains("serde(untagged")).collect();
    assert!(untagged.len() >= 6, "{untagged:#?}");
    let silent: Vec<&String> = untagged.iter().filter(|line| !line.contains("expecting = ")).collect();
    assert!(silent.is_empty(), "{silent:#?}");
}

#[test]
fn library_code_is_safe() {
    // Names to be called by from WebAssembly count as unsafe; they stand in one file.
    let (names, others): (Vec<String>, Vec<String>) = crates().into_iter().partition(|name| name == "web");
    for (place, line) in names.iter().flat_map(|name| code(name)) {
        assert!(!line.contains("unsafe") || place.contains("abi.rs") && !line.contains("unsafe {"), "{place}: {line}");
    }
    for name in others {
        let manifest: toml::Table = read(&folder(&name).join("Cargo.toml")).parse().unwrap();
        assert_eq!(manifest["lints"]["workspace"].as_bool(), Some(true), "`{name}` keeps the lints of the workspace");
    }
    let workspace: toml::Table = read(&root().join("Cargo.toml")).parse().unwrap();
    assert_eq!(workspace["workspace"]["lints"]["rust"]["unsafe_code"].as_str(), Some("forbid"));
}

/// `DepthTest` as `depth_test`; digits stand alone: `selector_28`.
fn snake(name: &str) -> String {
    let mut out = String::new();
    for (i, c) in name.char_indices() {
        let begins = c.is_uppercase() || (c.is_ascii_digit() && !out.ends_with(|p: char| p.is_ascii_digit()));
        if begins && i > 0 {
            out.push('_');
        }
        out.extend(c.to_lowercase());
    }
    out
}

/// The units of a crate's file: what has an `impl` of `Unit`.
fn units_in(text: &str) -> impl Iterator<Item = &str> {
    let impls = text.lines().filter(|line| line.starts_with("impl")).filter_map(|line| line.split_once(" Unit for "));
    impls.filter_map(|(_, after)| after.split(['<', ' ']).next())
}

#[test]
fn every_unit_states_its_contract_where_all_others_do() {
    for name in units() {
        let places = ["contract.rs", "patent/contract.rs"].map(|file| folder(&name).join("tests").join(file));
        assert!(places.iter().any(|place| place.exists()), "`{name}`: expected one of {places:?}");
        let (mut tests, mut sources) = (Vec::new(), Vec::new());
        rust_files(&folder(&name).join("tests"), &mut tests);
        rust_files(&folder(&name).join("src"), &mut sources);
        // All of them: a wrapper that a contract is stated of may stand beside it.
        let tests: String = tests.iter().map(|file| read(file)).collect();
        for file in sources {
            let text = read(&file);
            assert!(!text.contains("unit_contract!"), "{}: its place is `tests/`", file.display());
            let forgotten = units_in(&text).find(|unit| !tests.contains(unit));
            assert_eq!(forgotten, None, "`{name}`: a unit without contract");
        }
    }
}

/// Units that remember nothing.
const STATELESS: [&str; 1] = ["Expander"];

#[test]
fn every_unit_has_the_same_shape() {
    let mut found = 0;
    for name in units() {
        let mut files = Vec::new();
        rust_files(&folder(&name).join("src"), &mut files);
        let all: String = files.iter().map(|file| read(file)).collect();
        for file in &files {
            let text = read(file);
            for unit in units_in(&text) {
                found += 1;
                let place = file.with_extension("");
                let in_place = place.ends_with("src/unit")
                    || place.ends_with(snake(unit))
                    || place.ends_with(format!("{}/unit", snake(unit)));
                assert!(in_place, "{}: expected {unit} in unit.rs or {}.rs", file.display(), snake(unit));
                let stateless = STATELESS.contains(&unit);
                assert_eq!(text.contains(&format!("pub state: {unit}State,")), !stateless, "{unit}: its field `state`");
                let counts = all.contains(&format!("pub struct {unit}Counters"));
                assert_eq!(all.contains(&format!("pub counters: {unit}Counters,")), counts, "{unit}: its `state.counters`");
                assert!(
                    !text.contains("pub fn state(") && !text.contains("pub fn counters("),
                    "{unit}: a second way to its state"
                );
            }
            let other = text.split("Counters {").next().filter(|t| t.ends_with("pub struct ") || t.ends_with(" struct "));
            assert_eq!(other, None, "{}: Counters of which unit?", file.display());
        }
    }
    assert!(found > 30, "{found}");
}
