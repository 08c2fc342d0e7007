//! Scene to trace and back with the rate-limited renderer: the same pictures, bytes and tiles.

use basrelief_machines::defer::DeferConfig;
use basrelief_report::Report;
use basrelief_scene::{ViewOptions, load_path};
use basrelief_signals::{Control, Material, Object, Scene, Texture, WrapMode};
use basrelief_sim::{NoObserver, RunInput, RunOptions, display_list, run, trace_header};
use basrelief_trace::{TraceForm, TraceRecorder};
use std::io::Cursor;
use std::path::Path;
use std::sync::Arc;

/// The textured patch, and a copy of it with another texture behind the viewer.
fn scene() -> Arc<Scene> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/models/patch.gltf");
    let options = ViewOptions { size: [64, 48], frames: Some(2), orbit_degrees: Some(40.0), ..ViewOptions::default() };
    let mut scene = load_path(&path, &options).unwrap();
    let seen = scene.objects.iter().find(|o| o.material.color_texture.is_some()).unwrap();
    let texture = seen.material.color_texture.as_ref().unwrap();
    let texture = Arc::new(Texture { id: 77, name: "unseen".into(), ..Texture::clone(texture) });
    let material = Material { id: 77, color_texture: Some(texture), ..Material::clone(&seen.material) };
    let mut world = [0.0; 16];
    [0, 5, 10, 15].into_iter().for_each(|i| world[i] = 1.0);
    world[7] = 1e6;
    let hidden = Object { id: scene.objects.len() as u32, material: Arc::new(material), world, ..Object::clone(seen) };
    scene.objects.push(Arc::new(hidden));
    Arc::new(scene)
}

fn config(mode: &str) -> DeferConfig {
    basrelief_parameters::load("", &[("defer.mode", mode), ("tile.width", "8"), ("tile.height", "8")]).unwrap()
}

fn recorded(scene: &Arc<Scene>, config: &DeferConfig, form: TraceForm) -> Vec<u8> {
    let mut recorder = TraceRecorder::new(Vec::new(), form, trace_header(scene)).unwrap();
    display_list(scene, &config.clone().into()).for_each(|control| recorder.record(&control).unwrap());
    recorder.finish(Vec::new()).unwrap()
}

fn report(source: RunInput, config: &DeferConfig) -> Report {
    let settings = RunOptions { config: config.clone().into(), exact: false, ..RunOptions::default() };
    run(source, &settings, &mut NoObserver, None).unwrap().report
}

/// Returns the machine's counts of tiles, bytes and pixels.
fn counted(report: &Report) -> String {
    let of_tiles = |name: &str| ["tile", "path", "layer", "pixel", "texture", "conventional"].iter().any(|n| name.contains(n));
    format!("{:?}", report.figures.iter().filter(|(name, _)| of_tiles(name)).collect::<Vec<_>>())
}

#[test]
fn replay_draws_the_same_pictures_in_every_mode() {
    let scene = scene();
    for mode in ["best", "progressive", "conventional"] {
        let config = config(mode);
        let drawn = report(RunInput::scene(Arc::clone(&scene)), &config);
        for form in TraceForm::ALL.into_iter().filter(|form| !form.compressed) {
            let replayed = report(RunInput::trace(Cursor::new(recorded(&scene, &config, form)), "recorded"), &config);
            assert_eq!(drawn.input.sha256, replayed.input.sha256, "the same input");
            assert_eq!(drawn.image, replayed.image, "{mode}, {form:?}: the same pictures to the bit");
            assert_eq!(drawn.image.len(), 2);
            assert_eq!(counted(&drawn), counted(&replayed), "{mode}, {form:?}");
        }
    }
}

#[test]
fn first_frame_declares_all_textures_of_the_scene_452() {
    let scene = scene();
    let list: Vec<Control> = display_list(&scene, &config("best").into()).collect();
    let of = |control: &Control| match control {
        Control::Frame(frame) => Some(frame.textures.iter().map(|t| t.id).collect::<Vec<_>>()),
        _ => None,
    };
    let declared: Vec<Vec<u32>> = list.iter().filter_map(of).collect();
    assert!(declared.len() == 2 && declared[0].contains(&77) && declared[1].is_empty(), "{declared:?}");
    let names = |c: &Control| matches!(c, Control::Polygon(p) if p.material.color_texture.as_ref().is_some_and(|t| t.id == 77));
    assert!(!list.iter().any(names), "no polygon names it");
}

/// The alcove with this wrap mode on all textures, coordinates running far beyond their edges.
fn wrapped(wrap: WrapMode) -> Arc<Scene> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/models/alcove.gltf");
    let mut scene = load_path(&path, &ViewOptions { size: [160, 120], ..ViewOptions::default() }).unwrap();
    for object in &mut scene.objects {
        let object = Arc::make_mut(object);
        let mesh = Arc::make_mut(&mut object.mesh);
        mesh.uv.iter_mut().flatten().for_each(|c| *c = 2.5 * *c - 0.7);
        if let Some(texture) = &mut Arc::make_mut(&mut object.material).color_texture {
            Arc::make_mut(texture).sampler.wrap = [wrap; 2];
        }
    }
    Arc::new(scene)
}

