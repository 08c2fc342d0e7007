//! Tests the service with the questions of the page.

use basrelief_input::MemoryPool;
use basrelief_report::{Report, compare};
use basrelief_scene::{ViewOptions, demo};
use basrelief_sim::{
    AnalysisPolicy, ExplainOptions, KeptRecording, MACHINES, MachineInfo, NoObserver, Overrides, RecordedRun, RunInput,
    RunOptions, explain, run,
};
use basrelief_web::{Message, SimulationService};
use serde_json::{Value, json};
use std::sync::Arc;

const SIZE: [u32; 2] = [48, 36];

fn send(service: &mut SimulationService, question: Value) -> Message {
    Message::read(&service.answer(&Message::from_json(question).into_bytes())).expect("an answer")
}

fn ask_with(service: &mut SimulationService, json: Value, rest: &[u8]) -> Value {
    let question = Message { json, rest: rest.to_vec() };
    Message::read(&service.answer(&question.into_bytes())).expect("an answer").json
}

/// Decodes the report of an answer.
fn reported(answer: &Message) -> Value {
    let place = serde_json::from_value(answer.json["report"].clone()).unwrap_or_else(|_| panic!("no report: {}", answer.json));
    serde_json::from_slice(answer.bytes(place).expect("a report")).expect("JSON")
}

fn error(answer: &Value) -> &str {
    answer["error"].as_str().unwrap_or_else(|| panic!("no error: {answer}"))
}

/// Returns the report of a run as the command line writes it.
fn report(machine: &str, name: &str, set: &[(&str, &str)]) -> Value {
    let settings = set.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
    let given = Overrides { toml: String::new(), settings };
    let config = given.config(MachineInfo::named(machine).unwrap(), &[]).unwrap();
    let options = RunOptions { config, overrides: given, bottlenecks: AnalysisPolicy::IfShort, ..RunOptions::default() };
    let scene = demo(name, &ViewOptions { size: SIZE, turn: Some([20.0, 5.0]), ..ViewOptions::default() }).unwrap();
    let report = run(RunInput::scene(Arc::new(scene)), &options, &mut NoObserver, None).unwrap().report;
    serde_json::to_value(report).unwrap()
}

#[test]
fn every_machine_returns_the_report_of_a_run() {
    let demos = [("bump", "cut-plane@1"), ("shade", "goblet@1"), ("texel", "corridor"), ("defer", "turntable")];
    for (machine, name) in demos {
        let mut service = SimulationService::default();
        assert_eq!(send(&mut service, json!({"ask": "demo", "name": name})).json["scene"], true);
        let view = json!({"size": SIZE, "turn": [20.0, 5.0]});
        let question = |depth: &str, exact: bool| {
            let set = json!([["fifo.polygons.depth", depth]]);
            json!({"ask": "run", "machine": machine, "set": set, "view": view, "exact": exact, "limits": exact})
        };
        // Earlier questions do not change the answer.
        for depth in ["8", "64"] {
            let quick = send(&mut service, question(depth, false));
            let whole = send(&mut service, question(depth, true));
            let expected = report(machine, name, &[("fifo.polygons.depth", depth)]);
            assert_eq!(reported(&quick)["cycles"], expected["cycles"], "{machine}");
            assert_eq!(reported(&whole), expected, "{machine}");
            let [image, exact] = [0, 1].map(|n| &whole.json["pictures"][n]);
            assert_eq!([&image["name"], &exact["name"]], ["image", "reference"]);
            let at = serde_json::from_value(image["at"].clone()).unwrap();
            assert_eq!(whole.bytes(at).map(<[u8]>::len), Some((4 * SIZE[0] * SIZE[1]) as usize));
        }
    }
}

#[test]
fn shown_command_repeats_the_run() {
    let mut service = SimulationService::default();
    send(&mut service, json!({"ask": "demo", "name": "goblet@1"}));
    let view = json!({"size": SIZE, "zoom": 1.5});
    let run = json!({"ask": "run", "machine": "shade", "set": [["shade.mode", "polyhedron"]], "view": view});
    let expected = "basrelief demo goblet@1 --size 48x36 --zoom 1.5 --set shade.mode=polyhedron";
    assert_eq!(send(&mut service, run).json["command"], expected);
    let other = json!({"ask": "run", "machine": "bump", "set": [], "view": {}});
    assert_eq!(send(&mut service, other).json["command"], "basrelief demo goblet@1 --machine bump");
}

#[test]
fn featured_parameters_exist() {
    let catalogue = send(&mut SimulationService::default(), json!({"ask": "catalogue"})).json;
    let machines = catalogue["machines"].as_array().unwrap();
    assert_eq!(machines.len(), MACHINES.len());
    for machine in machines {
        let keys: Vec<&Value> = machine["parameters"].as_array().unwrap().iter().map(|p| &p["key"]).collect();
        let main = machine["main"].as_array().unwrap();
        assert!(!main.is_empty(), "{}", machine["name"]);
        main.iter().for_each(|key| assert!(keys.contains(&key), "{key}"));
    }
}

