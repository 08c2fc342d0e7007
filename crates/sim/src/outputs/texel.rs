//! Auxiliary outputs of machine `texel`: spans, displacements, division points.

use super::aux_output::AuxForm;
use super::aux_spec::AuxOutputSpec;
use super::heat_map::{ColourScale, heat_map};
use basrelief_frame_buffer::FinishedFrame;
use basrelief_machines::texel::{DisplacementMap, SpanRecord, TexelLog, TexelMachineConfig};
use basrelief_reference::RgbPicture;
use std::io::{self, Write};

pub(crate) const AUX_OUTPUTS: &[AuxOutputSpec<TexelMachineConfig, TexelLog>] = &[
    AuxOutputSpec::lines("spans", "spans with their division points", |frame, log: &TexelLog, out| {
        write_spans(frame, &log.frame.spans, out)
    }),
    AuxOutputSpec::picture(
        "displacement",
        AuxForm::PicturePerFrame,
        "displacement of each pixel's texel",
        |config: &TexelMachineConfig, log: &TexelLog| Some(displacement_picture(&log.frame.map, config.texel.error_bound)),
    )
    .with_judgement(),
    AuxOutputSpec::picture(
        "divisions",
        AuxForm::PicturePerFrame,
        "pixels whose coordinates were divided",
        |_, log: &TexelLog| Some(divisions_picture(&log.picture, &log.frame.map)),
    )
    .with_judgement(),
];

/// Writes one line per span, in drawing order: `{"y", "x", "w", "divisions"}`, with x and w at both ends and the division points from
/// left to right. Lines of later frames begin with `"frame"`.
fn write_spans(frame: u32, spans: &[SpanRecord], out: &mut dyn Write) -> io::Result<()> {
    for SpanRecord { y, x: [left, right], w: [w_left, w_right], divisions } in spans {
        let mut divisions = divisions.clone();
        divisions.sort_unstable();
        out.write_all(b"{")?;
        if frame > 0 {
            write!(out, "\"frame\": {frame}, ")?;
        }
        writeln!(out, "\"y\": {y}, \"x\": [{left}, {right}], \"w\": [{w_left}, {w_right}], \"divisions\": {divisions:?}}}")?;
    }
    Ok(())
}

/// Draws the displacement of each visible pixel's texel as a heat map with a scale. The scale ends at the error bound \[pixels\], or at
/// the largest displacement if that is larger; the bound is then marked. Pixels without a texture are background.
fn displacement_picture(map: &DisplacementMap, error_bound: f64) -> RgbPicture {
    let largest = map.displacement.iter().copied().filter(|d| !d.is_nan()).fold(0.0, f32::max);
    let top = f64::from(largest).max(error_bound);
    let marks: &[f64] = if top > error_bound { &[error_bound] } else { &[] };
    let title = "displacement of the texel in pixels";
    heat_map(map.width, &map.displacement, &ColourScale { marks, ..ColourScale::new(title, top) })
}

/// Draws the machine's image in dark grey, and every visible pixel with divided coordinates in yellow: ends of spans, and division
/// points.
fn divisions_picture(frame: &FinishedFrame, map: &DisplacementMap) -> RgbPicture {
    const POINT: [u8; 3] = [255, 225, 40];
    let FinishedFrame { width, height, rgb, covered, .. } = frame.clone();
    let mut drawn = RgbPicture::drawn([width, height], rgb, covered);
    for (rgb, divided) in drawn.rgb.iter_mut().zip(&map.divided) {
        let [r, g, b] = rgb.map(u16::from);
        *rgb = if *divided { POINT } else { [((r + 2 * g + b) / 8) as u8; 3] };
    }
    drawn
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(displacement: &[f32]) -> DisplacementMap {
        let mut map = DisplacementMap::new(displacement.len() as u32, 1);
        (0..).zip(displacement).for_each(|(x, d)| map.note(x, 0, *d, *d == 0.0));
        map
    }

    #[test]
    fn scale_ends_at_bound_or_largest_displacement() {
        let within = displacement_picture(&map(&[0.0, 0.25, f32::NAN, 0.5]), 0.5);
        let beyond = displacement_picture(&map(&[0.0, 0.25, f32::NAN, 2.0]), 0.5);
        assert_eq!(within.covered[..4], [true, true, false, true]);
        assert_eq!((within.rgb[0], within.rgb[3]), (beyond.rgb[0], beyond.rgb[3]));
        assert_ne!(within.rgb[1], beyond.rgb[1], "another scale");
    }

    #[test]
    fn divided_pixels_stand_out() {
        let rgb = vec![[80, 80, 80], [200, 100, 0], [0, 0, 0]];
        let frame = FinishedFrame { index: 0, round: 0, width: 3, height: 1, rgb, covered: vec![true, true, false] };
        let drawn = divisions_picture(&frame, &map(&[0.0, 0.3, f32::NAN]));
        assert_eq!(drawn.rgb, [[255, 225, 40], [50; 3], [0; 3]]);
        assert_eq!(drawn.covered, frame.covered);
    }

    #[test]
    fn span_is_one_line_with_sorted_division_points() {
        let line = |frame, span: &SpanRecord| {
            let mut bytes = Vec::new();
            write_spans(frame, std::slice::from_ref(span), &mut bytes).unwrap();
            String::from_utf8(bytes).unwrap()
        };
        let span = SpanRecord { y: 12, x: [3, 90], w: [0.25, 1.0 / 3.0], divisions: vec![60, 9, 25] };
        let expected = "{\"y\": 12, \"x\": [3, 90], \"w\": [0.25, 0.3333333333333333], \"divisions\": [9, 25, 60]}\n";
        assert_eq!(line(0, &span), expected);
        let none = SpanRecord { divisions: vec![], ..span };
        assert!(line(2, &none).starts_with("{\"frame\": 2, \"y\": 12, ") && line(2, &none).ends_with("\"divisions\": []}\n"));
        let read: serde_json::Value = serde_json::from_str(&line(1, &none)).unwrap();
        assert_eq!(read["w"][1].as_f64(), Some(1.0 / 3.0), "to the bit");
    }
}
