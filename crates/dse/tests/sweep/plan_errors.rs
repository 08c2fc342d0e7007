//! Errors of plans, before the first run.

use crate::support::{HEAD, Program};
use basrelief_dse::Plan;

const IN: &str = "input = \"demo:ellipsoid@1\"\n";
const OBJECTIVE: &str = "[[objectives]]\nfigure = \"cycles\"\ngoal = \"min\"\n";

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
        ("views = []", "line 4: views: is empty; expected a view at least, or no `views`"),
        ("axes.shade.mode = [\"normal\"]", "this is `bump`; set machine = \"shade\" in the plan"),
        ("config.\"replacement.lanes\" = 2", "config: `replacement.lanes`: has quotes around dots"),
    ];
    says(cases.map(|(rest, expected)| (format!("{HEAD}{rest}\n"), expected)));
}

#[test]
fn wrong_types_are_named_in_plain_words() {
    let cases = [
        ("max_cycles = -1", "line 4: max_cycles: the number -1 stands here, expected a whole number "),
        ("max_cycles = 1.5", "line 4: max_cycles: the number 1.5 stands here, expected a whole number"),
        ("max_cycles = 0", "line 4: max_cycles: the number 0 stands here, expected a whole number 1..=18446744073709551615"),
        ("title = 3", "line 4: title: the number 3 stands here, expected a text in quotes"),
        ("title = 1979-05-27", "line 4: title: a date stands here, expected a text in quotes"),
        ("view = 3", "line 4: view: the number 3 stands here, expected a table"),
        ("views = { turn = \"1,2\" }", "line 4: views: a table stands here, expected a list"),
        ("views = [{ turn = \"1,2\" },\n3]", "line 5: views[1]: the number 3 stands here, expected a table"),
        ("axes = [1]", "line 4: axes: a list stands here, expected a table"),
        ("zip = true", "line 4: zip: true stands here, expected a list"),
        ("exclude = \"lanes\"", "line 4: exclude: the text \"lanes\" stands here, expected a list"),
        ("config = 3", "line 4: config: expected parameters, as in a file of --config, or the name of such a file"),
        ("constraints = [\"cycles < 5\",\n3]", "line 5: constraints[1]: the number 3 stands here, expected a text in quotes"),
        ("samples = 3", "line 4: samples: the number 3 stands here, expected a table"),
        ("[samples]\nmethod = 3", "line 5: samples.method: expected one of its names in quotes"),
        ("[samples]\npoints = 3", "line 4: samples: missing field `method`"),
        (
            "[samples]\nmethod = \"sobol\"\npoints = \"3\"",
            "line 6: samples.points: the text \"3\" stands here, expected a whole number",
        ),
        ("[samples]\nmethod = \"sobol\"\npionts = 3", "line 6: samples.pionts: unknown field `pionts`, expected one of `method`"),
        ("[samples]\nmethod = \"sobel\"", "line 5: samples.method: unknown value `sobel`, expected one of `grid`"),
        ("axes.clock.hz = { from = \"a\", to = 4, step = 1 }", "axes.clock.hz: the text \"a\" stands here, expected a number"),
        ("axes.shade.mode = [3]", "axes: `shade.mode` is a parameter of machine `shade`"),
        ("axes.replacement.codebook = [3]", "axes: `replacement.codebook`: the number 3 stands here, expected one of its names"),
        ("axis = 3", "line 4: axis: unknown field `axis`, expected one of `title`, "),
    ];
    says(cases.map(|(rest, expected)| (format!("{HEAD}{rest}\n"), expected)));
}

#[test]
fn wrong_view_option_has_the_line_of_its_key() {
    let cases = [
        ("[view]\nframes = 1\nsise = 1", "line 6: view.sise: no option is called `sise`"),
        ("[view]\nsise = 1\n[[views]]\nframes = 1", "line 5: view.sise: no option is called `sise`"),
        ("[view]\nframes = 1\n[[views]]\n[[views]]\nsise = 1", "line 8: views[1].sise: no option is called `sise`"),
        ("views = [\n{ turn = \"1,2\" },\n{ sise = 1 }]", "line 6: views[1].sise: no option is called `sise`"),
        ("[[views]]\n[[views]]\norbit = 30", "line 6: views[1].orbit: 30; expected 0 with a single frame"),
        ("[view]\norbit = 30\n[[views]]\n", "line 5: view.orbit: 30; expected 0 with a single frame"),
    ];
    says(cases.map(|(rest, expected)| (format!("{HEAD}{rest}\n"), expected)));
    let trace = HEAD.replace("demo:ellipsoid@1", "quad.dl.jsonl");
    says([(format!("{trace}views = [{{}},\n{{}}]"), "line 4: views[0]: quad.dl.jsonl: is a trace, which has its own view")]);
}

