//! State of the pipeline. State that the devices have is read; other state is refused, or left out with a warning.

use crate::draw::LEAVE_OUT;
use crate::dump::GlDump;
use basrelief_scene::SceneError;
use serde_json::Value;

/// State of a draw call. Missing parameters have the initial value of OpenGL.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct DrawState {
    /// Left, bottom, width and height \[pixels\].
    pub viewport: [u32; 4],
    /// Front faces are clockwise in the window, or front faces are culled.
    pub reversed: bool,
    /// No face is culled.
    pub double_sided: bool,
}

/// Access to parameters by name.
pub(crate) struct Parameters<'a>(pub &'a GlDump);

impl<'a> Parameters<'a> {
    pub fn value(&self, name: &str) -> Option<&'a Value> {
        self.0.parameters.0.get(name)
    }

    /// Returns true if a parameter is on.
    pub fn flag(&self, name: &str) -> bool {
        self.value(name).is_some_and(is_on)
    }

    pub fn word(&self, name: &str, initial: &'static str) -> &'a str {
        self.value(name).and_then(Value::as_str).unwrap_or(initial)
    }

    /// Returns a list of N numbers; `None` if the parameter is missing or another value.
    pub fn numbers<const N: usize>(&self, name: &str) -> Option<[f64; N]> {
        let list: Option<Vec<f64>> = self.value(name)?.as_array()?.iter().map(Value::as_f64).collect();
        list?.try_into().ok()
    }
}

/// Returns true if a value is on.
pub(crate) fn is_on(value: &Value) -> bool {
    matches!(value.as_str(), Some("GL_TRUE" | "GL_ONE")) || value.as_u64() == Some(1) || value.as_bool() == Some(true)
}

/// Switches of state that the devices do not have: drawn without it, with a warning.
const IGNORED: [(&str, &str); 19] = [
    ("GL_BLEND", "blending"),
    ("GL_ALPHA_TEST", "the alpha test"),
    ("GL_STENCIL_TEST", "the stencil test"),
    ("GL_FOG", "fog"),
    ("GL_DEPTH_CLAMP", "the depth clamp"),
    ("GL_POLYGON_OFFSET_FILL", "the polygon offset"),
    ("GL_COLOR_LOGIC_OP", "the logical operation"),
    ("GL_FRAMEBUFFER_SRGB", "the sRGB conversion of the frame buffer"),
    ("GL_SAMPLE_BUFFERS", "multisampling"),
    ("GL_CLIP_DISTANCE0", "user clipping"),
    ("GL_CLIP_DISTANCE1", "user clipping"),
    ("GL_CLIP_DISTANCE2", "user clipping"),
    ("GL_CLIP_DISTANCE3", "user clipping"),
    ("GL_CLIP_DISTANCE4", "user clipping"),
    ("GL_CLIP_DISTANCE5", "user clipping"),
    ("GL_CLIP_DISTANCE6", "user clipping"),
    ("GL_CLIP_DISTANCE7", "user clipping"),
    ("GL_LIGHT_MODEL_LOCAL_VIEWER", "the local viewer"),
    ("GL_LIGHT_MODEL_TWO_SIDE", "two-sided lighting"),
];

/// Parameter with a switch for each of red, green, blue and alpha.
pub(crate) const COLOR_MASK: &str = "GL_COLOR_WRITEMASK";

/// Returns the switches of red, green and blue.
fn color_mask(parameters: &Parameters<'_>) -> [bool; 3] {
    let mask = parameters.value(COLOR_MASK);
    [0, 1, 2].map(|channel| mask.and_then(|mask| mask.get(channel)).is_none_or(is_on))
}

/// Returns true if a draw call writes no colour, such as one that only fills the depth buffer.
pub(crate) fn writes_no_color(dump: &GlDump) -> bool {
    color_mask(&Parameters(dump)) == [false; 3]
}

/// Returns the state of a draw call, and the sentences of warnings.
pub(crate) fn draw_state(dump: &GlDump) -> Result<(DrawState, Vec<String>), SceneError> {
    let parameters = Parameters(dump);
    check_pipeline(dump)?;
    check_depth(&parameters)?;
    let viewport = viewport(&parameters)?;
    check_scissor(&parameters, viewport)?;
    let culls = parameters.flag("GL_CULL_FACE");
    let mode = parameters.word("GL_CULL_FACE_MODE", "GL_BACK");
    if culls && !matches!(mode, "GL_BACK" | "GL_FRONT") {
        let what = if mode == "GL_FRONT_AND_BACK" { "culls all faces".into() } else { format!("is {mode}") };
        return Err(refused("GL_CULL_FACE_MODE", what, "GL_BACK or GL_FRONT"));
    }
    let front = parameters.word("GL_FRONT_FACE", "GL_CCW");
    if !matches!(front, "GL_CCW" | "GL_CW") {
        return Err(refused("GL_FRONT_FACE", format!("is {front}"), "GL_CCW or GL_CW"));
    }
    let reversed = (front == "GL_CW") != (culls && mode == "GL_FRONT");
    let warned = IGNORED.into_iter().filter(|(name, _)| parameters.flag(name));
    let mut warnings: Vec<String> = warned.map(|(name, what)| format!("{what} ({name}) is left out")).collect();
    if color_mask(&parameters) != [true; 3] {
        warnings.push(format!("the colour mask ({COLOR_MASK}) is left out: all channels are drawn"));
    }
    Ok((DrawState { viewport, reversed, double_sided: !culls }, warnings))
}

