//! Builder of well-formed markup: it escapes text and closes every element.

use std::fmt::Write;

/// Elements without an end tag.
const VOID: [&str; 3] = ["meta", "img", "wbr"];

/// A piece of a page.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Html(String);

impl Html {
    /// A style sheet of a program.
    pub fn style(sheet: &'static str) -> Self {
        Self(format!("<style>{sheet}</style>"))
    }

    /// A script of a program, which must not hold `</script`; the policy of the page must name its hash.
    pub fn script(code: &'static str) -> Self {
        Self(format!("<script>{code}</script>"))
    }

    /// Returns data for a script as an element with this id. The data may hold any text, because each `<` is escaped.
    pub fn data(id: &str, value: &serde_json::Value) -> Self {
        let json = value.to_string().replace('<', "\\u003c");
        Self(format!("<script type=\"application/json\" id=\"{}\">{json}</script>\n", escape(id)))
    }

    /// Returns true if the markup is empty.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Returns the markup as text.
    pub fn into_text(self) -> String {
        self.0
    }
}

impl FromIterator<Html> for Html {
    fn from_iter<T: IntoIterator<Item = Html>>(pieces: T) -> Self {
        Self(pieces.into_iter().map(|piece| piece.0).collect())
    }
}

/// A text, escaped. A percent sign stays in the line of its number.
pub fn text(text: impl AsRef<str>) -> Html {
    Html(escape(text.as_ref()).replace(" %", "\u{a0}%"))
}

/// Names, escaped, with places for line breaks after the separators within them.
pub fn breakable(names: impl AsRef<str>) -> Html {
    let parts = names.as_ref().split_inclusive(['.', '_']);
    let place = |part: &str| if part.ends_with(['.', '_']) { el("wbr", &[], []) } else { Html::default() };
    parts.flat_map(|part| [text(part), place(part)]).collect()
}

/// Returns an element with attributes and children.
pub fn el(name: &str, attributes: &[(&str, &str)], children: impl IntoIterator<Item = Html>) -> Html {
    let mut out = format!("<{name}");
    for (key, value) in attributes {
        let _ = write!(out, " {key}=\"{}\"", escape(value));
    }
    if VOID.contains(&name) {
        return Html(out + "/>");
    }
    out.push('>');
    children.into_iter().for_each(|child| out.push_str(&child.0));
    let _ = write!(out, "</{name}>");
    // A line per block keeps the file readable and its differences small.
    if matches!(name, "p" | "tr" | "section" | "g" | "figure" | "svg" | "table" | "h2" | "h3") {
        out.push('\n');
    }
    Html(out)
}

/// An element that holds a text, with its class where that is not empty.
pub fn el_text(name: &str, class: &str, content: impl AsRef<str>) -> Html {
    let class = [("class", class)];
    el(name, if class[0].1.is_empty() { &[] } else { &class }, [text(content)])
}

/// Returns a sentence in which the parts between backticks are code.
pub fn sentence(sentence: &str) -> Html {
    let parts = sentence.split('`').enumerate();
    parts.map(|(i, part)| if i % 2 == 1 { el_text("code", "", part) } else { text(part) }).collect()
}

/// Returns a collapsed block with a title.
pub fn details(title: &str, content: Html) -> Html {
    if content.is_empty() { content } else { el("details", &[], [el_text("summary", "", title), content]) }
}

/// Control characters, which a page must not hold, become blanks.
fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            '\n' => out.push('\n'),
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_and_attributes_are_escaped() {
        let page = el("p", &[("title", "\"><script>")], [text("a < b & 'c'\u{0}")]);
        assert_eq!(page.into_text(), "<p title=\"&quot;&gt;&lt;script&gt;\">a &lt; b &amp; &#39;c&#39; </p>\n");
    }

    #[test]
    fn percent_signs_stay_with_their_numbers() {
        assert_eq!(text("48.5 % of 7").into_text(), "48.5\u{a0}% of 7");
    }

    #[test]
    fn names_between_backticks_are_code() {
        assert_eq!(sentence("The unit `a<b` waits.").into_text(), "The unit <code>a&lt;b</code> waits.");
    }

    #[test]
    fn long_names_break_at_their_separators() {
        assert_eq!(breakable("fifo.a_b, c<").into_text(), "fifo.<wbr/>a_<wbr/>b, c&lt;");
    }

    #[test]
    fn data_cannot_end_its_element() {
        let data = Html::data("rows", &serde_json::json!(["</script><script>"])).into_text();
        assert_eq!(data, "<script type=\"application/json\" id=\"rows\">[\"\\u003c/script>\\u003cscript>\"]</script>\n");
    }

    #[test]
    fn void_elements_have_no_end() {
        assert_eq!(el("img", &[("alt", "x")], []).into_text(), "<img alt=\"x\"/>");
        assert_eq!(el_text("b", "", "x").into_text(), "<b>x</b>");
        assert!(details("empty", Html::default()).is_empty());
    }
}
