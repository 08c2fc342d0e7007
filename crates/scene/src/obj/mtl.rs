//! Material libraries (MTL).

use super::map::{self, TextureMap};
use super::text::{Line, check_text, escaped, keyword_and_rest, lines, numbers, shown};
use crate::SceneError;
use crate::error::ImportWarnings;
use crate::outside::ImportContext;

/// A material as written.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct MtlMaterial {
    pub name: Vec<u8>,
    /// Kd.
    pub diffuse: [f32; 3],
    /// Ks.
    pub specular: Option<[f32; 3]>,
    /// Ns.
    pub exponent: Option<f32>,
    /// Ke.
    pub emission: [f32; 3],
    /// illum.
    pub model: Option<u32>,
    /// map_Kd.
    pub color: Option<Box<TextureMap>>,
    /// map_Ke.
    pub emission_map: Option<Box<TextureMap>>,
    /// map_Bump, bump: heights.
    pub bump: Option<Box<TextureMap>>,
    /// norm: a tangent-space normal map.
    pub normal: Option<Box<TextureMap>>,
}

impl MtlMaterial {
    fn new(name: &[u8]) -> Self {
        Self {
            name: name.into(),
            diffuse: [1.0; 3],
            specular: None,
            exponent: None,
            emission: [0.0; 3],
            model: None,
            color: None,
            emission_map: None,
            bump: None,
            normal: None,
        }
    }

    /// All references to pictures.
    pub fn maps(&mut self) -> impl Iterator<Item = &mut TextureMap> {
        [&mut self.color, &mut self.emission_map, &mut self.bump, &mut self.normal].into_iter().flatten().map(|map| &mut **map)
    }
}

/// Begins a material.
const KEYWORD: &[u8] = b"newmtl";

/// Parses a material library. A statement that cannot be used is left out with a warning that names `file`.
///
/// # Errors
/// No text, or over the budget.
pub(super) fn parse(
    bytes: &[u8],
    file: &str,
    outside: &ImportContext<'_>,
    warnings: &mut ImportWarnings,
) -> Result<Vec<MtlMaterial>, SceneError> {
    check_text(bytes, "MTL")?;
    // It stays as long as the scene is read, and so it is counted as if it stayed for good.
    let materials = bytes.windows(KEYWORD.len()).filter(|window| *window == KEYWORD).count();
    let structs = (2 * size_of::<MtlMaterial>() + size_of::<TextureMap>()) * materials;
    outside.hold((structs + 3 * bytes.len()) as u64, "", "materials of a library")?;
    let mut materials: Vec<MtlMaterial> = Vec::new();
    for line in lines(bytes) {
        if let Err(error) = statement(&line, &mut materials, warnings) {
            let error = SceneError { place: format!("line {}", line.number), ..error }.in_file(file);
            warnings.add(format!("{error}; this statement is left out"));
        }
    }
    Ok(materials)
}

fn statement(line: &Line<'_>, materials: &mut Vec<MtlMaterial>, warnings: &mut ImportWarnings) -> Result<(), SceneError> {
    let (keyword, rest) = keyword_and_rest(&line.text);
    if keyword == KEYWORD {
        materials.push(MtlMaterial::new(rest.trim_ascii()));
        return Ok(());
    }
    let keyword = keyword.to_ascii_lowercase();
    let Some(material) = materials.last_mut() else {
        let what = format!("`{}` in front of the first material", shown(&keyword));
        return if keyword.is_empty() { Ok(()) } else { Err(SceneError::at("", what).expected("newmtl")) };
    };
    match keyword.as_slice() {
        b"" => {}
        b"kd" => material.diffuse = color(rest, material.diffuse, &keyword, warnings)?.map(|c| clamped(c, "Kd", warnings)),
        b"ks" => material.specular = Some(color(rest, [0.0; 3], &keyword, warnings)?.map(|c| clamped(c, "Ks", warnings))),
        b"ke" => material.emission = color(rest, [0.0; 3], &keyword, warnings)?.map(|c| clamped(c, "Ke", warnings)),
        b"ns" => material.exponent = Some(numbers::<1>(rest, 1)?.1[0] as f32),
        b"illum" => material.model = Some(model(rest)?),
        b"map_kd" => material.color = map::parse(rest, warnings)?,
        b"map_ke" => material.emission_map = map::parse(rest, warnings)?,
        b"map_bump" | b"bump" => material.bump = map::parse(rest, warnings)?,
        b"norm" | b"map_kn" => material.normal = map::parse(rest, warnings)?,
        b"d" | b"tr" => {
            let opaque = if keyword == b"d" { 1.0 } else { 0.0 };
            if numbers::<1>(rest.strip_prefix(b"-halo").unwrap_or(rest), 1)?.1 != [opaque] {
                warnings.add(format!("material `{}` is transparent: drawn opaque", escaped(&material.name)));
            }
        }
        b"ka" => warnings.add("MTL statement `Ka` is not used: ambient light has the colour of `Kd`"),
        // Refraction concerns transparent materials only, and sharpness reflection maps.
        b"ni" | b"tf" | b"sharpness" => {}
        _ => warnings.add(format!("MTL statement `{}` is not used", shown(keyword_and_rest(&line.text).0))),
    }
    Ok(())
}

