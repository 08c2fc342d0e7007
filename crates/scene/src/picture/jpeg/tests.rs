//! All kinds of JPEG against libjpeg, whose pixels `tests/inputs/jpeg/make.py` has stored.

use super::super::decode;
use crate::outside::ImportContext;
use crate::{MemoryFiles, SceneError};
use basrelief_input::MemoryPool;
use basrelief_signals::Image;

/// A JPEG file and the RGB pixels that libjpeg decodes from it.
struct JpegCase {
    name: String,
    file: Vec<u8>,
    pixels: Vec<u8>,
}

fn matrix() -> Vec<JpegCase> {
    fn take<'a>(bytes: &mut &'a [u8], count: usize) -> &'a [u8] {
        let (taken, rest) = bytes.split_at(count);
        *bytes = rest;
        taken
    }
    fn number(bytes: &mut &[u8], size: usize) -> usize {
        take(bytes, size).iter().rev().fold(0, |sum, byte| sum << 8 | usize::from(*byte))
    }
    let packed = include_bytes!("../../../../../tests/inputs/jpeg/matrix.z");
    let unpacked = miniz_oxide::inflate::decompress_to_vec_zlib(packed).unwrap();
    let (mut rest, mut pictures, mut cases) = (&unpacked[..], Vec::new(), Vec::new());
    while let Some(kind) = rest.split_off_first() {
        if *kind == b'P' {
            let (width, height) = (number(&mut rest, 2), number(&mut rest, 2));
            pictures.push(take(&mut rest, 3 * width * height).to_vec());
            continue;
        }
        let length = number(&mut rest, 1);
        let name = String::from_utf8(take(&mut rest, length).to_vec()).unwrap();
        let length = number(&mut rest, 4);
        let file = take(&mut rest, length).to_vec();
        cases.push(JpegCase { name, file, pixels: pictures[number(&mut rest, 2)].clone() });
    }
    assert!(cases.len() > 1000, "{} cases", cases.len());
    cases
}

fn decoded(bytes: &[u8]) -> Result<Image, SceneError> {
    let files = MemoryFiles::default();
    decode(bytes, "t.jpg", &ImportContext::new(&files, &MemoryPool::default())).map(|(image, _)| image)
}

fn case(name: &str) -> JpegCase {
    matrix().into_iter().find(|case| case.name == name).unwrap()
}

/// Mean difference of the colour components.
fn difference(image: &Image, pixels: &[u8]) -> f64 {
    let ours = image.texels.iter().flat_map(|[r, g, b, _]| [r, g, b]);
    ours.zip(pixels).map(|(a, b)| f64::from(a.abs_diff(*b))).sum::<f64>() / pixels.len() as f64
}

/// Refused are only scans of one component with factor 2 of 4, which the decoder reads wrong.
#[test]
fn every_kind_of_jpeg_agrees_with_libjpeg_or_is_refused() {
    let mut refused = 0;
    for JpegCase { name, file, pixels } in matrix() {
        match decoded(&file) {
            Ok(image) => {
                let difference = difference(&image, &pixels);
                assert!(difference < 4.0, "{name}: {difference}");
            }
            Err(error) => {
                let factor = "has a scan of a single component whose sampling factor is 2 of 4, which is not supported";
                assert!(error.to_string().contains(factor) && name.starts_with('4'), "{name}: {error}");
                refused += 1;
            }
        }
    }
    assert_eq!(refused, 88);
}

#[test]
fn jpeg_without_end_marker_is_an_error() {
    for JpegCase { name, file, .. } in matrix().into_iter().step_by(17) {
        for end in [file.len() / 2, file.len() * 4 / 5, file.len() - 2] {
            let error = decoded(&file[..end]).map(drop).expect_err(&name).to_string();
            assert!(error.contains("is cut off") || error.contains("not supported"), "{name}: {error}");
        }
    }
}

/// A scan that only refines mean values is not checked: each bit of it is valid, and the picture is off by half a level.
#[test]
fn jpeg_with_incomplete_scan_is_an_error() {
    for JpegCase { name, file, .. } in matrix().into_iter().filter(|case| !case.name.contains("two-dc")).step_by(17) {
        let cut = [&file[..file.len() - 24], b"\xff\xd9"].concat();
        let error = decoded(&cut).map(drop).expect_err(&name).to_string();
        assert!(["is cut off", "corrupt", "not supported"].iter().any(|part| error.contains(part)), "{name}: {error}");
    }
}

#[test]
fn unsupported_kinds_of_jpeg_are_named() {
    let ordinary = case("1x1 interleaved restart None").file;
    let frame = ordinary.windows(2).position(|pair| pair == [0xff, 0xc0]).unwrap();
    let with = |offset: usize, byte: u8| {
        let mut file = ordinary.clone();
        file[frame + offset] = byte;
        decoded(&file).map(drop).unwrap_err().to_string()
    };
    assert!(with(1, 0xc3).contains("this JPEG uses lossless coding, which is not supported"));
    assert!(with(1, 0xc5).contains("this JPEG uses hierarchical coding"));
    assert!(with(1, 0xc9).contains("this JPEG uses arithmetic coding"));
    assert!(with(1, 0xf7).contains("this JPEG is a JPEG-LS file"));
    assert!(with(4, 12).contains("this JPEG has 12 bits per sample"));
    assert!(with(9, 4).contains("this JPEG has four components (CMYK or YCCK colours)"));
    assert!(with(9, 2).contains("this JPEG has 2 components"));
    assert!(with(14, 0x25).contains("a sampling factor is not 1, 2, 3 or 4"));
}

#[test]
fn sampling_factor_that_divides_no_other_is_refused() {
    let mut file = case("3x1 interleaved restart None").file;
    let frame = file.windows(2).position(|pair| pair == [0xff, 0xc0]).unwrap();
    file[frame + 14] = 0x21;
    let error = decoded(&file).map(drop).unwrap_err().to_string();
    assert!(error.contains("has sampling factors 3 and 2, whose ratio is not a whole number"), "{error}");
}

#[test]
fn too_many_scans_are_refused() {
    let file = case("1x1 interleaved restart None").file;
    let scan = file.windows(2).rposition(|pair| pair == [0xff, 0xda]).unwrap();
    let (head, rest) = file.split_at(scan);
    let (scan, end) = rest.split_at(rest.len() - 2);
    let error = decoded(&[head, &scan.repeat(1001), end].concat()).map(drop).unwrap_err().to_string();
    assert!(error.starts_with("t.jpg: this JPEG has 1001 scans; expected at most 1000 in an image of"), "{error}");
}

/// Photoshop writes RGB with component numbers 1 to 3, an Adobe segment with transform 0, and no JFIF segment.
#[test]
fn adobe_transform_0_means_rgb() {
    let JpegCase { mut file, pixels, .. } = case("rgb");
    assert!(file.windows(5).any(|bytes| bytes == b"Adobe"));
    for i in 0..file.len() - 2 {
        if file[i..].starts_with(&[0xff, 0xc0]) {
            for (component, id) in (1u8..).zip([b'R', b'G', b'B']) {
                let at = i + 7 + 3 * usize::from(component);
                assert_eq!(file[at], id);
                file[at] = component;
            }
        }
        if file[i..].starts_with(&[0xff, 0xda]) {
            for component in 1u8..=3 {
                file[i + 3 + 2 * usize::from(component)] = component;
            }
            break;
        }
    }
    assert!(difference(&decoded(&file).unwrap(), &pixels) < 4.0);
}
