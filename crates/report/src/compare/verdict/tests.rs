use crate::compare::{Comparison, compare};
use crate::model::{Figure, OutcomeKind, PictureQuality, Report};
use crate::samples;
use basrelief_reference::QualityMetrics;

/// A report with the quality of three frames.
fn several_frames() -> Report {
    let mut report = samples::balanced();
    let quality = report.quality.as_mut().unwrap();
    quality.frames = [30.0, 27.9, quality.last.psnr_db].map(|psnr_db| QualityMetrics { psnr_db, ..quality.last }).into();
    report
}

fn changed(change: impl FnOnce(&mut Report)) -> Comparison {
    let a = several_frames();
    let mut b = a.clone();
    change(&mut b);
    compare(&a, &b, None)
}

fn worse(change: impl FnOnce(&mut Report)) -> (f64, String) {
    let comparison = changed(change);
    assert_eq!(comparison.verdict.unjudged, []);
    (comparison.verdict.worst.percent, comparison.verdict.worst.what)
}

/// The figures that cannot be judged.
fn unjudged(change: impl FnOnce(&mut Report)) -> Vec<String> {
    let comparison = changed(change);
    assert!(!comparison.failures(f64::MAX).is_empty(), "no limit lets them pass");
    assert!(!comparison.to_text(crate::TextStyle::default()).contains("No regression"));
    comparison.verdict.unjudged.into_iter().map(|u| format!("{}: {}", u.figure, u.reason)).collect()
}

#[test]
fn pictures_of_a_frame_are_judged_together() {
    // Three pictures of two frames in A, one of each in B.
    let mut a = samples::balanced();
    a.cycles.as_mut().unwrap().frames = vec![300_000, 200_000, 500_000];
    a.figures.insert("picture_frame".into(), Figure::List(vec![0.into(), 0.into(), 1.into()]));
    let mut b = a.clone();
    b.cycles.as_mut().unwrap().frames = vec![510_000, 490_000];
    b.figures.insert("picture_frame".into(), Figure::List(vec![0.into(), 1.into()]));
    let verdict = compare(&a, &b, None).verdict;
    assert_eq!((verdict.unjudged, verdict.worst.percent, verdict.worst.what), (vec![], 2.0, "cycles of frame 1".into()));
}

#[test]
fn cycles_bytes_and_quality_count() {
    assert_eq!(worse(|b| b.cycles.as_mut().unwrap().total += 10_000), (1.0, "cycles.total".into()));
    assert_eq!(worse(|b| b.cycles.as_mut().unwrap().frames[1] += 4_800), (1.0, "cycles.frames[1]".into()));
    let client = |b: &mut Report| b.memories.as_mut().unwrap()["graphics"].clients["z"].moved_bytes += 960_000;
    assert_eq!(worse(client), (50.0, "bytes of memories.graphics.clients.z".into()));
    assert_eq!(worse(|b| b.quality.as_mut().unwrap().last.psnr_db = 33.0), (20.0, "quality.psnr_db".into()));
    assert_eq!(worse(|b| b.quality.as_mut().unwrap().last.flip += 0.02), (2.0, "quality.flip".into()));
}

#[test]
fn slower_clock_counts_as_time() {
    assert_eq!(worse(|b| samples::set_clock(b, 20_000_000)), (900.0, "derived.frame_ms".into()));
    assert_eq!(worse(|b| samples::set_clock(b, 400_000_000)).0, 0.0);
    let slower_frame = |b: &mut Report| {
        b.cycles.as_mut().unwrap().frames = vec![520_000, 960_000];
        samples::set_clock(b, 400_000_000);
    };
    assert_eq!(worse(slower_frame).0, 0.0, "twice the cycles of half the length");
    let slower_tail = |b: &mut Report| {
        b.cycles.as_mut().unwrap().total = 4_000_000;
        samples::set_clock(b, 400_000_000);
    };
    assert_eq!(worse(slower_tail), (100.0, "derived.time_ms".into()));
    let one_frame = |b: &mut Report| {
        b.cycles.as_mut().unwrap().frames = vec![20_000, 1_920_000];
        samples::set_clock(b, 400_000_000);
    };
    assert_eq!(worse(one_frame), (100.0, "time of cycles.frames[1]".into()));
}

#[test]
fn missing_clock_passes_no_limit() {
    let bare = |report: &mut Report| drop(report.config.as_object_mut().unwrap().remove("clock"));
    assert_eq!(unjudged(bare), ["config.clock.hz: A has it and B lacks it"]);
    let mut old = several_frames();
    bare(&mut old);
    assert_eq!(compare(&old, &several_frames(), None).failures(0.0), [""; 0]);
    let mut slow = several_frames();
    slow.cycles.as_mut().unwrap().total += 10_000;
    assert_eq!(compare(&old, &slow, None).failures(0.5), ["cycles.total got worse by 1 %; the limit is 0.5 %"]);
}

#[test]
fn time_of_incomplete_frames_passes_no_limit() {
    let cut = |b: &mut Report| {
        samples::set_clock(b, 20_000_000);
        b.cycles.as_mut().unwrap().frames.clear();
    };
    assert_eq!(unjudged(cut), ["cycles.frames: A has 2 frames and B has 0"]);
    let from_zero = |b: &mut Report| {
        samples::set_clock(b, 20_000_000);
        b.cycles.as_mut().unwrap().frames[0] = 0;
    };
    let (mut a, b) = (several_frames(), several_frames());
    from_zero(&mut a);
    let unjudged = compare(&a, &b, None).verdict.unjudged;
    assert_eq!((unjudged.len(), &*unjudged[0].figure), (1, "time of cycles.frames[0]"));
}

