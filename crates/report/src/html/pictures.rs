//! Pictures of the last frame.

use super::head::data_url;
use super::markup::{Html, el, el_text, sentence, text};
use crate::model::Report;

/// A picture on the page.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PagePicture {
    /// Meaning.
    pub caption: String,
    /// The file.
    pub png: Vec<u8>,
    /// For a difference picture: the value of full brightness \[steps of 1/255\].
    pub largest: Option<u8>,
}

/// Narrower pictures show their pixels instead of blurring them.
const SMALL: u32 = 480;

pub(super) fn pictures(report: &Report, pictures: &[PagePicture]) -> Html {
    if pictures.is_empty() {
        return Html::default();
    }
    let class = if report.size.width < SMALL { "pictures small" } else { "pictures" };
    el("div", &[("class", class)], pictures.iter().map(|picture| figure(report, picture)))
}

fn figure(report: &Report, picture: &PagePicture) -> Html {
    let (width, height) = (report.size.width.to_string(), report.size.height.to_string());
    let source = data_url("image/png", &picture.png);
    let caption = picture.caption.clone() + &report.last_frame_suffix();
    let attributes = [("src", source.as_str()), ("alt", &caption), ("width", &width), ("height", &height)];
    let scale = picture.largest.map_or(Html::default(), scale);
    el("figure", &[], [el("img", &attributes, []), el("figcaption", &[], [text(&caption), scale])])
}

/// Returns the colour scale from zero to the largest difference.
fn scale(largest: u8) -> Html {
    let says = format!(
        "scaled to the largest difference in this image; `difference.png` of a run is amplified eight times instead. \
         Black is 0, full red, green or blue is {largest} of 255 steps."
    );
    let ends = [el_text("span", "", "0"), el("span", &[("class", "ramp")], []), el_text("span", "", largest.to_string())];
    [el("span", &[("class", "says")], [sentence(&says)]), el("span", &[("class", "scale"), ("aria-hidden", "true")], ends)]
        .into_iter()
        .collect()
}