// Claim: defer, wrap modes: The reference image continues odd textures beyond their edges like the device, in every mode.
#[test]
fn section_3_exact_picture_wraps_odd_textures_like_the_device() {
    for wrap in [WrapMode::Repeat, WrapMode::Mirror, WrapMode::Clamp] {
        for centre in ["half", "integer"] {
            let settings = [("tile.width", "4"), ("tile.height", "4"), ("defer.texel_centre", centre)];
            let config: DeferConfig = basrelief_parameters::load("", &settings).unwrap();
            let settings = RunOptions { config: config.into(), engine: None, ..RunOptions::default() };
            let report = run(RunInput::scene(wrapped(wrap)), &settings, &mut NoObserver, None).unwrap().report;
            let db = report.quality.map_or(0.0, |quality| quality.last.psnr_db);
            assert!(db >= 50.0, "{wrap:?}, {centre}: {db:.2} dB");
        }
    }
}

// Claim: as bump_target_is_lit_at_vertices_by_formula.
#[test]
fn gouraud_with_normal_maps_matches_the_exact_picture() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/models/patch.gltf");
    let scene = load_path(&path, &ViewOptions { size: [160, 120], ..ViewOptions::default() }).unwrap();
    assert!(scene.objects.iter().any(|o| o.material.normal_map.is_some()), "its polygons are bump targets");
    let config: DeferConfig = basrelief_parameters::load("", &[("defer.lighting", "gouraud")]).unwrap();
    let settings = RunOptions { config: config.into(), engine: None, ..RunOptions::default() };
    let report = run(RunInput::scene(Arc::new(scene)), &settings, &mut NoObserver, None).unwrap().report;
    let db = report.quality.map_or(0.0, |quality| quality.last.psnr_db);
    assert!(db >= 40.0, "{db:.2} dB");
}

/// Three views of an alcove over a slow path: a tile of 4 x 4 texels takes a millisecond.
fn looking_around(set: &[(&str, &str)]) -> Report {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/models/alcove.gltf");
    let options = ViewOptions { size: [160, 120], frames: Some(3), orbit_degrees: Some(60.0), ..ViewOptions::default() };
    let small = [("defer.mode", "progressive"), ("tile.width", "4"), ("tile.height", "4"), ("display.enabled", "false")];
    let slow = [("path.bits_per_second", "384000")];
    let config: DeferConfig = basrelief_parameters::load("", &[&small[..], &slow, set].concat()).unwrap();
    report(RunInput::scene(Arc::new(load_path(&path, &options).unwrap())), &config)
}

fn counts(report: &Report, name: &str) -> Vec<u64> {
    serde_json::to_value(&report.figures[name]).and_then(serde_json::from_value).unwrap()
}

// Claim: as user_times_become_stable_tile_counts_475.
#[test]
fn left_view_requests_no_more_tiles_475() {
    let never = looking_around(&[("defer.left_at_tile", "[0]")]);
    let all = counts(&never, "view_tiles");
    assert!(all[0] > 20 && counts(&never, "view_abandoned") == [0; 3], "{all:?}");
    let left = looking_around(&[("defer.left_at_tile", "[12, 1]")]);
    let tiles = counts(&left, "view_tiles");
    assert_eq!(tiles[..2], [11, 0]);
    assert_eq!(counts(&left, "view_left_at_tile"), [12, 1, 0]);
    let abandoned = counts(&left, "view_abandoned");
    assert!(abandoned[0] > 0 && abandoned[1] > 0 && abandoned[2] == 0, "{abandoned:?}");
    // Abandoned tiles are requested again, and no tile is loaded twice.
    assert!(tiles[2] > all[2] && tiles.iter().sum::<u64>() <= all.iter().sum::<u64>(), "{tiles:?} {all:?}");
    assert_eq!(left.image[2].sha256, never.image[2].sha256);
    assert_ne!(left.image[0].sha256, never.image[0].sha256);
}

// Claim: defer, 475: Solver runs turn times of user input into counts. An abandoned view requests nothing more, and the next
// continues from there.
#[test]
fn user_times_become_stable_tile_counts_475() {
    let tiles_left_at = |ms: &str| {
        let report = looking_around(&[("defer.left_at_ms", ms)]);
        assert_eq!(report.config["defer"]["left_at_tile"], serde_json::to_value(counts(&report, "view_left_at_tile")).unwrap());
        report
    };
    let first = tiles_left_at("[60, 90]");
    let left = counts(&first, "view_left_at_tile");
    assert!(left[0] > 1 && left[1] > 1 && left[2] == 0, "{left:?}");
    let later = counts(&tiles_left_at("[63, 90]"), "view_left_at_tile");
    assert_eq!(later[0], left[0] + 3, "a tile by the millisecond");
    let at: Vec<f64> = serde_json::to_value(&first.figures["picture_at_ms"]).and_then(serde_json::from_value).unwrap();
    let begins = counts(&first, "picture_frame").iter().position(|frame| *frame == 1).unwrap();
    assert!((60.0..75.0).contains(&at[begins]), "the next view shows at once what is there: {at:?}");
    let by_counts = looking_around(&[("defer.left_at_tile", &format!("{left:?}"))]);
    assert_eq!((&first.image, &first.cycles), (&by_counts.image, &by_counts.cycles));
    // Idle time after the last picture takes no cycles, and the next view begins at its time.
    let patient = tiles_left_at("[5000]");
    let never = looking_around(&[]);
    assert_eq!((&patient.image, &patient.cycles), (&never.image, &never.cycles));
    let at: Vec<f64> = serde_json::to_value(&patient.figures["picture_at_ms"]).and_then(serde_json::from_value).unwrap();
    let begins = counts(&patient, "picture_frame").iter().position(|frame| *frame == 1).unwrap();
    assert!(at[begins - 1] < 5000.0 && at[begins] > 5000.0, "{at:?}");
}
