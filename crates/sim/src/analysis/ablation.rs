//! Ablation: runs the same input with each short cut of the machine disabled in turn.

use crate::observer::{FramePictures, Observer};
use crate::options::{AnalysisPolicy, RunOptions};
use crate::run::result::{RunError, RunResult};
use basrelief_input::MemoryReservation;
use basrelief_kernel::Outcome;
use basrelief_machines::{MACHINES, MachineInfo};
use basrelief_report::Report;
use basrelief_report::ablation::{Ablation, AblationVariant};

/// Runs the machine as configured, without each short cut in turn, and without all short cuts. `run` performs one run of the same input
/// with the given options and observer, without the reference image. That observer forwards only the progress to `observer`.
///
/// # Errors
/// A machine without short cuts, a run without time, a run that does not finish, and all errors of `run`.
pub fn ablate<E: From<RunError>>(
    settings: &RunOptions,
    observer: &mut dyn Observer,
    mut run: impl FnMut(&RunOptions, &mut dyn Observer) -> Result<RunResult, E>,
) -> Result<Ablation, E> {
    let no_shortcuts = || RunError::NoShortcuts(settings.config.machine().name, machine_names(|machine| machine.has_shortcuts));
    let mut comparison =
        PictureComparison { observer, kept: Vec::new(), held: settings.budget.empty_reservation(), first: true, largest: 0 };
    let mut ablation: Option<Ablation> = None;
    for (variant, config) in settings.config.ablations() {
        let settings = RunOptions {
            config,
            exact: false,
            bottlenecks: AnalysisPolicy::Never,
            recording: AnalysisPolicy::Never,
            ..settings.clone()
        };
        let report = complete(&variant, run(&settings, &mut comparison)?)?;
        let ablation = ablation.get_or_insert_with(|| Ablation::of(&report));
        ablation.variants.push(AblationVariant::of(variant, &report, ablation.variants.first(), comparison.largest));
        (comparison.first, comparison.largest) = (false, 0);
    }
    ablation.ok_or_else(|| no_shortcuts().into())
}

/// Returns the names of the machines that an analysis supports, for a message.
pub(crate) fn machine_names(has: impl Fn(&MachineInfo) -> bool) -> String {
    let names: Vec<&str> = MACHINES.iter().filter(|machine| has(machine)).map(|machine| machine.name).collect();
    names.join(" or ")
}

/// Returns the report of a run that finished and has time.
pub(crate) fn complete(variant: &str, run: RunResult) -> Result<Report, RunError> {
    let why = match run.timing.as_ref().map(|t| &t.outcome) {
        Some(Outcome::Complete) => return Ok(run.report),
        Some(Outcome::Limit) => "reached the cycle limit",
        Some(_) => run.report.outcome.message.as_deref().unwrap_or("stopped"),
        None => "has no cycles to compare",
    };
    Err(RunError::Incomplete(format!("`{variant}`: {why}")))
}

/// Observer that keeps the pictures of the first run, and compares those of later runs with them.
struct PictureComparison<'a> {
    observer: &'a mut dyn Observer,
    kept: Vec<Vec<[u8; 3]>>,
    held: MemoryReservation,
    first: bool,
    largest: u8,
}

impl Observer for PictureComparison<'_> {
    fn progress(&mut self, commands: u64, total: Option<u64>) -> bool {
        self.observer.progress(commands, total)
    }

    fn frame(&mut self, pictures: &FramePictures<'_>) -> Result<(), String> {
        let rgb = &pictures.machine.rgb;
        if self.first {
            let held = self.held.try_grow(size_of_val(rgb.as_slice()) as u64, "the images of the first run of an ablation");
            held.map_err(|error| format!("{error}, or reduce the number of frames or the image size"))?;
            self.kept.push(rgb.clone());
            return Ok(());
        }
        let kept = self.kept.get(pictures.index).ok_or("the run has more images than the first run")?;
        let steps = kept.as_flattened().iter().zip(rgb.as_flattened()).map(|(a, b)| a.abs_diff(*b));
        self.largest = steps.max().unwrap_or(0).max(self.largest);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observer::NoObserver;
    use basrelief_input::MemoryPool;
    use basrelief_reference::RgbPicture;

    fn picture(grey: u8) -> RgbPicture {
        let mut picture = RgbPicture::new(2, 1);
        picture.rgb = vec![[7; 3], [7, grey, 7]];
        picture
    }

    fn show(comparison: &mut PictureComparison<'_>, index: usize, machine: &RgbPicture) -> Result<(), String> {
        comparison.frame(&FramePictures { index, machine, exact: None })
    }

    #[test]
    fn largest_change_of_any_picture_counts() {
        let held = MemoryPool::default().empty_reservation();
        let mut comparison = PictureComparison { observer: &mut NoObserver, kept: vec![], held, first: true, largest: 0 };
        show(&mut comparison, 0, &picture(100)).unwrap();
        show(&mut comparison, 1, &picture(50)).unwrap();
        comparison.first = false;
        show(&mut comparison, 0, &picture(91)).unwrap();
        show(&mut comparison, 1, &picture(52)).unwrap();
        assert_eq!(comparison.largest, 9);
        assert!(show(&mut comparison, 2, &picture(0)).unwrap_err().contains("more images"));
    }

    #[test]
    fn pictures_beyond_memory_limit_are_an_error_with_a_hint() {
        let held = MemoryPool::new(6).empty_reservation();
        let mut comparison = PictureComparison { observer: &mut NoObserver, kept: vec![], held, first: true, largest: 0 };
        show(&mut comparison, 0, &picture(0)).unwrap();
        assert!(show(&mut comparison, 1, &picture(0)).unwrap_err().contains("reduce the number of frames"));
    }
}
