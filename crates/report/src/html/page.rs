//! The frame of a page: its policy, its style sheet, its sections.

use super::markup::{self, Html, el, el_text};

/// The style sheet of the page.
pub const STYLE: &str = include_str!("style.css");

/// Security policy: the page loads nothing and runs nothing.
pub(super) const POLICY: &str = "default-src 'none'; img-src data:; style-src 'unsafe-inline'";

/// Returns a page in the common style, from its title, security policy, additional style sheet and body.
pub fn whole_page(title: &str, policy: &str, style: &'static str, body: Html) -> String {
    let page = el("html", &[("lang", "en")], [page_head(title, policy, style), body]);
    format!("<!DOCTYPE html>\n{}\n", page.into_text())
}

fn page_head(title: &str, policy: &str, style: &'static str) -> Html {
    let meta = |attributes: &[(&str, &str)]| el("meta", attributes, []);
    let children = [
        meta(&[("charset", "utf-8")]),
        meta(&[("http-equiv", "Content-Security-Policy"), ("content", policy)]),
        meta(&[("name", "viewport"), ("content", "width=device-width, initial-scale=1")]),
        meta(&[("name", "color-scheme"), ("content", "light dark")]),
        el_text("title", "", title),
        Html::style(STYLE),
        if style.is_empty() { Html::default() } else { Html::style(style) },
    ];
    el("head", &[], children)
}

/// A part of a page under its heading.
pub fn section(id: &str, title: &str, content: Html) -> Html {
    let heading = format!("{id}-title");
    let title = el("h2", &[("id", &heading)], [markup::text(title)]);
    el("section", &[("id", id), ("aria-labelledby", &heading)], [title, content])
}
