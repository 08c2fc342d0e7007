//! The statements of an OBJ file.

use super::text::{Line, check_text, escaped, keyword_and_rest, lines, number, numbers, shown, takes_name, words};
use crate::SceneError;
use crate::error::ImportWarnings;
use crate::outside::{ImportContext, over_budget};
use basrelief_input::{MemoryReservation, OverBudget};
use std::collections::BTreeMap;

/// Memory of a group beside its names and faces \[bytes\].
const GROUP: u64 = 256;

/// No texture coordinate, or no normal.
pub(super) const NONE: u32 = u32::MAX;

/// Smoothing group of faces in front of the first `s` statement.
const UNSET: u32 = u32::MAX;

/// Numbers of position, texture coordinate and normal, from 0; [`NONE`] where not given.
pub(super) type CornerIndices = [u32; 3];

/// A polygon of a group.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ObjFace {
    /// Number of corners of this face and of those ahead of it in its group.
    end: usize,
    /// Smoothing group: faces of one group share normals; 0 if the face is flat.
    pub smoothing: u32,
}

/// Faces of one object and material.
#[derive(Debug, Default)]
pub(super) struct ObjGroup {
    pub object: Vec<u8>,
    pub material: Vec<u8>,
    corners: Vec<CornerIndices>,
    faces: Vec<ObjFace>,
}

impl ObjGroup {
    /// Faces with their corners, at least 3 each.
    pub fn faces(&self) -> impl Iterator<Item = (ObjFace, &[CornerIndices])> {
        let begins = std::iter::once(0).chain(self.faces.iter().map(|face| face.end));
        begins.zip(&self.faces).map(|(begin, face)| (*face, self.corners.get(begin..face.end).unwrap_or_default()))
    }

    /// Number of triangles that the faces consist of.
    pub fn triangles(&self) -> usize {
        self.corners.len() - 2 * self.faces.len()
    }

    /// Returns the names of the group's object and material, as far as it has them.
    pub fn name(&self) -> String {
        let named = [&self.object, &self.material].into_iter().filter(|name| !name.is_empty());
        let names: Vec<String> = named.map(|name| escaped(name)).collect();
        if names.is_empty() { "object".into() } else { names.join(" / ") }
    }
}

/// An OBJ file.
#[derive(Debug, Default)]
pub(super) struct ObjFile {
    pub positions: Vec<[f64; 3]>,
    /// Colours of the positions, or empty.
    pub colors: Vec<[f32; 4]>,
    /// v runs up, as in the file.
    pub uv: Vec<[f32; 2]>,
    pub normals: Vec<[f32; 3]>,
    pub groups: Vec<ObjGroup>,
    /// The file has no `s` statement.
    pub smoothing_is_assumed: bool,
    /// Arguments of the `mtllib` statements.
    pub libraries: Vec<Vec<u8>>,
}

/// Parses OBJ text, with the memory that the result takes. Elements other than faces are left out with a warning.
pub(super) fn parse(
    bytes: &[u8],
    outside: &ImportContext<'_>,
    warnings: &mut ImportWarnings,
) -> Result<(ObjFile, MemoryReservation), SceneError> {
    check_text(bytes, "OBJ")?;
    // Only lines that are joined are copied. One may be the whole text, in a list that grows by doubling.
    let joined = bytes.windows(2).any(|pair| matches!(pair, b"\\\n" | b"\\\r"));
    let _lines = outside.take(if joined { 2 * bytes.len() as u64 } else { 0 }, "", "lines of OBJ text")?;
    let mut parser = ObjParser {
        warnings,
        obj: ObjFile::default(),
        held: outside.nothing(),
        groups: BTreeMap::new(),
        current: None,
        names: Default::default(),
        smoothing: UNSET,
        largest: [(0, 0); 3],
    };
    for line in lines(bytes) {
        parser.statement(&line).map_err(|e| SceneError { place: format!("line {}", line.number), ..e })?;
    }
    parser.finish()
}

struct ObjParser<'a> {
    warnings: &'a mut ImportWarnings,
    obj: ObjFile,
    /// Memory of all of it.
    held: MemoryReservation,
    /// Groups by object and material.
    groups: BTreeMap<[Vec<u8>; 2], usize>,
    /// Group that faces go to; `None` after a change of object or material.
    current: Option<usize>,
    /// Current object and material.
    names: [Vec<u8>; 2],
    /// Current smoothing group.
    smoothing: u32,
    /// Largest number of a position, texture coordinate and normal used so far, and its line.
    largest: [(u32, usize); 3],
}

