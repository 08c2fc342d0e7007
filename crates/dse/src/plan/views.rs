//! Views of a plan, and inputs seen with them.

use super::written::PlanFile;
use crate::{OpenError, OpenedInput, SweepHost};
use basrelief_parameters::TomlFault;
use basrelief_signals::{Frame, Scene};
use basrelief_sim::PreparedScene;
use std::sync::Arc;
use toml::{Table, Value};

/// One view of all inputs of a plan.
pub(super) struct PlanView<'a> {
    /// Options of `[view]`.
    common: &'a Table,
    /// Options of an element of `[[views]]`, with its number; `None` without `[[views]]`.
    own: Option<(usize, &'a Table)>,
}

impl<'a> PlanView<'a> {
    /// Returns the views of a plan; at least one.
    pub(super) fn all(written: &'a PlanFile) -> Result<Vec<Self>, TomlFault> {
        let common = &written.view;
        match written.views.as_deref() {
            None => Ok(vec![Self { common, own: None }]),
            Some([]) => Err(TomlFault::new(&["views"], "views: is empty; expected a view at least, or no `views`")),
            Some(views) => Ok(views.iter().enumerate().map(|own| Self { common, own: Some(own) }).collect()),
        }
    }

    /// Returns the options, as the command line takes them: those of `[[views]]` over those of `[view]`. An element of `[[views]]` draws
    /// one frame unless it states more.
    fn settings(&self) -> Vec<(String, String)> {
        let mut all = self.common.clone();
        if let Some((_, own)) = self.own {
            all.extend(own.clone());
            all.entry("frames").or_insert(Value::Integer(1));
        }
        all.iter().map(|(name, value)| (name.clone(), setting_text(value))).collect()
    }

    /// Returns the error of an option.
    fn fault(&self, option: &str, message: &str) -> TomlFault {
        let in_view = || TomlFault::at(&["view", option], message);
        let Some((number, own)) = self.own else { return in_view() };
        let number = number.to_string();
        match own.contains_key(option) {
            true => TomlFault::at(&["views", &number, option], message),
            false if self.common.contains_key(option) => in_view(),
            // The option is `frames` with its default.
            false => TomlFault::at(&["views", &number], message),
        }
    }
}

/// Opens the input at this path of the plan. The frames of several views follow each other.
pub(super) fn open_seen(
    path: &[String],
    name: &str,
    views: &[PlanView<'_>],
    host: &dyn SweepHost,
) -> Result<OpenedInput, TomlFault> {
    let open = |view: &PlanView<'_>| {
        host.open(name, &view.settings()).map_err(|error| match error {
            OpenError::Input(message) => TomlFault::new(path, format!("input: {message}")),
            OpenError::View { option, message } => view.fault(&option, &message),
        })
    };
    let opened = views.iter().map(open).collect::<Result<Vec<_>, _>>()?;
    match opened.as_slice() {
        [one] => Ok(one.clone()),
        several => joined(several, host).map_err(|(number, error)| {
            let number = number.to_string();
            TomlFault::at(&["views", &number], format!("{name}: {error}"))
        }),
    }
}

/// Returns one scene with the frames of all views. An error has the number of the wrong view.
fn joined(opened: &[OpenedInput], host: &dyn SweepHost) -> Result<OpenedInput, (usize, String)> {
    let scene = |(number, input): (usize, &OpenedInput)| match input {
        OpenedInput::Scene(prepared) => Ok(Arc::clone(prepared.scene())),
        OpenedInput::Trace => Err((number, "is a trace, which has its own view; remove `views`".to_owned())),
    };
    let scenes = opened.iter().enumerate().map(scene).collect::<Result<Vec<_>, _>>()?;
    let size = |scene: &Scene| scene.frames.first().map(|frame| (frame.width, frame.height));
    let sizes: Vec<_> = scenes.iter().filter_map(|scene| size(scene)).collect();
    if let Some(other) = sizes.iter().position(|size| *size != sizes[0]) {
        let ((width, height), (first_width, first_height)) = (sizes[other], sizes[0]);
        let message = format!("has the size {width}x{height}; expected {first_width}x{first_height}, as in the first view");
        return Err((other, message));
    }
    let all = scenes.iter().flat_map(|scene| &scene.frames);
    let frames: Vec<Arc<Frame>> = (0..).zip(all).map(|(index, frame)| Arc::new(Frame { index, ..(**frame).clone() })).collect();
    let joined = Scene { frames, ..(*scenes[0]).clone() };
    Ok(OpenedInput::Scene(PreparedScene::cached(Arc::new(joined), host.budget())))
}

/// A value as the command line takes it.
fn setting_text(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Array(values) => values.iter().map(setting_text).collect::<Vec<_>>().join(","),
        other => other.to_string(),
    }
}
