//! The same commands with every machine.

use crate::support::{Place, is_valid, patch, without_host, workspace};
use serde_json::Value;
use std::fs;

const DEMOS: [&str; 10] =
    ["golf-ball", "coin", "brick", "mixed", "cut-plane@1", "ellipsoid", "sphere", "goblet@2", "corridor", "turntable"];

#[test]
fn demo_selects_its_machine_by_default() {
    let place = Place::new();
    for (line, name, drawn_by) in [
        ("demo ellipsoid@1", "ellipsoid@1", "shade"),
        ("demo --machine shade", "ellipsoid", "shade"),
        ("demo goblet@1 --machine bump", "goblet@1", "bump"),
        ("demo", "golf-ball", "bump"),
        ("run demo:cut-plane@1", "cut-plane@1", "shade"),
        ("run PATCH", "patch.gltf", "bump"),
        ("run PATCH --machine shade", "patch.gltf", "shade"),
        ("demo turntable", "turntable", "texel"),
    ] {
        place.ok(&format!("{line} --size 32x24 --no-exact --quiet"));
        let report = place.report("out");
        assert_eq!((&report["machine"], &report["input"]["name"]), (&drawn_by.into(), &name.into()), "{line}");
    }
}

// Claim: as engines_agree_on_demos_in_every_mode.
#[test]
fn engines_and_functional_mode_agree_on_all_demos() {
    let place = Place::new();
    // One machine for each demo. Random lists and configurations are compared within the process.
    for (demo, machine) in DEMOS.iter().zip(["bump", "shade", "texel"].iter().cycle()) {
        let line = format!("demo {demo} --machine {machine} --size 32x24 --frames 1 --no-bottlenecks --quiet");
        place.ok(&format!("{line} --out timed"));
        place.ok(&format!("{line} --out ticked --engine ticked"));
        place.ok(&format!("{line} --out functional --functional --no-exact"));
        let [timed, ticked] = ["timed", "ticked"].map(|out| without_host(place.report(out)));
        assert_eq!(timed.to_string(), ticked.to_string(), "{line}");
        assert_eq!(timed["image"], place.report("functional")["image"], "{line}");
    }
}

#[test]
fn shade_report_has_paths_circuits_and_errors() {
    let place = Place::new();
    let said = place.ok("demo cut-plane@2 --size 64x48 --csv --tables all --timeline t.pftrace").out;
    let report = place.report("out");
    is_valid(&report, &place);
    let count = |name: &str| report["figures"][name].as_u64().unwrap_or_else(|| panic!("{name}"));
    let paths = ["polyhedron", "brightness", "normal", "gate_closed", "flat", "reused"];
    let [dots, polygons] = ["dots", "polygons"].map(|what| paths.map(|p| count(&format!("{what}_{p}"))).iter().sum::<u64>());
    assert_eq!(dots, count("fragments"));
    assert_eq!(polygons, count("polygons_sent"));
    assert!(count("dots_reused") > 0 && count("dots_gate_closed") > 0, "the demo is made for the short cuts");
    let total = place.frame_cycles("out") as f64;
    let derived = |name: &str| report["derived"][name]["value"].as_f64().unwrap_or_else(|| panic!("{name}"));
    assert!((derived("cycles_per_dot") - total / dots as f64).abs() < 1e-6);
    assert!((derived("cycles_per_polygon") - total / polygons as f64).abs() < 1e-6);
    let started = count("normal_interpolation_started_cycles");
    assert!((derived("normal_interpolation.idle") - (total - started as f64)).abs() < 1e-6);
    let difference = &report["quality"]["difference"];
    assert!(difference["mean"].as_f64().is_some_and(|mean| mean > 0.0 && mean < 255.0));
    assert!(difference["largest"].as_u64().is_some_and(|largest| largest > 0 && largest < 256));
    for part in ["Route ", "gate_closed", "Circuit ", "Process ", "mean error", "microcomputer (10)", "dots/s"] {
        assert!(said.contains(part), "{part}: {said}");
    }
    assert!(place.text("out/report.csv").contains("quality,,largest_difference,,"));
    assert!(!place.bytes("t.pftrace").is_empty());
}

