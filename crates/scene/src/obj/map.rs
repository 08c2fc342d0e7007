//! References to pictures in material libraries: options and a file name, in any order.

use super::text::{escaped, keyword_and_rest, number, shown};
use crate::SceneError;
use crate::error::ImportWarnings;

/// A reference to a picture.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct TextureMap {
    /// Relative to the library, `/` between folders.
    pub file: String,
    /// `-clamp on`.
    pub clamp: bool,
    /// Multiplies heights: `-bm`, and the gain of `-mm`.
    pub height: f64,
    /// Base and gain of `-mm`: a colour becomes base + gain * colour.
    pub range: [f64; 2],
    /// `-s`: multiplies u and v.
    pub scale: [f64; 2],
    /// `-o`: added to u and v after scaling.
    pub offset: [f64; 2],
}

impl TextureMap {
    fn new() -> Self {
        Self { file: String::new(), clamp: false, height: 1.0, range: [0.0, 1.0], scale: [1.0; 2], offset: [0.0; 2] }
    }

    /// Texture coordinates of the picture, v down, at those of the file, v up.
    pub fn at(&self, uv: [f32; 2]) -> [f32; 2] {
        let [u, v] = [0, 1].map(|i| (f64::from(uv[i]) * self.scale[i] + self.offset[i]) as f32);
        [u, 1.0 - v]
    }
}

/// Arguments of an option.
enum OptionArguments {
    Word,
    Numbers { least: usize, most: usize },
}

fn arguments_of(option: &[u8]) -> Option<OptionArguments> {
    Some(match option {
        b"-blendu" | b"-blendv" | b"-cc" | b"-clamp" | b"-imfchan" | b"-type" | b"-colorspace" => OptionArguments::Word,
        b"-bm" | b"-boost" | b"-texres" => OptionArguments::Numbers { least: 1, most: 1 },
        b"-mm" => OptionArguments::Numbers { least: 2, most: 2 },
        b"-o" | b"-s" | b"-t" => OptionArguments::Numbers { least: 1, most: 3 },
        _ => return None,
    })
}

/// Parses the argument of a map statement. `None` if it has no file name.
///
/// # Errors
/// An option without its number.
pub(super) fn parse(text: &[u8], warnings: &mut ImportWarnings) -> Result<Option<Box<TextureMap>>, SceneError> {
    let mut map = TextureMap::new();
    let text = text.trim_ascii();
    let mut rest = text;
    // Begin and end of the name, which may contain blanks.
    let mut name: Option<[usize; 2]> = None;
    while !rest.is_empty() {
        let begin = text.len() - rest.len();
        let (word, behind) = keyword_and_rest(rest);
        rest = behind;
        match arguments_of(word) {
            Some(OptionArguments::Word) => {
                let (argument, behind) = keyword_and_rest(rest);
                rest = behind;
                apply_word(word, argument, &mut map, warnings);
            }
            Some(OptionArguments::Numbers { least, most }) => {
                let values = leading_numbers(&mut rest, most);
                if values.len() < least {
                    let what = format!("{} numbers behind `{}`", values.len(), shown(word));
                    return Err(SceneError::at("", what).expected(format!("at least {least}")));
                }
                apply_numbers(word, &values, &mut map, warnings);
            }
            None if name.is_none() && word.starts_with(b"-") && !rest.is_empty() => {
                warnings.add(format!("MTL option `{}` is unknown: left out, with the word behind it", shown(word)));
                let (argument, behind) = keyword_and_rest(rest);
                if behind.is_empty() {
                    name = Some([text.len() - rest.len(), text.len() - rest.len() + argument.len()]);
                }
                rest = behind;
            }
            None => name = Some([name.map_or(begin, |[begin, _]| begin), begin + word.len()]),
        }
    }
    let Some([begin, end]) = name else {
        warnings.add("MTL: a map without a file name is ignored");
        return Ok(None);
    };
    map.file = escaped(text.get(begin..end).unwrap_or_default()).replace('\\', "/");
    Ok(Some(Box::new(map)))
}

