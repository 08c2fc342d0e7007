//! What each short cut of a machine saves, and what it costs: the same input with each switched off in turn.

use crate::observer::{Observer, Pictures};
use crate::outcome::{Run, SessionError};
use crate::settings::{RunOptions, When};
use basrelief_input::Held;
use basrelief_kernel::Outcome;
use basrelief_report::Report;
use basrelief_report::ablation::{Ablation, Variant};

/// Runs the machine as configured, without each of its short cuts in turn, and without any. `run` makes one run to its end,
/// of the same input under the settings it is given, watched by the observer it is given; that one passes only the progress on
/// to `observer`. The options are without the exact picture.
///
/// # Errors
/// A machine without short cuts, a run that does not complete or has no time, whatever `run` says.
pub fn ablate<E: From<SessionError>>(
    settings: &RunOptions,
    observer: &mut dyn Observer,
    mut run: impl FnMut(&RunOptions, &mut dyn Observer) -> Result<Run, E>,
) -> Result<Ablation, E> {
    let no_short_cuts = || SessionError::NoShortCuts(settings.config.machine().name);
    let mut beside = Beside { observer, kept: Vec::new(), held: settings.budget.nothing(), first: true, largest: 0 };
    let mut ablation: Option<Ablation> = None;
    for (variant, config) in settings.config.ablations() {
        let settings = RunOptions { config, exact: false, limits: When::Never, tape: When::Never, ..settings.clone() };
        let report = complete(&variant, run(&settings, &mut beside)?)?;
        let ablation = ablation.get_or_insert_with(|| Ablation::of(&report));
        ablation.variants.push(Variant::of(variant, &report, ablation.variants.first(), beside.largest));
        (beside.first, beside.largest) = (false, 0);
    }
    ablation.ok_or_else(|| no_short_cuts().into())
}

/// The report of a run that came to its end, with time.
pub(crate) fn complete(variant: &str, run: Run) -> Result<Report, SessionError> {
    let why = match run.timing.as_ref().map(|t| &t.outcome) {
        Some(Outcome::Complete) => return Ok(run.report),
        Some(Outcome::Limit) => "stopped at the limit of cycles",
        Some(_) => run.report.outcome.message.as_deref().unwrap_or("stopped"),
        None => "has no cycles that could be compared",
    };
    Err(SessionError::Incomplete(format!("`{variant}`: {why}")))
}

/// Keeps the pictures of the first run, and holds those of the others against them.
struct Beside<'a> {
    observer: &'a mut dyn Observer,
    kept: Vec<Vec<[u8; 3]>>,
    held: Held,
    first: bool,
    largest: u8,
}

impl Observer for Beside<'_> {
    fn progress(&mut self, commands: u64, total: Option<u64>) -> bool {
        self.observer.progress(commands, total)
    }

    fn frame(&mut self, pictures: &Pictures<'_>) -> Result<(), String> {
        let rgb = &pictures.machine.rgb;
        if self.first {
            let held = self.held.grow(size_of_val(rgb.as_slice()) as u64, "the pictures of the first run of an ablation");
            held.map_err(|error| format!("{error}, or take fewer frames or a smaller picture"))?;
            self.kept.push(rgb.clone());
            return Ok(());
        }
        let kept = self.kept.get(pictures.index).ok_or("there are more pictures than in the first run")?;
        let steps = kept.as_flattened().iter().zip(rgb.as_flattened()).map(|(a, b)| a.abs_diff(*b));
        self.largest = steps.max().unwrap_or(0).max(self.largest);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observer::Unobserved;
    use basrelief_input::Budget;
    use basrelief_reference::Picture;

    fn picture(grey: u8) -> Picture {
        let mut picture = Picture::new(2, 1);
        picture.rgb = vec![[7; 3], [7, grey, 7]];
        picture
    }

    fn show(beside: &mut Beside<'_>, index: usize, machine: &Picture) -> Result<(), String> {
        beside.frame(&Pictures { index, machine, exact: None })
    }

    #[test]
    fn the_largest_change_of_any_picture_counts() {
        let held = Budget::default().nothing();
        let mut beside = Beside { observer: &mut Unobserved, kept: vec![], held, first: true, largest: 0 };
        show(&mut beside, 0, &picture(100)).unwrap();
        show(&mut beside, 1, &picture(50)).unwrap();
        beside.first = false;
        show(&mut beside, 0, &picture(91)).unwrap();
        show(&mut beside, 1, &picture(52)).unwrap();
        assert_eq!(beside.largest, 9);
        assert!(show(&mut beside, 2, &picture(0)).unwrap_err().contains("more pictures"));
    }

    #[test]
    fn pictures_beyond_the_limit_are_an_error_that_says_what_to_do() {
        let held = Budget::new(6).nothing();
        let mut beside = Beside { observer: &mut Unobserved, kept: vec![], held, first: true, largest: 0 };
        show(&mut beside, 0, &picture(0)).unwrap();
        assert!(show(&mut beside, 1, &picture(0)).unwrap_err().contains("take fewer frames"));
    }
}