// Claim: shade, normals: Normalized normals come closest to the reference image.
#[test]
fn normalized_normals_are_closest_to_reference() {
    let place = Place::new();
    let error = |settings: &str| {
        place.ok(&format!("demo ellipsoid@4 --size 64x48 --quiet {settings}"));
        place.report("out")["quality"]["difference"]["mean"].as_f64().expect("an error")
    };
    let renormalised = error("--set shade.renormalise=true");
    let [plain, polyhedron] = ["", "--set shade.mode=polyhedron"].map(error);
    assert!(renormalised < 0.5 * plain && renormalised < 0.5 * polyhedron, "{renormalised} {plain} {polyhedron}");
}

// Claim: trace: A trace from any machine gives the same image on `shade` and `texel`, and covers the same pixels.
#[test]
fn replay_gives_same_image_from_any_machine() {
    let place = Place::new();
    for (recorder, list) in [("bump", "b.jsonl"), ("shade", "s.bdl.zst"), ("texel", "t.bdl")] {
        place.ok(&format!("record PATCH --machine {recorder} --size 48x36 --frames 2 --orbit 30 --out {list}"));
    }
    for machine in ["shade", "texel"] {
        place.ok(&format!("run PATCH --machine {machine} --size 48x36 --frames 2 --orbit 30 --out scene"));
        for list in ["b.jsonl", "s.bdl.zst", "t.bdl"] {
            place.ok(&format!("run {list} --machine {machine} --out replay"));
            assert_eq!(place.report("replay")["image"], place.report("scene")["image"], "{machine}, {list}");
            // The arrival times in a list are those of the machine that recorded it.
            let is_same = place.report("replay")["input"]["sha256"] == place.report("scene")["input"]["sha256"];
            assert_eq!(is_same, list.starts_with(&machine[..1]), "{machine}, {list}");
        }
    }
}

