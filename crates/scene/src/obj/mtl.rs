//! Material libraries (MTL).

use super::parse::numbers;
use crate::SceneError;
use crate::error::Warnings;
use crate::outside::Outside;

/// A material as written.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct MtlMaterial {
    pub name: String,
    /// Kd.
    pub diffuse: [f32; 3],
    /// map_Kd.
    pub color: Option<Map>,
    /// map_Bump, bump: heights.
    pub bump: Option<Map>,
    /// norm: a tangent-space normal map.
    pub normal: Option<Map>,
}

/// A reference to a picture.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Map {
    /// As written, `/` between folders.
    pub file: String,
    /// -clamp on.
    pub clamp: bool,
    /// -bm: multiplies heights.
    pub multiplier: f64,
}

/// Begins a material.
const KEYWORD: &str = "newmtl";

/// Parses a material library.
pub(crate) fn parse(bytes: &[u8], outside: &Outside<'_>, warnings: &mut Warnings) -> Result<Vec<MtlMaterial>, SceneError> {
    // It stays as long as the scene is read, and so it is counted as if it stayed for good.
    let materials = bytes.windows(KEYWORD.len()).filter(|window| *window == KEYWORD.as_bytes()).count();
    let structs = 2 * size_of::<MtlMaterial>() * materials;
    outside.hold((structs + 3 * bytes.len()) as u64, "", "materials of a library")?;
    let text = String::from_utf8_lossy(bytes);
    let mut materials: Vec<MtlMaterial> = Vec::new();
    for (i, line) in text.lines().enumerate() {
        statement(line, &mut materials, warnings).map_err(|e| SceneError { place: format!("line {}", i + 1), ..e })?;
    }
    Ok(materials)
}

fn statement(line: &str, materials: &mut Vec<MtlMaterial>, warnings: &mut Warnings) -> Result<(), SceneError> {
    let line = line.trim();
    let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
    if keyword == KEYWORD {
        let name = rest.trim().to_owned();
        materials.push(MtlMaterial { name, diffuse: [1.0; 3], color: None, bump: None, normal: None });
        return Ok(());
    }
    let Some(material) = materials.last_mut() else { return Ok(()) };
    match keyword.to_ascii_lowercase().as_str() {
        "kd" => match rest.split_whitespace().next() {
            Some("spectral" | "xyz") => warnings.add(format!("MTL: {line}: only RGB is supported: white")),
            _ => material.diffuse = gray_or_rgb(rest)?,
        },
        "map_kd" => material.color = map(rest, warnings)?,
        "map_bump" | "bump" => material.bump = map(rest, warnings)?,
        "norm" | "map_kn" => material.normal = map(rest, warnings)?,
        "d" | "tr" => {
            let opaque = if keyword == "d" { 1.0 } else { 0.0 };
            if numbers::<1>(rest.trim_start_matches("-halo"), 1)?.1 != [opaque] {
                warnings.add(format!("material `{}` is transparent: drawn opaque", material.name));
            }
        }
        _ => {}
    }
    Ok(())
}

fn gray_or_rgb(rest: &str) -> Result<[f32; 3], SceneError> {
    let (count, rgb) = numbers::<3>(rest, 1)?;
    let rgb = if count == 3 { rgb } else { [rgb[0]; 3] };
    Ok(rgb.map(|c| c.clamp(0.0, 1.0)))
}

/// A file name after options; `None` where there is no name.
fn map(rest: &str, warnings: &mut Warnings) -> Result<Option<Map>, SceneError> {
    let mut map = Map { file: String::new(), clamp: false, multiplier: 1.0 };
    let mut rest = rest.trim();
    while rest.starts_with('-') {
        let (option, tail) = next_word(rest);
        let (argument, after) = next_word(tail);
        rest = after;
        match option {
            "-bm" => map.multiplier = f64::from(numbers::<1>(argument, 1)?.1[0]),
            "-clamp" => map.clamp = argument == "on",
            "-blendu" | "-blendv" | "-cc" | "-imfchan" | "-texres" | "-boost" | "-type" => {}
            "-mm" | "-o" | "-s" | "-t" => {
                warnings.add(format!("MTL option {option} is not supported: drawn without it"));
                while next_word(rest).0.parse::<f32>().is_ok() {
                    rest = next_word(rest).1;
                }
            }
            _ => {
                return Err(SceneError::at("", format!("unknown option `{option}`"))
                    .expected("-bm, -clamp or another of the MTL format, then a file name"));
            }
        }
    }
    if rest.is_empty() {
        warnings.add("MTL: a map without a file name is ignored");
        return Ok(None);
    }
    map.file = rest.replace('\\', "/");
    Ok(Some(map))
}

fn next_word(text: &str) -> (&str, &str) {
    let (word, rest) = text.split_once(char::is_whitespace).unwrap_or((text, ""));
    (word, rest.trim_start())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Memory;
    use basrelief_input::Budget;

    fn read(text: &str) -> Result<Vec<MtlMaterial>, SceneError> {
        let files = Memory::default();
        parse(text.as_bytes(), &Outside::new(&files, &Budget::default()), &mut Warnings::default())
    }

    #[test]
    fn maps_with_options_are_read() {
        let text =
            "# c\nnewmtl my wall\nKd 0.5 0.25 2\nmap_Kd -s 2 2 1 -clamp on tex\\my wall.png\nbump -bm 0.5 h.png\nnorm n.png\n";
        let map = |file: &str, clamp, multiplier| Some(Map { file: file.into(), clamp, multiplier });
        assert_eq!(
            read(text).unwrap(),
            [MtlMaterial {
                name: "my wall".into(),
                diffuse: [0.5, 0.25, 1.0],
                color: map("tex/my wall.png", true, 1.0),
                bump: map("h.png", false, 0.5),
                normal: map("n.png", false, 1.0),
            }]
        );
    }

    #[test]
    fn mistakes_are_named_with_their_line() {
        assert!(read("newmtl a\nKd x\n").unwrap_err().to_string().starts_with("line 2: `x`"));
        assert!(read("newmtl a\nmap_Kd -foo x.png\n").unwrap_err().to_string().contains("unknown option `-foo`"));
        assert!(read("newmtl a\nbump -bm\n").is_err());
    }
}
