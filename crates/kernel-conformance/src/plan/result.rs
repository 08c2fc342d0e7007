//! A run of a plan as canonical JSON.

use basrelief_kernel::{Outcome, PortCounts, RunReport};
use serde_json::{Map, Value, json};

/// The result of a run in the format of the executable reading of the laws: sorted keys, zero entries left out.
pub fn result(report: &RunReport) -> Value {
    let named = |names: &[String], cycles: &[u64]| -> Value {
        let mut map = Map::new();
        for (name, &n) in names.iter().zip(cycles).filter(|&(_, &n)| n > 0) {
            map.insert(name.clone(), json!(n));
        }
        Value::Object(map)
    };
    let units: Map<String, Value> = report
        .units
        .iter()
        .map(|u| {
            let a = &u.account;
            let unit = json!({
                "steps": u.steps, "busy": a.busy, "done": a.done,
                "starved": named(&u.inputs, &a.starved),
                "memory": named(&u.clients, &a.memory),
                "blocked": named(&u.outputs, &a.blocked),
            });
            (u.name.clone(), unit)
        })
        .collect();
    let mut memories = Map::new();
    for m in &report.memories {
        let port = |c: &PortCounts| {
            json!({
                "requests": c.requests(), "bursts": c.rows.bursts(),
                "row_hits": c.rows.hits, "row_closed": c.rows.closed, "row_conflicts": c.rows.conflicts,
            })
        };
        let ports: Map<_, _> = m.ports.iter().map(|p| (p.client.clone(), port(&p.counts))).collect();
        memories.insert(m.name.clone(), ports.into());
    }
    json!({
        "outcome": if report.outcome == Outcome::Complete { "complete" } else { "deadlock" },
        "total": report.total,
        "units": units,
        "fifos": report.fifos.iter().map(|f| (f.name.clone(), json!(f.histogram))).collect::<Map<_, _>>(),
        "memories": memories,
        "caches": report.caches.iter().map(|c| (c.name.clone(), json!(c.counts))).collect::<Map<_, _>>(),
    })
}
