//! Errors of plans name the line, the field and the cure.

use crate::support::{Place, workspace};
use std::fs;

const HEAD: &str = "input = \"demo:ellipsoid@1\"\nobjectives = [\"cycles min\"]\nmachine = \"bump\"\n";

/// Runs each plan, which must be refused with these words.
fn says(place: &Place, cases: &[(&str, &str)]) {
    for (text, expected) in cases {
        fs::write(place.path("plan.toml"), text).unwrap();
        let outcome = place.run("sweep plan.toml --list");
        assert!(outcome.error(1).contains(&format!("plan.toml: {expected}")), "{text}\n{}", outcome.err);
    }
}

#[test]
fn wrong_view_has_the_line_of_its_option() {
    let place = Place::new();
    fs::write(place.path("views.toml"), "[[views]]\norbt = 1\n").unwrap();
    fs::write(place.path("camera.json"), "{").unwrap();
    fs::copy(workspace().join("traces/patch-one-level.jsonl"), place.path("t.jsonl")).unwrap();
    for (view, expected) in [
        ("[view]\nframes = 1\nzoom = 1000", "line 6: view.zoom: invalid value '1000'"),
        ("[view]\nframes = 2\ncamera = \"none.json\"", "line 6: view.camera: none.json: cannot be read: "),
        (
            "[view]\nsize = \"40x30\"\n[[views]]\n[[views]]\ncamera = \"camera.json\"",
            "line 8: views[1].camera: camera.json: line 1",
        ),
        (
            "[view]\nviews = \"views.toml\"",
            "line 5: view.views: views.toml: line 2: views[0].orbt: unknown field `orbt`, expected one of",
        ),
        ("[view]\nframes = 2\nviews = \"camera.json\"", "line 6: view.views: the argument '--"),
        ("[view]\nframes = 1\norbit = 30", "line 6: view.orbit: 30; expected 0 with a single frame"),
        ("[[views]]\n[[views]]\nsize = \"30x20\"", "line 5: views[1]: demo:ellipsoid@1: has the size 30x20; expected 640x480"),
        ("views = []", "line 4: views: is empty; expected a view at least, or no `views`"),
    ] {
        says(&place, &[(&format!("{HEAD}{view}"), expected)]);
    }
    let trace = HEAD.replace("demo:ellipsoid@1", "t.jsonl") + "[view]\nsize = \"40x30\"";
    says(&place, &[(&trace, "line 5: view.size: t.jsonl is a trace, which has its own view; move it into a plan without views")]);
    assert!(!place.path("out").exists());
}

#[test]
fn view_of_a_plan_is_relative_to_it() {
    let place = Place::new();
    fs::create_dir(place.path("plans")).unwrap();
    fs::write(place.path("plans/views.toml"), "views = [{ orbit = 0 }, { orbit = 30 }]\n").unwrap();
    fs::write(place.path("plans/plan.toml"), format!("{HEAD}[view]\nsize = \"40x30\"\nviews = \"views.toml\"\n")).unwrap();
    place.ok("sweep plans/plan.toml --list");
}

#[test]
fn missing_file_of_a_plan_is_relative_to_it() {
    let place = Place::new();
    fs::create_dir(place.path("plans")).unwrap();
    let cure = "expected an existing file; check the name, which is looked up from the folder of the plan";
    for (line, expected) in [
        ("input = \"none.obj\"\nview.zoom = 2", "line 1: input: plans/none.obj: cannot be read: "),
        ("input = \"demo:coin\"\nview.camera = \"none.json\"", "line 2: view.camera: plans/none.json: cannot be read: "),
        ("input = \"demo:coin\"\nconfig = \"none.toml\"", "line 2: config: plans/none.toml: cannot be read: "),
    ] {
        fs::write(place.path("plans/plan.toml"), format!("{line}\nobjectives = [\"cycles min\"]\n")).unwrap();
        let outcome = place.run("sweep plans/plan.toml --list");
        let error = outcome.error(1);
        assert!(error.contains(expected) && error.contains(cure), "{error}");
    }
}

#[test]
fn parameter_of_other_machine_is_cured_in_plan_and_trace() {
    let place = Place::new();
    fs::write(place.path("other.toml"), "\n[shade]\nmode = \"normal\"\n").unwrap();
    let words = "is a parameter of machine `shade`, and this is `bump`; set machine = \"shade\" in the plan";
    for (text, start) in [
        ("[axes]\nshade.mode = [\"normal\"]", "line 5: axes: `shade.mode`"),
        ("[[zip]]\nreplacement.lanes = [1]\nshade.mode = [\"normal\"]", "line 6: zip: `shade.mode`"),
        ("[config]\nshade.mode = \"normal\"", "line 5: config: `shade`"),
        ("config = \"other.toml\"", "line 4: config: other.toml: line 2: `shade`"),
    ] {
        says(&place, &[(&format!("{HEAD}{text}"), &format!("{start} {words}"))]);
    }
    place.ok("record demo:cut-plane@1 --size 48x36 --set shade.mode=brightness --expect --out t.jsonl");
    fs::write(place.path("t.jsonl"), place.text("t.jsonl").replace(r#""machine":"shade""#, r#""machine":"bump""#)).unwrap();
    let outcome = place.run("verify t.jsonl");
    let error = outcome.error(1);
    assert!(error.contains(": expect.config: `shade.mode` is a parameter of machine `shade`"), "{error}");
    assert!(error.contains("and this is `bump`; set expect.machine to \"shade\""), "{error}");
}
