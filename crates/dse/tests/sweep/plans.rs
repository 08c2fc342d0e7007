//! Plans: errors before the first run, and points.

use crate::support::{Program, plan};
use basrelief_dse::Plan;
use std::collections::BTreeSet;

const HEAD: &str = "input = \"demo:ellipsoid@1\"\nmachine = \"bump\"\nobjectives = [\"cycles min\"]\n";

/// Error of a plan.
fn error(text: &str) -> String {
    Plan::read(text, &Program::new())
        .map_or_else(|error| error.to_string(), |plan| format!("it has {} points", plan.points.len()))
}

/// Each plan must be refused with these words.
fn says<const N: usize>(cases: [(String, &str); N]) {
    let others = cases
        .iter()
        .map(|(text, expected)| (text, expected, error(text)))
        .filter(|(_, expected, said)| !said.contains(**expected));
    let others: Vec<String> = others.map(|(text, expected, said)| format!("{text}\nsays: {said}\nnot:  {expected}\n")).collect();
    assert!(others.is_empty(), "{}", others.join("\n"));
}

#[test]
fn plan_errors_precede_the_first_run() {
    let cases = [
        ("axes = 3 4", "TOML parse error at line 4, column 8"),
        ("axis.a = [1]", "unknown field `axis`, expected one of"),
        ("axis.a = [1]", "; did you mean `axes`?"),
        ("constraint = [\"cycles < 5\"]", "did you mean `constraints`?"),
        ("samples = { method = \"sobel\" }", "unknown value `sobel`, expected one of `grid`, `latin_hypercube`, `sobol`"),
        ("samples = { method = \"sobel\" }", "did you mean `sobol`?"),
        ("samples = { method = \"sobol\" }", "samples: `points` says how many; expected a number such as points = 64"),
        (
            "samples = { method = \"grid\", points = 4 }",
            "samples: a grid, or one value at a time, has all its points; leave `points` out",
        ),
        ("samples = { method = \"sobol\", points = 0 }", "samples: no points; expected one at least"),
        ("samples = { method = \"sobol\", points = 99999 }", "99999 points; expected at most 32768"),
        ("axes.replacement.lane = [1]", "axes: unknown parameter `replacement.lane`; did you mean `replacement.lanes`?"),
        ("axes.replacement.lanes = [1, 0]", "axes: `replacement.lanes` is 0, expected 1..=65536 dot-product units"),
        ("axes.replacement.lanes = [1, \"many\"]", "axes: `replacement.lanes` is \"many\", expected 1..=65536 dot-product units"),
        ("axes.replacement.lanes = []", "axes.replacement.lanes: has no values; expected one at least"),
        ("axes.shade.mode = [\"normal\"]", "axes: `shade.mode` is a parameter of machine `shade`, and this is `bump`"),
        ("axes.replacement = [1]", "axes: `replacement` is a group of parameters; set one of them, such as `replacement."),
        ("config.replacement.lanes = 0", "config: `replacement.lanes` is 0, expected 1..=65536"),
        ("config = \"none.toml\"", "config: none.toml: cannot be read"),
        ("config = 3", "expected parameters, as in a file of --config, or the name of such a file"),
        (
            "axes.replacement.lanes = [1]\nzip = [{ replacement.lanes = [1], replacement.entries = [16] }]",
            "axes: `replacement.lanes` is on two axes; expected it on one",
        ),
        (
            "axes.replacement.lanes = [1]\nexclude = [{ replacement.lane = 1 }]",
            "exclude: `replacement.lane` is on no axis; did you mean `replacement.lanes`?",
        ),
        ("axes.replacement.lanes = [1]\nexclude = [{ replacement.lanes = 1 }]", "exclude: leaves no point"),
        (
            "constraints = [\"quality.psnr >= 30\"]",
            "constraints: the report has no figure `quality.psnr`; did you mean `quality.",
        ),
        (
            "constraints = [\"quality.psnr_db => 30\"]",
            "constraints: constraint `quality.psnr_db => 30`: expected the name of a figure",
        ),
        (
            "axes.replacement.lanes = { from = 1, to = 4096, step = 1 }\naxes.fifo.shaded.depth = { from = 1, to = 64, step = 1 }",
            "262144 points; expected at most 32768: shorten axes, take samples, or write several plans for one folder",
        ),
        ("max_cycles = -1", "invalid value: integer `-1`, expected u64"),
    ];
    says(cases.map(|(rest, expected)| (format!("{HEAD}{rest}\n"), expected)));
}