#[test]
fn expectation_names_its_machine() {
    let place = Place::new();
    place.ok("record demo:cut-plane@1 --size 48x36 --set shade.mode=brightness --expect --out t.jsonl");
    let good = place.text("t.jsonl");
    assert!(good.contains(r#""machine":"shade""#) && good.contains(r#""shade.mode":"brightness""#), "{good}");
    place.ok("verify t.jsonl");
    place.ok("verify --bless t.jsonl");
    assert_eq!(place.text("t.jsonl"), good);
    fs::write(place.path("t.jsonl"), good.replace(r#""machine":"shade""#, r#""machine":"lathe""#)).expect("written");
    let outcome = place.run("verify t.jsonl");
    let line = good.lines().count() - 1;
    let named = format!("t.jsonl: line {line}: expect.machine: no machine is called `lathe`; expected bump, shade, texel, defer");
    assert!(outcome.error(1).starts_with(&named), "{}", outcome.err);
}

#[test]
fn bad_shade_values_are_named() {
    let place = Place::new();
    for (settings, code, part) in [
        ("--set shade.mod=normal", 2, "did you mean `shade.mode`"),
        ("--set mode=normal", 2, "did you mean `shade.mode`"),
        ("--set shade.mode=flat", 2, "unknown value `flat`, expected one of `normal`, `brightness`, `polyhedron`"),
        ("--set shade.clamp=maybe", 2, "shade.clamp"),
        ("--set shade.ia=nan", 2, "`shade.ia`"),
        ("--set gate.latency=99999", 2, "`gate.latency` is 99999, expected 0..=4096"),
        ("--set replacement.entries=64", 2, "`replacement.entries` is a parameter of machine `bump`, and this is `shade`"),
        ("--set host.buffers=2 --set fifo.finished.depth=1", 2, "`fifo.finished.depth`: is 1, but 2 polygons"),
        ("--set cache.depth.line_bytes=48", 2, "--set: `cache.depth.line_bytes`: is 48, expected a power of two"),
        ("--machine bump --set shade.mode=normal", 2, "`shade.mode` is a parameter of machine `shade`"),
        ("--set machine=bump", 2, "`machine` is no parameter; to choose the machine, use --machine NAME"),
        ("--machine lathe", 2, ""),
    ] {
        let outcome = place.run(&format!("demo ellipsoid@1 --size 16x12 {settings}"));
        assert!(outcome.error(code).contains(part), "{settings}: {}", outcome.err);
    }
    fs::write(place.path("c.toml"), "[shortcut.flatness]\nenable = false\n").expect("written");
    let outcome = place.run("demo ellipsoid --config c.toml");
    assert!(outcome.error(1).contains("did you mean `shortcut.flatness.enabled`"), "{}", outcome.err);
    fs::write(place.path("c.toml"), "machine = \"bump\"\n").expect("written");
    let outcome = place.run("demo ellipsoid --config c.toml");
    assert!(outcome.error(1).contains("c.toml: line 1: `machine` is no parameter; to choose"), "{}", outcome.err);
    fs::write(place.path("c.toml"), "[replacement]\nentries = 64\n").expect("written");
    let outcome = place.run("demo ellipsoid --config c.toml");
    assert!(outcome.error(1).contains("c.toml: line 1: `replacement` is a parameter of machine `bump`"), "{}", outcome.err);
    // The error for inconsistent parameters names the file that set them.
    fs::write(place.path("c.toml"), "[host]\nbuffers = 2\n[fifo.finished]\ndepth = 1\n").expect("written");
    let outcome = place.run("demo ellipsoid@1 --config c.toml");
    assert!(outcome.error(1).starts_with("c.toml: line 4: `fifo.finished.depth`: is 1, but 2 polygons"), "{}", outcome.err);
    let mended = place.run("demo ellipsoid@1 --size 16x12 --config c.toml --set host.buffers=1 --out mended");
    assert_eq!(mended.code(), 0, "{}", mended.err);
    assert_eq!(place.names(""), ["c.toml", "mended"]);
}

/// Returns the places of all formats in a schema.
fn formats(part: &Value, place: &str) -> Vec<String> {
    let below = |(key, value): (String, &Value)| formats(value, &format!("{place}/{key}"));
    match part {
        Value::Object(fields) => {
            let own = fields.get("format").filter(|format| format.is_string()).map(|format| format!("{place}: {format}"));
            own.into_iter().chain(fields.iter().map(|(key, value)| (key.clone(), value)).flat_map(below)).collect()
        }
        Value::Array(list) => list.iter().enumerate().map(|(k, value)| (k.to_string(), value)).flat_map(below).collect(),
        _ => vec![],
    }
}

#[test]
fn printed_schemas_have_no_unknown_format() {
    let place = Place::new();
    let machines = ["bump", "shade", "texel", "defer"].map(|machine| format!("config --machine {machine}"));
    for of in ["trace", "report", "camera"].map(str::to_owned).into_iter().chain(machines) {
        let schema: Value = serde_json::from_str(&place.ok(&format!("schema {of}")).out).expect("a schema");
        assert!(jsonschema::meta::is_valid(&schema), "{of}");
        jsonschema::validator_for(&schema).expect("a valid schema");
        assert_eq!(formats(&schema, ""), [""; 0], "{of}");
    }
}

/// Returns the descriptions with links or escapes of rustdoc.
fn rustdoc_markup(part: &Value) -> Vec<&str> {
    let own = ["description", "about"].into_iter().filter_map(|key| part.get(key)?.as_str());
    let own = own.filter(|text| ["[`", "`]", "](", "\\[", "\\]"].iter().any(|markup| text.contains(markup)));
    let below: Box<dyn Iterator<Item = &Value>> = match part {
        Value::Object(fields) => Box::new(fields.values()),
        Value::Array(list) => Box::new(list.iter()),
        _ => Box::new(std::iter::empty()),
    };
    own.chain(below.flat_map(rustdoc_markup)).collect()
}

#[test]
fn descriptions_have_no_rustdoc_markup() {
    let place = Place::new();
    let machines = ["bump", "shade", "texel", "defer"];
    let printed = machines.iter().flat_map(|of| {
        [format!("schema config --machine {of}"), format!("schema plan --machine {of}"), format!("describe {of} --json")]
    });
    let named = ["trace", "report", "camera", "views"].map(|of| format!("schema {of}"));
    for line in named.into_iter().chain(printed) {
        let json: Value = serde_json::from_str(&place.ok(&line).out).expect("JSON");
        assert_eq!(rustdoc_markup(&json), [""; 0], "{line}");
    }
    for table in ["parameters.csv", "report-keys.csv"] {
        let text = fs::read_to_string(workspace().join("docs/reference").join(table)).expect("a table");
        let marked: Vec<&str> = text.lines().filter(|line| line.contains("[`") || line.contains("](")).collect();
        assert_eq!(marked, [""; 0], "{table}");
    }
}

#[test]
fn report_config_matches_schema() {
    let place = Place::new();
    for (machine, other, demo) in [("shade", "bump", "ellipsoid@1"), ("bump", "shade", "mixed")] {
        place.ok(&format!("demo {demo} --size 16x12 --no-exact --quiet"));
        let config = place.report("out")["config"].clone();
        let valid = |of: &str| {
            let schema: Value = serde_json::from_str(&place.ok(&format!("schema config --machine {of}")).out).expect("a schema");
            jsonschema::validator_for(&schema).expect("a valid schema").is_valid(&config)
        };
        assert!(valid(machine) && !valid(other), "{machine}");
        let said = place.ok(&format!("describe {machine}")).out;
        let table: Value = serde_json::from_str(&place.ok(&format!("describe {machine} --json")).out).expect("a table");
        for parameter in table.as_array().expect("a list") {
            let key = parameter["key"].as_str().expect("a key");
            assert!(said.contains(&format!("\n  {key} = ")), "{key}");
            assert!(config.pointer(&format!("/{}", key.replace('.', "/"))).is_some(), "{key}");
        }
    }
}

#[test]
fn reports_do_not_differ_between_folders() {
    let place = Place::new();
    for folder in ["here", "far/away"] {
        fs::create_dir_all(place.path(folder)).expect("a folder");
        fs::copy(patch(), place.path(&format!("{folder}/patch.gltf"))).expect("copied");
        place.ok(&format!("record {folder}/patch.gltf --size 32x24 --out {folder}/t.jsonl"));
    }
    for (name, machine) in [("patch.gltf --size 32x24", "bump"), ("patch.gltf --size 32x24", "shade"), ("t.jsonl", "shade")] {
        let report = |folder: &str| {
            place.ok(&format!("run {folder}/{name} --machine {machine} --quiet"));
            without_host(place.report("out"))
        };
        let here = report("here");
        assert_eq!(here.to_string(), report("far/away").to_string(), "{name}");
        assert_eq!(here["input"]["name"].as_str(), name.split(' ').next());
    }
}

#[test]
fn describe_filters_units_and_parameters() {
    let place = Place::new();
    let said = place.ok("describe bump memory.graphics").out;
    assert!(said.lines().count() < 200 && said.contains("memory.graphics.cl = "), "{said}");
    assert!(!said.contains("replacement.lanes") && !said.contains("Demo scenes"), "{said}");
    assert!(place.run("describe bump memory.grafics").error(2).contains("did you mean"));
}

#[test]
fn describe_shows_derived_memory_timings() {
    let place = Place::new();
    let said = place.ok("describe bump --set memory.graphics.part=sdr-133 --set memory.graphics.cl=2").out;
    let entry = |key: &str| {
        let begin = said.find(&format!("\n  memory.graphics.{key} = ")).unwrap_or_else(|| panic!("no {key}"));
        said[begin + 1..].split("\n\n").next().unwrap_or_default().to_owned()
    };
    assert!(entry("part").contains("= sdr-133") && entry("part").contains("HB52F649E1"), "{}", entry("part"));
    assert!(entry("rcd").contains("= 4 cycles") && entry("rcd").contains("derived: tRCD: 20 ns, rounded up at 200 MHz"));
    assert!(entry("cl").contains("= 2 cycles") && entry("cl").contains("set by the user; the memory part has 5"));
    assert!(entry("channels").contains("= 4 channels") && entry("channels").contains("assumed: 256 bits"));
    fs::write(place.path("slow.toml"), "[clock]\nhz = 100_000_000\n").expect("written");
    let table = place.ok("describe bump --config slow.toml --json").out;
    let table: Value = serde_json::from_str(&table).expect("a table");
    let of = |key: &str| table.as_array().into_iter().flatten().find(|p| p["key"] == key).cloned().unwrap_or_default();
    let cl = of("memory.graphics.cl");
    assert_eq!((cl["value"].as_u64(), cl["default"].as_u64()), (Some(2), Some(3)));
    // A part that does not fit the clock and an unknown part are errors. A setting can correct the value of a file.
    fs::write(place.path("slow.toml"), "[clock]\nhz = 3_000_000\n").expect("written");
    assert!(
        place
            .run("describe bump --config slow.toml")
            .error(1)
            .contains("slow.toml: `memory.graphics.part`: ddr-400 does not fit")
    );
    assert!(place.run("describe bump --set clock.hz=3000000").error(2).contains("--set: `memory.graphics.part`"));
    place.ok("describe bump --config slow.toml --set memory.graphics.part=fpm-80");
    assert!(place.run("describe --set memory.graphics.part=ddr-500").error(2).contains("ddr-400"));
}
