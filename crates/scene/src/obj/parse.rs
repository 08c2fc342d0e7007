//! The statements of an OBJ file.

use crate::SceneError;
use crate::error::Warnings;
use crate::files::shorten;
use crate::outside::{Outside, over_budget};
use basrelief_input::{Held, OverBudget};
use std::collections::BTreeMap;

/// What a group takes beside its names and triangles \[bytes\].
const GROUP: u64 = 256;

/// No texture coordinate, or no normal.
pub(crate) const NONE: u32 = u32::MAX;

/// Numbers of position, texture coordinate and normal, from 0; [`NONE`] where not given.
pub(crate) type Corner = [u32; 3];

/// Triangles of one object and material.
#[derive(Debug, Default)]
pub(crate) struct Group {
    pub object: String,
    pub material: String,
    pub triangles: Vec<[Corner; 3]>,
}

/// An OBJ file.
#[derive(Debug, Default)]
pub(crate) struct Obj {
    pub positions: Vec<[f32; 3]>,
    /// As many as positions, or none.
    pub colors: Vec<[f32; 4]>,
    /// v runs up, as in the file.
    pub uv: Vec<[f32; 2]>,
    pub normals: Vec<[f32; 3]>,
    pub groups: Vec<Group>,
    pub libraries: Vec<String>,
}

/// Parses OBJ text. Polygons become fans; elements other than faces are left out with a warning. With it comes what it takes.
pub(crate) fn parse(bytes: &[u8], outside: &Outside<'_>, warnings: &mut Warnings) -> Result<(Obj, Held), SceneError> {
    if let Some(at) = bytes.iter().position(|b| *b == 0) {
        return Err(SceneError::at(format!("byte {at}"), "binary data").expected("OBJ text"));
    }
    // A line may be the whole text. What is no UTF-8 is replaced by three bytes, in a text of its own.
    let copies = if std::str::from_utf8(bytes).is_ok() { 1 } else { 2 * 3 };
    let _lines = outside.take(copies * bytes.len() as u64, "", "lines of OBJ text")?;
    let text = String::from_utf8_lossy(bytes);
    let mut parser = Parser {
        warnings,
        obj: Obj::default(),
        held: outside.nothing(),
        corners: Vec::new(),
        current: None,
        groups: BTreeMap::new(),
        names: Default::default(),
        largest: [(0, 0); 3],
    };
    for (number, line) in logical_lines(&text) {
        parser.statement(&line, number).map_err(|e| SceneError { place: format!("line {number}"), ..e })?;
    }
    parser.finish()
}

/// Lines with their numbers from 1, those that end in a backslash joined with the next, comments removed.
fn logical_lines(text: &str) -> impl Iterator<Item = (usize, String)> + '_ {
    let mut lines = text.lines().enumerate();
    std::iter::from_fn(move || {
        let (number, first) = lines.next()?;
        let mut line = first.to_owned();
        while line.ends_with('\\') {
            line.pop();
            line.push(' ');
            line.push_str(lines.next().map_or("", |(_, next)| next));
        }
        line.truncate(line.find('#').unwrap_or(line.len()));
        Some((number + 1, line))
    })
}

struct Parser<'a> {
    warnings: &'a mut Warnings,
    obj: Obj,
    /// What all of it takes.
    held: Held,
    /// Of the face that is being read.
    corners: Vec<Corner>,
    /// Groups by object and material.
    groups: BTreeMap<[String; 2], usize>,
    /// Group that faces go to; `None` after a change of object or material.
    current: Option<usize>,
    /// Current object and material.
    names: [String; 2],
    /// Largest number of a position, texture coordinate and normal used so far, and its line.
    largest: [(u32, usize); 3],
}

