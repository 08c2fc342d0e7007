//! The largest regression. The parent module lists the figures that count.

use super::comparison::Worst;
use crate::model::{OutcomeKind, Report};
use crate::number::round6;

pub(super) fn worst(a: &Report, b: &Report) -> Worst {
    let none = Worst { percent: 0.0, what: "nothing".into() };
    let all = outcome(a, b).into_iter().chain(cycles(a, b)).chain(bytes(a, b)).chain(quality(a, b));
    all.fold(none, |worst, w| if w.percent > worst.percent { w } else { worst })
}

fn growth(what: String, before: u64, after: u64) -> Worst {
    let percent = match (before, after) {
        (before, after) if after <= before => 0.0,
        (0, _) => 100.0,
        (before, after) => round6(100.0 * (after - before) as f64 / before as f64),
    };
    Worst { percent, what }
}

fn outcome(a: &Report, b: &Report) -> Option<Worst> {
    let broken = a.outcome.kind == OutcomeKind::Complete && b.outcome.kind != OutcomeKind::Complete;
    broken.then(|| Worst { percent: f64::INFINITY, what: "outcome".into() })
}

fn cycles(a: &Report, b: &Report) -> Vec<Worst> {
    let (Some(a), Some(b)) = (&a.cycles, &b.cycles) else { return vec![] };
    let frames = a.frames.iter().zip(&b.frames).enumerate();
    let frames = frames.map(|(k, (&before, &after))| growth(format!("cycles.frames[{k}]"), before, after));
    std::iter::once(growth("cycles.total".into(), a.total, b.total)).chain(frames).collect()
}

fn bytes(a: &Report, b: &Report) -> Vec<Worst> {
    let (Some(a), Some(b)) = (&a.memories, &b.memories) else { return vec![] };
    let clients = b.iter().flat_map(|(memory, m)| m.clients.iter().map(move |(name, c)| (memory, name, c)));
    let grown = clients.map(|(memory, name, after)| {
        let before = a.get(memory).and_then(|m| m.clients.get(name)).map_or(0, |c| c.bytes());
        growth(format!("bytes of memories.{memory}.clients.{name}"), before, after.bytes())
    });
    grown.collect()
}

fn quality(a: &Report, b: &Report) -> Vec<Worst> {
    let (Some(a), Some(b)) = (&a.quality, &b.quality) else { return vec![] };
    let (a, b) = (&a.last, &b.last);
    let psnr = if a.psnr_db > 0.0 { 100.0 * (a.psnr_db - b.psnr_db) / a.psnr_db } else { 0.0 };
    let losses = [("psnr_db", psnr), ("ssim", 100.0 * (a.ssim - b.ssim)), ("flip", 100.0 * (b.flip - a.flip))];
    losses.map(|(name, loss)| Worst { percent: round6(loss), what: format!("quality.{name}") }).into()
}

#[cfg(test)]
mod tests {
    use crate::compare::compare;
    use crate::model::{OutcomeKind, Report};
    use crate::samples;

    fn worse(change: impl FnOnce(&mut Report)) -> (f64, String) {
        let a = samples::balanced();
        let mut b = a.clone();
        change(&mut b);
        let worst = compare(&a, &b, None).worst;
        (worst.percent, worst.what)
    }

    #[test]
    fn cycles_bytes_and_quality_count() {
        assert_eq!(worse(|b| b.cycles.as_mut().unwrap().total += 10_000), (1.0, "cycles.total".into()));
        assert_eq!(worse(|b| b.cycles.as_mut().unwrap().frames[1] += 4_800), (1.0, "cycles.frames[1]".into()));
        let client = |b: &mut Report| b.memories.as_mut().unwrap()["graphics"].clients["z"].write_bytes += 400_000;
        assert_eq!(worse(client), (50.0, "bytes of memories.graphics.clients.z".into()));
        assert_eq!(worse(|b| b.quality.as_mut().unwrap().last.psnr_db = 33.0), (20.0, "quality.psnr_db".into()));
        assert_eq!(worse(|b| b.quality.as_mut().unwrap().last.flip += 0.02), (2.0, "quality.flip".into()));
    }

    #[test]
    fn improvements_do_not_count() {
        assert_eq!(worse(|b| b.cycles.as_mut().unwrap().total -= 10_000).0, 0.0);
        assert_eq!(worse(|b| b.quality.as_mut().unwrap().last.ssim = 1.0).0, 0.0);
        assert_eq!(worse(|b| b.units.as_mut().unwrap()["replacement"].busy += 10_000).0, 0.0);
    }

    #[test]
    fn a_run_that_no_longer_completes_passes_no_limit() {
        assert_eq!(worse(|b| b.outcome.kind = OutcomeKind::Deadlock), (f64::INFINITY, "outcome".into()));
    }

    #[test]
    fn traffic_out_of_nothing_is_a_hundred_percent() {
        let new = |b: &mut Report| {
            let clients = &mut b.memories.as_mut().unwrap()["graphics"].clients;
            let like = clients["z"].clone();
            clients.insert("new".into(), like);
        };
        assert_eq!(worse(new), (100.0, "bytes of memories.graphics.clients.new".into()));
    }
}