fn refused(parameter: &str, what: impl Into<String>, expected: &str) -> SceneError {
    SceneError::at(format!("/parameters/{parameter}"), what).expected(expected).cure(LEAVE_OUT)
}

fn check_pipeline(dump: &GlDump) -> Result<(), SceneError> {
    for stage in ["GL_GEOMETRY_SHADER", "GL_TESS_CONTROL_SHADER", "GL_TESS_EVALUATION_SHADER", "GL_VERTEX_PROGRAM_ARB"] {
        if dump.shaders.contains_key(stage) {
            return Err(SceneError::at(format!("/shaders/{stage}"), "the draw call has such a program")
                .expected("the fixed function, or a vertex and a fragment program in GLSL")
                .cure(LEAVE_OUT));
        }
    }
    let parameters = Parameters(dump);
    if parameters.flag("GL_RASTERIZER_DISCARD") {
        return Err(refused("GL_RASTERIZER_DISCARD", "nothing is drawn", "GL_FALSE"));
    }
    let fills = |value: &Value| match value {
        Value::Array(modes) => modes.iter().all(|mode| mode == "GL_FILL"),
        mode => mode == "GL_FILL",
    };
    if parameters.value("GL_POLYGON_MODE").is_some_and(|mode| !fills(mode)) {
        return Err(refused("GL_POLYGON_MODE", "draws lines or points", "GL_FILL"));
    }
    Ok(())
}

fn check_depth(parameters: &Parameters<'_>) -> Result<(), SceneError> {
    if !parameters.flag("GL_DEPTH_TEST") {
        return Err(refused("GL_DEPTH_TEST", "the depth test is off", "a depth test, which the devices always make"));
    }
    let test = parameters.word("GL_DEPTH_FUNC", "GL_LESS");
    if !matches!(test, "GL_LESS" | "GL_LEQUAL") {
        return Err(refused("GL_DEPTH_FUNC", format!("is {test}"), "GL_LESS or GL_LEQUAL"));
    }
    if parameters.value("GL_DEPTH_WRITEMASK").is_some_and(|mask| !is_on(mask)) {
        return Err(refused("GL_DEPTH_WRITEMASK", "depth is not written", "GL_TRUE"));
    }
    let range = parameters.numbers("GL_DEPTH_RANGE").unwrap_or([0.0, 1.0]);
    if range != [0.0, 1.0] {
        return Err(refused("GL_DEPTH_RANGE", format!("is {range:?}"), "0 to 1"));
    }
    for (name, usual) in [("GL_CLIP_ORIGIN", "GL_LOWER_LEFT"), ("GL_CLIP_DEPTH_MODE", "GL_NEGATIVE_ONE_TO_ONE")] {
        let word = parameters.word(name, usual);
        if word != usual {
            return Err(refused(name, format!("is {word}"), usual));
        }
    }
    Ok(())
}

fn viewport(parameters: &Parameters<'_>) -> Result<[u32; 4], SceneError> {
    let place = "/parameters/GL_VIEWPORT";
    let expected = "left, bottom, width and height: whole numbers of pixels within the frame buffer";
    let missing = || SceneError::at(place, "is missing or no list of 4 numbers").expected(expected);
    let numbers: [f64; 4] = parameters.numbers("GL_VIEWPORT").ok_or_else(missing)?;
    let is_whole = numbers.iter().all(|n| (0.0..=65_536.0).contains(n) && n.fract() == 0.0);
    if !is_whole || numbers[2] == 0.0 || numbers[3] == 0.0 {
        return Err(SceneError::at(place, format!("is {numbers:?}")).expected(expected));
    }
    Ok(numbers.map(|n| n as u32))
}

