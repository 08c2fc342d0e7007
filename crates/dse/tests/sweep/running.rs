//! Sweeps: resimulation equals a run, threads change nothing, failures are rows, existing points stay.

use crate::support::{Program, files, plan, sweep};
use basrelief_dse::folder::{PointFailure, PointStore};
use basrelief_dse::{PointStatus, SweepFolder, SweepJob, execute, tables, verify};
use basrelief_sim::BUILD;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;
use tempfile::tempdir;

/// Two works, each under six times.
const PLAN: &str = "input = \"demo:ellipsoid@1\"\nmachine = \"shade\"\nobjectives = [\"cycles min\", \"hardware.bits min\"]\n\
                    [axes]\nshade.mode = [\"normal\", \"brightness\"]\nfifo.interpolated.depth = [1, 2, 64]\n\
                    memory.frame.part = [\"fpm-80\", \"sram\"]\n";

#[test]
fn resimulated_point_equals_a_run() {
    for text in [PLAN.to_owned(), PLAN.replace("demo:ellipsoid@1", "quad.dl.jsonl")] {
        let folder = tempdir().unwrap();
        let (plan, tally) = sweep(&text, folder.path(), 2);
        assert_eq!((tally.points, tally.run, tally.resimulated, tally.failed), (12, 2, 10, 0));
        let points: Vec<_> = plan.points.iter().collect();
        let (count, others) = verify(&plan, &points, 100.0, &SweepFolder::new(folder.path()), &Program::new()).unwrap();
        assert_eq!((count, others), (12, vec![]));
    }
}

// Claim: analysis: A plan with several views has the worst and the mean quality over them, and the quality of each.
#[test]
fn views_of_a_plan_have_worst_and_mean_quality() {
    let plan_of = |views: &str| {
        format!(
            "input = \"demo:ellipsoid@1\"\nmachine = \"bump\"\nobjectives = [\"cycles min\", \"quality.min.psnr_db max\"]\n\
             constraints = [\"quality.mean.psnr_db >= 0\"]\naxes.replacement.entries = [16]\n{views}"
        )
    };
    let psnr = |views: &str, figure: &str| {
        let folder = tempdir().unwrap();
        let (plan, tally) = sweep(&plan_of(views), folder.path(), 2);
        assert_eq!((tally.run, tally.failed), (1, 0));
        let report = SweepFolder::new(folder.path()).report(&plan.points[0].id).unwrap();
        let figures = basrelief_dse::figures::figures(&report);
        let found = figures.iter().find(|of| of.name == figure).unwrap_or_else(|| panic!("no {figure}"));
        found.cell.number().unwrap()
    };
    let (first, second) = ("[[views]]\nturn = [0, 0]\n", "[[views]]\nturn = [90, 20]\n");
    let [alone, other] = [first, second].map(|view| psnr(view, "quality.psnr_db"));
    assert_ne!(alone, other, "the views differ");
    let both = format!("{first}{second}");
    assert_eq!([0, 1].map(|frame| psnr(&both, &format!("quality.frames.{frame}.psnr_db"))), [alone, other]);
    assert_eq!(psnr(&both, "quality.min.psnr_db"), alone.min(other));
    assert!((psnr(&both, "quality.mean.psnr_db") - (alone + other) / 2.0).abs() < 1e-5);
    let error = |objective: &str| {
        let text = plan_of(&both).replace("quality.min.psnr_db", objective);
        basrelief_dse::Plan::read(&text, &Program::new()).map(|_| ()).map_err(|error| error.to_string())
    };
    assert_eq!(error("quality.frames.1.psnr_db"), Ok(()));
    assert!(error("quality.frames.2.psnr_db").unwrap_err().contains("the report has no figure `quality.frames.2.psnr_db`"));
}

#[test]
fn a_point_that_was_tampered_with_is_found() {
    let folder = tempdir().unwrap();
    let (plan, _) = sweep(PLAN, folder.path(), 2);
    let id = &plan.points[7].id;
    let path = folder.path().join("points").join(id).join("report.json");
    fs::write(&path, fs::read_to_string(&path).unwrap().replacen("\"total\": ", "\"total\": 1", 1)).unwrap();
    let points: Vec<_> = plan.points.iter().collect();
    let (_, others) = verify(&plan, &points, 100.0, &SweepFolder::new(folder.path()), &Program::new()).unwrap();
    assert_eq!(others, std::slice::from_ref(id));
    let (count, _) = verify(&plan, &points, 10.0, &SweepFolder::new(folder.path()), &Program::new()).unwrap();
    assert_eq!(count, 2, "a tenth of twelve, and what is left");
}

