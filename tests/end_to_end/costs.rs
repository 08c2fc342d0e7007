//! `--costs`: pictures and tables of the cycles attributed to objects and polygons.

use crate::support::{Place, picture};

#[test]
fn costs_come_as_pictures_and_as_tables() {
    let place = Place::new();
    let text = place.ok("demo golf-ball --size 48x36 --costs --csv --no-exact --no-bottlenecks").out;
    assert_eq!(
        place.names("out"),
        ["cost.png", "entry.png", "image.png", "level.png", "overdraw.png", "report.csv", "report.json", "wait.png"]
    );
    // The picture is on top and the scale below. The title of a narrow picture takes more lines.
    for name in ["cost.png", "wait.png", "overdraw.png", "level.png", "entry.png"] {
        let (width, height, ..) = picture(&place.path("out").join(name));
        assert!(width == 48 && height > 36 + 30, "{name}: {width} x {height}");
    }
    for part in ["Cycles spent on", "Object", "golf ball", "Polygon"] {
        assert!(text.contains(part), "{part}: {text}");
    }
    let report = place.report("out");
    let costs = &report["costs"];
    let units = report["units"].as_object().expect("units").len() as u64;
    let all: u64 = ["pixels", "non_pixel", "unattributed"].iter().filter_map(|whom| costs[whom]["cycles"].as_u64()).sum();
    assert_eq!(all + costs["done"].as_u64().expect("a number"), units * report["cycles"]["total"].as_u64().expect("a number"));
    let polygons = costs["polygons"].as_array().expect("a list");
    let cycles = |i: usize| polygons[i]["breakdown"]["cycles"].as_u64().expect("a number");
    assert!(polygons.len() == 100 && (1..100).all(|i| cycles(i - 1) >= cycles(i)), "the hundred most expensive, most first");
    let csv = place.text("out/report.csv");
    assert!(csv.contains("\nobjects,0,cycles,,") && csv.contains("\npolygons,others,count,,"), "{csv}");
}

#[test]
fn costs_are_optional_and_need_timing() {
    let place = Place::new();
    place.ok("demo golf-ball --size 16x12 --no-exact --no-bottlenecks");
    assert_eq!(place.names("out"), ["image.png", "report.json"]);
    assert!(place.report("out").get("costs").is_none());
    let refused = place.run("demo golf-ball --size 16x12 --costs --functional");
    assert!(refused.error(2).contains("--costs"), "{}", refused.err);
}