#[test]
fn wrong_option_among_several_views_has_no_line() {
    let wrong = |rest: &str| error(&format!("{HEAD}{rest}"));
    assert_eq!(wrong("[view]\nsise = 1\n"), "line 4: view: no option is called `sise`");
    assert_eq!(wrong("[view]\nframes = 1\n[[views]]\nsise = 1\n"), "view: no option is called `sise`");
}

#[test]
fn plan_errors_name_line_and_key() {
    let zip = "[[zip]]\nreplacement.lanes = [1]\n[[zip]]\n";
    let exclude = "[axes]\nreplacement.lanes = [1]\n[[exclude]]\nreplacement.lanes = 1\n[[exclude]]\n";
    let cases = [
        ("[axes]\n\nreplacement.lane = [1]".into(), "line 6: axes: unknown parameter `replacement.lane`; did you mean"),
        ("[axes.replacement]\nlanes = [1,\n0]".into(), "line 5: axes: `replacement.lanes` is 0, expected 1..=65536"),
        ("[axes.replacement]\nlanes = [\"many\"]".into(), "line 5: axes: `replacement.lanes` is \"many\", expected 1..=65536"),
        (
            "[axes]\nreplacement.codebook = [\"fixd\"]".into(),
            "line 5: axes: `replacement.codebook`: unknown value `fixd`, expected one of `fixed`",
        ),
        ("[axes]\nreplacement.lanes = 3".into(), "line 5: axes.replacement.lanes: is 3, expected a list of values"),
        (format!("{zip}replacement.lanes = [2]"), "line 7: axes: `replacement.lanes` is on two axes"),
        (format!("{zip}replacement.entries = [0]"), "line 7: zip: `replacement.entries` is 0, expected"),
        (format!("{zip}replacement.entries = []"), "line 7: zip.replacement.entries: has no values"),
        (format!("{zip}frame.width = [1]\nreplacement.entries = [16, 64]"), "line 8: zip: `frame.width` has 1 values and"),
        (zip.into(), "line 6: zip: names no parameter"),
        (format!("{exclude}replacement.lanes = 3"), "line 9: exclude: `replacement.lanes` never is 3"),
        (format!("{exclude}replacement.lane = 3"), "line 9: exclude: `replacement.lane` is on no axis; did you mean"),
        ("[config.replacement]\nlanes = 0".into(), "line 5: config: `replacement.lanes` is 0, expected 1..=65536"),
        ("\nconfig = \"wrong.toml\"".into(), "line 5: config: wrong.toml: line 2: `replacement.lanes` is 0, expected"),
        ("\nconfig = \"broken.toml\"".into(), "line 5: config: broken.toml: not valid TOML: TOML parse error at line 1"),
        ("\nconstraints = [\"cycels < 5\"]".into(), "line 5: constraints: the report has no figure `cycels`; did you mean"),
        ("\n[samples]\nmethod = \"sobol\"".into(), "line 5: samples: `points` says how many"),
    ];
    says(cases.map(|(rest, expected): (String, &str)| (format!("{HEAD}{rest}\n"), expected)));
}