#[test]
fn every_frame_counts() {
    let (percent, what) = worse(|b| b.quality.as_mut().unwrap().frames[1].psnr_db = 5.0);
    assert_eq!((percent.round(), what.as_str()), (82.0, "quality.frames[1].psnr_db"));
    let (percent, what) = worse(|b| b.quality.as_mut().unwrap().frames[1].ssim -= 0.25);
    assert_eq!((percent.round(), what.as_str()), (25.0, "quality.frames[1].ssim"));
}

#[test]
fn improvements_do_not_count() {
    assert_eq!(worse(|b| b.cycles.as_mut().unwrap().total -= 10_000).0, 0.0);
    assert_eq!(worse(|b| b.quality.as_mut().unwrap().last.ssim = 1.0).0, 0.0);
    assert_eq!(worse(|b| b.units.as_mut().unwrap()["replacement"].busy += 10_000).0, 0.0);
}

#[test]
fn incomplete_run_passes_no_limit() {
    assert_eq!(unjudged(|b| b.outcome.kind = OutcomeKind::Deadlock), ["outcome: run B did not finish (deadlock)"]);
    let (a, b) = (samples::deadlocked(), samples::balanced());
    assert!(compare(&a, &b, None).failures(f64::MAX)[0].contains("run A did not finish (deadlock)"));
}

#[test]
fn figure_missing_in_b_passes_no_limit() {
    assert_eq!(unjudged(|b| b.quality = None), ["quality: A has it and B lacks it"]);
    let functional = |b: &mut Report| *b = Report { quality: b.quality.clone(), ..samples::functional() };
    assert_eq!(unjudged(functional), ["cycles: A has it and B lacks it", "memories: A has it and B lacks it"]);
    let client = |b: &mut Report| drop(b.memories.as_mut().unwrap()["graphics"].clients.shift_remove("z"));
    assert_eq!(unjudged(client), ["bytes of memories.graphics.clients.z: A has it and B lacks it"]);
    let memory = |b: &mut Report| drop(b.memories.as_mut().unwrap().shift_remove("graphics"));
    assert_eq!(unjudged(memory).len(), 2);
}

#[test]
fn fewer_frames_pass_no_limit() {
    let cycles = |b: &mut Report| b.cycles.as_mut().unwrap().frames.truncate(1);
    assert_eq!(unjudged(cycles), ["cycles.frames: A has 2 frames and B has 1"]);
    let quality = |b: &mut Report| b.quality.as_mut().unwrap().frames.truncate(2);
    assert_eq!(unjudged(quality), ["quality.frames: A has 3 frames and B has 2"]);
    assert_eq!(unjudged(|b| b.quality.as_mut().unwrap().frames.clear()).len(), 1);
}

#[test]
fn value_that_is_no_number_is_named() {
    let nan = |b: &mut Report| b.quality.as_mut().unwrap().frames[1].psnr_db = f64::NAN;
    assert_eq!(unjudged(nan), ["quality.frames[1].psnr_db: it is NaN in B"]);
    let infinite = |b: &mut Report| b.quality.as_mut().unwrap().last.ssim = f64::INFINITY;
    assert_eq!(unjudged(infinite), ["quality.ssim: it is inf in B"]);
    let a = Report { quality: Some(quality_of(f64::NAN)), ..samples::balanced() };
    assert!(
        compare(&a, &samples::balanced(), None).failures(f64::MAX)[0]
            .contains("quality.psnr_db cannot be judged: it is NaN in A")
    );
}

fn quality_of(psnr_db: f64) -> PictureQuality {
    let last = QualityMetrics { psnr_db, ssim: 0.5, flip: 0.5 };
    PictureQuality::of(&[last], None).unwrap()
}

#[test]
fn change_from_zero_passes_no_limit() {
    let new = |b: &mut Report| {
        let clients = &mut b.memories.as_mut().unwrap()["graphics"].clients;
        let like = clients["z"].clone();
        clients.insert("new".into(), like);
    };
    assert_eq!(unjudged(new), ["bytes of memories.graphics.clients.new: it grew from 0 to 1,920,000, and 0 has no percentage"]);
    let of = |psnr_db: f64| Report { quality: Some(quality_of(psnr_db)), ..samples::functional() };
    assert!(
        compare(&of(0.0), &of(-1.0), None).failures(f64::MAX)[0]
            .contains("quality.psnr_db cannot be judged: it fell from 0 to -1 dB")
    );
    assert_eq!(compare(&of(0.0), &of(1.0), None).failures(0.0), [""; 0]);
}

#[test]
fn reports_without_counted_figures_fail() {
    let bare = |machine: &str| Report { quality: None, machine: machine.into(), ..samples::functional() };
    let failures = compare(&bare("a"), &bare("b"), None).failures(f64::MAX);
    assert_eq!(failures, ["report cannot be judged: A has neither cycles nor bytes nor quality"]);
    assert_eq!(compare(&bare("a"), &bare("a"), None).failures(0.0), [""; 0]);
}

#[test]
fn failure_names_figure_and_limit() {
    let comparison = changed(|b| b.cycles.as_mut().unwrap().total += 10_000);
    assert_eq!(comparison.failures(0.5), ["cycles.total got worse by 1 %; the limit is 0.5 %"]);
    assert_eq!(comparison.failures(1.0), [""; 0]);
}
