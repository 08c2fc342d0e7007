//! Identity of a build: equal sources have equal identities, wherever and whenever they are built.

#[path = "../../build/identity.rs"]
mod identity;

use basrelief_sim::BUILD;
use identity::{OTHER_CRATES, Sources};
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::{TempDir, tempdir};

fn package() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn hash(package: &Path) -> String {
    Sources::around(package).unwrap().hash().unwrap()
}

/// Makes a small workspace and returns its package `sim`.
fn workspace() -> (TempDir, PathBuf) {
    let folder = tempdir().unwrap();
    for name in ["sim", "kernel", "units/rasterizer", "cli"] {
        let place = folder.path().join("crates").join(name);
        fs::create_dir_all(place.join("src")).unwrap();
        fs::create_dir_all(place.join("tests")).unwrap();
        fs::write(place.join("Cargo.toml"), name).unwrap();
        fs::write(place.join("src/lib.rs"), "mod a;").unwrap();
    }
    fs::write(folder.path().join("Cargo.toml"), "[workspace]").unwrap();
    fs::write(folder.path().join("Cargo.lock"), "").unwrap();
    let package = folder.path().join("crates/sim");
    (folder, package)
}

#[test]
fn build_has_hash_of_its_sources() {
    assert_eq!(BUILD, format!("{}+{}", env!("CARGO_PKG_VERSION"), hash(package())));
    // Cargo builds again in vain if it watches a file that does not exist.
    assert!(Sources::around(package()).unwrap().watched.iter().all(|path| path.exists()));
}

#[test]
fn identity_depends_on_neither_path_nor_time() {
    let [(_one, first), (_two, second)] = [workspace(), workspace()];
    let before = hash(&first);
    assert_eq!(before, hash(&second));
    let file = fs::File::options().append(true).open(first.join("src/lib.rs")).unwrap();
    file.set_modified(std::time::SystemTime::UNIX_EPOCH).unwrap();
    assert_eq!(before, hash(&first));
}

#[test]
fn changed_source_gives_another_identity() {
    for (file, counts) in [
        ("crates/kernel/src/lib.rs", true),
        ("crates/units/rasterizer/src/lib.rs", true),
        ("crates/units/rasterizer/Cargo.toml", true),
        ("crates/sim/src/new.rs", true),
        ("Cargo.lock", true),
        ("crates/cli/src/lib.rs", false),
        ("crates/kernel/tests/laws.rs", false),
        ("README.md", false),
    ] {
        let (folder, package) = workspace();
        let before = hash(&package);
        fs::write(folder.path().join(file), "other").unwrap();
        assert_eq!(before != hash(&package), counts, "{file}");
    }
    let (folder, package) = workspace();
    let before = hash(&package);
    fs::rename(folder.path().join("crates/kernel/src/lib.rs"), folder.path().join("crates/kernel/src/main.rs")).unwrap();
    assert_ne!(before, hash(&package));
}

#[test]
fn published_package_has_identity_of_its_own_sources() {
    let (_folder, inside) = workspace();
    let outside = tempdir().unwrap();
    let alone = outside.path().join("src/basrelief-sim-0.1.0");
    fs::create_dir_all(alone.join("src")).unwrap();
    fs::write(alone.join("Cargo.toml"), "sim").unwrap();
    fs::write(alone.join("src/lib.rs"), "mod a;").unwrap();
    let before = hash(&alone);
    assert_ne!(before, hash(&inside));
    fs::write(alone.join("src/lib.rs"), "mod b;").unwrap();
    assert_ne!(before, hash(&alone));
}

#[test]
fn crates_below_the_simulator_count() {
    let crates = package().join("..");
    let mut open = vec!["sim".to_owned()];
    while let Some(name) = open.pop() {
        assert!(!OTHER_CRATES.contains(&name.as_str()), "`{name}` must count");
        let manifest = ["", "units"].map(|folder| crates.join(folder).join(&name).join("Cargo.toml"));
        let text = manifest.iter().find_map(|path| fs::read_to_string(path).ok()).unwrap();
        let needed = text.split("[dev-dependencies]").next().unwrap_or_default().lines();
        open.extend(needed.filter_map(|line| line.strip_prefix("basrelief-")?.split(['.', ' ']).next()).map(str::to_owned));
    }
    for name in OTHER_CRATES {
        assert!(crates.join(name).is_dir(), "`{name}` is no crate");
    }
}
