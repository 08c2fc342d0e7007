//! `--views`: a sequence of views, optionally with times.

use basrelief_input::{JsonFault, MemoryPool, from_str, json_weight};
use basrelief_parameters::TomlFault;
use basrelief_scene::OwnView;
use basrelief_signals::{Camera, schema_of};
use basrelief_sim::TOML_GROWTH;
use schemars::JsonSchema;
use serde::Deserialize;
use serde_json::Value;

/// The file format.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct ViewFile {
    /// The views, one frame each.
    views: Vec<WrittenView>,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a view, such as { orbit = 30 }")]
struct WrittenView {
    /// Time at which the user changes to the view (ms).
    at_ms: Option<f64>,
    /// Camera.
    camera: Option<WrittenCamera>,
    /// Rotation of the camera about the model, around the vertical axis and upwards (degrees).
    #[schemars(with = "Option<[f64; 2]>")]
    turn: Option<ExactList<2>>,
    /// Zoom factor about the image centre.
    #[schemars(range(min = 0.01, max = 100.0))]
    zoom: Option<f64>,
    /// Rotation of the camera around the vertical axis (degrees).
    orbit: Option<f64>,
    /// Direction to the light in world space.
    #[schemars(with = "Option<[f64; 3]>")]
    light: Option<ExactList<3>>,
    /// Rotation of the light around the vertical axis (degrees).
    light_orbit: Option<f64>,
}

/// A camera as written in a view file.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "view_projection, to_light and to_viewer, as a file of --camera holds them")]
struct WrittenCamera {
    /// Matrix from world to clip space, row by row.
    #[schemars(with = "[f64; 16]")]
    view_projection: ExactList<16>,
    /// Direction to the light.
    #[schemars(with = "[f64; 3]")]
    to_light: ExactList<3>,
    /// Direction to the viewer.
    #[schemars(with = "[f64; 3]")]
    to_viewer: ExactList<3>,
}

/// Returns the JSON schema of a view file.
pub fn schema() -> Value {
    schema_of::<ViewFile>("views-1").to_value()
}

/// A list of exactly N numbers. (The TOML reader of serde would ignore further numbers.)
#[derive(Debug, Deserialize)]
#[serde(try_from = "Vec<f64>")]
struct ExactList<const N: usize>([f64; N]);

impl<const N: usize> TryFrom<Vec<f64>> for ExactList<N> {
    type Error = String;

    fn try_from(given: Vec<f64>) -> Result<Self, String> {
        given
            .try_into()
            .map(Self)
            .map_err(|given: Vec<f64>| format!("a list of {} stands here, expected {N} numbers", given.len()))
    }
}

/// Latest time: three months \[ms\].
const LATEST_MS: f64 = 8e9;

/// A sequence of views.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ViewScript {
    /// The views.
    pub views: Vec<OwnView>,
    /// Time at which the user leaves each view for the next \[ms from the start\]. Empty if the views have no times.
    pub left_at_ms: Option<Vec<f64>>,
}

impl ViewScript {
    /// Reads TOML, or JSON if the text starts with a brace.
    ///
    /// # Errors
    /// A sentence with the place of the error.
    pub fn read(text: &str, budget: &MemoryPool) -> Result<Self, String> {
        let is_json = text.trim_start().starts_with('{');
        let weight = if is_json { json_weight(text.as_bytes()) } else { TOML_GROWTH * text.len() as u64 };
        let _held = budget.try_reserve(weight, "the values of a script of views").map_err(|e| e.to_string())?;
        let written: ViewFile = if is_json {
            from_str(text).map_err(|fault| json(&fault))?
        } else {
            toml::from_str(text).map_err(|error| TomlFault::of_reader(text, &error).at_line(text))?
        };
        if written.views.is_empty() {
            return Err("/views: is empty; expected a view at least".into());
        }
        let left_at_ms = times(&written.views)?;
        let views: Vec<OwnView> = written.views.into_iter().map(to_own_view).collect();
        OwnView::check(&views).map_err(|e| e.to_string())?;
        Ok(Self { views, left_at_ms })
    }
}

fn to_own_view(view: WrittenView) -> OwnView {
    let WrittenView { camera, turn, zoom, orbit, light, light_orbit, .. } = view;
    let camera = camera.map(|WrittenCamera { view_projection, to_light, to_viewer }| Camera {
        view_projection: view_projection.0,
        to_light: to_light.0,
        to_viewer: to_viewer.0,
    });
    let (turn, light) = (turn.map(|turn| turn.0), light.map(|light| light.0));
    OwnView { camera, turn, zoom, orbit_degrees: orbit, light, light_orbit_degrees: light_orbit }
}

