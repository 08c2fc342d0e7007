//! Properties of every machine, tested with random plans.

use crate::common::random::{GraphPart, recipe, tight_recipe};
use crate::common::{machine, report, run_both, sink_tokens};
use basrelief_kernel::{
    CacheCounts, Cycle, CycleAccount, Deadlock, Engine, Interval, MemoryEvent, Outcome, Recorder, RunLimits, RunReport,
    StallCause, UnitReport, run, run_with,
};
use basrelief_kernel_conformance::plan::{Plan, PlanMachine, PlanMemory, Token, result};
use proptest::prelude::*;

/// Returns the blocked units in order of name.
fn stuck(deadlock: &Deadlock) -> Vec<String> {
    let mut clauses: Vec<_> = deadlock.stuck.iter().map(ToString::to_string).collect();
    clauses.sort_unstable();
    clauses
}

proptest! {
    // Claim: as no_token_is_lost_doubled_or_reordered.
    #[test]
    fn both_engines_give_equal_reports(recipe in recipe()) {
        // `run_both` compares the engines. A separate test lets a difference shrink to the smallest plan.
        let plan = recipe.plan().0;
        let (report, _) = run_both(&plan, u64::MAX);
        prop_assert_eq!(&silent(&plan, Engine::Ticked, u64::MAX), &report);
    }

    // Claim: as no_token_is_lost_doubled_or_reordered.
    #[test]
    fn order_of_units_does_not_matter(recipe in recipe()) {
        let (here, there) = (report(&recipe.plan().0), report(&recipe.reordered()));
        prop_assert_eq!(result(&here), result(&there));
        if let (Outcome::Deadlock(here), Outcome::Deadlock(there)) = (&here.outcome, &there.outcome) {
            prop_assert_eq!(stuck(here), stuck(there));
        }
    }

    // Claim: as busy_starved_blocked_done.
    #[test]
    fn accounts_and_histograms_sum_to_total(recipe in recipe()) {
        let report = report(&recipe.plan().0);
        for unit in &report.units {
            prop_assert_eq!(unit.account.total(), report.total, "{}", &unit.name);
        }
        for fifo in &report.fifos {
            prop_assert_eq!(fifo.histogram.iter().sum::<u64>(), report.total, "{}", &fifo.name);
        }
        for cache in &report.caches {
            let c = cache.counts;
            let port = report.memories.iter().flat_map(|m| &m.ports);
            prop_assert!(port.map(|p| p.counts.reads).any(|reads| reads == c.misses), "a line request per miss");
        }
    }

    // Claim: laws, all: On random machines no token is lost, the order of units has no effect, and both engines give equal reports.
    #[test]
    fn no_token_is_lost_doubled_or_reordered(recipe in recipe()) {
        let (plan, tokens) = recipe.plan();
        let [timed, functional] = sink_tokens(&plan);
        let expected: Vec<Token> = (0..tokens).map(|id| Token { id, last: id + 1 == tokens }).collect();
        prop_assert_eq!(&timed, &functional);
        let [(_, seen)] = timed.as_slice() else { panic!("one sink") };
        if report(&plan).outcome == Outcome::Complete {
            prop_assert_eq!(seen, &expected);
        } else {
            prop_assert!(seen.len() < expected.len() && expected.starts_with(seen));
        }
    }

    #[test]
    fn shallow_graph_reports_deadlock_by_name(recipe in tight_recipe()) {
        let (plan, _) = recipe.plan();
        let outcome = report(&plan).outcome;
        // About half of the plans deadlock.
        let Outcome::Deadlock(deadlock) = outcome else { return Ok(()) };
        prop_assert!(deadlock.is_any_full());
        prop_assert!(deadlock.circle.len() > 1, "{:?}", deadlock.circle);
        let text = deadlock.to_string();
        let full = plan.fifos.iter().filter(|f| {
            text.contains(&format!("waits for a slot in `{}` ({} of {} slots)", f.name, f.depth, f.depth))
        });
        prop_assert!(full.count() > 0, "{}", text);
        let sink = &plan.units.last().unwrap().name;
        let starved = format!("`{sink}` waits for a token from ");
        prop_assert!(text.contains(&starved), "{}", text);
    }

    // Claim: laws, 2: Without memories, more slots in a FIFO never take more cycles.
    #[test]
    fn deeper_fifo_never_slows_a_machine_without_memory(mut recipe in recipe(), fifo in any::<prop::sample::Index>(), more in 1..9_usize) {
        recipe.parts.retain(|part| !matches!(part, GraphPart::Access { .. } | GraphPart::Cached { .. }));
        let (mut plan, _) = recipe.plan();
        let before = run(&mut machine(&plan), Engine::Timed);
        let fifos = plan.fifos.len();
        plan.fifos[fifo.index(fifos)].depth += more;
        let after = run(&mut machine(&plan), Engine::Timed);
        prop_assume!(before.outcome == Outcome::Complete);
        prop_assert_eq!(after.outcome, Outcome::Complete);
        prop_assert!(after.total <= before.total, "{} cycles, then {}", before.total, after.total);
    }

    #[test]
    fn two_runs_are_equal(recipe in recipe()) {
        let (plan, _) = recipe.plan();
        let [first, second] = [0, 1].map(|_| run(&mut machine(&plan), Engine::Timed));
        prop_assert_eq!(first, second);
    }

    #[test]
    fn probe_intervals_cover_each_units_time(recipe in recipe()) {
        let (plan, _) = recipe.plan();
        let (report, intervals) = run_both(&plan, u64::MAX);
        for (unit, intervals) in report.units.iter().zip(&intervals.stages) {
            let mut at = 0;
            let mut busy = 0;
            for interval in intervals {
                prop_assert_eq!(interval.from.0, at, "a gap in {}", &unit.name);
                prop_assert!(interval.to > interval.from);
                at = interval.to.0;
                busy += if interval.cause.is_none() { at - interval.from.0 } else { 0 };
            }
            prop_assert_eq!(busy, unit.account.busy);
            prop_assert_eq!(at + unit.account.done, report.total, "{}", &unit.name);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// The FIFO levels reported to a probe sum to the FIFO's histogram.
    #[test]
    fn fifo_levels_add_up_to_histograms(recipe in recipe()) {
        let (report, seen) = run_both(&recipe.plan().0, u64::MAX);
        for (number, fifo) in report.fifos.iter().enumerate() {
            let fills = seen.fifos.get(number).cloned().unwrap_or_default();
            let mut histogram = vec![0; fifo.depth + 1];
            let (mut from, mut held) = (0, 0);
            for (at, slots) in fills.into_iter().map(|(at, slots)| (at.0, slots)).chain([(report.total, 0)]) {
                prop_assert!(at >= from && (slots != held || at == report.total), "reported once per change");
                histogram[held] += at - from;
                (from, held) = (at, slots);
            }
            prop_assert_eq!(&histogram, &fifo.histogram, "{}", &fifo.name);
        }
    }

    /// The number of visible tokens is 0 in each cycle in which the consumer is starved, and at most that of occupied slots.
    #[test]
    fn starved_unit_has_no_visible_token(recipe in recipe(), limit in prop::option::of(1..200_u64)) {
        let plan = recipe.plan().0;
        let (report, seen) = run_both(&plan, limit.unwrap_or(u64::MAX));
        for (number, fifo) in report.fifos.iter().enumerate() {
            let [visible, held] = [&seen.visible, &seen.fifos].map(|of| of.get(number).map_or(&[][..], Vec::as_slice));
            prop_assert!(visible.is_sorted_by(|a, b| a.0 < b.0 && a.1 != b.1), "reported once per change");
            let level = |of: &[(Cycle, usize)], at: Cycle| of[..of.partition_point(|change| change.0 <= at)].last().map_or(0, |c| c.1);
            for (at, tokens) in visible {
                prop_assert!(at.0 < report.total && *tokens <= level(held, *at), "{} in {}", &fifo.name, at.0);
            }
            for (unit, intervals) in report.units.iter().zip(&seen.stages) {
                let Some(input) = unit.inputs.iter().position(|input| *input == fifo.name) else { continue };
                for wait in intervals.iter().filter(|wait| wait.cause == Some(StallCause::Starved(input))) {
                    prop_assert_eq!(level(visible, wait.from), 0, "{} in {}", &fifo.name, wait.from.0);
                    prop_assert!(visible.iter().all(|(at, _)| *at <= wait.from || *at >= wait.to), "{}", &fifo.name);
                }
            }
        }
    }

    /// The memory events reported to a probe sum to the memory's counts.
    #[test]
    fn memory_events_add_up_to_report(recipe in recipe()) {
        let plan = recipe.plan().0;
        let (report, seen) = run_both(&plan, u64::MAX);
        if report.outcome != Outcome::Complete {
            return Ok(());
        }
        let mut client = 0;
        for (m, memory) in report.memories.iter().enumerate() {
            for (c, channel) in memory.channels.iter().enumerate() {
                let moved = intervals(&seen, [0, m, c, 0]);
                // The last bursts of a periodic client may move their data after the end of the run.
                let late = channel.rows.bursts() - moved.len() as u64;
                prop_assert!(late == 0 || !plan.memories[m].periodic.is_empty());
                prop_assert_eq!(moved.iter().map(|(from, to)| to - from).sum::<u64>(), channel.bus_busy);
                prop_assert!(moved.iter().all(|(_, to)| *to <= report.total) && moved.is_sorted_by(|a, b| a.1 <= b.0));
                let banks = plan.memories[m].config.banks as usize;
                let rows: Vec<_> = (0..banks).map(|bank| intervals(&seen, [1, m, c, bank])).collect();
                prop_assert_eq!(rows.iter().map(Vec::len).sum::<usize>() as u64, channel.rows.closed + channel.rows.conflicts);
                prop_assert!(rows.iter().all(|rows| rows.is_sorted_by(|a, b| a.1 <= b.0) && rows.iter().all(|(from, to)| from <= to)));
                prop_assert_eq!(area(&seen, [2, m, c, 0], report.total), channel.queued);
            }
            for port in &memory.ports {
                let is_own = |e: &&MemoryEvent| matches!(e, MemoryEvent::Moved { client: of, .. } if *of == client);
                if moves_no_data_for_units(&plan, &port.client) {
                    client += 1;
                    continue;
                }
                let bursts = seen.memories.values().flatten().filter(is_own).count() as u64;
                prop_assert_eq!(bursts, port.counts.rows.bursts(), "{}", &port.client);
                let used = port.counts.latencies.used_classes().iter().zip(0..);
                let least: u64 = used.map(|(answers, class)| answers << class).sum();
                let held = area(&seen, [3, client, 0, 0], report.total);
                prop_assert!((least..=2 * least).contains(&held), "{held} cycles in flight, {least} at least");
                client += 1;
            }
        }
        // In order of addition, as in the report.
        let looked_up: Vec<CacheCounts> = seen.memories.range([4, 0, 0, 0]..).map(|(_, events)| found(events)).collect();
        let counted: Vec<CacheCounts> = report.caches.iter().map(|cache| cache.counts).filter(|c| *c != CacheCounts::default()).collect();
        prop_assert_eq!(looked_up, counted);
    }

    #[test]
    fn every_cycle_limit_gives_equal_reports(recipe in recipe(), first in 0..64_u64) {
        let (plan, _) = recipe.plan();
        let whole = report(&plan);
        // Tests every limit of a short run, and about 64 limits of a long run, different ones in each case.
        let stride = whole.total / 64 + 1;
        for max_cycles in (first % stride..whole.total + 3).step_by(stride as usize) {
            let (cut, seen) = run_both(&plan, max_cycles);
            // Without a probe, memories serve runs of reads at once.
            prop_assert_eq!(&silent(&plan, Engine::Timed, max_cycles), &cut);
            prop_assert_eq!(&silent(&plan, Engine::Ticked, max_cycles), &cut);
            prop_assert!(cut.total <= max_cycles.max(whole.total));
            if cut.outcome != Outcome::Limit {
                prop_assert_eq!(&cut, &whole);
            }
            for unit in &cut.units {
                prop_assert_eq!(unit.account.total(), cut.total, "{}", &unit.name);
            }
            for (stage, unit) in cut.units.iter().enumerate() {
                let intervals = seen.stages.get(stage).map_or(&[][..], Vec::as_slice);
                prop_assert_eq!(&reported_account(intervals, unit), &unit.account, "{}", &unit.name);
            }
            let late = seen.memories.values().flatten().find(|event| event_end(event) > cut.total);
            prop_assert_eq!(late, None, "the run ends in {}", cut.total);
        }
    }
}

/// Returns the account of a unit with the waits that were reported to a probe.
fn reported_account(intervals: &[Interval], unit: &UnitReport) -> CycleAccount {
    let CycleAccount { busy, done, .. } = unit.account;
    let mut account = CycleAccount { busy, done, ..CycleAccount::default() };
    for Interval { cause, from, to, .. } in intervals {
        cause.iter().for_each(|cause| account.charge(*cause, to.since(*from)));
    }
    account
}

/// Returns the report of a run without a probe.
fn silent(plan: &Plan, engine: Engine, max_cycles: u64) -> RunReport {
    run_with(&mut machine(plan), engine, None, RunLimits { max_cycles, progress: &mut |_: &mut PlanMachine| true })
}

/// Returns true if a client is periodic or makes flips.
fn moves_no_data_for_units(plan: &Plan, name: &str) -> bool {
    let is_flips = |memory: &PlanMemory| memory.ports.iter().any(|port| port.name == name && port.flips.is_some());
    plan.memories.iter().any(|memory| is_flips(memory) || memory.periodic.iter().any(|periodic| periodic.name == name))
}

/// Returns the end of an interval, or the cycle of a change.
fn event_end(event: &MemoryEvent) -> u64 {
    match event {
        MemoryEvent::Moved { to, .. } | MemoryEvent::Open { to, .. } => to.0,
        MemoryEvent::Queued { at, .. } | MemoryEvent::InFlight { at, .. } | MemoryEvent::LookedUp { at, .. } => at.0,
    }
}

/// Returns start and end of each interval reported for a source.
fn intervals(seen: &Recorder, source: [usize; 4]) -> Vec<(u64, u64)> {
    let interval = |event: &MemoryEvent| match event {
        MemoryEvent::Moved { from, to, .. } | MemoryEvent::Open { from, to, .. } => (from.0, to.0),
        other => panic!("{other:?}"),
    };
    seen.memories.get(&source).map_or_else(Vec::new, |events| events.iter().map(interval).collect())
}

/// Returns the sum of a level over all cycles.
fn area(seen: &Recorder, source: [usize; 4], total: u64) -> u64 {
    let (mut from, mut level, mut sum) = (0, 0, 0);
    for event in seen.memories.get(&source).into_iter().flatten() {
        let (MemoryEvent::Queued { at, bursts: new, .. } | MemoryEvent::InFlight { at, requests: new, .. }) = *event else {
            panic!("{event:?}")
        };
        assert!(new != level && at.0 >= from && at.0 < total, "reported once per change: {event:?}");
        sum += (at.0 - from) * level as u64;
        (from, level) = (at.0, new);
    }
    sum + (total - from) * level as u64
}

/// Returns the sum of a client's look-up results.
fn found(events: &[MemoryEvent]) -> CacheCounts {
    let mut sum = CacheCounts::default();
    for event in events {
        let MemoryEvent::LookedUp { found, .. } = event else { panic!("{event:?}") };
        sum = CacheCounts { hits: sum.hits + found.hits, misses: sum.misses + found.misses, merged: sum.merged + found.merged };
    }
    sum
}
