//! Values on the command line, checked where they are given.

use crate::outputs::not_stdout;
use basrelief_dse::Budget;
use basrelief_report::TableGroup;
use basrelief_scene::ZOOM;
pub use basrelief_scene::text::{angles, direction, finite, size};
use basrelief_sim::{MACHINES, MachineInfo};
use clap::builder::{PathBufValueParser, PossibleValue, PossibleValuesParser, TypedValueParser};
use std::net::SocketAddr;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::time::Duration;
use ureq::http::Uri;
use ureq::http::uri::Authority;

/// The name of a machine.
pub fn machine() -> impl TypedValueParser<Value = &'static MachineInfo> {
    let names = MACHINES.iter().map(|m| PossibleValue::new(m.name).help(m.about));
    PossibleValuesParser::new(names).try_map(|name| MachineInfo::named(&name))
}

/// Tables of a report, by one name.
#[derive(Clone, Debug)]
pub struct TableSelection(pub Vec<TableGroup>);

/// Name of the table of bottlenecks in version 0.1.
const OLD_BOTTLENECKS: &str = "limits";

/// Names of tables, or of all of them.
pub fn tables() -> impl TypedValueParser<Value = TableSelection> {
    let names = TableGroup::ALL.iter().map(|of| {
        let value = PossibleValue::new(of.name()).help(of.about());
        if *of == TableGroup::Bottlenecks { value.alias(OLD_BOTTLENECKS) } else { value }
    });
    let all = PossibleValue::new("all").help("All of them");
    PossibleValuesParser::new(names.chain([all])).map(|name| {
        let name = if name == OLD_BOTTLENECKS { TableGroup::Bottlenecks.name() } else { name.as_str() };
        let named = TableGroup::ALL.iter().copied().filter(|of| name == "all" || name == of.name());
        TableSelection(named.collect())
    })
}

/// The path of an output: a file.
pub fn output_file() -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new().try_map(|path| not_stdout(&path).map(|()| path.clone()))
}

/// The path of waveforms.
pub fn wave_file() -> impl TypedValueParser<Value = PathBuf> {
    file_in_format("fst", false)
}

/// The path of token paths.
pub fn token_file() -> impl TypedValueParser<Value = PathBuf> {
    file_in_format("kanata", true)
}

/// The path of a record of wires.
pub fn wire_file() -> impl TypedValueParser<Value = PathBuf> {
    file_in_format("wires", true)
}

/// The path of an output in one format, with its ending or none. The ending of another format is an error. `.zst` is written in small letters,
/// because only that name compresses the file.
fn file_in_format(format: &'static str, may_be_compressed: bool) -> impl TypedValueParser<Value = PathBuf> {
    output_file().try_map(move |path: PathBuf| {
        let is_compressed = may_be_compressed && path.extension().is_some_and(|ending| ending == "zst");
        let name = path.file_stem().filter(|_| is_compressed).map_or(&*path, Path::new);
        if name.extension().is_none_or(|ending| ending.eq_ignore_ascii_case(format)) {
            return Ok(path);
        }
        let compressed = if may_be_compressed { format!(" or .{format}.zst") } else { String::new() };
        Err(format!("expected a name that ends in .{format}{compressed}, the format that is written"))
    })
}

/// Parses the name of a host.
pub fn host_name(text: &str) -> Result<String, String> {
    let is_name = text.parse::<Authority>().is_ok_and(|name| name.host() == text && !text.is_empty());
    if is_name {
        Ok(text.into())
    } else {
        Err("expected the name of a host, such as simulator.example, without scheme and port".into())
    }
}

/// The address of a server.
pub fn http(url: &str) -> Result<String, String> {
    let expected = "expected http://ADDRESS:PORT/";
    let uri: Uri = url.parse().map_err(|e| format!("{expected}: {e}"))?;
    let port_or_none = |a: &Authority| a.port_u16().is_some() || a.as_str() == a.host();
    let named = uri.authority().is_some_and(|a| !a.host().is_empty() && port_or_none(a)) && !url.contains(['@', '#']);
    if uri.scheme_str() == Some("http") && named && uri.query().is_none() { Ok(url.into()) } else { Err(expected.into()) }
}

/// Parses the origin of web pages.
pub fn origin(text: &str) -> Result<String, String> {
    let uri = text.parse::<Uri>().ok().filter(|uri| uri.scheme().is_some() && uri.authority().is_some());
    let is_origin = text == "*" || uri.is_some_and(|uri| uri.path_and_query().is_none_or(|path| path == "/"));
    let origin = text.trim_end_matches('/');
    if is_origin { Ok(origin.into()) } else { Err("expected SCHEME://HOST:PORT, such as http://localhost:3000, or `*`".into()) }
}

/// Parses the budget of an exploration: a number of points, or seconds.
pub fn budget(text: &str) -> Result<Budget, String> {
    let points = text.parse().ok().filter(|points| *points > 0).map(Budget::Points);
    let seconds = text.strip_suffix('s').and_then(|seconds| seconds.parse::<f64>().ok()).filter(|seconds| *seconds > 0.0);
    let time = seconds.and_then(|seconds| Duration::try_from_secs_f64(seconds).ok()).map(Budget::Time);
    points.or(time).ok_or_else(|| "expected a number of points such as 40, or seconds such as 90s".into())
}

/// An address to listen at.
pub fn socket(text: &str) -> Result<SocketAddr, String> {
    text.parse().map_err(|_| "expected ADDRESS:PORT in numbers, such as 127.0.0.1:8080 or [::1]:8080".into())
}