/// Returns the time at which each view is left, if there are times.
fn times(views: &[WrittenView]) -> Result<Option<Vec<f64>>, String> {
    if views.iter().all(|view| view.at_ms.is_none()) {
        return Ok(None);
    }
    let mut before = None;
    for (i, view) in views.iter().enumerate() {
        let place = format!("/views/{i}/at_ms");
        let at = view.at_ms.ok_or_else(|| format!("{place}: is missing; expected a time for each view, or for none"))?;
        let later = before.is_none_or(|before| at > before);
        match (before, later && (0.0..=LATEST_MS).contains(&at)) {
            (None, _) if at != 0.0 => return Err(format!("{place}: {at}; expected 0: the first view begins at the start")),
            (_, true) => before = Some(at),
            _ => return Err(format!("{place}: {at}; expected rising times of 0 to {LATEST_MS} ms")),
        }
    }
    Ok(Some(views.iter().skip(1).filter_map(|view| view.at_ms).collect()))
}

fn json(fault: &JsonFault) -> String {
    let JsonFault { path, line, column, is_data, message } = fault;
    let place = format!("line {line}, column {column}");
    if *is_data { format!("{path} ({place}): {message}") } else { format!("{place}: not valid JSON: {message}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<ViewScript, String> {
        ViewScript::read(text, &MemoryPool::default())
    }

    #[test]
    fn view_script_reads_alike_in_toml_and_json() {
        let toml =
            "views = [{ at_ms = 0, orbit = 0 }, { at_ms = 350, orbit = 30.5, zoom = 2 }, { at_ms = 400.5, turn = [1, 2] }]";
        let json = r#"{"views": [{"at_ms": 0, "orbit": 0}, {"at_ms": 350, "orbit": 30.5, "zoom": 2}, {"at_ms": 400.5, "turn": [1, 2]}]}"#;
        let script = read(toml).unwrap();
        assert_eq!(script, read(json).unwrap());
        assert_eq!(script.left_at_ms, Some(vec![350.0, 400.5]));
        let second = OwnView { orbit_degrees: Some(30.5), zoom: Some(2.0), ..OwnView::default() };
        assert_eq!(script.views[1], second);
        assert_eq!(read("[[views]]\nturn = [1, 2]\n[[views]]").unwrap().left_at_ms, None);
    }

    // Claim: as own_views_equal_the_same_options.
    #[test]
    fn view_file_errors_name_place_and_field() {
        for (text, says) in [
            ("", "missing field `views`"),
            ("views = []", "/views: is empty; expected a view at least"),
            ("views = [{ at = 3 }]", "unknown field `at`"),
            ("\nviews = [{ orbit = \"x\" }]", "line 2: views[0].orbit: the text \"x\" stands here, expected a number"),
            ("views = 3", "line 1: views: the number 3 stands here, expected a list"),
            ("views = [3]", "line 1: views[0]: the number 3 stands here, expected a view, such as { orbit = 30 }"),
            ("views = [\n{ orbit = 3 },\n{ orbt = 3 }]", "line 3: views[1].orbt: unknown field `orbt`, expected one of"),
            ("views = [{ orbt = 3 }]", "; did you mean `orbit`?"),
            ("views = [", "TOML parse error at line 1, column 10"),
            ("views = [{ camera = 3 }]", "expected view_projection, to_light and to_viewer, as a file of --camera holds them"),
            ("views = [{ turn = [1] }]", "a list of 1 stands here, expected 2 numbers"),
            ("views = [{ turn = [1, 2, 3] }]", "a list of 3 stands here, expected 2 numbers"),
            (
                r#"{"views": [{"light": [1, 2, 3, 4]}]}"#,
                "views[0].light (line 1, column 34): a list of 4 stands here, expected 3 numbers",
            ),
            ("views = [{ zoom = 1000 }]", "/views/0/zoom: 1000; expected a number from 0.01 to 100"),
            ("views = [{ turn = [1, nan] }]", "/views/0/turn: NaN; expected a finite angle"),
            ("views = [{ at_ms = 0 }, {}]", "/views/1/at_ms: is missing; expected a time for each view, or for none"),
            ("views = [{ at_ms = 5 }]", "/views/0/at_ms: 5; expected 0"),
            ("views = [{ at_ms = 0 }, { at_ms = 7 }, { at_ms = 7 }]", "/views/2/at_ms: 7; expected rising times"),
            ("views = [{ at_ms = 0 }, { at_ms = inf }]", "/views/1/at_ms: inf; expected rising times"),
            ("views = [{ at_ms = 0 }, { at_ms = nan }]", "/views/1/at_ms: NaN; expected rising times"),
            (
                r#"{"views": [{"orbit": 1}, {"orbit": "x"}]}"#,
                "views[1].orbit (line 1, column 38): the text \"x\" stands here, expected a number",
            ),
            (r#"{"views": ["#, "line 1, column 11: not valid JSON"),
        ] {
            let error = read(text).unwrap_err();
            assert!(error.contains(says), "{text}: {error}");
        }
        assert!(ViewScript::read(&"[[views]]\n".repeat(1000), &MemoryPool::new(1000)).unwrap_err().contains("a script of views"));
    }
}