#[test]
fn plan_head_errors_name_the_field() {
    let cases = [
        ("objectives = [\"cycles min\"]", "missing field `input`"),
        ("input = \"demo:coin\"", "missing field `objectives`"),
        ("input = 3\nobjectives = []", "expected the name of an input, such as \"demo:golf-ball\", or a list of them"),
        ("input = []\nobjectives = [\"cycles min\"]", "input: names nothing; expected one input at least"),
        ("input = \"demo:teapot\"\nobjectives = [\"cycles min\"]", "input: demo: no demo is called `teapot`; expected golf-ball"),
        ("input = \"none.gltf\"\nobjectives = [\"cycles min\"]", "input: none.gltf: cannot be read"),
        ("input = \"demo:coin\"\nmachine = \"bumb\"\nobjectives = [\"cycles min\"]", "machine: no machine is called `bumb`"),
        ("input = \"demo:coin\"\nobjectives = []", "objectives: there are none; expected one at least, such as \"cycles min\""),
        (
            "input = \"demo:coin\"\nobjectives = [\"cycles\"]",
            "objectives: objective `cycles`: expected the name of a figure and `min`",
        ),
        (
            "input = \"demo:ellipsoid@1\"\nobjectives = [\"cycle min\"]",
            "objectives: the report has no figure `cycle`; did you mean",
        ),
        (
            "input = \"demo:ellipsoid@1\"\nobjectives = [\"cycles min\", \"cycles.frames max\"]",
            "objectives: `cycles.frames` is named twice",
        ),
        (
            "input = \"demo:coin\"\nobjectives = [{ figure = \"cycles\", goal = \"mni\" }]",
            "expected \"FIGURE min\", \"FIGURE max\" or",
        ),
    ];
    says(cases.map(|(text, expected)| (text.to_owned(), expected)));
}

#[test]
fn figures_of_a_slow_path_can_be_named() {
    let text = "input = \"demo:gallery\"\nobjectives = [\"figures.final_picture_ms min\"]\n\
                [axes]\npath.bits_per_second = [56_000, 1_000_000]\n";
    assert_eq!(plan(text, &Program::new()).points.len(), 2);
}

#[test]
fn grid_order_is_inputs_then_axes() {
    let text = "input = [\"demo:ellipsoid@1\", \"quad.dl.jsonl\"]\nobjectives = [{ figure = \"cycles\", goal = \"min\" }]\n\
                config = { memory.frame.part = \"sram\" }\n\
                [axes]\nshade.mode = [\"normal\", \"brightness\"]\nfifo.shaded.depth = { from = 2, to = 8, factor = 2 }\n\
                [[exclude]]\nshade.mode = \"normal\"\nfifo.shaded.depth = [2, 8]\n";
    let plan = plan(&text.replace("fifo.shaded", &format!("fifo.{}", fifo_of("shade"))), &Program::new());
    assert_eq!(plan.machine.name, "shade", "the one that the first demo is made for");
    let places: Vec<(usize, Vec<usize>)> = plan.points.iter().map(|p| (p.input, p.places.clone())).collect();
    let of_input = |n| [vec![0, 1], vec![1, 0], vec![1, 1], vec![1, 2]].map(|places| (n, places));
    assert_eq!(places, [of_input(0), of_input(1)].concat());
    assert_eq!(plan.min_runs(), 4, "a mode of each input");
}

/// A FIFO of a machine.
fn fifo_of(machine: &str) -> String {
    let info = basrelief_sim::MachineInfo::named(machine).unwrap();
    let key =
        info.parameters().into_iter().map(|p| p.key).find(|key| key.starts_with("fifo.") && key.ends_with(".depth")).unwrap();
    key["fifo.".len()..key.len() - ".depth".len()].into()
}

