//! One line of `apitrace dump`: a call with its arguments.

/// A call of a trace.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct TraceCall<'a> {
    pub number: u64,
    pub name: &'a str,
    arguments: Vec<(&'a str, &'a str)>,
    /// Returned value, possibly with a comment behind it.
    result: &'a str,
}

impl<'a> TraceCall<'a> {
    /// Parses `NUMBER NAME(ARGUMENT = VALUE, ...) = RESULT`; `None` for another line.
    pub fn parse(line: &'a str) -> Option<Self> {
        let (number, rest) = line.split_once(' ')?;
        let (name, rest) = rest.split_once('(')?;
        let number = number.parse().ok()?;
        let (arguments, result) = arguments(rest);
        Some(Self { number, name, arguments, result })
    }

    /// Returns the text of an argument.
    pub fn text(&self, name: &str) -> Option<&'a str> {
        self.arguments.iter().find(|(known, _)| *known == name).map(|(_, value)| *value)
    }

    /// Returns an argument that is a whole number or a pointer.
    pub fn number(&self, name: &str) -> Option<u64> {
        number(self.text(name)?)
    }

    /// Returns the number of the display list that it compiles or calls.
    pub fn list(&self) -> u64 {
        self.number("list").unwrap_or_default()
    }

    /// Returns true if the display list that it begins is also executed.
    pub fn executes_list(&self) -> bool {
        self.text("mode") == Some("GL_COMPILE_AND_EXECUTE")
    }

    /// Returns the numbers of all arguments but constants, with the elements of lists.
    pub fn all_numbers(&self) -> Vec<f64> {
        let elements = self.arguments.iter().flat_map(|(_, value)| value.trim_matches(['{', '}']).split(','));
        elements.filter_map(|element| element.trim().parse().ok()).collect()
    }

    /// Returns the file name of an argument that is a blob.
    pub fn blob(&self, name: &str) -> Option<&'a str> {
        self.text(name)?.strip_prefix("blob(\"")?.strip_suffix("\")")
    }

    /// Returns a string argument.
    pub fn string(&self, name: &str) -> Option<&'a str> {
        self.text(name)?.strip_prefix('"')?.strip_suffix('"')
    }

    /// Returns the returned number or pointer.
    pub fn returned(&self) -> Option<u64> {
        number(self.result.strip_prefix("= ")?.split(' ').next()?)
    }
}

fn number(text: &str) -> Option<u64> {
    match text.strip_prefix("0x") {
        Some(digits) => u64::from_str_radix(digits, 16).ok(),
        None if text == "NULL" => Some(0),
        None => text.parse().ok(),
    }
}

/// Splits the text behind the opening parenthesis into arguments and the rest behind the closing one.
fn arguments(text: &str) -> (Vec<(&str, &str)>, &str) {
    let (mut result, mut depth, mut start) = (Vec::new(), 0_u32, 0);
    let (mut quoted, mut escaped) = (false, false);
    for (at, byte) in text.bytes().enumerate() {
        if quoted {
            quoted = escaped || byte != b'"';
            escaped = byte == b'\\' && !escaped;
            continue;
        }
        let ends = depth == 0 && matches!(byte, b',' | b')');
        if ends {
            let argument = text.get(start..at).and_then(|text| text.trim().split_once(" = "));
            result.extend(argument);
            start = at + 1;
        }
        match byte {
            b'"' => quoted = true,
            b'(' | b'{' => depth += 1,
            b')' if depth == 0 => return (result, text.get(at + 1..).unwrap_or_default().trim()),
            b')' | b'}' => depth = depth.saturating_sub(1),
            _ => {}
        }
    }
    (result, "")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arguments_with_lists_texts_and_blobs_are_split() {
        let line = r#"12 f(a = {1, 2}, s = "x, (\"y", p = 0x1c, data = blob("b.bin"), m = GL_A | GL_B, n = NULL) = 0x7f // fake"#;
        let call = TraceCall::parse(line).unwrap();
        assert_eq!((call.number, call.name, call.returned()), (12, "f", Some(0x7f)));
        assert_eq!([call.text("a"), call.text("m"), call.string("s")], [Some("{1, 2}"), Some("GL_A | GL_B"), Some("x, (\\\"y")]);
        assert_eq!([call.number("p"), call.number("n"), call.number("m")], [Some(28), Some(0), None]);
        assert_eq!((call.blob("data"), call.blob("p")), (Some("b.bin"), None));
        assert_eq!(TraceCall::parse("1 f(t = GL_TEXTURE0, v = {1, -2e-3}, w = 3)").unwrap().all_numbers(), [1.0, -0.002, 3.0]);
    }

    #[test]
    fn other_lines_are_no_calls() {
        for line in ["", "// process.name = \"x\"", "x f()", "7 f"] {
            assert_eq!(TraceCall::parse(line), None, "{line}");
        }
        assert_eq!(TraceCall::parse("7 f()").unwrap().returned(), None);
        assert!(TraceCall::parse("7 f(a = \"").is_some());
    }
}