impl Parser<'_> {
    fn statement(&mut self, line: &str, number: usize) -> Result<(), SceneError> {
        let line = line.trim();
        let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        match keyword {
            "" | "g" | "s" => {}
            "v" => self.vertex(rest)?,
            "vt" => {
                let [u, v] = numbers(rest, 1)?.1;
                self.held.room(&mut self.obj.uv, 1, "texture coordinates").map_err(over)?;
                self.obj.uv.push([u, v]);
            }
            "vn" => {
                self.held.room(&mut self.obj.normals, 1, "normals").map_err(over)?;
                self.obj.normals.push(numbers(rest, 3)?.1);
            }
            "f" => self.face(rest, number)?,
            "o" => self.rename(0, rest),
            "usemtl" => self.rename(1, rest),
            "mtllib" => {
                self.held.grow(64 + rest.len() as u64, "names of material libraries").map_err(over)?;
                self.obj.libraries.push(rest.trim().into());
            }
            "l" | "p" => self.warnings.add("lines and points are skipped"),
            other => self.warnings.add(format!("OBJ statement `{}` is skipped", shorten(other))),
        }
        Ok(())
    }

    fn vertex(&mut self, rest: &str) -> Result<(), SceneError> {
        let (count, [x, y, z, r, g, b]) = numbers(rest, 3)?;
        self.held.room(&mut self.obj.positions, 1, "positions").map_err(over)?;
        self.obj.positions.push([x, y, z]);
        if count >= 6 {
            let missing = self.obj.positions.len() - self.obj.colors.len();
            self.held.room(&mut self.obj.colors, missing, "colours").map_err(over)?;
            // Vertices before the first coloured one are white.
            self.obj.colors.resize(self.obj.positions.len() - 1, [1.0; 4]);
            self.obj.colors.push([r.clamp(0.0, 1.0), g.clamp(0.0, 1.0), b.clamp(0.0, 1.0), 1.0]);
        }
        Ok(())
    }

    fn rename(&mut self, which: usize, name: &str) {
        if let Some(slot) = self.names.get_mut(which) {
            *slot = name.trim().into();
        }
        self.current = None;
    }

    fn face(&mut self, rest: &str, line: usize) -> Result<(), SceneError> {
        let mut corners = std::mem::take(&mut self.corners);
        corners.clear();
        for token in rest.split_whitespace() {
            self.held.room(&mut corners, 1, "corners of a face").map_err(over)?;
            corners.push(self.corner(token, line)?);
        }
        let (Some(hub), true) = (corners.first().copied(), corners.len() >= 3) else {
            return Err(SceneError::at("", format!("face of {} vertices", corners.len())).expected("at least 3"));
        };
        let group = self.group()?;
        let Self { obj, held, .. } = self;
        let Some(Group { triangles, .. }) = obj.groups.get_mut(group) else { return Ok(()) };
        held.room(triangles, corners.len() - 2, "triangles").map_err(over)?;
        let fan = corners.get(1..).unwrap_or_default().windows(2);
        triangles.extend(fan.filter_map(|w| w.first_chunk().map(|[a, b]| [hub, *a, *b])));
        self.corners = corners;
        Ok(())
    }

    /// Number of the group that faces go to.
    fn group(&mut self) -> Result<usize, SceneError> {
        if let Some(current) = self.current.or_else(|| self.groups.get(&self.names).copied()) {
            self.current = Some(current);
            return Ok(current);
        }
        let [object, material] = &self.names;
        // The names stand in the group and in the table of groups.
        let names = 2 * (object.len() + material.len()) as u64;
        self.held.grow(GROUP + names, "groups and their names").map_err(over)?;
        let index = self.obj.groups.len();
        self.obj.groups.push(Group { object: object.clone(), material: material.clone(), triangles: Vec::new() });
        self.groups.insert(self.names.clone(), index);
        self.current = Some(index);
        Ok(index)
    }

    /// `position`, `position/uv`, `position//normal` or `position/uv/normal`; negative numbers count from the end.
    fn corner(&mut self, token: &str, line: usize) -> Result<Corner, SceneError> {
        let counts = [self.obj.positions.len(), self.obj.uv.len(), self.obj.normals.len()];
        let mut corner = [NONE; 3];
        let wrong = || {
            SceneError::at("", format!("face vertex `{}`", shorten(token)))
                .expected("position[/texture[/normal]], each a number from 1, or from -1 backwards")
        };
        let mut parts = token.split('/');
        for (i, part) in parts.by_ref().take(3).enumerate() {
            if part.is_empty() && i > 0 {
                continue;
            }
            let number: i64 = part.parse().map_err(|_| wrong())?;
            let zero_based = if number < 0 { counts[i] as i64 + number } else { number - 1 };
            let index = u32::try_from(zero_based).ok().filter(|i| *i != NONE).ok_or_else(wrong)?;
            corner[i] = index;
            if index >= self.largest[i].0 {
                self.largest[i] = (index, line);
            }
        }
        if parts.next().is_some() { Err(wrong()) } else { Ok(corner) }
    }

    fn finish(mut self) -> Result<(Obj, Held), SceneError> {
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
            self.held.room(&mut self.obj.colors, missing, "colours").map_err(over)?;
            self.obj.colors.resize(self.obj.positions.len(), [1.0; 4]);
        }
        Ok((self.obj, self.held))
    }
}