#[test]
fn point_hash_covers_exactly_its_report() {
    let host = Program::new();
    let ids = |text: &str| plan(text, &host).points.into_iter().map(|p| (p.id, p.work)).collect::<Vec<_>>();
    let axes = "[axes]\nreplacement.lanes = [8, 16]\n";
    let first = ids(&format!("{HEAD}{axes}"));
    assert_ne!(first[0].1, first[1].1, "lanes are work");
    // The same points by other ways.
    assert_eq!(ids(&format!("{HEAD}config = \"wide.toml\"\n")), first[1..]);
    assert_eq!(
        ids(&format!("{HEAD}constraints = [\"cycles < 5\"]\n[axes]\nreplacement.lanes = [16, 8]\n")),
        [first[1].clone(), first[0].clone()]
    );
    assert_eq!(ids(&format!("{HEAD}[axes]\nreplacement.lanes = [8, 8, 16]\n")), first, "each once");
    // Others.
    let mut all: Vec<String> = first.into_iter().map(|(id, _)| id).collect();
    for text in [
        HEAD.to_owned(),
        format!("{HEAD}[view]\nframes = 2\n"),
        format!("{HEAD}max_cycles = 1000000\n"),
        format!("{HEAD}[axes]\nfifo.shaded.depth = [3]\n"),
        HEAD.replace("ellipsoid@1", "ellipsoid@2"),
        HEAD.replace("bump", "shade"),
        HEAD.replace("demo:ellipsoid@1", "quad.dl.jsonl"),
    ] {
        all.extend(ids(&text).into_iter().map(|(id, _)| id));
    }
    assert_eq!(all.iter().collect::<BTreeSet<_>>().len(), all.len());
    let timing = ids(&format!("{HEAD}[axes]\nfifo.shaded.depth = [3, 5]\n"));
    assert!(timing[0].0 != timing[1].0 && timing[0].1 == timing[1].1, "a depth is time");
}

#[test]
fn shards_are_all_points_once_and_keep_work_together() {
    let text = format!("{HEAD}[axes]\nreplacement.lanes = [1, 2, 4, 8, 16]\nfifo.shaded.depth = [2, 4]\n");
    let plan = plan(&text, &Program::new());
    let shards: Vec<Vec<&str>> = (1..=3).map(|n| plan.shard(n, 3).into_iter().map(|p| p.id.as_str()).collect()).collect();
    assert_eq!(shards.iter().map(Vec::len).collect::<Vec<_>>(), [4, 4, 2]);
    assert_eq!(shards.concat().into_iter().collect::<BTreeSet<_>>().len(), 10);
}

#[test]
fn default_points_are_those_without_axes() {
    let defaults = |text: &str| {
        let plan =
            plan(&format!("{HEAD}{text}[axes]\nreplacement.lanes = [8, 32, 64]\nfifo.shaded.depth = [2, 8]\n"), &Program::new());
        let base = plan.machine.parameters();
        let value = |key: &str| base.iter().find(|parameter| parameter.key == key).unwrap().default.as_u64().unwrap();
        let found: Vec<_> = plan.default_points().into_iter().map(|point| plan.settings(&point.places)).collect();
        (found, [value("replacement.lanes"), value("fifo.shaded.depth")])
    };
    let (found, of_machine) = defaults("");
    assert_eq!(of_machine, [64, 64], "the test expects these defaults");
    assert!(found.is_empty(), "no depth of the axis is the default: {found:?}");
    let (found, _) = defaults("config.fifo.shaded.depth = 8\n");
    let settings = [("replacement.lanes", "64"), ("fifo.shaded.depth", "8")].map(|(key, value)| (key.into(), value.into()));
    assert_eq!(found, [settings.to_vec()]);
}

#[test]
fn samples_are_points_of_the_grid_the_same_for_the_same_seed() {
    let sampled = |method: &str, seed: u32| {
        let text = format!(
            "{HEAD}samples = {{ method = \"{method}\", points = 8, seed = {seed} }}\n\
             [axes]\nreplacement.lanes = {{ from = 1, to = 64, step = 1 }}\nfifo.shaded.depth = {{ from = 1, to = 64, step = 1 }}\n"
        );
        plan(&text, &Program::new()).points.into_iter().map(|p| p.places).collect::<Vec<_>>()
    };
    for method in ["sobol", "latin_hypercube"] {
        assert_eq!(sampled(method, 1), sampled(method, 1));
        assert_ne!(sampled(method, 1), sampled(method, 2));
        assert!(sampled(method, 1).iter().all(|places| places.iter().all(|place| *place < 64)));
    }
}
