//! Damages to an input.

use super::random::RandomChoice as _;
use basrelief_dse::SplitMix64;
use serde_json::{Value, json};

/// Unusual numbers.
pub const ODD_NUMBERS: [&str; 18] = [
    "0",
    "-0",
    "-1",
    "1",
    "2",
    "255",
    "65535",
    "65536",
    "2147483648",
    "4294967295",
    "18446744073709551615",
    "99999999999999999999",
    "0.5",
    "1e-40",
    "1e38",
    "-1e38",
    "1e308",
    "nan",
];

/// Returns the number of places: mostly one, because the first of many keeps the others from being read.
fn places(random: &mut SplitMix64) -> usize {
    *random.one(&[1, 1, 1, 2, 4])
}

/// Damages bytes in a few places.
pub fn bytes(bytes: &mut Vec<u8>, random: &mut SplitMix64) {
    for _ in 0..places(random) {
        let at = random.below(bytes.len());
        let end = (at + 1 + random.below(64)).min(bytes.len());
        match random.below(8) {
            0 => bytes.truncate(at),
            1 => drop(bytes.drain(at..end)),
            2 => {
                let part = bytes[at..end].to_vec();
                bytes.splice(at..at, part);
            }
            3 => bytes.insert(at, random.byte()),
            4 => overwrite(bytes, at, &odd_float(random).to_le_bytes()),
            5 => overwrite(bytes, at, &(1u64 << random.below(64)).to_le_bytes()),
            _ => overwrite(bytes, at, &[random.byte()]),
        }
    }
}

fn overwrite(bytes: &mut [u8], at: usize, with: &[u8]) {
    bytes.iter_mut().skip(at).zip(with).for_each(|(byte, new)| *byte = *new);
}

fn odd_float(random: &mut SplitMix64) -> f32 {
    *random.one(&[f32::NAN, f32::INFINITY, -1e30, 1e30, f32::MAX, f32::MIN_POSITIVE, -0.0, 1e-40, 3.5])
}

/// Damages a text: lines and words are lost, doubled, moved, or replaced by unexpected numbers.
pub fn text(text: &str, random: &mut SplitMix64) -> String {
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    for _ in 0..places(random) {
        let at = random.below(lines.len());
        let Some(line) = lines.get(at).cloned() else { return String::new() };
        match random.below(6) {
            0 => drop(lines.remove(at)),
            1 => lines.insert(random.below(lines.len()), line),
            2 => {
                let other = random.below(lines.len());
                lines.swap(at, other);
            }
            _ => lines[at] = words(&line, random),
        }
    }
    lines.join("\n") + "\n"
}

/// Replaces one word by another, if the line has any.
fn words(line: &str, random: &mut SplitMix64) -> String {
    let mut words: Vec<&str> = line.split(' ').collect();
    let other = *random.one(&words);
    let at = random.below(words.len());
    words[at] = if random.once_in(3) { other } else { *random.one(&ODD_NUMBERS) };
    words.join(" ")
}

/// Damages a JSON document in a few places.
pub fn document(document: &mut Value, random: &mut SplitMix64) {
    for _ in 0..places(random) {
        let mut all = Vec::new();
        pointers(document, String::new(), &mut all);
        let place = random.one(&all).clone();
        if let Some(value) = document.pointer_mut(&place) {
            spoil(value, random);
        }
    }
}

fn pointers(value: &Value, prefix: String, all: &mut Vec<String>) {
    let escaped = |key: &str| key.replace('~', "~0").replace('/', "~1");
    match value {
        Value::Object(map) => map.iter().for_each(|(k, v)| pointers(v, format!("{prefix}/{}", escaped(k)), all)),
        Value::Array(list) => list.iter().enumerate().for_each(|(i, v)| pointers(v, format!("{prefix}/{i}"), all)),
        _ => {}
    }
    all.push(prefix);
}

fn spoil(value: &mut Value, random: &mut SplitMix64) {
    match value {
        Value::Object(map) if random.once_in(2) => {
            let keys: Vec<String> = map.keys().cloned().collect();
            if !keys.is_empty() {
                map.remove(random.one(&keys));
            }
        }
        Value::Array(list) if !list.is_empty() && random.once_in(2) => {
            let item = random.one(list).clone();
            let times = *random.one(&[1, 1, 1, 2, 100, 3000]);
            list.extend(std::iter::repeat_n(item, times));
        }
        other => *other = odd_value(random),
    }
}

fn odd_value(random: &mut SplitMix64) -> Value {
    let fixed = [json!(null), json!([]), json!({}), json!("x"), json!(true), json!("data:;base64,AAAA"), json!([0, 0, 0])];
    match random.below(4) {
        0 => random.one(&fixed).clone(),
        1 => json!(1u64 << random.below(64)),
        2 => json!(random.below(12)),
        _ => random.one(&ODD_NUMBERS).parse::<serde_json::Number>().map_or(Value::Null, Value::Number),
    }
}
