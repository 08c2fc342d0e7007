//! The command that repeats a run.

use crate::request::ViewRequest;
use std::fmt::Write;

/// The input, as the command line names it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum InputName {
    Demo(String),
    File(String),
    /// Address of a server.
    From(String),
}

impl InputName {
    pub(crate) fn name(&self) -> &str {
        match self {
            Self::Demo(name) | Self::File(name) | Self::From(name) => name,
        }
    }
}

/// Returns the command line that gives the same report. `machine` is `None` for the input's default machine.
pub(crate) fn command(drawn: &InputName, machine: Option<&str>, view: Option<&ViewRequest>, set: &[(String, String)]) -> String {
    let mut line = match drawn {
        InputName::Demo(name) => format!("basrelief demo {}", quoted(name)),
        InputName::File(name) => format!("basrelief run {}", quoted(name)),
        InputName::From(server) => format!("basrelief run --from {}", quoted(server)),
    };
    if let Some(machine) = machine {
        let _ = write!(line, " --machine {machine}");
    }
    if let Some(view) = view {
        options(&mut line, view);
    }
    for (key, value) in set {
        let _ = write!(line, " --set {}", quoted(&format!("{key}={value}")));
    }
    line
}

fn options(line: &mut String, ViewRequest { size, turn, zoom, light, frames, orbit }: &ViewRequest) {
    if let Some([width, height]) = size {
        let _ = write!(line, " --size {width}x{height}");
    }
    if let Some([around, up]) = turn {
        let _ = write!(line, " --turn {around},{up}");
    }
    if let Some(zoom) = zoom {
        let _ = write!(line, " --zoom {zoom}");
    }
    if let Some([x, y, z]) = light {
        let _ = write!(line, " --light {x},{y},{z}");
    }
    if let Some(frames) = frames {
        let _ = write!(line, " --frames {frames}");
    }
    if let Some(orbit) = orbit {
        let _ = write!(line, " --orbit {orbit}");
    }
}

/// Quotes a word for a shell.
pub(crate) fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "@%+=:,./_-".contains(c);
    if !word.is_empty() && word.chars().all(plain) { word.into() } else { format!("'{}'", word.replace('\'', "'\\''")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn command_lists_non_default_settings() {
        let view = ViewRequest { size: Some([320, 240]), turn: Some([-30.0, 10.5]), ..ViewRequest::default() };
        let set = [("replacement.entries".into(), "[256, 64]".into())];
        let line = command(&InputName::Demo("coin".into()), Some("shade"), Some(&view), &set);
        let expected = "basrelief demo coin --machine shade --size 320x240 --turn -30,10.5 --set 'replacement.entries=[256, 64]'";
        assert_eq!(line, expected);
        let line = command(&InputName::From("http://127.0.0.1:8080/".into()), None, Some(&view), &[]);
        assert_eq!(line, "basrelief run --from http://127.0.0.1:8080/ --size 320x240 --turn -30,10.5");
    }

    #[test]
    fn names_are_quoted_for_a_shell() {
        let line = |name: &str| command(&InputName::File(name.into()), None, None, &[]);
        assert_eq!(line("a/b.glb"), "basrelief run a/b.glb");
        assert_eq!(line("it's; rm"), "basrelief run 'it'\\''s; rm'");
    }
}
