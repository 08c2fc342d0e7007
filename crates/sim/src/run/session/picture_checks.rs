//! Warnings about finished images that show nothing, or surfaces from behind.

use basrelief_machines::UnitStats;
use basrelief_reference::{RenderStyle, RgbPicture, ShadingModel};

/// Findings in the images of a run.
#[derive(Debug, Default)]
pub(super) struct PictureChecks {
    images: usize,
    /// True if there are reference images.
    is_compared: bool,
    /// Frames whose image is empty.
    empty: Vec<usize>,
    /// Largest share of drawn pixels that show surfaces from behind, rounded down \[%\]. Closed models show a few through gaps.
    behind_percent: usize,
}

impl PictureChecks {
    /// Checks the image of a frame. `exact`: its reference image.
    pub(super) fn add(&mut self, frame: usize, image: &RgbPicture, exact: Option<&RgbPicture>) {
        self.images += 1;
        self.is_compared |= exact.is_some();
        let (of_exact, backs) = exact.map_or((0, 0), |exact| (drawn(exact), exact.backs));
        // A user may leave a view before the machine has drawn anything of it.
        if of_exact == 0 && drawn(image) == 0 {
            self.empty.push(frame);
        }
        self.behind_percent = self.behind_percent.max((100 * backs).checked_div(of_exact).unwrap_or(0));
    }

    /// Returns the warnings. `of_scene`: the reference images are drawn from a scene.
    pub(super) fn warnings(&self, facts: &UnitStats, style: RenderStyle, of_scene: bool) -> Vec<String> {
        let is_lit = style.shading != ShadingModel::Texture && !style.options.two_sided_lighting;
        let behind = (of_scene && is_lit && self.behind_percent > 0).then(|| self.behind());
        self.nothing(facts).into_iter().chain(behind).collect()
    }

    fn behind(&self) -> String {
        let (up_to, of) = if self.images > 1 { ("up to ", " of an image") } else { ("", "") };
        format!(
            "{up_to}{} % of the drawn pixels{of} show surfaces from behind, lit with the normals of their fronts; set \
             geometry.two_sided_lighting = true to light both sides",
            self.behind_percent
        )
    }

    fn nothing(&self, facts: &UnitStats) -> Option<String> {
        let (empty, images) = (self.empty.len(), self.images);
        let first = self.empty.first()?;
        let which = if empty < images {
            format!("{empty} of {images} images are empty, the first in frame {first}: no triangle covers a pixel there")
        } else {
            let all = if images > 1 { format!("all {images} images are empty") } else { "the image is empty".to_owned() };
            format!("{all}: no triangle covers a pixel{}; choose another view", causes(facts))
        };
        let quality = if self.is_compared { ". Quality figures of empty images are those of identical images" } else { "" };
        Some(which + quality)
    }
}

/// Number of drawn pixels.
fn drawn(picture: &RgbPicture) -> usize {
    picture.covered.iter().filter(|covered| **covered).count()
}

/// Returns the numbers of triangles by the reason why they are not drawn. Traces have polygons instead.
fn causes(facts: &UnitStats) -> String {
    let of = |name, reason| (facts.count(name), reason);
    let dropped = [
        of("triangles_outside", "outside the view"),
        of("triangles_culled", "seen from behind, with a single-sided material"),
        of("triangles_degenerate", "without area"),
    ];
    let passed = facts.count("triangles") - dropped.iter().map(|(count, _)| count).sum::<u64>();
    let all = dropped.into_iter().chain([(passed, "between pixel centres")]).filter(|(count, _)| *count > 0);
    let all: Vec<String> = all.map(|(count, reason)| format!("{count} {reason}")).collect();
    if all.is_empty() { String::new() } else { format!(" (triangles: {})", all.join("; ")) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use basrelief_reference::RenderOptions;

    fn image(covered: usize, backs: usize) -> RgbPicture {
        let mut image = RgbPicture { backs, ..RgbPicture::new(10, 10) };
        image.covered[..covered].fill(true);
        image
    }

    fn warnings(images: &[[usize; 2]], two_sided_lighting: bool) -> Vec<String> {
        let mut checks = PictureChecks::default();
        for (frame, [covered, backs]) in images.iter().enumerate() {
            checks.add(frame, &image(*covered, 0), Some(&image(*covered, *backs)));
        }
        let mut facts = UnitStats::default();
        for (name, count) in [("triangles", 9), ("triangles_outside", 2), ("triangles_culled", 4)] {
            facts.figure(name, count, "triangles", "");
        }
        let options = RenderOptions { two_sided_lighting, ..RenderOptions::default() };
        checks.warnings(&facts, options.into(), true)
    }

    #[test]
    fn empty_images_are_named_with_their_causes() {
        let causes = "2 outside the view; 4 seen from behind, with a single-sided material; 3 between pixel centres";
        let quality = "Quality figures of empty images are those of identical images";
        let one = format!("the image is empty: no triangle covers a pixel (triangles: {causes}); choose another view. {quality}");
        assert_eq!(warnings(&[[0, 0]], false), [one]);
        let some = format!("2 of 3 images are empty, the first in frame 1: no triangle covers a pixel there. {quality}");
        assert_eq!(warnings(&[[5, 0], [0, 0], [0, 0]], false), [some]);
        assert!(warnings(&[[0, 0], [0, 0]], false)[0].starts_with("all 2 images are empty: "));
        assert_eq!(warnings(&[[1, 0]], false), [""; 0]);
    }

    #[test]
    fn image_without_reference_has_no_quality() {
        let mut checks = PictureChecks::default();
        checks.add(0, &image(0, 0), None);
        let [warning] = &checks.warnings(&UnitStats::default(), RenderOptions::default().into(), true)[..] else {
            panic!("one warning is expected")
        };
        assert_eq!(warning, "the image is empty: no triangle covers a pixel; choose another view");
    }

    #[test]
    fn visible_backs_are_named_unless_they_are_lit() {
        let [warning] = &warnings(&[[50, 1], [50, 21]], false)[..] else { panic!("one warning is expected") };
        assert!(warning.starts_with("up to 42 % of the drawn pixels of an image show surfaces from behind"));
        assert_eq!(warnings(&[[50, 21]], true), [""; 0]);
        assert_eq!(warnings(&[[100, 0]], false), [""; 0]);
    }
}
