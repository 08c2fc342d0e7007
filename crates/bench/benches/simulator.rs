//! All workloads under criterion: `cargo bench`, or `cargo bench -p basrelief-bench -- PART` for the workloads whose names
//! contain PART.

use basrelief_bench::workload::{ThroughputUnit, Workload, WorkloadSize};
use basrelief_bench::{machines, workloads};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use std::time::Duration;

/// Returns true if the command line selects this name. Criterion decides again, but a workload that is not selected need not be
/// prepared.
fn asked_for(name: &str) -> bool {
    let mut parts = std::env::args().skip(1).filter(|argument| !argument.starts_with('-')).peekable();
    parts.peek().is_none() || parts.any(|part| name.contains(&part))
}

fn bench(c: &mut Criterion, workload: &Workload) {
    let mut run = workload.prepare();
    let count = run().count;
    let throughput =
        if workload.counted == ThroughputUnit::Bytes { Throughput::Bytes(count) } else { Throughput::Elements(count) };
    let (group, name) = workload.name.split_once('/').unwrap_or(("", &workload.name));
    let mut group = c.benchmark_group(group);
    group.throughput(throughput).sample_size(10);
    group.warm_up_time(Duration::from_millis(500)).measurement_time(Duration::from_secs(2));
    group.bench_function(name, |b| b.iter_custom(|n| (0..n).map(|_| run().time).sum()));
    group.finish();
}

fn simulator(c: &mut Criterion) {
    let all = workloads(WorkloadSize::Full).into_iter().chain(machines::units());
    all.filter(|workload| asked_for(&workload.name)).for_each(|workload| bench(c, &workload));
}

criterion_group!(benches, simulator);
criterion_main!(benches);
