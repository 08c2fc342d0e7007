//! Lines, words, names and numbers of OBJ and MTL text.
//!
//! The text is read as bytes, because names need not be UTF-8. Two names are the same only if all their bytes are.

use crate::SceneError;
use crate::files::shorten;
use std::borrow::Cow;

/// A line without its comment, joined with the lines that continue it.
pub(super) struct Line<'a> {
    /// Number of its first line, from 1.
    pub number: usize,
    pub text: Cow<'a, [u8]>,
    /// Number of lines that it consists of.
    pub parts: usize,
}

/// The lines of a text. A byte order mark is skipped; CR, LF and CR LF end a line.
pub(super) fn lines(text: &[u8]) -> impl Iterator<Item = Line<'_>> {
    let mut rest = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text);
    let mut number = 0;
    std::iter::from_fn(move || {
        let first = split_line(&mut rest)?;
        let keyword = keyword_and_rest(first).0;
        let mut line = Line { number: number + 1, text: Cow::Borrowed(without_comment(first, keyword)), parts: 1 };
        while let Some(continued) = line.text.strip_suffix(b"\\") {
            let next = split_line(&mut rest).map(|next| without_comment(next, keyword)).unwrap_or_default();
            let length = continued.len();
            let text = line.text.to_mut();
            text.truncate(length);
            text.push(b' ');
            text.extend_from_slice(next);
            line.parts += 1;
        }
        number += line.parts;
        Some(line)
    })
}

/// Refuses binary data and UTF-16. `format` is for messages.
pub(super) fn check_text(bytes: &[u8], format: &str) -> Result<(), SceneError> {
    let Some(at) = bytes.iter().position(|b| *b == 0) else { return Ok(()) };
    let what = if matches!(bytes, [0xff, 0xfe, ..] | [0xfe, 0xff, ..]) { "UTF-16 text" } else { "binary data" };
    Err(SceneError::at(format!("byte {at}"), what)
        .expected(format!("{format} text"))
        .cure("save the file as UTF-8 or ASCII text"))
}

/// Takes the next physical line, without its end.
fn split_line<'a>(rest: &mut &'a [u8]) -> Option<&'a [u8]> {
    if rest.is_empty() {
        return None;
    }
    let end = rest.iter().position(|byte| matches!(byte, b'\n' | b'\r')).unwrap_or(rest.len());
    let (line, behind) = rest.split_at(end);
    *rest = match behind {
        [b'\r', b'\n', next @ ..] | [_, next @ ..] => next,
        [] => &[],
    };
    Some(line)
}

/// A line up to its comment.
///
/// In statements with names a comment is a `#` that is a word of its own, since `Material #25` is a common name. Elsewhere it
/// is any `#`.
fn without_comment<'a>(line: &'a [u8], keyword: &[u8]) -> &'a [u8] {
    let is_space = |byte: Option<&u8>| byte.is_none_or(u8::is_ascii_whitespace);
    let named = takes_name(keyword);
    let begins_comment = |at: usize| {
        let alone = is_space(at.checked_sub(1).and_then(|before| line.get(before))) && is_space(line.get(at + 1));
        line.get(at) == Some(&b'#') && (!named || alone)
    };
    let end = (0..line.len()).find(|at| begins_comment(*at)).unwrap_or(line.len());
    line.get(..end).unwrap_or(line)
}

/// True for statements whose argument is a name.
pub(super) fn takes_name(keyword: &[u8]) -> bool {
    const NAMED: [&[u8]; 10] = [b"o", b"g", b"usemtl", b"mtllib", b"newmtl", b"bump", b"disp", b"decal", b"norm", b"refl"];
    let keyword = keyword.to_ascii_lowercase();
    NAMED.contains(&keyword.as_slice()) || keyword.starts_with(b"map_")
}

/// Returns the first word of a text, and the rest without surrounding blanks.
pub(super) fn keyword_and_rest(text: &[u8]) -> (&[u8], &[u8]) {
    let text = text.trim_ascii();
    let end = text.iter().position(u8::is_ascii_whitespace).unwrap_or(text.len());
    let (word, rest) = text.split_at(end);
    (word, rest.trim_ascii_start())
}

pub(super) fn words(text: &[u8]) -> impl Iterator<Item = &[u8]> {
    text.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty())
}

/// A name as text: bytes that are no UTF-8 and control characters are escaped.
pub(super) fn escaped(name: &[u8]) -> String {
    let mut text = String::new();
    for chunk in name.utf8_chunks() {
        for c in chunk.valid().chars() {
            if c.is_control() { text.extend(c.escape_default()) } else { text.push(c) }
        }
        text.extend(chunk.invalid().escape_ascii().map(char::from));
    }
    text
}

/// A name for messages, shortened if it is long.
pub(super) fn shown(name: &[u8]) -> String {
    shorten(&escaped(name))
}

/// Up to `N` numbers, at least `least` of them, and how many there are. Missing numbers are 0.
///
/// # Errors
/// Too few numbers, or one that single precision cannot hold.
pub(super) fn numbers<const N: usize>(text: &[u8], least: usize) -> Result<(usize, [f64; N]), SceneError> {
    let mut values = [0.0; N];
    let mut count = 0;
    for (value, word) in values.iter_mut().zip(words(text)) {
        *value = number(word).ok_or_else(|| {
            SceneError::at("", format!("`{}`", shown(word)))
                .expected("a finite number of single precision")
                .cure("correct it or export the file again")
        })?;
        count += 1;
    }
    if count < least {
        return Err(SceneError::at("", format!("{count} numbers")).expected(format!("at least {least}")));
    }
    Ok((count, values))
}

/// The number that a word says, if single precision can hold it.
pub(super) fn number(word: &[u8]) -> Option<f64> {
    let value: f64 = std::str::from_utf8(word).ok()?.parse().ok()?;
    (value as f32).is_finite().then_some(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(text: &[u8]) -> Vec<(usize, String)> {
        lines(text).map(|line| (line.number, String::from_utf8_lossy(&line.text).into_owned())).collect()
    }

    fn line(number: usize, text: &str) -> (usize, String) {
        (number, text.into())
    }

    #[test]
    fn three_kinds_of_line_ends_are_read() {
        assert_eq!(texts(b"a\rb\r\nc\n\nd"), [line(1, "a"), line(2, "b"), line(3, "c"), line(4, ""), line(5, "d")]);
    }

    #[test]
    fn byte_order_mark_is_skipped() {
        assert_eq!(texts(b"\xef\xbb\xbfv 1"), [line(1, "v 1")]);
    }

    #[test]
    fn backslash_continues_a_line() {
        assert_eq!(texts(b"f 1 \\\n2 \\\r\n3\nv\\"), [line(1, "f 1  2  3"), line(4, "v ")]);
    }

    #[test]
    fn backslash_in_a_comment_continues_nothing() {
        assert_eq!(texts(b"# C:\\models\\\nv 1 # x\\\nv 2"), [line(1, ""), line(2, "v 1 "), line(3, "v 2")]);
    }

    #[test]
    fn number_sign_in_a_name_is_no_comment() {
        assert_eq!(
            texts(b"usemtl Material #1\nnewmtl a#b # c\nv 1 2#c"),
            [line(1, "usemtl Material #1"), line(2, "newmtl a#b "), line(3, "v 1 2"),]
        );
    }

    #[test]
    fn names_that_are_not_utf8_are_escaped() {
        assert_eq!(shown(b"\xba\xec w\x1b"), "\\xba\\xec w\\u{1b}");
        assert_eq!(shown("ä b".as_bytes()), "ä b");
    }
}