#[test]
fn content_identifies_models_and_display_lists() {
    let obj = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let mut service = SimulationService::default();
    let files = json!([{"name": "a.obj", "at": [0, obj.len()]}]);
    let taken = ask_with(&mut service, json!({"ask": "files", "name": "a.obj", "files": files}), obj);
    assert_eq!(taken["triangles"], 1);
    let run = json!({"ask": "run", "machine": "shade", "set": [], "view": {"size": SIZE}});
    assert_eq!(send(&mut service, run.clone()).json["command"], "basrelief run a.obj --machine shade --size 48x36");

    let list = basrelief_sim::doc_trace();
    let files = json!([{"name": "quad.dl.jsonl", "at": [0, list.len()]}]);
    let taken = ask_with(&mut service, json!({"ask": "files", "name": "quad.dl.jsonl", "files": files}), &list);
    assert_eq!(taken["scene"], false);
    // A display list has its own view.
    let answer = send(&mut service, run);
    assert_eq!(answer.json["command"], "basrelief run quad.dl.jsonl --machine shade");
    assert!(reported(&answer)["cycles"]["total"].as_u64().unwrap() > 0);
}

#[test]
fn compressed_input_names_file_and_cure() {
    let mut service = SimulationService::default();
    let zstd = [0x28, 0xb5, 0x2f, 0xfd, 0x04, 0x00, 0x00, 0x00];
    let mut refused = |name: &str| {
        let files = json!([{"name": name, "at": [0, zstd.len()]}]);
        error(&ask_with(&mut service, json!({"ask": "files", "name": name, "files": files}), &zstd)).to_owned()
    };
    let reason = "is compressed with zstd, which this page cannot read; expected a model or an uncompressed trace";
    assert_eq!(refused("x.bdl.zst"), format!("x.bdl.zst: {reason}; `basrelief convert x.bdl.zst x.bdl` decompresses a trace"));
    assert_eq!(refused("a b"), format!("a b: {reason}; `basrelief convert 'a b' 'a b.bdl'` decompresses a trace"));
    assert_eq!(
        refused("run.recording"),
        "run.recording: the recording of a run, expected a model or a trace; `basrelief resimulate run.recording` reads it"
    );
}

#[test]
fn pictures_of_several_frames_name_the_last_frame() {
    let mut service = SimulationService::default();
    send(&mut service, json!({"ask": "demo", "name": "cut-plane@1"}));
    let about = |service: &mut SimulationService, frames: u32| {
        let view = json!({"size": SIZE, "frames": frames});
        let run = json!({"ask": "run", "machine": "bump", "set": [], "view": view, "exact": true});
        send(service, run).json["pictures"][0]["about"].as_str().unwrap().to_owned()
    };
    assert_eq!(about(&mut service, 3), "the machine's image, frame 3 of 3");
    assert_eq!(about(&mut service, 1), "the machine's image");
}

#[test]
fn errors_are_responses() {
    let mut service = SimulationService::default();
    let run = |set: Value| json!({"ask": "run", "machine": "bump", "set": set, "view": {"size": SIZE}});
    assert!(error(&send(&mut service, run(json!([]))).json).contains("nothing to draw yet"));
    assert!(error(&send(&mut service, json!({"ask": "demo", "name": "teapot"})).json).contains("no demo is called `teapot`"));
    send(&mut service, json!({"ask": "demo", "name": "cut-plane@1"}));
    assert!(error(&send(&mut service, run(json!([["replacement.lanes", "0"]]))).json).contains("expected 1..=65536"));
    assert!(error(&send(&mut service, run(json!([["lanes", "1"]]))).json).contains("unknown parameter"));
    let lathe = json!({"ask": "run", "machine": "lathe", "set": [], "view": {}});
    assert!(error(&send(&mut service, lathe).json).contains("no machine is called `lathe`"));
    assert!(error(&send(&mut service, json!({"ask": "dance"})).json).contains("no question"));
    let files = json!([{"name": "a.glb", "at": [0, 9]}]);
    assert!(error(&ask_with(&mut service, json!({"ask": "files", "name": "a.glb", "files": files}), b"short")).contains("a.glb"));
    let broken = json!([{"name": "a.glb", "at": [0, 5]}]);
    assert!(
        error(&ask_with(&mut service, json!({"ask": "files", "name": "a.glb", "files": broken}), b"short"))
            .starts_with("a.glb: ")
    );
    assert_eq!(service.answer(b"no"), service.answer(b"\xff\xff\xff\xff"));
    // The previous input is still drawn.
    assert!(reported(&send(&mut service, run(json!([]))))["cycles"]["total"].is_u64());
}