fn check_scissor(parameters: &Parameters<'_>, viewport: [u32; 4]) -> Result<(), SceneError> {
    if !parameters.flag("GL_SCISSOR_TEST") {
        return Ok(());
    }
    let [left, bottom, width, height] = viewport.map(f64::from);
    let holds = |[x, y, w, h]: [f64; 4]| x <= left && y <= bottom && x + w >= left + width && y + h >= bottom + height;
    if parameters.numbers("GL_SCISSOR_BOX").is_some_and(holds) {
        return Ok(());
    }
    Err(refused("GL_SCISSOR_BOX", "cuts the viewport", "no scissor test, or a box around the viewport"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn state(parameters: &str) -> Result<(DrawState, Vec<String>), String> {
        let text = format!(r#"{{"parameters": {{"GL_VIEWPORT": [0, 0, 8, 6], "GL_DEPTH_TEST": "GL_TRUE"{parameters}}}}}"#);
        draw_state(&serde_json::from_str(&text).unwrap()).map_err(|e| e.to_string())
    }

    #[test]
    fn culling_and_front_face_are_read() {
        let faces = |parameters: &str| state(parameters).map(|(state, _)| (state.reversed, state.double_sided)).unwrap();
        assert_eq!(faces(""), (false, true));
        assert_eq!(faces(r#", "GL_CULL_FACE": "GL_TRUE""#), (false, false));
        assert_eq!(faces(r#", "GL_CULL_FACE": true, "GL_CULL_FACE_MODE": "GL_FRONT""#), (true, false));
        assert_eq!(faces(r#", "GL_CULL_FACE": 1, "GL_CULL_FACE_MODE": "GL_FRONT", "GL_FRONT_FACE": "GL_CW""#), (false, false));
    }

    #[test]
    fn state_that_devices_lack_is_refused_by_name() {
        for (parameter, value) in [
            ("GL_DEPTH_TEST", "\"GL_FALSE\""),
            ("GL_DEPTH_FUNC", "\"GL_ALWAYS\""),
            ("GL_DEPTH_WRITEMASK", "\"GL_FALSE\""),
            ("GL_DEPTH_RANGE", "[1, 0]"),
            ("GL_CLIP_ORIGIN", "\"GL_UPPER_LEFT\""),
            ("GL_FRONT_FACE", "\"GL_CWW\""),
            ("GL_POLYGON_MODE", "[\"GL_FILL\", \"GL_LINE\"]"),
            ("GL_RASTERIZER_DISCARD", "\"GL_TRUE\""),
            ("GL_VIEWPORT", "[0, 0, 8]"),
            ("GL_VIEWPORT", "[0, -1, 8, 6]"),
            ("GL_VIEWPORT", "[0, 0, 0, 6]"),
        ] {
            let text = format!(r#"{{"GL_VIEWPORT": [0, 0, 8, 6], "GL_DEPTH_TEST": "GL_TRUE", "{parameter}": {value}}}"#);
            let parameters: crate::dump::GlParameters = serde_json::from_str(&text).unwrap();
            let dump = GlDump { parameters, ..serde_json::from_str("{}").unwrap() };
            let error = draw_state(&dump).unwrap_err().to_string();
            assert!(error.starts_with(&format!("/parameters/{parameter}: ")), "{error}");
        }
        let scissor = r#", "GL_SCISSOR_TEST": "GL_TRUE", "GL_SCISSOR_BOX": [1, 0, 8, 6]"#;
        assert!(state(scissor).unwrap_err().starts_with("/parameters/GL_SCISSOR_BOX"));
        assert!(state(&scissor.replace("[1,", "[0,")).is_ok());
        for mode in ["GL_FRONT_AND_BACK", "GL_SIDE"] {
            let culls = format!(r#", "GL_CULL_FACE": "GL_TRUE", "GL_CULL_FACE_MODE": "{mode}""#);
            assert!(state(&culls).unwrap_err().starts_with("/parameters/GL_CULL_FACE_MODE"));
        }
    }

    #[test]
    fn state_that_is_left_out_is_a_warning() {
        let warnings = |name: &str| state(&format!(r#", "{name}": "GL_TRUE""#)).unwrap().1;
        assert_eq!(warnings("GL_BLEND"), ["blending (GL_BLEND) is left out"]);
        assert_eq!(warnings("GL_DEPTH_CLAMP"), ["the depth clamp (GL_DEPTH_CLAMP) is left out"]);
        assert_eq!(warnings("GL_CLIP_DISTANCE7"), ["user clipping (GL_CLIP_DISTANCE7) is left out"]);
    }

    #[test]
    fn partial_color_mask_is_a_warning() {
        let warnings = |mask: &str| state(&format!(r#", "GL_COLOR_WRITEMASK": {mask}"#)).unwrap().1;
        let left_out = ["the colour mask (GL_COLOR_WRITEMASK) is left out: all channels are drawn"];
        assert_eq!(warnings(r#"["GL_TRUE", "GL_FALSE", "GL_TRUE", "GL_TRUE"]"#), left_out);
        // Devices have no alpha.
        assert_eq!(warnings(r#"["GL_TRUE", "GL_TRUE", "GL_TRUE", "GL_FALSE"]"#), [""; 0]);
    }
}
