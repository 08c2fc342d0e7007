//! `--html`: the report as one page.

use crate::support::Place;
use serde_json::Value;

/// Maximum size of a page with a small picture \[bytes\].
const MOST: usize = 3_000_000;

/// Returns the names in one section of a report, for example its units.
fn names<'a>(report: &'a Value, what: &str) -> impl Iterator<Item = &'a String> {
    report[what].as_object().into_iter().flat_map(|map| map.keys())
}

/// Checks that the page is self-contained: apart from embedded data, it has no external references and no scripts.
fn check_stands_alone(page: &str) {
    for part in page.split('"').filter(|part| !part.starts_with("data:")) {
        for text in ["http:", "https:", "//", "<script", "url(", "@import"] {
            assert!(!part.contains(text), "{text}: {part}");
        }
    }
    assert!(page.len() < MOST, "{} bytes", page.len());
}

/// Returns the titles of the shapes of this class in block diagrams, bottlenecks included.
fn titles<'a>(page: &'a str, class: &str) -> impl Iterator<Item = &'a str> {
    let starts = ["", " limit"].map(|mark| format!("{class}{mark}\"><title>"));
    let shapes =
        page.split("<g class=\"").filter_map(move |rest| starts.iter().find_map(|start| rest.strip_prefix(start.as_str())));
    shapes.filter_map(|rest| rest.split('<').next())
}

#[test]
fn html_report_is_self_contained() {
    for machine in ["bump", "shade", "texel", "defer"] {
        let place = Place::new();
        place.ok(&format!("demo --machine {machine} --size 64x48 --html a.html --quiet"));
        place.ok(&format!("demo --machine {machine} --size 64x48 --html b.html --quiet --csv"));
        let (page, report) = (place.text("a.html"), place.report("out"));
        check_stands_alone(&page);
        assert!(page == place.text("b.html"), "{machine}: two pages of equal runs differ");
        assert_eq!(page.matches("data:image/png;base64,").count(), 3, "{machine}");
        // The block diagram has a filled box per unit, a gauge per FIFO and a bus per memory.
        for unit in names(&report, "units") {
            let told = |title: &&str| [" (", ": "].iter().any(|end| title.starts_with(&format!("{unit}{end}")));
            assert_eq!(titles(&page, "unit").filter(told).count(), 1, "{machine}: {unit}");
        }
        for fifo in names(&report, "fifos") {
            assert_eq!(page.matches(&format!("<title>FIFO {fifo}: ")).count(), 1, "{machine}: {fifo}");
        }
        for memory in names(&report, "memories") {
            let told = |title: &&str| title.starts_with(&format!("memory {memory}")) && title.contains(": bus busy ");
            assert_eq!(titles(&page, "memory-box").filter(told).count(), 1, "{machine}: {memory}");
        }
    }
}

#[test]
fn page_lists_changed_parameters_in_any_mode() {
    let place = Place::new();
    place.ok("run PATCH --size 64x48 --set replacement.entries=64 --frames 2 --orbit 30 --html a.html --quiet");
    let page = place.text("a.html");
    let (changed, rest) =
        page.split_once("Different from the defaults").expect("what was set").1.split_once("</table>").expect("a table");
    assert!(changed.contains("replacement.entries") && changed.matches("<tr>").count() == 2, "{changed}");
    assert!(rest.contains("fifo.shaded.depth"));
    place.ok("resimulate out --set fifo.shaded.depth=8 --html again.html --quiet");
    let again = place.text("again.html");
    check_stands_alone(&again);
    assert!(again.contains("fifo.shaded.depth") && !again.contains("data:image/png"));
    place.ok("run PATCH --size 64x48 --functional --no-exact --html f.html --quiet");
    let functional = place.text("f.html");
    check_stands_alone(&functional);
    assert_eq!(functional.matches("data:image/png").count(), 1);
}

#[test]
fn page_into_file_of_other_output_is_refused() {
    let place = Place::new();
    assert!(place.run("run PATCH --size 16x12 --html out/report.json").error(2).contains("the report.json of this run"));
    assert!(place.run("run PATCH --size 16x12 --html x --timeline x").error(2).contains("is also the output of"));
    assert!(place.run("run no.gltf --size 16x12 --html x.html").code() != 0);
    assert_eq!(place.run("run PATCH --size 16x12 --html x.html --max-cycles 100 --no-exact").code(), 1);
    assert!(place.text("x.html").contains("class=\"bad\""), "what is known of a run that was stopped is shown");
}