#[test]
fn every_file_is_the_same_to_the_byte_whatever_the_threads() {
    let [one, two] = [1, 2].map(|threads| {
        let folder = tempdir().unwrap();
        sweep(PLAN, folder.path(), threads);
        files(folder.path())
    });
    assert_eq!(one.len(), 12 * 2 + tables::FILES.len());
    assert!(one == two);
}

/// The same with a limit that some points keep and others do not.
fn limited() -> String {
    let folder = tempdir().unwrap();
    let (plan, _) = sweep(PLAN, folder.path(), 2);
    let total = |id: &str| SweepFolder::new(folder.path()).report(id).unwrap()["cycles"]["total"].as_u64().unwrap();
    let mut totals: Vec<u64> = plan.points.iter().map(|point| total(&point.id)).collect();
    totals.sort_unstable();
    format!("max_cycles = {}\n{PLAN}", totals[5])
}

#[test]
fn incomplete_points_are_rows_with_reason() {
    let folder = tempdir().unwrap();
    let (plan, tally) = sweep(&limited(), folder.path(), 2);
    let store = SweepFolder::new(folder.path());
    let failed: Vec<_> = plan.points.iter().filter(|p| store.find(&p.id) == PointStatus::Failed).collect();
    assert!(!failed.is_empty() && failed.len() < 12, "{} of 12", failed.len());
    assert_eq!(tally.failed, failed.len());
    let failure = store.failure(&failed[0].id).unwrap();
    assert_eq!((failure.outcome.as_str(), failure.message.as_str()), ("limit", "stopped at the limit of max_cycles"));
    let table = fs::read_to_string(folder.path().join("sweep.csv")).unwrap();
    assert_eq!(
        table.lines().filter(|line| line.contains(",failed,limit: stopped at the limit of max_cycles,")).count(),
        failed.len()
    );
    // A run within the limit has the report of a run without limit.
    let whole = tempdir().unwrap();
    let (free, _) = sweep(PLAN, whole.path(), 2);
    for (point, free) in plan.points.iter().zip(&free.points).filter(|(point, _)| store.find(&point.id) == PointStatus::Report) {
        assert_eq!(store.report_text(&point.id).unwrap(), SweepFolder::new(whole.path()).report_text(&free.id).unwrap());
    }
}

#[test]
fn invalid_parameters_are_rows_with_reason() {
    let text = "input = \"demo:ellipsoid@1\"\nmachine = \"bump\"\nobjectives = [\"cycles min\"]\n\
                [axes]\nmemory.normal_map.outstanding = [1, 16]\nfifo.shaded.depth = [2, 4]\n";
    let folder = tempdir().unwrap();
    let (_, tally) = sweep(text, folder.path(), 2);
    assert_eq!((tally.points, tally.failed), (4, 2));
    let table = fs::read_to_string(folder.path().join("sweep.csv")).unwrap();
    assert_eq!(
        table.matches(",failed,\"unfit: `memory.normal_map.outstanding`: is 1, but one step needs 8 requests").count(),
        2,
        "{table:.2000}"
    );
}

#[test]
fn deadlocked_point_stays_off_the_front() {
    let folder = tempdir().unwrap();
    let host = Program::new();
    let (plan, store) = (plan(PLAN, &host), SweepFolder::new(folder.path()));
    let message = "nothing can start: a waits for b".to_owned();
    store.put_failure(&plan.points[3].id, &PointFailure { outcome: "deadlock".into(), message }, &host).unwrap();
    let (_, tally) = sweep(PLAN, folder.path(), 2);
    assert_eq!((tally.existing, tally.run + tally.resimulated, tally.failed), (1, 11, 0));
    let table = fs::read_to_string(folder.path().join("sweep.csv")).unwrap();
    let row = format!("{},failed,deadlock: nothing can start: a waits for b,,,", plan.points[3].id);
    assert!(table.lines().nth(4).unwrap().starts_with(&row), "{table:.2000}");
    assert!(fs::read_to_string(folder.path().join("front.txt")).unwrap().contains("of 11 points is Pareto-optimal"));
    let points: Vec<_> = plan.points.iter().collect();
    let work = SweepJob { points: &points, retry_failed: true, pictures: true, threads: 2 };
    assert_eq!(execute(&plan, &work, &store, &host).unwrap().run, 1);
    assert_eq!(store.find(&plan.points[3].id), PointStatus::Report);
}

#[test]
fn existing_points_are_reused_failed_on_demand() {
    let folder = tempdir().unwrap();
    let text = limited();
    let (_, first) = sweep(&text, folder.path(), 2);
    assert!(first.failed > 0);
    let before = files(folder.path());
    let (_, second) = sweep(&text, folder.path(), 2);
    assert_eq!((second.existing, second.run, second.resimulated), (12, 0, 0));
    assert!(before == files(folder.path()));
    let host = Program::new();
    let plan = plan(&text, &host);
    let points: Vec<_> = plan.points.iter().collect();
    let work = SweepJob { points: &points, retry_failed: true, pictures: true, threads: 2 };
    let tally = execute(&plan, &work, &SweepFolder::new(folder.path()), &host).unwrap();
    assert_eq!((tally.existing, tally.run, tally.failed), (12 - first.failed, first.failed, first.failed));
}

