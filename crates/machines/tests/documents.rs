//! Documents: every relative link leads somewhere, and the topics that readers search for have a page.

use std::fs::{read_dir, read_to_string};
use std::path::{Path, PathBuf};

/// Folders that hold no documents of ours.
const SKIPPED: [&str; 4] = ["target", "node_modules", ".git", "corpus"];

/// Words that a reader searches for.
const TOPICS: [&str; 12] = [
    "backpressure",
    "bandwidth",
    "bottleneck",
    "breakdown",
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

/// All Markdown files below a folder.
fn documents(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if path.is_dir() && !SKIPPED.contains(&name.as_str()) {
            documents(&path, found);
        } else if name.ends_with(".md") {
            found.push(path);
        }
    }
}

/// A document without its code blocks.
fn prose(path: &Path) -> String {
    let text = read_to_string(path).unwrap();
    text.split("```").step_by(2).collect()
}

/// Targets of the links and images of a document, without those of the web.
fn links(text: &str) -> impl Iterator<Item = &str> {
    let targets = text.split("](").skip(1).filter_map(|rest| rest.split(')').next());
    targets.filter(|target| !target.contains("://") && !target.starts_with("mailto:"))
}

/// The anchor of a heading, as forges make it.
fn anchor(heading: &str) -> String {
    let kept = heading.trim_start_matches('#').trim().chars().filter(|c| c.is_alphanumeric() || " -_".contains(*c));
    kept.map(|c| if c == ' ' { '-' } else { c.to_ascii_lowercase() }).collect()
}

fn has_anchor(document: &Path, wanted: &str) -> bool {
    prose(document).lines().any(|line| line.starts_with('#') && anchor(line) == wanted)
}

#[test]
fn relative_links_resolve() {
    let mut all = Vec::new();
    documents(&root(), &mut all);
    assert!(all.len() > 20, "{}", all.len());
    for document in all {
        for link in links(&prose(&document)) {
            let (path, fragment) = link.split_once('#').unwrap_or((link, ""));
            let target = if path.is_empty() { document.clone() } else { document.parent().unwrap().join(path) };
            assert!(target.exists(), "{}: {link}: no such file", document.display());
            let checked = !fragment.is_empty() && target.extension().is_some_and(|e| e == "md");
            assert!(!checked || has_anchor(&target, fragment), "{}: {link}: no such heading", document.display());
        }
    }
}

#[test]
fn every_topic_has_a_page_that_explains_it() {
    let folder = root().join("docs");
    let index = prose(&folder.join("README.md"));
    let (_, topics) = index.split_once("\n## Topics\n").expect("a table of topics");
    for topic in TOPICS {
        let row = topics.lines().find(|line| line.starts_with('|') && line.contains(topic));
        let link = row.and_then(|row| links(row).next()).unwrap_or_else(|| panic!("docs/README.md: no row for {topic}"));
        let page = prose(&folder.join(link.split('#').next().unwrap())).to_lowercase();
        assert!(page.matches(&topic.to_lowercase()).count() >= 2, "{link} does not explain {topic}");
    }
}