#[test]
fn wrong_element_of_a_list_has_its_line() {
    let axes = "[axes]\nreplacement.lanes = [1]\n";
    let two = "objectives = [\n\"cycles min\",\n";
    let cases = [
        ("input = [\"demo:coin\",\n\"none.gltf\"]\nobjectives = [\"cycles min\"]".into(), "line 2: input: none.gltf: cannot"),
        ("input = [\"demo:coin\",\n3]\nobjectives = [\"cycles min\"]".into(), "line 2: input: is 3, expected the name of an"),
        (format!("{IN}{two}\"cycels min\"]"), "line 4: objectives: the report has no figure `cycels`"),
        (format!("{IN}{two}\"cycles least\"]"), "line 4: objectives: objective `cycles least`: expected"),
        (format!("{IN}{two}3]"), "line 4: objectives: expected \"FIGURE min\", \"FIGURE max\" or"),
        (format!("{IN}{two}\"cycles max\"]"), "line 4: objectives: `cycles.frames` is named twice"),
        (format!("{IN}{OBJECTIVE}{OBJECTIVE}"), "line 5: objectives: `cycles.frames` is named twice"),
        (format!("{IN}{OBJECTIVE}[[objectives]]\ngoal = \"min\"\nfigure = \"cycels\""), "line 5: objectives: the report has no"),
        (format!("{HEAD}constraints = [\n\"cycles < 5\",\n\"cycels < 5\"]"), "line 6: constraints: the report has no figure"),
        (format!("{HEAD}constraints = [\n\"cycles < 5\",\n\"cycles\"]"), "line 6: constraints: constraint `cycles`: expected"),
        (format!("{HEAD}{axes}[[exclude]]\nreplacement.lanes = 1\n[[exclude]]"), "line 8: exclude: names no parameter"),
    ];
    says(cases);
}

#[test]
fn names_quoted_with_dots_have_a_line() {
    let cases = [
        ("[axes]\n\"replacement.lanes\" = [0]", "line 5: axes: `replacement.lanes` is 0, expected"),
        ("[axes]\n\"replacement.lane\" = [1]", "line 5: axes: unknown parameter `replacement.lane`"),
        ("[axes]\nfifo.\"shaded.depth\" = [0]", "line 5: axes: `fifo.shaded.depth` is 0, expected"),
        ("[axes]\n\"fifo.shaded\".depth = [0]", "line 5: axes: `fifo.shaded.depth` is 0, expected"),
        ("[axes.\"fifo.shaded\"]\ndepth = []", "line 5: axes.fifo.shaded.depth: has no values"),
        ("[axes]\n\"replacement.lanes\" = [1]\nreplacement.lanes = [2]", "line 6: axes: `replacement.lanes` is on two axes"),
        ("[axes]\nreplacement.lanes = [1]\n\"replacement.lanes\" = [2]", "line 6: axes: `replacement.lanes` is on two axes"),
        ("[[zip]]\n\"replacement.lanes\" = [1]\n\"fifo.shaded.depth\" = [0]", "line 6: zip: `fifo.shaded.depth` is 0, expected"),
        (
            "[axes]\n\"replacement.lanes\" = [1]\n[[exclude]]\n\"replacement.lanes\" = 3",
            "line 7: exclude: `replacement.lanes` never",
        ),
        ("[config]\n\"replacement.lanes\" = 3", "line 5: config: `replacement.lanes`: has quotes around dots"),
    ];
    says(cases.map(|(rest, expected)| (format!("{HEAD}{rest}\n"), expected)));
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
        (format!("{zip}frame.width = [1]\nreplacement.entries = [16, 64]"), "line 8: zip: `frame.width` has 1 value and"),
        (zip.into(), "line 6: zip: names no parameter"),
        (format!("{exclude}replacement.lanes = 3"), "line 9: exclude: `replacement.lanes` never is 3"),
        (format!("{exclude}replacement.lane = 3"), "line 9: exclude: `replacement.lane` is on no axis; did you mean"),
        ("[config.replacement]\nlanes = 0".into(), "line 5: config: `replacement.lanes` is 0, expected 1..=65536"),
        ("\nconfig = \"wrong.toml\"".into(), "line 5: config: wrong.toml: line 2: `replacement.lanes` is 0, expected"),
        ("\nconfig = \"broken.toml\"".into(), "line 5: config: broken.toml: not valid TOML: TOML parse error at line 1"),
        ("\nconstraints = [\"cycels < 5\"]".into(), "line 5: constraints: the report has no figure `cycels`; did you mean"),
        ("\n[samples]\nmethod = \"sobol\"".into(), "line 5: samples: `points` says how many"),
        (
            "[samples]\nmethod = \"grid\"\npoints = 4".into(),
            "line 6: samples: a grid, or one value at a time, has all its points",
        ),
        ("[samples]\nmethod = \"sobol\"\npoints = 99999".into(), "line 6: 99999 points; expected at most 32768"),
        (
            "[axes]\nvideo_out.enabled = [3]".into(),
            "line 5: axes: `display.enabled`: the number 3 stands here, expected true or false",
        ),
        ("config = { video_out.enabled = 3 }".into(), "line 4: config: `display.enabled`: the number 3 stands here"),
    ];
    says(cases.map(|(rest, expected): (String, &str)| (format!("{HEAD}{rest}\n"), expected)));
}

#[test]
fn plan_head_errors_name_the_field() {
    let cases = [
        (
            "objectives = [\"cycles min\"]",
            "input: is missing; expected the name of an input, or a list of them; add for example input = \"demo:golf-ball\"",
        ),
        (
            "input = \"demo:coin\"",
            "objectives: is missing; expected a list of figures with their goals; add for example objectives = [\"cycles min\"]",
        ),
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
            "input = \"demo:ellipsoid@1\"\nmachine = \"bump\"\nobjectives = [\"derived.normal_map.hit_rate max\"]",
            "objectives: a trial run of demo:ellipsoid@1 has no figure `derived.normal_map.hit_rate`: the divisor of its formula, \
             caches.normal_map.hits / caches.normal_map.lookups, is 0 or unknown",
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
