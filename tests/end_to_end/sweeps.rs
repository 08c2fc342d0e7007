//! Sweeps resume after being killed, can share a folder, and end with the same bytes.

use crate::support::{PROGRAM, Place, finish, wait, workspace};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Stdio};
use std::thread::sleep;
use std::time::Duration;

/// Six recordings, each with four timings.
const PLAN: &str = r#"
title = "Modes and depths"
input = "demo:ellipsoid@2"
machine = "shade"
objectives = ["cycles min", "hardware.area_ge min", "quality.psnr_db max"]

[view]
size = "96x72"

[axes]
shade.mode = ["normal", "brightness", "polyhedron"]
geometry.multipliers = [4, 8]
fifo.interpolated.depth = { from = 1, to = 8, factor = 2 }
"#;

const POINTS: usize = 24;

fn place() -> Place {
    let place = Place::new();
    fs::write(place.path("plan.toml"), PLAN).unwrap();
    place
}

/// Returns all files below a folder, including hidden ones, with their bytes.
fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut all = BTreeMap::new();
    let mut folders = vec![folder.to_path_buf()];
    while let Some(next) = folders.pop() {
        for path in fs::read_dir(next).into_iter().flatten().map(|entry| entry.unwrap().path()) {
            if path.is_dir() {
                folders.push(path);
            } else if let Ok(bytes) = fs::read(&path) {
                // While a sweep runs, a file can be renamed before it is read.
                all.insert(path.strip_prefix(folder).unwrap().into(), bytes);
            }
        }
    }
    all
}

fn names(files: &BTreeMap<PathBuf, Vec<u8>>) -> Vec<String> {
    files.keys().map(|path| path.display().to_string()).collect()
}

/// Runs an undisturbed sweep and returns its files.
fn undisturbed(place: &Place) -> BTreeMap<PathBuf, Vec<u8>> {
    let said = place.ok("sweep plan.toml --out whole").out;
    assert!(said.starts_with("24 points: 0 reused, 6 run, 18 resimulated; 0 failed\n\nModes and depths\n"), "{said}");
    files(&place.path("whole"))
}

fn same(left: &BTreeMap<PathBuf, Vec<u8>>, right: &BTreeMap<PathBuf, Vec<u8>>) {
    assert_eq!(names(left), names(right));
    let other = left.iter().find(|(path, bytes)| right[*path] != **bytes);
    assert!(other.is_none(), "{:?}", other.map(|(path, _)| path));
}

fn start(place: &Place, line: &str) -> Child {
    place.command(line).stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("the program starts")
}

/// Counts the reports written so far.
fn reports(place: &Place) -> usize {
    names(&files(&place.path("out"))).iter().filter(|name| name.ends_with("report.json")).count()
}

#[test]
fn killed_sweep_ends_like_undisturbed_one() {
    let place = place();
    let whole = undisturbed(&place);
    // Pseudo-random numbers with a fixed seed: each run is killed after 0 to 4 more points and up to 20,000 microseconds.
    let mut seed = 7_u64;
    let mut random = |below: u64| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) % below
    };
    for _ in 0..10 {
        let wanted = reports(&place) + random(5) as usize;
        let mut child = start(&place, "sweep plan.toml --threads 2");
        while reports(&place) < wanted && child.try_wait().unwrap().is_none() {
            sleep(Duration::from_millis(1));
        }
        sleep(Duration::from_micros(random(20_000)));
        // On Unix this sends SIGKILL.
        child.kill().unwrap();
        child.wait().unwrap();
    }
    let before = reports(&place);
    let said = place.ok("sweep plan.toml").out;
    assert!(said.starts_with(&format!("24 points: {before} reused, ")), "{said}");
    same(&files(&place.path("out")), &whole);
}

#[test]
fn concurrent_sweeps_share_one_folder() {
    let place = place();
    let whole = undisturbed(&place);
    let both = ["sweep plan.toml --threads 1", "sweep plan.toml --threads 2"].map(|line| start(&place, line));
    for mut child in both {
        let status = wait(&mut child, Duration::from_secs(120)).expect("ends");
        assert!(status.success(), "{status}");
    }
    same(&files(&place.path("out")), &whole);
}

