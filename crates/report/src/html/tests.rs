//! The page as a whole.

use super::*;
use crate::model::{Bottlenecks, CriticalPath, PathPart, RelaxedCycles, RelaxedSet};
use crate::samples;
use basrelief_kernel::HardwareKind;
use sha2::{Digest, Sha256};
use std::fmt::Write;

const DIAGRAM: &str = " [geometry] --polygons--> [replacement (110)] ==z, color== {graphics (124)}\n";

/// A report with all parts, with this name of the input.
fn full(name: &str) -> Report {
    let mut report = samples::costed();
    report.input.name = name.into();
    report.warnings.push(name.into());
    let limit = |saved| RelaxedCycles {
        resource: "replacement".into(),
        what: crate::model::FULLY_PIPELINED.into(),
        set: vec!["ideal.units=replacement".into()],
        cycles: samples::TOTAL - saved,
        saved,
    };
    let rung = |names: &[&str], cycles: u64| RelaxedSet {
        relaxed: names.iter().map(|name| (*name).to_owned()).collect(),
        set: vec![format!("ideal.units={}", names.join(","))],
        cycles,
        saved: 1.0 - cycles as f64 / samples::TOTAL as f64,
        relaxes_all: false,
    };
    let ladder = vec![rung(&["replacement"], samples::TOTAL - 700_000), rung(&["replacement", "reader"], 200_000)];
    report.bottlenecks = Some(Bottlenecks { balanced: None, ladder, single: vec![limit(700_000), limit(0)] });
    let part = |what: &str| PathPart { resource: "replacement".into(), what: what.into(), cycles: 100_000, frames: vec![] };
    let parts = ["occupancy", "latency", "FIFO", "slot", "arrival", "bus", "bank", "data", "order", "cache", "refresh"].map(part);
    report.critical_path = Some(CriticalPath { cycles: samples::TOTAL, parts: parts.into(), polygons: None });
    report
}

fn assets(name: &str) -> PageAssets {
    let picture = PagePicture { caption: name.into(), png: vec![1, 2, 3], largest: Some(12) };
    let row =
        |value: &str| ParameterRow { key: name.into(), value: value.into(), default: "8".into(), ..ParameterRow::default() };
    PageAssets { diagram: DIAGRAM.into(), pictures: vec![picture], parameters: vec![row("8"), row("4")] }
}

fn page(report: &Report) -> String {
    to_html(report, &assets("lanes")).unwrap()
}

#[test]
fn images_of_several_frames_name_the_last_frame() {
    let mut report = samples::costed();
    report.image.truncate(1);
    assert!(page(&report).contains("<figcaption>lanes<"), "one frame needs no name");
    report.image = vec![report.image[0].clone(); 3];
    assert!(page(&report).contains("<figcaption>lanes, frame 3 of 3<"));
}

/// Every tag is closed, in order; every attribute is quoted; no sign of markup stands in a text.
fn check_well_formed(page: &str) {
    let mut open: Vec<&str> = vec![];
    let sheet = page.find("<style>").unwrap()..page.find("</style>").unwrap();
    let page = page.replace(&page[sheet], "<style>");
    for piece in page.strip_prefix("<!DOCTYPE html>").unwrap().split('<').skip(1) {
        let (tag, text) = piece.split_once('>').unwrap_or_else(|| panic!("`<{piece}` has no end"));
        assert!(!text.contains('>'), "`>` in a text: {text}");
        if let Some(name) = tag.strip_prefix('/') {
            assert_eq!(open.pop(), Some(name), "closed here: <{tag}>");
            continue;
        }
        let (name, attributes) = tag.split_once(' ').unwrap_or((tag.trim_end_matches('/'), ""));
        assert!(attributes.matches('"').count() % 2 == 0 && name.chars().all(|c| c.is_ascii_alphanumeric()), "<{tag}>");
        if !tag.ends_with('/') {
            open.push(name);
        }
    }
    assert!(open.is_empty(), "never closed: {open:?}");
}

#[test]
fn pages_are_well_formed_whatever_the_report_has() {
    let functional = samples::functional();
    let all = [full("coin"), functional, samples::deadlocked(), samples::with_routes(), samples::simulated()];
    for report in &all {
        check_well_formed(&page(report));
        check_well_formed(&to_html(report, &PageAssets::default()).unwrap());
    }
}

