//! Points of plans.

use crate::support::{HEAD, Program, plan};
use std::collections::BTreeSet;

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
