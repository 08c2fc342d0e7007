//! Cost maps: pictures of the costs of each pixel.

use super::aux_output::{AuxContent, AuxForm, AuxOutput, AuxOutputInfo};
use super::heat_map::{ColourRamp, ColourScale, HEAT, heat_map, heat_maps};
use crate::analysis::costs::{CostKind, RunCosts};
use crate::observer::Observer;
use basrelief_reference::RgbPicture;

/// Cost maps. They are made at the end of a run and sum all frames.
pub const COST_PICTURES: [AuxOutputInfo; 5] = [
    picture("cost", "cycles per pixel of all units, busy and waiting"),
    picture("wait", "waiting cycles per pixel, coloured by the main cause"),
    picture("overdraw", "fragments per pixel"),
    picture("level", "MIP level per pixel (machines with MIP levels)"),
    picture("entry", "table entry per pixel (machines with reference normals)"),
];

const fn picture(name: &'static str, about: &'static str) -> AuxOutputInfo {
    AuxOutputInfo { name, about, form: AuxForm::PictureAtEnd, judges: false }
}

/// Quantile of the pixels at which a scale of cycles ends. Outliers, such as the first pixel of a polygon or pixels that wait for a cold
/// cache, would make all other pixels dark.
const WITHIN: f64 = 0.95;

/// Colours of waits: violet for memory, blue for tokens, green for slots.
const WAITS: [(CostKind, &str, ColourRamp); 3] = [
    (CostKind::Memory, "for memory", HEAT),
    (
        CostKind::Starved,
        "for a token",
        [[6, 14, 32], [10, 36, 84], [16, 66, 140], [30, 104, 190], [70, 150, 226], [134, 196, 246], [214, 238, 255]],
    ),
    (
        CostKind::Blocked,
        "for a slot",
        [[4, 22, 12], [8, 54, 28], [14, 92, 46], [30, 134, 64], [80, 176, 92], [146, 214, 136], [222, 248, 204]],
    ),
];

/// Passes all cost maps to the observer.
///
/// # Errors
/// Errors of the observer.
pub(crate) fn send_maps(costs: &RunCosts, observer: &mut dyn Observer) -> Result<(), String> {
    if costs.size().contains(&0) {
        return Ok(());
    }
    let make: [fn(&RunCosts, &str) -> Option<RgbPicture>; 5] = [cost, main_wait, overdraw, level, entry];
    let frames = if costs.frames > 1 { format!(", sum of {} frames", costs.frames) } else { String::new() };
    for (info, make) in COST_PICTURES.into_iter().zip(make) {
        if let Some(picture) = make(costs, &frames) {
            let content = AuxContent::NamedPicture(format!("{}.png", info.name), &picture);
            observer.aux_output(&AuxOutput { info, frame: 0, content })?;
        }
    }
    Ok(())
}

fn cost(costs: &RunCosts, frames: &str) -> Option<RgbPicture> {
    let values = costs.cycles_by_pixel(None);
    let (top, and_more) = scale_top(&values);
    let title = format!("cycles per pixel of all units, busy and waiting{frames}");
    Some(heat_map(costs.size()[0], &values, &ColourScale { and_more, ..ColourScale::new(&title, top) }))
}

fn main_wait(costs: &RunCosts, frames: &str) -> Option<RgbPicture> {
    let by_kind = WAITS.map(|(kind, ..)| costs.cycles_by_pixel(Some(kind)));
    let place = |place: usize| by_kind.each_ref().map(|values| values[place]);
    let values: Vec<f32> = (0..by_kind[0].len()).map(|at| place(at).iter().sum()).collect();
    let (top, and_more) = scale_top(&values);
    let titles = WAITS.map(|(_, name, _)| format!("waiting cycles per pixel of all units, most of them {name}{frames}"));
    let scales = [0, 1, 2].map(|i| ColourScale { and_more, colors: &WAITS[i].2, ..ColourScale::new(&titles[i], top) });
    Some(heat_maps(costs.size()[0], &values, |at| index_of_largest(place(at)), &scales))
}

/// Returns the index of the largest value, the first one of ties.
fn index_of_largest(values: [f32; 3]) -> usize {
    (0..values.len()).fold(0, |best, i| if values[i] > values[best] { i } else { best })
}

fn overdraw(costs: &RunCosts, frames: &str) -> Option<RgbPicture> {
    whole_run_map(costs, &costs.overdraw(), &format!("fragments per pixel, including hidden ones{frames}"))
}

/// Returns `None` if all pixels have the finest level, because levels are then absent or unused.
fn level(costs: &RunCosts, _: &str) -> Option<RgbPicture> {
    let levels = costs.levels();
    levels.iter().any(|level| *level > 0.0).then(|| whole_run_map(costs, &levels, "MIP level, 0 is the finest"))?
}

fn entry(costs: &RunCosts, _: &str) -> Option<RgbPicture> {
    whole_run_map(costs, &costs.entries(), "entry of the table of reference normals of its level")
}

/// Draws whole numbers, with a scale from 0 to the largest. Returns `None` if no pixel has a value.
fn whole_run_map(costs: &RunCosts, values: &[f32], title: &str) -> Option<RgbPicture> {
    let most = values.iter().copied().filter(|value| !value.is_nan()).max_by(f32::total_cmp)?;
    let top = f64::from(most).max(1.0);
    let marks: Vec<f64> = if top <= 16.0 { (1..top as u32).map(f64::from).collect() } else { vec![(top / 2.0).floor()] };
    Some(heat_map(costs.size()[0], values, &ColourScale { marks: &marks, ..ColourScale::new(title, top) }))
}

/// Returns the end of a scale of cycles, and whether pixels exceed it.
fn scale_top(values: &[f32]) -> (f64, bool) {
    let mut sorted: Vec<f32> = values.iter().copied().filter(|value| !value.is_nan()).collect();
    sorted.sort_by(f32::total_cmp);
    let at = |share: f64| sorted.get(((sorted.len() as f64 * share) as usize).min(sorted.len().saturating_sub(1)));
    let [within, most] = [WITHIN, 1.0].map(|share| f64::from(at(share).copied().unwrap_or_default()));
    let top = within.ceil().max(1.0);
    (top, most > top)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scale_of_cycles_holds_most_pixels_and_marks_outliers() {
        let mut values = vec![3.0; 96];
        assert_eq!(scale_top(&values), (3.0, false));
        values.extend([f32::NAN; 50]);
        values.extend([2000.5; 4]);
        assert_eq!(scale_top(&values), (3.0, true), "background does not count");
        values.extend([7.2; 4]);
        assert_eq!(scale_top(&values), (8.0, true));
        assert_eq!(scale_top(&[]), (1.0, false));
    }

    #[test]
    fn pixel_has_colour_of_main_wait() {
        assert_eq!([[0.0, 0.0, 0.0], [1.0, 1.0, 0.5], [1.0, 2.0, 2.0], [0.0, 1.0, 4.0]].map(index_of_largest), [0, 0, 1, 2]);
    }
}