/// A setting.
pub fn key_value(text: &str) -> Result<(String, String), String> {
    let (key, value) = text.split_once('=').ok_or("expected KEY=VALUE, such as replacement.entries=64")?;
    Ok((key.trim().into(), value.trim().into()))
}

/// A whole number among these.
pub fn whole<T: TryFrom<u64>>(allowed: RangeInclusive<u64>) -> impl Fn(&str) -> Result<T, String> + Clone {
    move |text| {
        let number = text.parse().ok().filter(|number| allowed.contains(number)).and_then(|number| T::try_from(number).ok());
        number.ok_or_else(|| format!("expected a whole number from {} to {}", allowed.start(), allowed.end()))
    }
}

/// A share of all.
pub fn percent(text: &str) -> Result<f64, String> {
    number_in(text, 0.0..=100.0)
}

/// A zoom factor.
pub fn zoom(text: &str) -> Result<f64, String> {
    number_in(text, ZOOM)
}

fn number_in(text: &str, allowed: RangeInclusive<f64>) -> Result<f64, String> {
    let expected = || format!("expected a number from {} to {}", allowed.start(), allowed.end());
    finite(text).ok().filter(|number| allowed.contains(number)).ok_or_else(expected)
}

/// An allowed increase \[%\].
pub fn tolerance(text: &str) -> Result<f64, String> {
    finite(text).ok().filter(|percent| *percent >= 0.0).ok_or_else(|| "expected a percentage of 0 or more".into())
}

/// One of several parts of a plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// Number of the part, from 1.
    pub number: usize,
    /// Number of parts.
    pub count: usize,
}

/// A part of several.
pub fn shard(text: &str) -> Result<Shard, String> {
    let parts = text.split_once('/').and_then(|(number, count)| Some((number.parse().ok()?, count.parse().ok()?)));
    let shard = parts.map(|(number, count)| Shard { number, count }).filter(|s| (1..=s.count).contains(&s.number));
    shard.ok_or_else(|| "expected I/N, I from 1 to N, such as 2/8".into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use basrelief_scene::ViewOptions;

    #[test]
    fn whole_number_lies_in_its_range() {
        let small = whole::<u8>(1..=300);
        assert_eq!(small("200"), Ok(200));
        for bad in ["0", "256", "301", "-1", "1.5", "", "99999999999999999999"] {
            assert_eq!(small(bad), Err("expected a whole number from 1 to 300".into()), "{bad}");
        }
    }

    #[test]
    fn setting_is_split_into_key_and_value() {
        assert_eq!(key_value("a.b=[1, 2]"), Ok(("a.b".into(), "[1, 2]".into())));
        assert!(key_value("a.b").is_err());
        assert_eq!(shard("2/8"), Ok(Shard { number: 2, count: 8 }));
        assert!(["0/8", "9/8", "1/0", "-1/2", "1", "a/b", "1/2/3"].iter().all(|wrong| shard(wrong).is_err()));
        assert_eq!(percent("12.5"), Ok(12.5));
        assert!(percent("-1").is_err() && percent("101").is_err() && percent("NaN").is_err());
    }

    #[test]
    fn zoom_and_tolerance_lie_in_their_ranges() {
        let options = |zoom| ViewOptions { zoom: Some(zoom), ..ViewOptions::default() };
        for (text, factor) in [("0.01", 0.01), ("100", 100.0)] {
            assert_eq!(zoom(text), Ok(factor));
            assert!(basrelief_scene::demo("turntable", &options(factor)).is_ok(), "the range of the importer");
        }
        for wrong in ["0", "-1", "0.009", "101", "inf", "x"] {
            assert_eq!(zoom(wrong), Err("expected a number from 0.01 to 100".into()), "{wrong}");
        }
        assert_eq!((tolerance("0"), tolerance("150")), (Ok(0.0), Ok(150.0)));
        for wrong in ["-1", "nan", "inf", "x"] {
            assert_eq!(tolerance(wrong), Err("expected a percentage of 0 or more".into()), "{wrong}");
        }
    }

    #[test]
    fn origin_has_scheme_and_host() {
        assert_eq!(origin("http://localhost:3000/"), Ok("http://localhost:3000".into()));
        assert_eq!(origin("*"), Ok("*".into()));
        assert!(["localhost", "http://a/b", "http://a\r\nx: y", ""].iter().all(|wrong| origin(wrong).is_err()));
    }

    #[test]
    fn listen_address_must_be_numeric() {
        assert!(["127.0.0.1:0", "[::1]:8080"].iter().all(|right| socket(right).is_ok()));
        for wrong in ["localhost:80", "127.0.0.1", "::1:80", "127.0.0.1:99999", ":80"] {
            assert!(socket(wrong).unwrap_err().contains("such as 127.0.0.1:8080"), "{wrong}");
        }
    }

    #[test]
    fn server_address_must_be_http_with_host() {
        for right in ["http://127.0.0.1:8080/", "http://[::1]:8080", "http://host/below/"] {
            assert_eq!(http(right).as_deref(), Ok(right));
        }
        for wrong in [
            "127.0.0.1:8080",
            "localhost",
            "https://x/",
            "http://",
            "http://:80/",
            "http://a b/",
            "http://a:99999/",
            "http://a@b/",
            "http://a/?b",
        ] {
            assert!(http(wrong).unwrap_err().contains("expected http://ADDRESS:PORT/"), "{wrong}");
        }
    }
}