fn report_of(folder: &Path, id: &str) -> PathBuf {
    folder.join("points").join(id).join("report.json")
}

#[test]
fn damaged_point_runs_again() {
    let folder = tempdir().unwrap();
    let (plan, _) = sweep(PLAN, folder.path(), 2);
    let before = files(folder.path());
    let report = fs::read(report_of(folder.path(), &plan.points[0].id)).unwrap();
    let damages = [vec![], report[..report.len() / 2].to_vec(), vec![0; report.len()], [&report[..], b"}"].concat()];
    for (point, damaged) in plan.points.iter().zip(damages) {
        fs::write(report_of(folder.path(), &point.id), damaged).unwrap();
        assert_eq!(SweepFolder::new(folder.path()).find(&point.id), PointStatus::Missing);
    }
    let (_, tally) = sweep(PLAN, folder.path(), 2);
    assert_eq!((tally.existing, tally.run + tally.resimulated, tally.outdated), (8, 4, 0));
    assert!(before == files(folder.path()));
}

#[test]
fn points_of_another_build_run_again() {
    let folder = tempdir().unwrap();
    let (plan, _) = sweep(PLAN, folder.path(), 2);
    let before = files(folder.path());
    let store = SweepFolder::new(folder.path());
    for point in &plan.points[..3] {
        let text = store.report_text(&point.id).unwrap();
        fs::write(report_of(folder.path(), &point.id), text.replacen(BUILD, "0.1.0+another", 1)).unwrap();
        assert_eq!(store.find(&point.id), PointStatus::Outdated);
    }
    // A failure of another build may be mended now.
    let failed = folder.path().join("points").join(&plan.points[3].id).join("failed.json");
    fs::remove_file(failed.with_file_name("report.json")).unwrap();
    fs::write(failed, r#"{"outcome": "deadlock", "message": "of version 0.1"}"#).unwrap();
    let (_, tally) = sweep(PLAN, folder.path(), 2);
    assert_eq!((tally.existing, tally.run + tally.resimulated, tally.outdated), (8, 4, 4));
    assert!(before == files(folder.path()));
}

#[test]
fn failure_replaces_report_of_another_build() {
    let folder = tempdir().unwrap();
    let (host, store) = (Program::new(), SweepFolder::new(folder.path()));
    store.put("a", "{\"build\": \"0.1.0+another\"}", None, &host).unwrap();
    let failure = PointFailure { outcome: "limit".into(), message: "stopped".into() };
    store.put_failure("a", &failure, &host).unwrap();
    assert_eq!((store.find("a"), store.failure("a").unwrap()), (PointStatus::Failed, failure));
    assert!(!report_of(folder.path(), "a").exists());
}

#[test]
fn missing_or_damaged_tables_are_written_again() {
    let folder = tempdir().unwrap();
    sweep(PLAN, folder.path(), 2);
    let before = files(folder.path());
    for (table, _) in tables::FILES {
        fs::remove_file(folder.path().join(table)).unwrap();
        sweep(PLAN, folder.path(), 2);
        assert!(before == files(folder.path()), "{table}");
        fs::write(folder.path().join(table), "").unwrap();
        sweep(PLAN, folder.path(), 2);
        assert!(before == files(folder.path()), "{table}");
    }
}

#[test]
fn plan_warns_of_figures_of_the_last_image() {
    let warnings = |frames: &str, objective: &str| {
        let text = format!(
            "input = \"demo:ellipsoid@1\"\nmachine = \"shade\"\nobjectives = [\"{objective} max\"]\nconstraints = [\"quality.ssim > 0\"]\n\
             axes.shade.mode = [\"normal\"]\n{frames}"
        );
        plan(&text, &Program::new()).warnings()
    };
    let two = "[view]\nframes = 2\n";
    let [last, worst] = ["quality.psnr_db", "quality.min.psnr_db"].map(|objective| warnings(two, objective));
    assert_eq!(
        last[0],
        "objectives: `quality.psnr_db` is that of the last image; `quality.min.psnr_db` is that of the worst image"
    );
    assert_eq!(last[1..], worst, "{last:?}");
    assert!(worst[0].starts_with("constraints: `quality.ssim` is that of the last image"), "{worst:?}");
    assert_eq!(warnings("", "quality.psnr_db"), [""; 0]);
}

#[test]
fn plan_warns_of_the_area_of_ideal_parts() {
    let warnings = |objective: &str, axes: &str| {
        let text = format!(
            "input = \"demo:ellipsoid@1\"\nmachine = \"bump\"\nobjectives = [\"cycles min\", \"{objective} min\"]\n{axes}"
        );
        plan(&text, &Program::new()).warnings()
    };
    let ideal = "axes.ideal.units = [\"\", \"replacement\"]\naxes.fifo.indexes.depth = [2, 4, 8]\n";
    let warning = "objectives: `hardware.area_ge` has no meaning for 3 of 6 points, because no hardware is ideal: ideal.units";
    assert_eq!(warnings("hardware.area_ge", ideal), [warning]);
    assert_eq!(warnings("bytes.moved", ideal), [""; 0]);
    assert_eq!(warnings("hardware.area_ge", "axes.fifo.indexes.depth = [2, 4]\n"), [""; 0]);
}

#[test]
fn a_second_plan_finds_the_points_of_the_first() {
    let folder = tempdir().unwrap();
    sweep(PLAN, folder.path(), 2);
    let (plan, tally) = sweep(&PLAN.replace("[1, 2, 64]", "[2, 8]").replace("cycles min", "cycles max"), folder.path(), 2);
    assert_eq!((plan.points.len(), tally.existing, tally.run + tally.resimulated), (8, 4, 4));
}

#[test]
fn full_disk_ends_sweep_and_keeps_whole_files() {
    for room in [0, 1, 5, 12, 24, 26] {
        let folder = tempdir().unwrap();
        let host = Program::with_room(room);
        let plan = plan(PLAN, &host);
        let points: Vec<_> = plan.points.iter().collect();
        let work = SweepJob { points: &points, retry_failed: false, pictures: true, threads: 2 };
        let store = SweepFolder::new(folder.path());
        let ended = execute(&plan, &work, &store, &host).and_then(|_| tables(&plan, &store, &host));
        let error = ended.unwrap_err().to_string();
        assert!(error.contains(&folder.path().display().to_string()) && error.contains(": cannot be written: "), "{error}");
        let pictures = points.iter().filter(|point| store.picture(&point.id).is_some());
        assert!(pictures.into_iter().all(|point| !store.find(&point.id).is_missing()), "a picture without a report");
        // And when there is room again, it goes on.
        sweep(PLAN, folder.path(), 2);
        let undisturbed = tempdir().unwrap();
        sweep(PLAN, undisturbed.path(), 2);
        assert!(files(folder.path()) == files(undisturbed.path()), "room for {room} files");
    }
}

#[test]
fn columns_are_objectives_axes_figures_with_units() {
    let folder = tempdir().unwrap();
    sweep(PLAN, folder.path(), 2);
    let table = fs::read_to_string(folder.path().join("sweep.csv")).unwrap();
    let head = "id,state,reason,cycles.frames [cycles],hardware.bits [bits],shade.mode,\
                fifo.interpolated.depth [tokens],memory.frame.part,cycles.total [cycles],cycles.write_tail [cycles],";
    assert!(table.starts_with(head), "{table:.600}");
    assert_eq!(table.lines().count(), 13);
    let front = fs::read_to_string(folder.path().join("front.txt")).unwrap();
    assert!(front.contains("of 12 points is Pareto-optimal\ncycles.frames [cycles] min  hardware.bits [bits] min  "), "{front}");
}

#[test]
fn ten_thousand_points_are_checked_found_and_resumed_at_once() {
    let text = "input = \"demo:ellipsoid@1\"\nmachine = \"shade\"\nobjectives = [\"cycles min\"]\n[axes]\nshade.mode = [\"normal\", \"brightness\"]\n\
                fifo.pixels.depth = { from = 1, to = 50, step = 1 }\nfifo.interpolated.depth = { from = 1, to = 100, step = 1 }\n";
    let (folder, host) = (tempdir().unwrap(), Program::new());
    let store = SweepFolder::new(folder.path());
    for point in &plan(text, &host).points {
        let report = format!("{{ \"build\": \"{BUILD}\", \"cycles\": {{ \"frames\": [7] }} }}");
        store.put(&point.id, &report, None, &host).unwrap();
    }
    sweep(text, folder.path(), 2);
    let began = Instant::now();
    let (plan, tally) = sweep(text, folder.path(), 2);
    let seconds = began.elapsed().as_secs_f64();
    println!("{} points checked, found and resumed in {seconds:.2} s", plan.points.len());
    assert_eq!((plan.points.len(), tally.existing, tally.run), (10_000, 10_000, 0));
    // Less than 1 s when built for release. Here, for debugging and beside other work, sixty times that is no mistake.
    assert!(seconds < 60.0, "{seconds} s");
}
