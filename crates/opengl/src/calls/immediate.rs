//! Calls of the fixed function that a display list can hold: vertices one by one, and the current values of their attributes.

use super::line::TraceCall;
use super::mesh::ArrayMesh;

/// An attribute with a current value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum VertexPart {
    Position,
    Normal,
    Color,
    Uv,
}

/// A call of the fixed function.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum FixedCall {
    Begin(Box<str>),
    End,
    /// Sets a current value. Setting a position draws a vertex.
    Set(VertexPart, [f32; 4]),
    ShadeModel {
        flat: bool,
    },
    /// Draws the primitives of a display list.
    List(u64),
    /// A draw call from arrays, which a display list copies.
    Arrays(Box<ArrayMesh>),
    /// Changes state that a dump has.
    State(Box<str>),
    /// Moves or draws parts of a display list in a way that is not followed.
    Refused(Box<str>),
}

/// Prefixes of calls that move the parts of a display list.
const MOVES: [&str; 13] = [
    "glTranslate",
    "glRotate",
    "glScale",
    "glMultMatrix",
    "glMultTransposeMatrix",
    "glLoadIdentity",
    "glLoadMatrix",
    "glLoadTransposeMatrix",
    "glPushMatrix",
    "glPopMatrix",
    "glFrustum",
    "glOrtho",
    "glViewport",
];

/// Prefixes of calls that draw, or set attributes, in a way that is not followed.
const DRAWS: [&str; 7] =
    ["glRect", "glEvalMesh", "glEvalCoord", "glEvalPoint", "glArrayElement", "glCallLists", "glVertexAttrib"];

/// Prefixes of calls that change the look of a part of a display list.
const STATES: [&str; 17] = [
    "glMaterial",
    "glColorMaterial",
    "glBindTexture",
    "glEnable",
    "glDisable",
    "glLight",
    "glPushAttrib",
    "glPopAttrib",
    "glTexEnv",
    "glTexGen",
    "glTexParameter",
    "glActiveTexture",
    "glFrontFace",
    "glCullFace",
    "glPolygonMode",
    "glDepth",
    "glUseProgram",
];

impl FixedCall {
    /// Returns the call of a trace; `None` if it is no call of the fixed function.
    pub fn parse(call: &TraceCall<'_>) -> Option<Self> {
        let starts = |prefixes: &[&str]| prefixes.iter().any(|prefix| call.name.starts_with(prefix));
        let is_client =
            ["Pointer", "ClientState", "VertexAttribArray", "VertexAttribDivisor"].iter().any(|word| call.name.contains(word));
        match call.name {
            "glBegin" => Some(Self::Begin(call.text("mode").unwrap_or_default().into())),
            "glEnd" => Some(Self::End),
            "glShadeModel" => Some(Self::ShadeModel { flat: call.text("mode") == Some("GL_FLAT") }),
            "glCallList" => Some(Self::List(call.list())),
            _ if is_client => None,
            _ if starts(&MOVES) || starts(&DRAWS) => Some(Self::Refused(call.name.into())),
            _ => attribute(call).or_else(|| starts(&STATES).then(|| Self::State(call.name.into()))),
        }
    }
}

/// Returns a call such as `glNormal3f`: an attribute, the number of its components, their type, and `v` for a list.
fn attribute(call: &TraceCall<'_>) -> Option<FixedCall> {
    let name = call.name.strip_prefix("gl")?;
    let at = name.find(|c: char| c.is_ascii_digit())?;
    let (part, rest) = name.split_at(at);
    let kind = rest.get(1..)?.trim_end_matches("ARB").trim_end_matches('v');
    let (part, mut value, is_normalized) = match part {
        "Vertex" => (VertexPart::Position, [0.0, 0.0, 0.0, 1.0], false),
        "Normal" => (VertexPart::Normal, [0.0; 4], true),
        "Color" => (VertexPart::Color, [1.0; 4], true),
        "TexCoord" => (VertexPart::Uv, [0.0, 0.0, 0.0, 1.0], false),
        "MultiTexCoord" if call.text("target") == Some("GL_TEXTURE0") => (VertexPart::Uv, [0.0, 0.0, 0.0, 1.0], false),
        _ => return None,
    };
    let largest = match kind {
        "b" => 127.0,
        "ub" => 255.0,
        "s" => 32_767.0,
        "us" => 65_535.0,
        "i" => 2_147_483_647.0,
        "ui" => 4_294_967_295.0,
        _ => 1.0,
    };
    let divisor = if is_normalized { largest } else { 1.0 };
    value.iter_mut().zip(call.all_numbers()).for_each(|(to, from)| *to = (from / divisor) as f32);
    Some(FixedCall::Set(part, value))
}
