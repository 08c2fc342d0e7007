//! Checks of a plan before a machine is built.

use super::format::{Plan, PlanFlips, PlanLookUp, PlanRequest, PlannedUnit, UnitKind};
use basrelief_kernel::{MAX_CLIENTS, MAX_LINKS};
use basrelief_parameters::Parameters;
use std::collections::BTreeMap;
use std::ops::RangeInclusive;

/// Error of an invalid plan.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{place}: {what}")]
pub struct PlanError {
    /// The invalid FIFO, memory, cache or unit.
    pub place: String,
    /// The error and the expectation.
    pub what: String,
}

/// Maximum number of slots, banks, credits and tags. The limit prevents a number in a file from exhausting memory.
const MOST: u64 = 1 << 20;
/// Maximum time \[cycles\]. It is long enough for any idle stretch, and far from the end of a 64-bit count.
const LONGEST: u64 = 1 << 40;

fn fail<T>(place: &str, what: impl Into<String>) -> Result<T, PlanError> {
    Err(PlanError { place: place.into(), what: what.into() })
}

fn check_range(place: &str, field: &str, value: u64, range: RangeInclusive<u64>) -> Result<(), PlanError> {
    if range.contains(&value) {
        return Ok(());
    }
    fail(place, format!("`{field}` is {value}, expected {}..={}", range.start(), range.end()))
}

fn distinct<'p>(kind: &str, names: impl Iterator<Item = &'p String>) -> Result<(), PlanError> {
    let mut all: Vec<_> = names.collect();
    all.sort();
    match all.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => fail(&format!("{kind} `{}`", pair[0]), "there are two of this name, expected one"),
        None => Ok(()),
    }
}

/// Checks all assumptions of the machine and its units.
pub(super) fn check(plan: &Plan) -> Result<(), PlanError> {
    distinct("FIFO", plan.fifos.iter().map(|f| &f.name))?;
    distinct("memory", plan.memories.iter().map(|m| &m.name))?;
    let unit_ports = plan.memories.iter().flat_map(|m| &m.ports).map(|p| &p.name);
    distinct("port", unit_ports.chain(plan.memories.iter().flat_map(|m| &m.periodic).map(|p| &p.name)))?;
    distinct("cache", plan.caches.iter().map(|c| &c.name))?;
    distinct("unit", plan.units.iter().map(|u| &u.name))?;
    for f in &plan.fifos {
        let place = format!("FIFO `{}`", f.name);
        check_range(&place, "depth", f.depth as u64, 1..=MOST)?;
        check_range(&place, "latency", f.latency, 1..=LONGEST)?;
        check_range(&place, "period", f.period, 1..=LONGEST)?;
    }
    memories(plan)?;
    caches(plan)?;
    plan.units.iter().try_for_each(unit)?;
    check_fifo_ends(plan)?;
    ports(plan)
}

fn memories(plan: &Plan) -> Result<(), PlanError> {
    for m in &plan.memories {
        let place = format!("memory `{}`", m.name);
        m.config.check("").or_else(|error| fail(&place, error.to_string()))?;
        let (refi, rest) = (m.config.refi, u64::from(m.config.rfc) + u64::from(m.config.rcd));
        if refi > 0 && u64::from(refi) <= rest {
            return fail(&place, format!("`refi` is {refi}, expected 0 or more than `rfc` and `rcd` together, {rest}"));
        }
        for p in &m.ports {
            let place = format!("port `{}`", p.name);
            check_range(&place, "outstanding", p.outstanding.into(), 1..=MOST)?;
            if let Some(PlanFlips { of, period, hold, .. }) = &p.flips {
                check_range(&place, "period", *period, 1..=LONGEST)?;
                check_range(&place, "hold", *hold, 0..=LONGEST)?;
                if !m.periodic.iter().any(|periodic| periodic.name == *of) {
                    return fail(&place, format!("there is no periodic client `{of}` in memory `{}`", m.name));
                }
            }
        }
        for p in &m.periodic {
            let place = format!("periodic client `{}`", p.name);
            check_range(&place, "period", p.period, 1..=LONGEST)?;
            check_range(&place, "bytes", p.bytes.into(), 1..=MOST)?;
            check_range(&place, "span", p.span, 1..=LONGEST)?;
        }
    }
    Ok(())
}