#[test]
fn each_place_has_a_bar_of_its_area() {
    let mut report = full("coin");
    assert!(!page(&report).contains("Area by place"), "a report without areas");
    report.hardware =
        vec![samples::piece("search", HardwareKind::Adder, 1, 8), samples::piece("queue", HardwareKind::Fifo, 4, 8)];
    report.hardware[0].area.area_ge = 3000;
    report.hardware[1].area.area_ge = 1000;
    let page = page(&report);
    assert!(page.contains("Area by place: 4,000 gate equivalents"), "{page}");
    let bars: Vec<&str> =
        ["gate equivalents 100.0 %", "gate equivalents 33.3 %"].into_iter().filter(|bar| page.contains(bar)).collect();
    assert_eq!(bars.len(), 2, "{page}");
    for (place, kind) in [("search", "unit"), ("queue", "FIFO")] {
        assert!(page.contains(&format!(">{place}</th><td class=\"left\">{kind}</td>")), "{page}");
    }
}

#[test]
fn ladder_is_drawn_as_a_waterfall() {
    // Of 1,000,000 cycles, the first rung saves 700,000 and the second 100,000 more.
    let page = page(&full("coin"));
    for bar in ["left 100.0 %", "left 30.0 %, saved by this rung 70.0 %", "left 20.0 %, saved by this rung 10.0 %"] {
        assert!(page.contains(&format!("aria-label=\"{bar}\"")), "{bar}");
    }
}

#[test]
fn names_are_escaped() {
    let bad = "\"/><script>alert('x')</script>";
    let mut report = full(bad);
    let unit = report.units.as_ref().unwrap()["geometry"].clone();
    report.units.as_mut().unwrap().insert(bad.into(), unit);
    report.outcome.message = Some(bad.into());
    report.outcome.kind = crate::model::OutcomeKind::Fault;
    let mut assets = assets(bad);
    assets.diagram = format!(" [{bad}] --<script>--> [<script>] note<script>");
    let page = to_html(&report, &assets).unwrap();
    check_well_formed(&page);
    assert!(!page.contains("<script") && page.contains("&lt;script&gt;"));
}

#[test]
fn nothing_comes_from_outside_and_nothing_is_run() {
    let page = page(&full("coin"));
    let outside: Vec<&str> = page.split('"').filter(|text| !text.starts_with("data:")).collect();
    for text in ["//", "http:", "@import", "url(", "<script", "onload", "javascript:"] {
        assert!(!outside.iter().any(|part| part.contains(text)), "{text}");
    }
    assert!(page.contains(POLICY.split('\'').next().unwrap()));
}

#[test]
fn head_of_incomplete_run_has_no_mean_per_frame() {
    let numbers = super::head::numbers(&samples::deadlocked());
    for (number, unit) in [("1,000,000", "cycles"), ("4,992,000", "bytes of memory traffic"), ("5.000", "ms at 200 MHz")] {
        assert!(numbers.contains(&(number.into(), unit.into())), "{numbers:?}");
    }
}

#[test]
fn parts_stand_in_their_order() {
    let page = page(&full("coin"));
    let ids: Vec<&str> = page.split("<section id=\"").skip(1).filter_map(|part| part.split('"').next()).collect();
    let expected = [
        "bottlenecks",
        "pictures",
        "diagram",
        "units",
        "fifos",
        "memories",
        "frames",
        "costs",
        "figures",
        "quality",
        "parameters",
        "warnings",
    ];
    assert_eq!(ids, expected);
    for number in ["500,000", "5.00", "41.25"] {
        assert!(page.contains(&format!("<dd>{number}</dd>")), "{number}");
    }
    assert!(page.contains("replacement (110): busy 97.0\u{a0}%, starved: pseudo_normals 2.0\u{a0}%, done 1.0\u{a0}%"));
    assert!(page.contains("full red, green or blue is 12 of 255 steps"));
}