#[cfg(unix)]
#[test]
fn interrupted_sweep_resumes() {
    let place = place();
    // The pictures are so large that the sweep still runs when the signal arrives.
    fs::write(place.path("plan.toml"), PLAN.replace("96x72", "480x360")).unwrap();
    let whole = undisturbed(&place);
    let mut child = start(&place, "sweep plan.toml --threads 1");
    while reports(&place) < 2 {
        sleep(Duration::from_millis(1));
    }
    assert!(std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    let status = wait(&mut child, Duration::from_secs(10)).expect("ends soon");
    assert_eq!(status.code(), Some(130), "{status}");
    assert!((2..POINTS).contains(&reports(&place)));
    assert!(!names(&files(&place.path("out"))).iter().any(|name| name.contains(".partial")));
    place.ok("sweep plan.toml");
    same(&files(&place.path("out")), &whole);
}

/// The shell limits the size of files in blocks of 512 bytes, or of 1 KiB in some shells. This acts like a full disk, except for
/// the text of the error.
#[cfg(unix)]
#[test]
fn full_disk_ends_sweep_that_then_resumes() {
    let whole = undisturbed(&place());
    for (blocks, there, file) in [(40, 0, "/report.json: "), (160, POINTS, "out/sweep.")] {
        let place = place();
        let mut limited = std::process::Command::new("sh");
        limited.arg("-c").arg(format!("trap '' XFSZ; ulimit -f {blocks} && exec \"$0\" \"$@\""));
        limited.arg(PROGRAM).args(place.command("sweep plan.toml").get_args()).current_dir(place.path(""));
        let outcome = finish(&mut limited);
        let error = outcome.error(1);
        assert!(error.contains(file) && error.contains("cannot be written: File too large"), "{error}");
        let left = files(&place.path("out"));
        assert!(left.iter().all(|(path, bytes)| whole[path] == *bytes), "half-written: {:?}", names(&left));
        assert_eq!(reports(&place), there);
        place.ok("sweep plan.toml");
        same(&files(&place.path("out")), &whole);
    }
}

#[test]
fn listed_commands_and_shards_complete_sweep() {
    let place = place();
    let whole = undisturbed(&place);
    let said = place.ok("sweep plan.toml --shard 1/3").out;
    assert_eq!(
        said,
        "8 points: 0 reused, 2 run, 6 resimulated; 0 failed\n16 points of other shards are missing; the tables are written once they exist\n"
    );
    let listed = place.ok("sweep plan.toml --list").out;
    // Points that share a recording are in one command.
    assert_eq!((listed.lines().count(), listed.matches(" --point ").count()), (4, 16));
    let (program, arguments) = listed.lines().next().unwrap().split_once(' ').expect("a command");
    assert!(Path::new(program).is_absolute());
    assert_eq!(place.ok(arguments).out, "4 points: 0 reused, 1 run, 3 resimulated; 0 failed\n");
    let allowed = place.ok("sweep plan.toml --list --allow-outside --memory-limit 2GiB --no-pictures").out;
    assert!(allowed.lines().all(|line| line.contains(" --no-pictures --allow-outside --memory-limit 2147483648 ")), "{allowed}");
    let script = place.ok("sweep plan.toml --slurm").out;
    assert!(script.starts_with("#!/bin/sh\n# 12 points are missing."), "{script}");
    assert!(script.contains("\n#SBATCH --array=1-6\n"), "{script}");
    fs::write(place.path("job.sh"), script).unwrap();
    // In the place of Slurm's command: it prints a number, and keeps its arguments.
    let submit = place.path("sbatch");
    fs::write(&submit, format!("#!/bin/sh\necho \"$@\" >> {}\necho 77\n", place.path("submitted").display())).unwrap();
    fs::set_permissions(&submit, std::os::unix::fs::PermissionsExt::from_mode(0o755)).unwrap();
    let path = format!("{}:{}", place.path("").display(), std::env::var("PATH").unwrap());
    let job = |arguments: &[&str], task: &str| {
        let mut job = std::process::Command::new("sh");
        job.arg("job.sh").args(arguments).env("SLURM_ARRAY_TASK_ID", task).env("PATH", &path).current_dir(place.path(""));
        assert!(job.status().unwrap().success());
    };
    job(&["--time=10:00"], "");
    let submitted = fs::read_to_string(place.path("submitted")).unwrap();
    let tables = "--dependency=afterok:77 --array=1 --job-name=basrelief-tables --time=10:00 job.sh tables";
    assert_eq!(submitted, format!("--parsable --time=10:00 job.sh\n{tables}\n"));
    // These run the jobs as Slurm does.
    for task in 1..=6 {
        job(&[], &task.to_string());
    }
    assert_eq!(place.ok("sweep plan.toml --list").out, "");
    for table in ["sweep.csv", "sweep.html"] {
        fs::remove_file(place.path("out").join(table)).ok();
    }
    job(&["tables"], "1");
    same(&files(&place.path("out")), &whole);
    fs::write(place.path("job.sh"), place.ok("sweep plan.toml --slurm").out).unwrap();
    fs::remove_file(place.path("submitted")).unwrap();
    job(&[], "");
    let submitted = fs::read_to_string(place.path("submitted")).unwrap();
    assert_eq!(submitted, "--array=1 --job-name=basrelief-tables job.sh tables\n", "no points are missing");
}

#[test]
fn new_sweep_writes_all_tables_again() {
    let place = place();
    place.ok("sweep plan.toml");
    let whole = files(&place.path("out"));
    fs::remove_file(place.path("out/sweep.csv")).unwrap();
    fs::write(place.path("out/sweep.html"), "").unwrap();
    let said = place.ok("sweep plan.toml").out;
    assert!(said.starts_with("24 points: 24 reused, 0 run, ") && said.contains("sweep.csv"), "{said}");
    same(&files(&place.path("out")), &whole);
}

#[test]
fn damaged_or_outdated_points_run_again_with_note() {
    let place = place();
    place.ok("sweep plan.toml");
    let whole = files(&place.path("out"));
    let reports: Vec<PathBuf> = whole.keys().filter(|path| path.ends_with("report.json")).cloned().collect();
    for report in &reports[..3] {
        fs::write(place.path("out").join(report), "").unwrap();
    }
    for report in &reports[3..8] {
        let mut changed = place.json(&format!("out/{}", report.display()));
        changed["build"] = "0.1.0".into();
        fs::write(place.path("out").join(report), changed.to_string()).unwrap();
    }
    let said = place.ok("sweep plan.toml").out;
    assert!(said.starts_with("24 points: 16 reused, "), "{said}");
    assert_eq!(said.lines().nth(1), Some("5 of another build of basrelief are run again"));
    same(&files(&place.path("out")), &whole);
    assert!(!place.ok("sweep plan.toml").out.contains("another build"));
}

#[test]
fn wrong_plan_is_named_with_cure() {
    let place = place();
    let says = |replaced: &str, by: &str, code: i32, expected: &str| {
        fs::write(place.path("wrong.toml"), PLAN.replace(replaced, by)).unwrap();
        let outcome = place.run("sweep wrong.toml");
        assert!(outcome.error(code).contains(expected), "{}", outcome.err);
        assert!(!place.path("out").exists());
    };
    says("size =", "sise =", 1, "wrong.toml: line 8: view.sise: no option is called `sise`; did you mean `size`?");
    says(
        "\"96x72\"",
        "\"96\"",
        1,
        "wrong.toml: line 8: view.size: invalid value '96' for '--size <WIDTHxHEIGHT>': expected WIDTHxHEIGHT",
    );
    says("demo:ellipsoid@2", "none.gltf", 1, "wrong.toml: line 3: input: none.gltf: cannot be read");
    says(
        "demo:ellipsoid@2",
        "-",
        1,
        "wrong.toml: line 3: input: -: can be read only once, but every run of a sweep reads it; expected a file",
    );
    says("cycles min", "cycels min", 1, "wrong.toml: line 5: objectives: the report has no figure `cycels`");
    says("shade.mode", "shade.mood", 1, "wrong.toml: line 11: axes: unknown parameter `shade.mood`; did you mean `shade.mode`?");
    says(
        "\"normal\"",
        "\"norml\"",
        1,
        "wrong.toml: line 11: axes: `shade.mode`: unknown value `norml`, expected one of `normal`",
    );
    let unknown = place.run("sweep plan.toml --point 12");
    assert!(unknown.error(2).contains("the plan has no point 12; --list prints the missing points"), "{}", unknown.err);
    assert!(place.run("sweep none.toml").error(1).starts_with("none.toml: cannot be read: "));
}

#[test]
fn files_of_a_plan_lie_relative_to_it() {
    let place = Place::new();
    fs::create_dir(place.path("plans")).unwrap();
    fs::copy(workspace().join("tests/models/patch.gltf"), place.path("plans/patch.gltf")).unwrap();
    fs::write(place.path("plans/base.toml"), "[replacement]\nentries = 4\n").unwrap();
    let text = "input = [\"patch.gltf\", \"list.dl.jsonl\"]\nconfig = \"base.toml\"\nobjectives = [\"cycles min\"]\n[axes]\nreplacement.lanes = [4, 8]\n";
    fs::write(place.path("plans/plan.toml"), text).unwrap();
    place.ok("record plans/patch.gltf --size 40x30 --out plans/list.dl.jsonl");
    let said = place.ok("sweep plans/plan.toml --verify 50").out;
    assert!(
        said.starts_with("4 points: 0 reused, 4 run, 0 resimulated; 0 failed\n2 points repeated: reports are identical\n"),
        "{said}"
    );
    let table = place.text("out/sweep.csv");
    assert!(table.lines().nth(3).unwrap().contains("list.dl.jsonl,4,"), "{table}");
    // A point has the same report as a run, except for the host's figures.
    place.ok("run plans/patch.gltf --config plans/base.toml --set replacement.lanes=4 --no-bottlenecks --out run");
    let id = table.lines().nth(1).unwrap().split(',').next().unwrap();
    let swept = place.report(&format!("out/points/{id}"));
    assert_eq!(swept, crate::support::without_host(place.report("run")));
    assert_eq!(place.bytes(&format!("out/points/{id}/image.png")), place.bytes("run/image.png"));
}

#[test]
fn fifo_depth_study_matches_its_page() {
    let place = Place::new();
    let plan = workspace().join("studies/fifo-depths.toml");
    let said = place.ok(&format!("sweep {} --no-pictures --verify 2", plan.display())).out;
    let (tally, front) = said.split_once("\n\n").unwrap();
    assert_eq!(tally, "108 points: 0 reused, 1 run, 107 resimulated; 0 failed\n3 points repeated: reports are identical");
    let page = fs::read_to_string(workspace().join("docs/experiments/studies.md")).unwrap();
    assert!(page.contains(tally.lines().next().unwrap()));
    let section = page.split("## Quantization").next().unwrap();
    let cells =
        |line: &str| line.replace(',', "").split(['|', ' ']).filter_map(|cell| cell.parse::<u64>().ok()).collect::<Vec<_>>();
    let rows: Vec<Vec<u64>> =
        section.lines().filter(|line| line.starts_with("| ")).map(cells).filter(|cells| cells.len() == 6).collect();
    let front: Vec<Vec<u64>> = front.lines().map(cells).filter(|cells| cells.len() == 6).collect();
    assert_eq!((front.len(), rows.len()), (38, 4));
    assert!(rows.iter().all(|row| front.contains(row)), "{front:?}");
    assert_eq!(rows[2][2..], [32, 64, 128, 32], "the default");
}

/// Returns the points of a study. The keys are column names without units.
fn points_of(study: &str) -> Vec<BTreeMap<String, serde_json::Value>> {
    let place = Place::new();
    place.ok(&format!("sweep {} --no-pictures", workspace().join("studies").join(study).display()));
    let named = |(name, value): (String, serde_json::Value)| (name.split(' ').next().unwrap_or_default().to_owned(), value);
    let point = |line: &str| serde_json::from_str::<serde_json::Map<_, _>>(line).unwrap().into_iter().map(named).collect();
    place.text("out/sweep.jsonl").lines().map(point).collect()
}

/// Returns the rows of a table of docs/experiments/texture-caches.md, selected by the beginning of its heading.
fn rows_of(heading: &str) -> Vec<Vec<String>> {
    let page = fs::read_to_string(workspace().join("docs/experiments/texture-caches.md")).unwrap();
    let cells = |line: &str| line.trim_matches('|').split('|').map(|cell| cell.trim().to_owned()).collect();
    let rows = page.lines().skip_while(|line| !line.starts_with(heading)).skip(2);
    rows.take_while(|line| line.starts_with('|')).map(cells).collect()
}

#[test]
fn working_set_study_matches_its_page() {
    let points = points_of("texture-caches.toml");
    let rows = rows_of("| order | tile | layout |");
    assert_eq!((points.len(), rows.len()), (108, 8));
    for row in rows {
        let [order, tile, layout, cells @ ..] = row.as_slice() else { panic!("{row:?}") };
        let count = |point: &BTreeMap<String, serde_json::Value>, name: &str| point[name].as_u64().unwrap();
        let read = |layout: &str, size: u64| {
            let is_it = |point: &&BTreeMap<String, serde_json::Value>| {
                let lines = count(point, "cache.color_texture.sets") * count(point, "cache.color_texture.ways");
                let words = [&point["rasterizer.order"], &point["texture.layout"]].map(|word| word.as_str().unwrap());
                words == [order.as_str(), layout]
                    && (tile.is_empty() || count(point, "rasterizer.block").to_string() == *tile)
                    && 64 * lines == size
            };
            let point = points.iter().find(is_it).unwrap();
            let bytes = count(point, "memories.graphics.clients.color_texels.read_bytes");
            format!("{:.2}", bytes as f64 / count(point, "figures.pixels_textured") as f64)
        };
        let sizes = (8..=16).map(|n| 1 << n);
        assert_eq!(cells, sizes.clone().map(|size| read(layout, size)).collect::<Vec<_>>(), "{order}, {tile}, {layout}");
        if layout == "blocked" {
            assert_eq!(cells, sizes.map(|size| read("blocked_6d", size)).collect::<Vec<_>>(), "where nothing conflicts");
        }
    }
}

#[test]
fn texture_latency_study_matches_its_page() {
    let points = points_of("texture-latency.toml");
    let names = ["memory.texture.cl", "memory.texture.outstanding", "fifo.texture_values.depth", "cycles.frames"];
    let numbers = |point: &BTreeMap<String, serde_json::Value>| names.map(|name| point[name].as_u64().unwrap());
    let all: Vec<[u64; 4]> = points.iter().map(numbers).collect();
    let without = all.iter().filter(|[cl, ..]| *cl == 0).map(|point| point[3]).min().unwrap();
    let rows = rows_of("| `cl` | requests |");
    assert_eq!((all.len(), rows.len()), (96, 6));
    for row in rows {
        let of_row = |point: &&[u64; 4]| point[0].to_string() == row[0] && point[1].to_string() == row[1];
        let speeds = all.iter().filter(of_row).map(|point| format!("{:.1}", 100.0 * without as f64 / point[3] as f64));
        assert_eq!(row[2..], speeds.collect::<Vec<_>>(), "{row:?}");
    }
}

#[test]
fn exploration_of_study_matches_its_page() {
    let place = Place::new();
    let plan = workspace().join("studies/fifo-depths.toml");
    place.ok(&format!("sweep {} --no-pictures", plan.display()));
    let said = place.ok(&format!("explore {} --no-pictures --budget 27", plan.display())).out;
    let (_, share) = said.split_once("which all exist; these reach ").unwrap();
    let share = share.split_once(" of the hypervolume").unwrap().0;
    let page = fs::read_to_string(workspace().join("docs/experiments/studies.md")).unwrap();
    assert!(page.contains(&format!("| 108 | 27 | {share} |")), "{share}");
}

#[test]
fn plan_of_the_guide_runs_and_resimulates() {
    let place = Place::new();
    let guide = fs::read_to_string(workspace().join("docs/guide/sweep-and-explore.md")).unwrap();
    let (_, behind) = guide.split_once("```toml\n").expect("a plan");
    fs::write(place.path("plan.toml"), behind.split_once("```").unwrap().0).unwrap();
    let said = place.ok("sweep plan.toml --out out/sweep").out;
    assert!(said.starts_with("18 points: 0 reused, 6 run, 12 resimulated; 0 failed\n"), "{said}");
    assert!(place.text("out/sweep/sweep.html").contains("<html"), "a page");
}

#[test]
fn readme_figures_match_study() {
    let points = points_of("search-lanes.toml");
    let number = |point: &BTreeMap<String, serde_json::Value>, name: &str| point[name].as_f64().unwrap();
    let readme = fs::read_to_string(workspace().join("README.md")).unwrap();
    let rows = readme.lines().skip_while(|line| !line.starts_with("| reference normals |")).skip(2);
    let rows: Vec<String> = rows.take_while(|line| line.starts_with('|')).map(|line| line.replace(',', "")).collect();
    let expected = points.chunks(3).map(|of_size| {
        let [entries, psnr] = ["replacement.entries", "quality.psnr_db"].map(|name| number(&of_size[0], name));
        let cycles: Vec<String> = of_size.iter().map(|point| number(point, "cycles.frames").to_string()).collect();
        format!("| {entries} | {psnr:.2} dB | {} |", cycles.join(" | "))
    });
    assert_eq!(rows, expected.collect::<Vec<_>>());
}

#[test]
fn file_in_the_place_of_the_folder_is_named() {
    let place = place();
    fs::write(place.path("taken"), "mine").unwrap();
    for command in ["sweep plan.toml", "explore plan.toml --budget 4", "run PATCH --size 16x12"] {
        for out in ["taken", "taken/deeper"] {
            let outcome = place.run(&format!("{command} --out {out}"));
            let expected = format!("{out}: cannot be written: taken is a file, expected a folder; choose another folder\n");
            assert_eq!(outcome.error(1), expected, "{command}");
        }
    }
    assert_eq!(place.text("taken"), "mine");
}

#[test]
fn exploration_reports_share_of_front() {
    let place = place();
    let said = place.ok("explore plan.toml --budget 10 --threads 2").out;
    assert!(said.starts_with("10 points: 0 reused, "), "{said}");
    assert!(said.contains("\nthe grid has 24 points\n"), "{said}");
    assert_eq!(reports(&place), 10);
    let few = files(&place.path("out"));
    place.ok("explore plan.toml --budget 10 --threads 1 --out alone");
    same(&files(&place.path("alone")), &few);
    // An exploration that continues a shorter one makes the same choices.
    place.ok("explore plan.toml --budget 6 --out resumed");
    assert!(place.ok("explore plan.toml --budget 10 --out resumed").out.starts_with("10 points: 6 reused, "));
    same(&files(&place.path("resumed")), &few);
    // The sweep reuses the points of the exploration. After it, the whole grid is known.
    assert!(place.ok("sweep plan.toml").out.starts_with("24 points: 10 reused, "));
    let said = place.ok("explore plan.toml --budget 10").out;
    assert!(said.starts_with("10 points: 10 reused, 0 run, 0 resimulated; 0 failed\n"), "{said}");
    let share: f64 = said.split("these reach ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    assert!((90.0..=100.0).contains(&share), "{said}");
    assert!(
        place.ok("explore plan.toml --budget 24").out.contains("these reach 100.00 % of the hypervolume of its Pareto front")
    );
    fs::write(
        place.path("two.toml"),
        PLAN.replace("input = \"demo:ellipsoid@2\"", "input = [\"demo:ellipsoid@2\", \"demo:coin\"]"),
    )
    .unwrap();
    assert!(place.run("explore two.toml --budget 4").error(1).contains("two.toml: input: 2 inputs; expected one"));
}

#[test]
fn sweep_without_a_result_is_an_error() {
    let place = Place::new();
    let plan = |rows: &str| {
        let axes = format!("[axes]\nmemory.graphics.row_bytes = [{rows}]\n");
        format!("input = \"demo:golf-ball\"\nobjectives = [\"cycles min\"]\n[view]\nsize = \"16x12\"\n{axes}")
    };
    fs::write(place.path("none.toml"), plan("16, 32")).unwrap();
    let outcome = place.run("--quiet sweep none.toml --out none");
    let message = outcome.error(1);
    assert!(message.starts_with("all 2 points failed; none/points/ID/failed.json states why"), "{message}");
    assert!(place.path("none/sweep.csv").exists(), "the tables are written before the error");
    fs::write(place.path("one.toml"), plan("16, 4096")).unwrap();
    place.ok("--quiet sweep one.toml --out one");
    let listed = place.ok("sweep one.toml --out two --list").out;
    let points = listed.trim().split(" --point ").skip(1);
    let mut codes: Vec<i32> = points.map(|id| place.run(&format!("sweep one.toml --out two --point {id}")).code()).collect();
    codes.sort_unstable();
    assert_eq!(codes, [0, 1], "a command whose only point fails, and another");
}