impl ObjParser<'_> {
    fn statement(&mut self, line: &Line<'_>) -> Result<(), SceneError> {
        let (keyword, rest) = keyword_and_rest(&line.text);
        if line.parts > 1 && takes_name(keyword) {
            let what = "a name that ends in a backslash is continued in the next line, as the format asks for";
            self.warnings.add(format!("line {}: {what}", line.number));
        }
        match keyword {
            b"" | b"g" => {}
            b"v" => self.vertex(rest)?,
            b"vt" => {
                let [u, v] = numbers(rest, 1)?.1.map(|c: f64| c as f32);
                self.held.make_room(&mut self.obj.uv, 1, "texture coordinates").map_err(over)?;
                self.obj.uv.push([u, v]);
            }
            b"vn" => {
                self.held.make_room(&mut self.obj.normals, 1, "normals").map_err(over)?;
                self.obj.normals.push(numbers(rest, 3)?.1.map(|c: f64| c as f32));
            }
            b"f" => self.face(rest, line.number)?,
            b"s" => self.smoothing(rest)?,
            b"o" => self.rename(0, rest),
            b"usemtl" => self.rename(1, rest),
            b"mtllib" => {
                self.held.try_grow(64 + rest.len() as u64, "names of material libraries").map_err(over)?;
                self.obj.libraries.push(rest.trim_ascii().into());
            }
            b"l" | b"p" => self.warnings.add("lines and points are skipped"),
            other => self.warnings.add(format!("OBJ statement `{}` is skipped", shown(other))),
        }
        Ok(())
    }

    fn vertex(&mut self, rest: &[u8]) -> Result<(), SceneError> {
        let (count, [x, y, z, r, g, b, ..]) = numbers::<8>(rest, 3)?;
        self.held.make_room(&mut self.obj.positions, 1, "positions").map_err(over)?;
        self.obj.positions.push([x, y, z]);
        match count {
            3 | 6 => {}
            4 if r == 1.0 => {}
            4 => self.warnings.add("weights of vertices (a fourth number) are not used"),
            5 => self.warnings.add("vertices of 5 numbers: the fourth and fifth are not used"),
            _ => {
                self.warnings.add(format!("vertices of {count} or more numbers: the first six are taken as x y z red green blue"))
            }
        }
        if count < 6 {
            return Ok(());
        }
        let color = [r, g, b].map(|c| c as f32);
        if color.iter().any(|c| !(0.0..=1.0).contains(c)) {
            self.warnings.add("vertex colours beyond 0..=1 are clamped");
        }
        let missing = self.obj.positions.len() - self.obj.colors.len();
        self.held.make_room(&mut self.obj.colors, missing, "colours").map_err(over)?;
        // Vertices before the first coloured one are white.
        self.obj.colors.resize(self.obj.positions.len() - 1, [1.0; 4]);
        let [r, g, b] = color.map(|c| c.clamp(0.0, 1.0));
        self.obj.colors.push([r, g, b, 1.0]);
        Ok(())
    }

    fn rename(&mut self, which: usize, name: &[u8]) {
        if let Some(slot) = self.names.get_mut(which) {
            *slot = name.trim_ascii().into();
        }
        self.current = None;
    }

    fn smoothing(&mut self, rest: &[u8]) -> Result<(), SceneError> {
        let group = rest.trim_ascii();
        let wrong = || SceneError::at("", format!("smoothing group `{}`", shown(group))).expected("a number from 0, or off");
        self.smoothing = match group {
            b"off" => 0,
            b"on" => 1,
            _ => number(group).filter(|n| n.fract() == 0.0 && (0.0..f64::from(UNSET)).contains(n)).ok_or_else(wrong)? as u32,
        };
        Ok(())
    }

    fn face(&mut self, rest: &[u8], line: usize) -> Result<(), SceneError> {
        let index = self.group()?;
        let Some(mut group) = self.obj.groups.get_mut(index).map(std::mem::take) else { return Ok(()) };
        let begin = group.corners.len();
        for word in words(rest) {
            self.held.make_room(&mut group.corners, 1, "corners of faces").map_err(over)?;
            group.corners.push(self.corner(word, line)?);
        }
        let end = group.corners.len();
        if end < begin + 3 {
            return Err(SceneError::at("", format!("face of {} vertices", end - begin)).expected("at least 3"));
        }
        self.held.make_room(&mut group.faces, 1, "faces").map_err(over)?;
        group.faces.push(ObjFace { end, smoothing: self.smoothing });
        if let Some(slot) = self.obj.groups.get_mut(index) {
            *slot = group;
        }
        Ok(())
    }

    /// Number of the group that faces go to.
    fn group(&mut self) -> Result<usize, SceneError> {
        if let Some(current) = self.current.or_else(|| self.groups.get(&self.names).copied()) {
            self.current = Some(current);
            return Ok(current);
        }
        let [object, material] = &self.names;
        // The group and the table of groups both hold the names.
        let names = 2 * (object.len() + material.len()) as u64;
        self.held.try_grow(GROUP + names, "groups and their names").map_err(over)?;
        let index = self.obj.groups.len();
        self.obj.groups.push(ObjGroup { object: object.clone(), material: material.clone(), ..ObjGroup::default() });
        self.groups.insert(self.names.clone(), index);
        self.current = Some(index);
        Ok(index)
    }

    /// `position`, `position/uv`, `position//normal` or `position/uv/normal`; negative numbers count from the end.
    fn corner(&mut self, word: &[u8], line: usize) -> Result<CornerIndices, SceneError> {
        let counts = [self.obj.positions.len(), self.obj.uv.len(), self.obj.normals.len()];
        let mut corner = [NONE; 3];
        let wrong = || {
            SceneError::at("", format!("face vertex `{}`", shown(word)))
                .expected("position[/texture[/normal]], each a number from 1, or from -1 backwards")
        };
        let mut parts = std::str::from_utf8(word).map_err(|_| wrong())?.split('/');
        for (i, part) in parts.by_ref().take(3).enumerate() {
            if part.is_empty() && i > 0 {
                continue;
            }
            let number: i64 = part.parse().map_err(|_| wrong())?;
            let zero_based = if number < 0 { counts[i] as i64 + number } else { number - 1 };
            if number < 0 && zero_based < 0 {
                return Err(before_first(word, i, counts[i]));
            }
            let index = u32::try_from(zero_based).ok().filter(|i| *i != NONE).ok_or_else(wrong)?;
            corner[i] = index;
            if index >= self.largest[i].0 {
                self.largest[i] = (index, line);
            }
        }
        if parts.next().is_some() { Err(wrong()) } else { Ok(corner) }
    }

    fn finish(mut self) -> Result<(ObjFile, MemoryReservation), SceneError> {
        let lists =
            [("vertex", self.obj.positions.len()), ("texture coordinate", self.obj.uv.len()), ("normal", self.obj.normals.len())];
        for ((name, count), (index, line)) in lists.into_iter().zip(self.largest) {
            if line > 0 && index as usize >= count {
                return Err(SceneError::at(format!("line {line}"), format!("uses {name} {}", u64::from(index) + 1))
                    .expected(format!("at most {count}, as many as the file has"))
                    .cure("the file is cut off or corrupt: export it again"));
            }
        }
        if !self.obj.colors.is_empty() {
            let missing = self.obj.positions.len() - self.obj.colors.len();
            self.held.make_room(&mut self.obj.colors, missing, "colours").map_err(over)?;
            self.obj.colors.resize(self.obj.positions.len(), [1.0; 4]);
        }
        self.set_initial_smoothing();
        Ok((self.obj, self.held))
    }

    /// Faces in front of the first `s` statement are flat, as the format says. In a file without any `s` all faces are one
    /// group: such files are mostly scans and exports of smooth surfaces.
    fn set_initial_smoothing(&mut self) {
        self.obj.smoothing_is_assumed = self.smoothing == UNSET;
        let initial = u32::from(self.obj.smoothing_is_assumed);
        for face in self.obj.groups.iter_mut().flat_map(|group| &mut group.faces).filter(|face| face.smoothing == UNSET) {
            face.smoothing = initial;
        }
    }
}