/// Number of an illumination model.
fn model(text: &[u8]) -> Result<u32, SceneError> {
    let number = numbers::<1>(text, 1)?.1[0];
    if number.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(&number) {
        return Ok(number as u32);
    }
    Err(SceneError::at("", format!("illumination model `{}`", shown(text))).expected("a whole number 0..=10"))
}

/// A colour as one number or three; `fallback` if it is given in another way.
fn color(rest: &[u8], fallback: [f32; 3], keyword: &[u8], warnings: &mut ImportWarnings) -> Result<[f32; 3], SceneError> {
    if matches!(keyword_and_rest(rest).0, b"spectral" | b"xyz") {
        warnings.add(format!("MTL: `{} {}` is not used: only red, green and blue are supported", shown(keyword), shown(rest)));
        return Ok(fallback);
    }
    let (count, rgb) = numbers::<3>(rest, 1)?;
    let rgb = rgb.map(|c| c as f32);
    match count {
        1 => Ok([rgb[0]; 3]),
        3 => Ok(rgb),
        _ => Err(SceneError::at("", format!("{count} numbers")).expected("one number, or three for red, green and blue")),
    }
}

fn clamped(component: f32, name: &str, warnings: &mut ImportWarnings) -> f32 {
    if !(0.0..=1.0).contains(&component) {
        warnings.add(format!("MTL: `{name}` beyond 0..=1 is clamped"));
    }
    component.clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::MemoryFiles;
    use basrelief_input::MemoryPool;

    fn read(text: &str) -> (Vec<MtlMaterial>, Vec<String>) {
        let files = MemoryFiles::default();
        let mut warnings = ImportWarnings::default();
        let outside = ImportContext::new(&files, &MemoryPool::default());
        let materials = parse(text.as_bytes(), "m.mtl", &outside, &mut warnings).unwrap();
        (materials, warnings.into_vec())
    }

    #[test]
    fn statements_of_a_material_are_read() {
        let text = "\u{feff}newmtl my wall\nKd 0.5 0.25 1\nKs 0.5\nNs 20\nKe 0 0 0\nillum 2\nmap_Kd a.png\nbump h.png\nnorm n.png\nNi 1\nd 1\n";
        let map = |file: &str| map::parse(file.as_bytes(), &mut ImportWarnings::default()).unwrap();
        let material = MtlMaterial {
            diffuse: [0.5, 0.25, 1.0],
            specular: Some([0.5; 3]),
            exponent: Some(20.0),
            model: Some(2),
            color: map("a.png"),
            bump: map("h.png"),
            normal: map("n.png"),
            ..MtlMaterial::new(b"my wall")
        };
        assert_eq!(read(text), (vec![material], vec![]));
    }

    #[test]
    fn statements_that_are_not_used_are_named() {
        for statement in ["Ka 1 1 1", "map_d a.png", "map_Ka a.png", "map_Ks a.png", "disp a.png", "Pr 0.5", "Kq 1"] {
            let keyword = statement.split(' ').next().unwrap();
            let (_, warnings) = read(&format!("newmtl a\n{statement}\n{statement}\nnewmtl b\n{statement}\n"));
            assert!(warnings.len() == 1 && warnings[0].contains(&format!("`{keyword}` is not used")), "{warnings:?}");
        }
    }

    #[test]
    fn mistakes_are_warnings_with_their_line() {
        let says = |text: &str, part: &str| {
            let (_, warnings) = read(text);
            assert!(warnings.len() == 1 && warnings[0].starts_with(part), "{warnings:?}");
        };
        let number = "m.mtl: line 2: `x`; expected a finite number of single precision; correct it or export the file again";
        says("newmtl a\nKd x\n", &format!("{number}; this statement is left out"));
        says("newmtl a\nbump -bm\n", "m.mtl: line 2: 0 numbers behind `-bm`");
        says("newmtl a\nKd 1 0\n", "m.mtl: line 2: 2 numbers; expected one number, or three for red, green and blue; this");
        says("newmtl a\nillum -3\n", "m.mtl: line 2: illumination model `-3`; expected a whole number 0..=10; this");
        says("newmtl a\nillum 1.5\n", "m.mtl: line 2: illumination model `1.5`");
        says("Kd 1 1 1\n", "m.mtl: line 1: `kd` in front of the first material; expected newmtl");
        says("newmtl a\nKd 1 1 2\n", "MTL: `Kd` beyond 0..=1 is clamped");
        says("newmtl a\nd 0.5\n", "material `a` is transparent: drawn opaque");
        says("newmtl a\nKd xyz 1 1 1\n", "MTL: `kd xyz 1 1 1` is not used");
    }
}
