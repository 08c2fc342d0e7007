//! Identity of a point: a hash over everything that its report depends on, except the build of the simulator. A point keeps its identity
//! from build to build; its [folder](crate::folder) states the build.

use super::definition::Plan;
use crate::OpenedInput;
use basrelief_parameters::Effect;
use basrelief_report::SCHEMA;
use serde_json::Value;
use sha2::{Digest as _, Sha256};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// First hashed line.
const KIND: &str = "basrelief-point/2";

/// All of an input that a report depends on.
pub(super) fn of_input(name: &str, opened: &OpenedInput, sha256: &str) -> String {
    let (kind, name, warnings) = match opened {
        OpenedInput::Scene(prepared) => ("scene", prepared.scene().name.clone(), prepared.scene().warnings.clone()),
        OpenedInput::Trace => ("trace", name.to_owned(), vec![]),
    };
    // Reports name a file without its folder.
    let file = Path::new(&name).file_name().map_or_else(|| name.clone(), |file| file.to_string_lossy().into_owned());
    serde_json::json!([kind, file, sha256, warnings]).to_string()
}

/// Common part of the hashes of all points of a plan.
pub(super) struct PlanIdentity {
    /// Parameters that change times or costs only.
    timing: BTreeSet<String>,
    head: String,
}

impl PlanIdentity {
    pub(super) fn of(plan: &Plan) -> Self {
        let timing = plan.machine.parameters().into_iter().filter(|p| p.effect != Effect::Work).map(|p| p.key).collect();
        let limit = Some(plan.max_cycles).filter(|most| *most < u64::MAX);
        let head = serde_json::json!([KIND, SCHEMA, plan.machine.name, limit]).to_string();
        Self { timing, head }
    }

    /// The hash over all that the report of a point depends on, and over all that its work does.
    pub(super) fn hashes(&self, plan: &Plan, input: usize, places: &[usize]) -> (String, String) {
        let mut values = BTreeMap::new();
        match plan.config(places) {
            Ok(config) => parameters(&config.to_value(), &mut String::new(), &mut values),
            // An invalid point never runs, so it has an identity of its own.
            Err(_) => values.extend(plan.settings(places)),
        }
        let [mut all, mut work] = [(); 2].map(|()| {
            Sha256::new()
                .chain_update(&self.head)
                .chain_update("\n")
                .chain_update(&plan.inputs[input].identity)
                .chain_update("\n")
        });
        for (key, value) in &values {
            let line = format!("{key}={value}\n");
            all.update(&line);
            if !self.timing.contains(key) {
                work.update(&line);
            }
        }
        (hexadecimal(all), hexadecimal(work))
    }
}

/// Collects dotted names and values, sorted, because the order of JSON's keys depends on features that other crates may enable.
fn parameters(value: &Value, key: &mut String, found: &mut BTreeMap<String, String>) {
    let Some(group) = value.as_object() else {
        found.insert(key.clone(), value.to_string());
        return;
    };
    let before = key.len();
    for (name, value) in group {
        if before > 0 {
            key.push('.');
        }
        key.push_str(name);
        parameters(value, key, found);
        key.truncate(before);
    }
}

/// The digest as text.
fn hexadecimal(hash: Sha256) -> String {
    hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}
