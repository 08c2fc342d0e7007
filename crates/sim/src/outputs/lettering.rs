//! Text in pictures.

use basrelief_reference::RgbPicture;

/// Glyphs of three columns by five rows, with one octal digit per row.
const GLYPHS: [(char, [u8; 5]); 44] = [
    ('0', [7, 5, 5, 5, 7]),
    ('1', [2, 6, 2, 2, 7]),
    ('2', [7, 1, 7, 4, 7]),
    ('3', [7, 1, 7, 1, 7]),
    ('4', [5, 5, 7, 1, 1]),
    ('5', [7, 4, 7, 1, 7]),
    ('6', [7, 4, 7, 5, 7]),
    ('7', [7, 1, 2, 2, 2]),
    ('8', [7, 5, 7, 5, 7]),
    ('9', [7, 5, 7, 1, 7]),
    ('A', [2, 5, 7, 5, 5]),
    ('B', [6, 5, 6, 5, 6]),
    ('C', [3, 4, 4, 4, 3]),
    ('D', [6, 5, 5, 5, 6]),
    ('E', [7, 4, 6, 4, 7]),
    ('F', [7, 4, 6, 4, 4]),
    ('G', [3, 4, 5, 5, 3]),
    ('H', [5, 5, 7, 5, 5]),
    ('I', [7, 2, 2, 2, 7]),
    ('J', [1, 1, 1, 5, 2]),
    ('K', [5, 5, 6, 5, 5]),
    ('L', [4, 4, 4, 4, 7]),
    ('M', [5, 7, 7, 5, 5]),
    ('N', [6, 5, 5, 5, 5]),
    ('O', [2, 5, 5, 5, 2]),
    ('P', [6, 5, 6, 4, 4]),
    ('Q', [2, 5, 5, 6, 3]),
    ('R', [6, 5, 6, 5, 5]),
    ('S', [3, 4, 2, 1, 6]),
    ('T', [7, 2, 2, 2, 2]),
    ('U', [5, 5, 5, 5, 7]),
    ('V', [5, 5, 5, 5, 2]),
    ('W', [5, 5, 7, 7, 5]),
    ('X', [5, 5, 2, 5, 5]),
    ('Y', [5, 5, 2, 2, 2]),
    ('Z', [7, 1, 2, 4, 7]),
    ('.', [0, 0, 0, 0, 2]),
    ('-', [0, 0, 7, 0, 0]),
    ('_', [0, 0, 0, 0, 7]),
    (':', [0, 2, 0, 2, 0]),
    (',', [0, 0, 0, 2, 4]),
    ('+', [0, 2, 7, 2, 0]),
    ('(', [1, 2, 2, 2, 1]),
    (')', [4, 2, 2, 2, 4]),
];

/// Width and height of a glyph's pixel \[picture pixels\].
const SCALE: u32 = 2;
/// Distance from glyph to glyph \[pixels\].
pub(super) const ADVANCE: u32 = 4 * SCALE;
/// Height of a glyph \[pixels\].
pub(super) const HEIGHT: u32 = 5 * SCALE;
/// Distance from line to line \[pixels\].
pub(super) const LINE: u32 = HEIGHT + 4;

/// Breaks a text between words into lines of at most this width \[pixels\]. A wider word gets its own line.
pub(super) fn lines(text: &str, width: u32) -> Vec<String> {
    let most = (width / ADVANCE) as usize;
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if line.len() + 1 + word.len() <= most => *line += &format!(" {word}"),
            _ => lines.push(word.into()),
        }
    }
    lines
}

/// Writes a text in white capitals. Characters other than letters, digits and `.-_:,+()` are blanks.
pub(super) fn write(picture: &mut RgbPicture, start: u32, row: u32, text: &str) {
    for (k, letter) in (0..).zip(text.chars()) {
        let letter = letter.to_ascii_uppercase();
        let Some((_, glyph)) = GLYPHS.iter().find(|(known, _)| *known == letter) else { continue };
        for (y, x) in (0..HEIGHT).flat_map(|y| (0..3 * SCALE).map(move |x| (y, x))) {
            if glyph[(y / SCALE) as usize] >> (2 - x / SCALE) & 1 == 1 {
                set(picture, start + k * ADVANCE + x, row + y, [255; 3]);
            }
        }
    }
}

/// Draws a pixel. Pixels outside of the picture are ignored.
pub(super) fn set(picture: &mut RgbPicture, x: u32, y: u32, color: [u8; 3]) {
    let place = y as usize * picture.width as usize + x as usize;
    if x < picture.width && place < picture.rgb.len() {
        picture.rgb[place] = color;
        picture.covered[place] = true;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_break_between_words() {
        assert_eq!(lines("ab cd  efgh i", 5 * ADVANCE + 1), ["ab cd", "efgh", "i"]);
        assert_eq!(lines("abcdef g", ADVANCE), ["abcdef", "g"], "a word stays whole");
        assert!(lines("", 100).is_empty());
    }

    #[test]
    fn glyphs_are_distinct_and_unknown_characters_are_blank() {
        let drawn = |text: &str| {
            let mut picture = RgbPicture::new(20, HEIGHT);
            write(&mut picture, 0, 0, text);
            picture.covered
        };
        let mut all: Vec<_> = GLYPHS.iter().map(|(letter, _)| drawn(&letter.to_string())).collect();
        all.sort();
        all.dedup();
        assert_eq!(all.len(), GLYPHS.len());
        assert_eq!(drawn("a"), drawn("A"));
        assert!(drawn(" ").iter().chain(&drawn("\u{e9}")).all(|c| !c));
        assert_eq!(drawn("-").iter().filter(|c| **c).count(), 3 * 4);
        assert_eq!(drawn("ABCDEFGH").len(), 200, "clipped at the edge");
    }
}
