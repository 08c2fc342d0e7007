//! Files of an earlier run in the folder of a new one.

use super::distinct::PICTURES;
use super::{OF_A_RUN, REPORT};
use basrelief_report::Report;
use basrelief_report::model::Picture;
use basrelief_sim::picture_name;
use std::fs;
use std::path::Path;

/// Returns the names of the files of an earlier run in `folder`: report, tables, recording, and the pictures of the frames that its report
/// lists. They do not belong beside the pictures of a new run. A picture that no report lists may be the user's own.
pub fn earlier_files(folder: &Path) -> Vec<String> {
    let report = fs::read_to_string(folder.join(REPORT)).ok().and_then(|text| Report::from_json(&text).ok());
    let pictures = report.map_or(vec![], |report| pictures_of(&report.image, report.quality.is_some()));
    OF_A_RUN.into_iter().map(str::to_owned).chain(pictures).collect()
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