/// Returns the error of a face vertex that counts back beyond the first element of its kind: position, texture coordinate or normal.
fn before_first(word: &[u8], kind: usize, count: usize) -> SceneError {
    let name = ["vertices", "texture coordinates", "normals"].get(kind).copied().unwrap_or_default();
    let expected = match count {
        0 => format!("numbers from 1, since the file has no {name} so far"),
        _ => format!("at least -{count}, since the file has {count} {name} so far"),
    };
    SceneError::at("", format!("face vertex `{}` counts back too far", shown(word))).expected(expected)
}

fn over(error: OverBudget) -> SceneError {
    over_budget("", &error)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::MemoryFiles;
    use basrelief_input::MemoryPool;

    fn read(text: &str) -> Result<ObjFile, SceneError> {
        let files = MemoryFiles::default();
        let outside = ImportContext::new(&files, &MemoryPool::default());
        parse(text.as_bytes(), &outside, &mut ImportWarnings::default()).map(|(obj, _)| obj)
    }

    #[test]
    fn faces_of_every_form_are_read() {
        let obj = read("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0 # corner\nvt 0 0\nvn 0 0 1\nf 1 2 \\\n 3 4\nf -4/1 -3//1 -2/-1/1\n")
            .unwrap();
        let n = NONE;
        let faces: Vec<_> = obj.groups[0].faces().map(|(_, corners)| corners).collect();
        assert_eq!(faces, [&[[0, n, n], [1, n, n], [2, n, n], [3, n, n]][..], &[[0, 0, n], [1, n, 0], [2, 0, 0]]]);
        assert_eq!(obj.groups[0].triangles(), 3);
    }

    #[test]
    fn groups_follow_object_and_material() {
        let obj = read("v 0 0 0\nusemtl a\nf 1 1 1\nusemtl b\nf 1 1 1\nusemtl a\nf 1 1 1\no x\nf 1 1 1\n").unwrap();
        let sizes: Vec<_> = obj.groups.iter().map(|g| (&*g.object, &*g.material, g.triangles())).collect();
        assert_eq!(sizes, [(&b""[..], &b"a"[..], 2), (b"", b"b", 1), (b"x", b"a", 1)]);
    }

    #[test]
    fn smoothing_groups_are_read() {
        let smoothing = |text: &str| -> Vec<u32> {
            read(&format!("v 0 0 0\n{text}")).unwrap().groups[0].faces().map(|(face, _)| face.smoothing).collect()
        };
        assert_eq!(smoothing("f 1 1 1\ns 2\nf 1 1 1\ns off\nf 1 1 1\ns 0\nf 1 1 1\n"), [0, 2, 0, 0]);
        assert_eq!(smoothing("f 1 1 1\n"), [1]);
    }

    #[test]
    fn mistakes_are_named_with_their_line() {
        let says = |text: &str, part: &str| {
            let e = read(text).unwrap_err().to_string();
            assert!(e.contains(part), "{e}");
        };
        says("v 0 0\n", "line 1: 2 numbers; expected at least 3");
        says("\nv 0 0 x\n", "line 2: `x`; expected a finite number");
        says("v 0 0 nan\n", "`nan`");
        says("v 0 0 1e39\n", "`1e39`");
        says("s -1\n", "line 1: smoothing group `-1`; expected a number from 0, or off");
        says("v 0 0 0\nf 1 1\n", "line 2: face of 2 vertices");
        says("v 0 0 0\nf 1 1 2\n", "line 2: uses vertex 2; expected at most 1");
        says("v 0 0 0\nf 1/1 1 1\n", "uses texture coordinate 1; expected at most 0");
        for corner in ["0", "-2", "1/2/3/4", "a", "1/x", "99999999999", "/1"] {
            says(&format!("v 0 0 0\nf 1 1 {corner}\n"), "line 2: face vertex");
        }
        let back = "line 3: face vertex `-3` counts back too far; expected at least -2, since the file has 2 vertices so far";
        says("v 0 0 0\nv 1 0 0\nf -3 -2 -1\nv 0 1 0\n", back);
        says("v 0 0 0\nf 1/-1 1 1\n", "`1/-1` counts back too far; expected numbers from 1, since the file has no texture");
        says("v 0 0\u{0}", "byte 5: binary data");
    }

    #[test]
    fn vertices_without_colour_are_white_among_coloured_ones() {
        let obj = read("v 0 0 0\nv 0 0 0 1 0.5 0\nv 0 0 0\n").unwrap();
        assert_eq!(obj.colors, [[1.0; 4], [1.0, 0.5, 0.0, 1.0], [1.0; 4]]);
    }
}