fn caches(plan: &Plan) -> Result<(), PlanError> {
    for c in &plan.caches {
        let place = format!("cache `{}`", c.name);
        for (field, value) in
            [("line_bytes", c.line_bytes), ("sets", c.sets), ("ways", c.ways), ("lookups_per_cycle", c.lookups_per_cycle)]
        {
            check_range(&place, field, value.into(), 1..=MOST)?;
        }
        check_range(&place, "sets times ways", u64::from(c.sets) * u64::from(c.ways), 1..=MOST)?;
        check_range(&place, "hit_latency", c.hit_latency.into(), 0..=MOST)?;
    }
    Ok(())
}

/// Checks one unit by itself.
fn unit(unit: &PlannedUnit) -> Result<(), PlanError> {
    let place = format!("unit `{}`", unit.name);
    let most = MAX_LINKS as u64;
    let (ins, outs) = match unit.kind {
        UnitKind::Source { .. } => (0..=0, 1..=1),
        UnitKind::Work | UnitKind::Fork | UnitKind::Access { .. } | UnitKind::Cached { .. } | UnitKind::Mixed { .. } => {
            (1..=1, 0..=most)
        }
        UnitKind::Join | UnitKind::Merge { .. } => (1..=most, 1..=1),
        UnitKind::Route => (1..=1, 1..=most),
        UnitKind::Expand { .. } | UnitKind::Gather { .. } => (1..=1, 1..=1),
        UnitKind::Gate { .. } => (2..=2, 1..=1),
        UnitKind::Tap { .. } => (1..=1, 2..=2),
        UnitKind::Sink => (1..=most, 0..=0),
    };
    check_range(&place, "length of in", unit.inputs.len() as u64, ins)?;
    check_range(&place, "length of out", unit.outputs.len() as u64, outs)?;
    check_range(&place, "length of occupancy", unit.occupancy.len() as u64, 1..=MOST)?;
    check_range(&place, "length of latency", unit.latency.len() as u64, 1..=MOST)?;
    unit.occupancy.iter().try_for_each(|&o| check_range(&place, "occupancy", o, 1..=LONGEST))?;
    unit.latency.iter().try_for_each(|&l| check_range(&place, "latency", l, 0..=LONGEST))?;
    check_range(&place, "length of after", unit.after.len() as u64, 0..=MOST)?;
    match &unit.kind {
        UnitKind::Expand { factor } => check_range(&place, "factor", *factor, 1..=LONGEST),
        UnitKind::Gather { size } | UnitKind::Gate { size } | UnitKind::Tap { size } => {
            check_range(&place, "size", *size, 1..=LONGEST)
        }
        UnitKind::Access { requests } => check_requests(&place, requests),
        UnitKind::Cached { lookups, .. } => check_look_ups(&place, lookups),
        UnitKind::Mixed { requests, every, lookups, look_up_every, blocks, .. } => {
            check_range(&place, "length of every", every.len() as u64, 1..=MOST)?;
            check_range(&place, "length of blocks", blocks.len() as u64, 1..=MOST)?;
            every.iter().chain([look_up_every]).try_for_each(|&n| check_range(&place, "every", n, 1..=LONGEST))?;
            check_requests(&place, requests)?;
            check_look_ups(&place, lookups)
        }
        _ => Ok(()),
    }
}

fn check_requests(place: &str, requests: &[PlanRequest]) -> Result<(), PlanError> {
    requests.iter().try_for_each(|r| {
        check_range(place, "bytes", r.bytes.into(), 1..=MOST)?;
        check_range(place, "span", r.span, 1..=LONGEST)
    })
}

