//! `docs/reference/claims.csv` lists the tests of each claim of the patents. It is generated from comments above the tests.
//!
//! A comment has the form "Claim: SUBJECT, PLACE: STATEMENT." after two slashes, on as many lines as it needs. Other tests of the
//! same claim refer to the first one: "Claim: as NAME_OF_THE_FIRST_TEST." To regenerate the table, run `tools/dev claims`.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

const TABLE: &str = "docs/reference/claims.csv";
const MARK: &str = "// Claim: ";
/// Subjects in the order of the table.
const SUBJECTS: [&str; 8] = ["bump", "shade", "texel", "defer", "laws", "trace", "images", "analysis"];

/// Claim comment of one test.
#[derive(Clone)]
struct ClaimedTest {
    text: String,
    /// File and name of the test.
    test: String,
}

/// Adds the Rust files below a folder.
fn rust_files(folder: &Path, found: &mut Vec<PathBuf>) {
    for path in std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
        if path.is_dir() && !path.ends_with("target") {
            rust_files(&path, found);
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
}

/// Returns the claim comments of a file, in order. Panics if one is above a function that is no test.
fn claims_in(file: &str, text: &str) -> Vec<ClaimedTest> {
    let (mut found, mut pending, mut is_test) = (Vec::new(), Vec::<String>::new(), false);
    for line in text.lines().map(str::trim) {
        if let Some(begin) = line.strip_prefix(MARK) {
            pending.push(begin.to_owned());
        } else if let (Some(claim), Some(more)) = (pending.last_mut(), line.strip_prefix("// ")) {
            *claim += &format!(" {more}");
        } else if line == "#[test]" {
            is_test = true;
        } else if let Some((_, name)) = line.split_once("fn ").filter(|_| !line.starts_with("//")) {
            let name = name.split('(').next().unwrap_or_default();
            assert!(is_test || pending.is_empty(), "{file}: `{name}` has a claim but is no test");
            let claim =
                |text: String| ClaimedTest { text: text.trim_end_matches('.').to_owned(), test: format!("{file}::{name}") };
            found.extend(pending.drain(..).map(claim));
            is_test = false;
        }
    }
    found
}

/// Returns a place with numbers of equal length, so that places sort by number.
fn sort_key(place: &str) -> String {
    let digits = |c: char| c.is_ascii_digit();
    let mut rest = place;
    let mut key = String::new();
    while let Some(at) = rest.find(digits) {
        let end = rest[at..].find(|c| !digits(c)).map_or(rest.len(), |length| at + length);
        key += &format!("{}{:0>6}", &rest[..at], &rest[at..end]);
        rest = &rest[end..];
    }
    key + rest
}

/// Returns the table. Panics if a reference names no first test, or several.
fn table(claims: &[ClaimedTest]) -> String {
    let (references, firsts): (Vec<_>, Vec<_>) = claims.iter().partition(|claim| claim.text.starts_with("as "));
    let mut others: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for reference in references {
        let name = &reference.text["as ".len()..];
        let named: Vec<_> = firsts.iter().filter(|first| first.test.ends_with(&format!("::{name}"))).collect();
        assert_eq!(named.len(), 1, "{}: `Claim: as {name}` must name the first test of one claim", reference.test);
        others.entry(&named[0].test).or_default().push(&reference.test);
    }
    let row = |first: &ClaimedTest| {
        let (head, statement) =
            first.text.split_once(": ").unwrap_or_else(|| panic!("{}: a claim without statement", first.test));
        let (subject, place) = head.split_once(", ").unwrap_or((head, ""));
        let order = SUBJECTS.iter().position(|s| *s == subject).unwrap_or_else(|| panic!("{}: subject `{subject}`", first.test));
        let others = others.get(first.test.as_str()).into_iter().flatten().copied();
        let tests = std::iter::once(first.test.as_str()).chain(others).collect::<Vec<_>>().join(" ");
        ((order, sort_key(place), first.test.clone()), [subject, place, statement, &tests].map(str::to_owned))
    };
    let rows: BTreeMap<_, _> = firsts.into_iter().map(row).collect();
    let mut table = csv::Writer::from_writer(Vec::new());
    let heads = ["subject", "place", "shown", "tests"].map(str::to_owned);
    std::iter::once(heads).chain(rows.into_values()).for_each(|row| table.write_record(row).unwrap());
    String::from_utf8(table.into_inner().unwrap()).unwrap()
}

#[test]
fn table_of_claims_matches_comments_of_tests() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap();
    let mut files = Vec::new();
    ["crates", "tests"].iter().for_each(|folder| rust_files(&root.join(folder), &mut files));
    files.sort();
    let claims: Vec<_> = files
        .iter()
        .flat_map(|path| {
            let file = path.strip_prefix(&root).unwrap().to_string_lossy().replace('\\', "/");
            claims_in(&file, &std::fs::read_to_string(path).unwrap())
        })
        .collect();
    let table = table(&claims);
    if std::env::var("INSTA_UPDATE").is_ok_and(|mode| mode == "always") {
        std::fs::write(root.join(TABLE), &table).unwrap();
    }
    let stored = std::fs::read_to_string(root.join(TABLE)).unwrap();
    let stale = table.lines().zip(stored.lines()).find(|(new, old)| new != old).map(|(new, _)| new);
    assert!(table == stored, "{TABLE} is stale: run `tools/dev claims`. First difference: {stale:?}");
}

#[test]
fn reference_joins_the_row_of_the_first_test() {
    let text =
        "// Claim: bump, 1, 7: Two words,\n// two lines.\n#[test]\nfn first() {}\n// Claim: as first.\n#[test]\nfn second() {}\n";
    let table = table(&claims_in("a.rs", text));
    assert_eq!(table, "subject,place,shown,tests\nbump,\"1, 7\",\"Two words, two lines\",a.rs::first a.rs::second\n");
}
