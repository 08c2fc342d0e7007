//! Files of an earlier run in the folder of a new one.

use super::distinct::PICTURES;
use super::{OF_A_RUN, REPORT};
use basrelief_report::Report;
use basrelief_report::model::Picture;
use basrelief_sim::{AuxForm, AuxOutputInfo, COST_PICTURES, MACHINES, aux_outputs, picture_name};
use std::fs;
use std::path::Path;

/// Returns the names of the files of an earlier run in `folder`: report, tables, recording, the pictures of the frames that its report
/// lists, and its auxiliary pictures. They do not belong beside the pictures of a new run. Other pictures may be the user's own.
pub fn earlier_files(folder: &Path) -> Vec<String> {
    let report = fs::read_to_string(folder.join(REPORT)).ok().and_then(|text| Report::from_json(&text).ok());
    let pictures = report.map_or(vec![], |report| {
        let mut pictures = pictures_of(&report.image, report.quality.is_some());
        pictures.extend(auxiliary_pictures(folder, &auxiliary_outputs(&report.machine, report.costs.is_some())));
        pictures
    });
    OF_A_RUN.into_iter().map(str::to_owned).chain(pictures).collect()
}

/// Returns the auxiliary pictures that a run on this machine may have written.
fn auxiliary_outputs(machine: &str, has_costs: bool) -> Vec<AuxOutputInfo> {
    let of_machine = MACHINES.iter().filter(|known| known.name == machine).flat_map(aux_outputs);
    let costs = COST_PICTURES.into_iter().filter(|_| has_costs);
    of_machine.filter(|output| output.form != AuxForm::Lines).chain(costs).collect()
}

/// Returns the names of the files in `folder` that are named as pictures of these outputs.
fn auxiliary_pictures(folder: &Path, outputs: &[AuxOutputInfo]) -> Vec<String> {
    let names = fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.file_name());
    let names = names.filter_map(|name| name.into_string().ok());
    names.filter(|name| outputs.iter().any(|output| is_picture_of(output, name))).collect()
}

/// True if a file is named as a picture of this output. The name may have the number of a frame, and that of a round.
fn is_picture_of(output: &AuxOutputInfo, file: &str) -> bool {
    let Some(rest) = file.strip_suffix(".png").and_then(|stem| stem.strip_prefix(output.name)) else { return false };
    let is_number = |text: &str| !text.is_empty() && text.bytes().all(|digit| digit.is_ascii_digit());
    let (frame, round) = rest.split_once("-round-").map_or((rest, None), |(frame, round)| (frame, Some(round)));
    let has_round = (output.form == AuxForm::PicturePerRound) == round.is_some() && round.is_none_or(is_number);
    has_round && (frame.is_empty() || frame.strip_prefix('-').is_some_and(is_number))
}

/// Returns the names of the pictures of frames whose images a report lists. A listed file with another name is not of a run. A run without
/// reference images writes one picture of a frame.
fn pictures_of(images: &[Picture], has_references: bool) -> Vec<String> {
    let kinds = if has_references { &PICTURES[..] } else { &PICTURES[..1] };
    let name = |kind, index| picture_name(kind, index, images.len() > 1);
    let drawn = (0..images.len()).filter(|index| images[*index].file == name(PICTURES[0], *index));
    drawn.flat_map(|index| kinds.iter().map(move |kind| name(kind, index))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn auxiliary_pictures_are_those_of_the_machine() {
        let outputs = auxiliary_outputs("defer", true);
        let is_listed = |file: &str| outputs.iter().any(|output| is_picture_of(output, file));
        for picture in ["cost.png", "layer-depth.png", "layer-depth-0002.png", "image-round-0.png", "image-0002-round-11.png"] {
            assert!(is_listed(picture), "{picture}");
        }
        for other in
            ["image.png", "image-0002.png", "image-round-.png", "cost-x.png", "costs.png", "cost-round-1.png", "cost", "wall.png"]
        {
            assert!(!is_listed(other), "{other}");
        }
        assert!(auxiliary_outputs("bump", false).is_empty());
    }

    #[test]
    fn only_pictures_of_runs_are_listed() {
        let list = |files: &[&str], has_references| {
            let images: Vec<_> = files.iter().map(|file| Picture { file: (*file).into(), sha256: String::new() }).collect();
            pictures_of(&images, has_references)
        };
        assert_eq!(list(&["image.png"], true), ["image.png", "reference.png", "difference.png"]);
        assert_eq!(list(&["image-0001.png", "image-0002.png"], false), ["image-0001.png", "image-0002.png"]);
        for other in ["image", "image-.png", "image-round-0.png", "image-1/../../x.png", "imagery.png", "own.png", "../image.png"]
        {
            assert_eq!(list(&[other], true), [""; 0], "{other}");
        }
    }
}