fn over(error: OverBudget) -> SceneError {
    over_budget("", &error)
}

/// Up to `N` finite numbers, at least `least` of them; the rest is 0. Also how many there were.
pub(crate) fn numbers<const N: usize>(text: &str, least: usize) -> Result<(usize, [f32; N]), SceneError> {
    let mut values = [0.0; N];
    let mut count = 0;
    for (value, token) in values.iter_mut().zip(text.split_whitespace()) {
        *value = token
            .parse()
            .ok()
            .filter(|v: &f32| v.is_finite())
            .ok_or_else(|| SceneError::at("", format!("`{}`", shorten(token))).expected("a finite number"))?;
        count += 1;
    }
    if count < least {
        return Err(SceneError::at("", format!("{count} numbers")).expected(format!("at least {least}")));
    }
    Ok((count, values))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Memory;
    use basrelief_input::Budget;

    fn read(text: &str) -> Result<Obj, SceneError> {
        let files = Memory::default();
        let outside = Outside::new(&files, &Budget::default());
        parse(text.as_bytes(), &outside, &mut Warnings::default()).map(|(obj, _)| obj)
    }

    #[test]
    fn faces_of_every_form_are_read() {
        let obj = read("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0 # corner\nvt 0 0\nvn 0 0 1\nf 1 2 \\\n 3 4\nf -4/1 -3//1 -2/-1/1\n")
            .unwrap();
        let n = NONE;
        assert_eq!(
            obj.groups[0].triangles,
            [[[0, n, n], [1, n, n], [2, n, n]], [[0, n, n], [2, n, n], [3, n, n]], [[0, 0, n], [1, n, 0], [2, 0, 0]],]
        );
    }

    #[test]
    fn groups_follow_object_and_material() {
        let obj = read("v 0 0 0\nusemtl a\nf 1 1 1\nusemtl b\nf 1 1 1\nusemtl a\nf 1 1 1\no x\nf 1 1 1\n").unwrap();
        let sizes: Vec<_> = obj.groups.iter().map(|g| (&*g.object, &*g.material, g.triangles.len())).collect();
        assert_eq!(sizes, [("", "a", 2), ("", "b", 1), ("x", "a", 1)]);
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
        says("v 0 0 0\nf 1 1\n", "line 2: face of 2 vertices");
        says("v 0 0 0\nf 1 1 2\n", "line 2: uses vertex 2; expected at most 1");
        says("v 0 0 0\nf 1/1 1 1\n", "uses texture coordinate 1; expected at most 0");
        for corner in ["0", "-2", "1/2/3/4", "a", "1/x", "99999999999", "/1"] {
            says(&format!("v 0 0 0\nf 1 1 {corner}\n"), "line 2: face vertex");
        }
        says("v 0 0\u{0}", "byte 5: binary data");
    }

    #[test]
    fn vertices_without_colour_are_white_among_coloured_ones() {
        let obj = read("v 0 0 0\nv 0 0 0 1 0.5 0\nv 0 0 0\n").unwrap();
        assert_eq!(obj.colors, [[1.0; 4], [1.0, 0.5, 0.0, 1.0], [1.0; 4]]);
    }
}
