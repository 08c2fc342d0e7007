//! Links between documents lead to files and headings that exist, and so do paths of documents in comments.

use std::fs;
use std::path::{Path, PathBuf};

/// Folders that hold no documents or sources of ours.
const SKIPPED: [&str; 4] = ["target", "node_modules", ".git", "traces"];

/// Words that readers search for. `docs/README.md` names the page that explains each.
const TOPICS: [&str; 13] = [
    "backpressure",
    "bandwidth",
    "bottleneck",
    "breakdown",
    "infinite",
    "initiation interval",
    "latency",
    "occupancy",
    "Pareto",
    "speedup",
    "stall",
    "throughput",
    "utilization",
];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap()
}

/// Files with one of these extensions, below a folder.
fn files(folder: &Path, extensions: &[&str]) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for path in fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        if path.is_dir() && !SKIPPED.contains(&&*name) {
            found.extend(files(&path, extensions));
        } else if path.extension().is_some_and(|e| extensions.contains(&&*e.to_string_lossy())) {
            found.push(path);
        }
    }
    found
}

/// Lines outside of fenced blocks.
fn prose(text: &str) -> Vec<&str> {
    let mut fenced = false;
    let outside = |line: &&str| {
        let fence = line.trim_start().starts_with("```");
        fenced ^= fence;
        !fenced && !fence
    };
    text.lines().filter(outside).collect()
}

/// Targets of the links of a document.
fn links(text: &str) -> Vec<String> {
    let targets = |line: &str| -> Vec<String> {
        line.split("](").skip(1).filter_map(|rest| rest.split_once(')')).map(|(target, _)| target.to_owned()).collect()
    };
    prose(text).into_iter().flat_map(targets).filter(|target| !target.contains("://")).collect()
}

/// Anchors of the headings of a document, as GitHub names them.
fn anchors(text: &str) -> Vec<String> {
    let anchor = |heading: &str| -> String {
        let kept = heading.trim().to_lowercase();
        kept.chars().filter(|c| c.is_alphanumeric() || "-_ ".contains(*c)).map(|c| if c == ' ' { '-' } else { c }).collect()
    };
    prose(text).into_iter().filter(|line| line.starts_with('#')).map(|line| anchor(line.trim_start_matches('#'))).collect()
}

#[test]
fn links_between_documents_resolve() {
    for document in files(&root(), &["md"]) {
        let text = fs::read_to_string(&document).unwrap();
        for link in links(&text) {
            let (path, anchor) = link.split_once('#').unwrap_or((&link, ""));
            let target = if path.is_empty() { document.clone() } else { document.parent().unwrap().join(path) };
            assert!(target.exists(), "{}: no file for the link `{link}`", document.display());
            if !anchor.is_empty() && target.extension().is_some_and(|e| e == "md") {
                let headings = anchors(&fs::read_to_string(&target).unwrap());
                assert!(headings.iter().any(|h| h == anchor), "{}: no heading for the link `{link}`", document.display());
            }
        }
    }
}

#[test]
fn document_paths_in_sources_exist() {
    for source in files(&root(), &["rs", "toml", "py", "ts", "mjs", "yml"]) {
        let text = fs::read_to_string(&source).unwrap();
        for rest in text.split("docs/").skip(1) {
            let path: String = rest.chars().take_while(|c| c.is_ascii_alphanumeric() || "-_./".contains(*c)).collect();
            if let Some((path, _)) = path.split_once(".md") {
                let path = format!("docs/{path}.md");
                assert!(root().join(&path).exists(), "{}: `{path}` does not exist", source.display());
            }
        }
    }
}

#[test]
fn decision_records_are_numbered_and_listed() {
    let folder = root().join("docs/adr");
    let index = fs::read_to_string(folder.join("README.md")).unwrap();
    let mut records = files(&folder, &["md"]);
    records.retain(|record| !record.ends_with("README.md"));
    records.sort();
    for (number, record) in (1..).zip(&records) {
        let name = record.file_name().unwrap().to_string_lossy();
        assert!(name.starts_with(&format!("{number:04}-")), "{name}: expected number {number}");
        assert!(fs::read_to_string(record).unwrap().starts_with(&format!("# {number}. ")), "{name}: another number in its title");
        assert!(index.contains(&format!("]({name})")), "{name} is not in the index");
    }
}

#[test]
fn searched_topics_have_a_page_that_explains_them() {
    let folder = root().join("docs");
    let index = fs::read_to_string(folder.join("README.md")).unwrap();
    let (_, topics) = index.split_once("\n## Topics\n").expect("a table of topics");
    for topic in TOPICS {
        let row =
            topics.lines().find(|line| line.contains(topic)).unwrap_or_else(|| panic!("docs/README.md: no row for {topic}"));
        let link = links(row).into_iter().next().expect("a link to a page");
        let page = fs::read_to_string(folder.join(link.split('#').next().unwrap())).unwrap().to_lowercase();
        assert!(page.matches(&topic.to_lowercase()).count() >= 2, "{link} does not explain {topic}");
    }
}