/// Returns the report and the recording of a run of the golf ball, as the command line makes them.
fn recorded(set: &[(&str, &str)]) -> (Report, RecordedRun) {
    let budget = MemoryPool::default();
    let settings = set.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
    let overrides = Overrides { toml: String::new(), settings };
    let config = overrides.config(MachineInfo::named("bump").unwrap(), &[]).unwrap();
    let options = RunOptions { config, overrides, exact: false, recording: AnalysisPolicy::Always, ..RunOptions::default() };
    let mut kept = KeptRecording::new(&budget);
    let report = run(golf_ball(), &options, &mut kept, None).unwrap().report;
    let recording = RecordedRun::read(&report, &mut kept.bytes(), &budget).unwrap();
    (report, recording)
}

fn golf_ball() -> RunInput {
    RunInput::scene(Arc::new(demo("golf-ball", &ViewOptions { size: SIZE, ..ViewOptions::default() }).unwrap()))
}

// Claim: analysis: The page attributes a difference to the parameters that the user changed, as `compare` does.
#[test]
fn explanation_of_the_page_is_that_of_compare() {
    let mut service = SimulationService::default();
    assert_eq!(error(&send(&mut service, json!({"ask": "explain"})).json), "a comparison needs two recorded runs");
    send(&mut service, json!({"ask": "demo", "name": "golf-ball"}));
    let sides = [
        ("a", vec![("replacement.lanes", "64"), ("replacement.entries", "32")]),
        ("b", vec![("replacement.lanes", "16"), ("replacement.entries", "64"), ("fifo.indexes.depth", "2")]),
    ];
    for (side, set) in &sides {
        let run = json!({"machine": "bump", "set": set, "view": {"size": SIZE}});
        send(&mut service, json!({"ask": "record", "side": side, "run": run}));
    }
    let told = send(&mut service, json!({"ask": "explain"})).json;
    let [(a, recording_a), (b, recording_b)] = sides.map(|(_, set)| recorded(&set));
    let (open, budget) = (|| Some(golf_ball()), MemoryPool::default());
    let options = ExplainOptions { input: Some(&open), progress: &|_, _| {}, budget: &budget };
    let causes = explain(&recording_a, &recording_b, &options).unwrap();
    assert_eq!(told["text"], compare(&a, &b, Some(causes.clone())).explanation);
    let mut rows: Vec<Value> = causes.shares.iter().map(|share| json!({"cause": share.parameter, "by": share.by})).collect();
    rows.push(json!({"cause": "interaction", "by": causes.together}));
    assert_eq!(told["causes"], json!(rows));
    assert_eq!(rows.len(), 4, "a row for each changed parameter");
}

#[test]
fn steps_fill_every_cycle_of_a_unit() {
    let mut service = SimulationService::default();
    send(&mut service, json!({"ask": "demo", "name": "golf-ball"}));
    let mut ask = json!({"ask": "run", "machine": "bump", "set": [], "view": {"size": [24, 18]}});
    let report = reported(&send(&mut service, ask.clone()));
    ask["ask"] = json!("steps");
    let total = report["cycles"]["total"].as_u64().unwrap();
    let mut busy = vec![0; report["units"].as_object().unwrap().len()];
    let mut texts = String::new();
    for from in (0..total).step_by(4096) {
        let to = total.min(from + 4096);
        ask["cycles"] = json!([from, to]);
        let told = send(&mut service, ask.clone()).json;
        let mut ends = vec![from; busy.len()];
        for step in told["steps"].as_array().unwrap_or_else(|| panic!("{told}")) {
            let [unit, first, end] = [0, 1, 2].map(|n| step[n].as_u64().unwrap());
            assert_eq!(std::mem::replace(&mut ends[unit as usize], end), first, "{step}");
            busy[unit as usize] += if step[3] == "busy" { end - first } else { 0 };
            texts.push_str(step[4].as_str().unwrap());
        }
        // A unit has no steps after its last one.
        assert!(ends.iter().all(|end| *end == to || to == total), "{ends:?} {to}");
    }
    let mut expected: Vec<u64> = report["units"].as_object().unwrap().values().map(|u| u["busy"].as_u64().unwrap()).collect();
    [&mut busy, &mut expected].into_iter().for_each(|all| all.sort_unstable());
    assert_eq!(busy, expected, "the report counts the same busy cycles");
    for argument in ["frame 1", "polygon 3", "1 pixel at ", "uses "] {
        assert!(texts.contains(argument), "{argument}");
    }
    for (from, to) in [(5, 5), (9, 5), (0, 4097)] {
        ask["cycles"] = json!([from, to]);
        let told = send(&mut service, ask.clone()).json;
        assert!(error(&told).contains("expected 1 to 4096 cycles"), "{told}");
    }
}
