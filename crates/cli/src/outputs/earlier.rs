//! Files of an earlier run in the folder of a new one.

use super::{OF_A_RUN, REPORT};
use basrelief_report::Report;
use std::fs;
use std::path::Path;

/// Pictures of a frame. A run without an exact picture writes only the first.
const PICTURES: [&str; 3] = ["image", "reference", "difference"];

/// Returns the names of the files of an earlier run in `folder` that do not belong beside the pictures of a new run: report, tables,
/// recording, and the pictures of the frames that the report lists. A picture that no report lists may be the user's own.
pub fn earlier_files(folder: &Path) -> Vec<String> {
    let report = fs::read_to_string(folder.join(REPORT)).ok().and_then(|text| Report::from_json(&text).ok());
    let kinds = if report.as_ref().is_some_and(|report| report.quality.is_some()) { &PICTURES[..] } else { &PICTURES[..1] };
    let endings = report.iter().flat_map(|report| &report.image).filter_map(|picture| ending(&picture.file));
    let pictures = endings.flat_map(|ending| kinds.iter().map(move |kind| format!("{kind}{ending}")));
    OF_A_RUN.into_iter().map(str::to_owned).chain(pictures).collect()
}

/// Returns what follows the kind in the name of a picture: `.png` or `-0001.png`. Other names are not of a run.
fn ending(file: &str) -> Option<&str> {
    let ending = file.strip_prefix(PICTURES[0])?;
    let number = ending.strip_suffix(".png")?;
    let is_number = |number: &str| !number.is_empty() && number.bytes().all(|c| c.is_ascii_digit());
    (number.is_empty() || number.strip_prefix('-').is_some_and(is_number)).then_some(ending)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_pictures_have_an_ending() {
        assert_eq!(["image.png", "image-0012.png"].map(ending), [Some(".png"), Some("-0012.png")]);
        for other in ["image", "image-.png", "image-round-0.png", "image-1/../../x.png", "imagery.png", "own.png", "../image.png"]
        {
            assert_eq!(ending(other), None, "{other}");
        }
    }
}