fn check_look_ups(place: &str, look_ups: &[PlanLookUp]) -> Result<(), PlanError> {
    check_range(place, "length of lookups", look_ups.len() as u64, 1..=u16::MAX.into())?;
    look_ups.iter().try_for_each(|l| check_range(place, "span", l.span, 1..=LONGEST))
}

/// Checks that every FIFO has one unit at each end, and that these units differ.
fn check_fifo_ends(plan: &Plan) -> Result<(), PlanError> {
    let mut ends: BTreeMap<&str, [Vec<&str>; 2]> = plan.fifos.iter().map(|f| (f.name.as_str(), Default::default())).collect();
    for u in &plan.units {
        for (end, names) in [&u.inputs, &u.outputs].into_iter().enumerate() {
            for name in names {
                match ends.get_mut(name.as_str()) {
                    Some(users) => users[end].push(&u.name),
                    None => return fail(&format!("unit `{}`", u.name), format!("there is no FIFO `{name}` in \"fifos\"")),
                }
            }
        }
    }
    for (name, [poppers, pushers]) in &ends {
        match (poppers.as_slice(), pushers.as_slice()) {
            ([popper], [pusher]) if popper != pusher => {}
            _ => {
                let what = format!("is pushed to by {pushers:?} and popped by {poppers:?}, expected one unit each, not the same");
                return fail(&format!("FIFO `{name}`"), what);
            }
        }
    }
    Ok(())
}

/// Checks that every port belongs to one unit or one cache, and has enough credits for the unit's largest step.
fn ports(plan: &Plan) -> Result<(), PlanError> {
    let credits: BTreeMap<&str, u64> =
        plan.memories.iter().flat_map(|m| &m.ports).map(|p| (p.name.as_str(), p.outstanding.into())).collect();
    let mut owners: BTreeMap<&str, &str> = BTreeMap::new();
    for u in &plan.units {
        let place = format!("unit `{}`", u.name);
        for (port, needs) in port_needs(plan, u)? {
            let Some(&credits) = credits.get(port) else {
                return fail(&place, format!("there is no port `{port}` in \"memories\""));
            };
            if needs > credits {
                return fail(&place, format!("needs {needs} credits of port `{port}`, whose `outstanding` is {credits}"));
            }
            if let Some(owner) = owners.insert(port, &u.name) {
                return fail(&place, format!("uses port `{port}`, which belongs to `{owner}`; give it one of its own"));
            }
        }
    }
    for c in &plan.caches {
        let place = format!("cache `{}`", c.name);
        let shared = plan.caches.iter().filter(|other| other.port == c.port).count();
        check_range(&place, "number of caches on its port", shared as u64, 1..=1)?;
    }
    Ok(())
}

/// Returns the credits for a unit's largest step, by port.
fn port_needs<'p>(plan: &'p Plan, unit: &'p PlannedUnit) -> Result<BTreeMap<&'p str, u64>, PlanError> {
    let place = format!("unit `{}`", unit.name);
    let mut needs: BTreeMap<&str, u64> = BTreeMap::new();
    unit.kind.requests().iter().for_each(|r| *needs.entry(&r.port).or_default() += 1);
    if let Some(cache) = unit.kind.cache() {
        match plan.caches.iter().find(|c| c.name == cache) {
            Some(c) if needs.contains_key(c.port.as_str()) => {
                return fail(&place, format!("issues requests on port `{}` of its cache, expected another port", c.port));
            }
            Some(c) => {
                needs.insert(&c.port, unit.kind.look_ups().len() as u64);
            }
            None => return fail(&place, format!("there is no cache `{cache}` in \"caches\"")),
        }
    }
    check_range(&place, "number of ports", needs.len() as u64, 0..=MAX_CLIENTS as u64)?;
    Ok(needs)
}