/// Takes up to `most` numbers from the beginning of a text.
fn leading_numbers(rest: &mut &[u8], most: usize) -> Vec<f64> {
    let mut values = Vec::new();
    while values.len() < most {
        let (word, behind) = keyword_and_rest(rest);
        let Some(value) = number(word) else { break };
        values.push(value);
        *rest = behind;
    }
    values
}

fn apply_word(option: &[u8], argument: &[u8], map: &mut TextureMap, warnings: &mut ImportWarnings) {
    match (option, argument) {
        (b"-clamp", _) => map.clamp = argument == b"on",
        // Blending concerns MIP levels only.
        (b"-blendu" | b"-blendv", _) | (b"-cc", b"off") => {}
        _ => unused(option, warnings),
    }
}

fn apply_numbers(option: &[u8], values: &[f64], map: &mut TextureMap, warnings: &mut ImportWarnings) {
    let or = |i: usize, other: f64| values.get(i).copied().unwrap_or(other);
    match option {
        b"-bm" => map.height *= or(0, 1.0),
        b"-mm" => {
            map.range = [or(0, 0.0), or(1, 1.0)];
            map.height *= or(1, 1.0);
        }
        b"-o" => map.offset = [or(0, 0.0), or(1, 0.0)],
        b"-s" => map.scale = [or(0, 1.0), or(1, 1.0)],
        // The resolution at which another program loads the picture.
        b"-texres" => {}
        b"-t" if values.iter().all(|value| *value == 0.0) => {}
        _ => unused(option, warnings),
    }
}

fn unused(option: &[u8], warnings: &mut ImportWarnings) {
    warnings.add(format!("MTL option `{}` is not supported: drawn without it", shown(option)));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> (TextureMap, Vec<String>) {
        let mut warnings = ImportWarnings::default();
        let map = parse(text.as_bytes(), &mut warnings).unwrap().unwrap();
        (*map, warnings.into_vec())
    }

    #[test]
    fn options_stand_on_either_side_of_the_name() {
        let expected = TextureMap { file: "tex/my wall.png".into(), clamp: true, scale: [2.0, 3.0], ..TextureMap::new() };
        for text in
            ["-s 2 3 1 -clamp on tex\\my wall.png", "tex/my wall.png -clamp on -s 2 3", "-clamp on tex/my wall.png -s 2 3 1"]
        {
            assert_eq!(read(text), (expected.clone(), vec![]), "{text}");
        }
    }

    #[test]
    fn heights_are_scaled_by_bm_and_gain() {
        let (map, warnings) = read("-bm 0.5 -mm 0.1 4 h.png");
        assert_eq!((map.height, map.range, warnings), (2.0, [0.1, 4.0], vec![]));
    }

    /// By hand, with v up: u = 0.5 * 2 + 0.25, v = 0.25 * 4 + 0.125; then v is turned down.
    #[test]
    fn scale_comes_before_offset() {
        assert_eq!(read("-s 2 4 -o 0.25 0.125 a.png").0.at([0.5, 0.25]), [1.25, 1.0 - 1.125]);
        assert_eq!(read("a.png").0.at([0.3, 0.7]), [0.3, 1.0 - 0.7]);
    }

    #[test]
    fn unknown_option_is_a_warning() {
        for (text, option) in [
            ("-foo x a.png", "-foo"),
            ("-foo a.png", "-foo"),
            ("-colorspace sRGB a.png", "-colorspace"),
            ("-boost 2 a.png", "-boost"),
        ] {
            let (map, warnings) = read(text);
            assert_eq!(map.file, "a.png", "{text}");
            assert!(warnings.len() == 1 && warnings[0].contains(&format!("`{option}`")), "{warnings:?}");
        }
    }

    #[test]
    fn option_without_its_number_is_an_error() {
        let error = parse(b"a.png -bm", &mut ImportWarnings::default()).unwrap_err();
        assert_eq!(error.to_string(), "0 numbers behind `-bm`; expected at least 1");
        assert_eq!(parse(b"-clamp on", &mut ImportWarnings::default()).unwrap(), None);
    }
}