#[test]
fn the_host_leaves_no_trace_and_the_report_can_be_saved() {
    use base64::prelude::{BASE64_STANDARD, Engine};
    let report = full("coin");
    let text = page(&report);
    assert_eq!(text, page(&report.clone().with_host(4.0, 2.0)));
    let (_, data) = text.split_once("data:application/json;base64,").unwrap();
    let json = BASE64_STANDARD.decode(data.split('"').next().unwrap()).unwrap();
    assert_eq!(Report::from_json(std::str::from_utf8(&json).unwrap()).unwrap(), report);
}

#[test]
fn the_page_is_the_same_to_the_byte() {
    let hash = Sha256::digest(page(&full("coin"))).iter().fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    });
    insta::assert_snapshot!("page_sha256", hash);
}

/// Two reports, the second with other cycles of a unit.
#[test]
fn a_comparison_shows_both_and_what_explains_it() {
    let (a, mut b) = (full("before & after"), full("before & after"));
    b.units.as_mut().unwrap()[1].busy += 7;
    let share = |parameter: &str, by| crate::CauseShare {
        parameter: parameter.into(),
        derived: vec![],
        set: vec![],
        needs_run: false,
        cycles: None,
        by,
        share: None,
    };
    let explained =
        crate::MeasuredCauses { shares: vec![share("fifo.<x>", Some(-12_345)), share("memory.z", None)], together: 67 };
    let comparison = crate::compare(&a, &b, Some(explained));
    let side = |name, report| ComparedReport { name, report, assets: assets("lanes") };
    let one = compared(&side("out/<a>", &a), &[(side("out/b", &b), &comparison)]);
    check_well_formed(&one);
    assert!(one.contains("-12,345") && one.contains("not measured") && one.contains("fifo.&lt;x&gt;"), "{one}");
    assert!(one.contains("Cycle breakdown") && one.matches("class=\"blocks\"").count() == 2);
    let two = compared(&side("a", &a), &[(side("b", &b), &comparison), (side("c", &a), &comparison)]);
    check_well_formed(&two);
    assert!(two.contains("id=\"units-1\"") && two.contains("id=\"units-2\"") && !two.contains("id=\"units\""));
}

#[test]
fn comparison_page_shows_both_times_and_clocks() {
    let (a, mut b) = (full("model"), full("model"));
    let page = |b: &Report| {
        let side = |report| ComparedReport { name: "out", report, assets: assets("lanes") };
        compared(&side(&a), &[(side(b), &crate::compare(&a, b, None))])
    };
    let row = |kind: &str, before: &str, after: &str| {
        format!("{kind}</th><td class=\"right\">{before}</td><td class=\"right\">{after}</td>")
    };
    let one_clock = page(&b);
    assert!(one_clock.contains(&row("ms per frame at 200 MHz", "2.500", "2.500")), "{one_clock}");
    samples::set_clock(&mut b, 20_000_000);
    let two_clocks = page(&b);
    assert!(two_clocks.contains(&row("ms per frame", "2.500 at 200 MHz", "25.000 at 20 MHz")), "{two_clocks}");
}

/// Returns the luminance of each colour that the style sheet names, in the light and in the dark theme. A gamma of 2 is close enough.
fn luminances() -> [std::collections::BTreeMap<&'static str, f64>; 2] {
    let luminance = |hex: &str| {
        let channel = |at: usize| (f64::from(u8::from_str_radix(&hex[at..at + 2], 16).unwrap()) / 255.0).powi(2);
        0.2126 * channel(0) + 0.7152 * channel(2) + 0.0722 * channel(4)
    };
    let themes: Vec<&str> = STYLE.split(":root {").skip(1).take(2).map(|theme| theme.split('}').next().unwrap()).collect();
    let colours = |theme: &'static str| {
        let named = theme.split("--").skip(1).filter_map(|part| part.split_once(": #"));
        named.map(|(name, value)| (name, luminance(&value[..6]))).collect()
    };
    [colours(themes[0]), colours(themes[1])]
}

#[test]
fn red_and_green_differ_in_luminance() {
    for theme in luminances() {
        let [red, green] = [theme["blocked"] + 0.05, theme["busy"] + 0.05];
        assert!(green / red > 2.0, "busy and blocked differ by a factor of {}", green / red);
    }
}
