//! Damages to an input.

use super::chance::Chance;
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
fn places(chance: &mut Chance) -> usize {
    *chance.one(&[1, 1, 1, 2, 4])
}

/// Damages bytes in a few places.
pub fn bytes(bytes: &mut Vec<u8>, chance: &mut Chance) {
    for _ in 0..places(chance) {
        let at = chance.below(bytes.len());
        let end = (at + 1 + chance.below(64)).min(bytes.len());
        match chance.below(8) {
            0 => bytes.truncate(at),
            1 => drop(bytes.drain(at..end)),
            2 => {
                let part = bytes[at..end].to_vec();
                bytes.splice(at..at, part);
            }
            3 => bytes.insert(at, chance.byte()),
            4 => overwrite(bytes, at, &odd_float(chance).to_le_bytes()),
            5 => overwrite(bytes, at, &(1u64 << chance.below(64)).to_le_bytes()),
            _ => overwrite(bytes, at, &[chance.byte()]),
        }
    }
}

fn overwrite(bytes: &mut [u8], at: usize, with: &[u8]) {
    bytes.iter_mut().skip(at).zip(with).for_each(|(byte, new)| *byte = *new);
}

fn odd_float(chance: &mut Chance) -> f32 {
    *chance.one(&[f32::NAN, f32::INFINITY, -1e30, 1e30, f32::MAX, f32::MIN_POSITIVE, -0.0, 1e-40, 3.5])
}

/// Damages a text: lines and words are lost, doubled, moved, or replaced by unexpected numbers.
pub fn text(text: &str, chance: &mut Chance) -> String {
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    for _ in 0..places(chance) {
        let at = chance.below(lines.len());
        let Some(line) = lines.get(at).cloned() else { return String::new() };
        match chance.below(6) {
            0 => drop(lines.remove(at)),
            1 => lines.insert(chance.below(lines.len()), line),
            2 => {
                let other = chance.below(lines.len());
                lines.swap(at, other);
            }
            _ => lines[at] = words(&line, chance),
        }
    }
    lines.join("\n") + "\n"
}

/// Replaces one word by another, if the line has any.
fn words(line: &str, chance: &mut Chance) -> String {
    let mut words: Vec<&str> = line.split(' ').collect();
    let other = *chance.one(&words);
    let at = chance.below(words.len());
    words[at] = if chance.once_in(3) { other } else { *chance.one(&ODD_NUMBERS) };
    words.join(" ")
}

/// Damages a JSON document in a few places.
pub fn document(document: &mut Value, chance: &mut Chance) {
    for _ in 0..places(chance) {
        let mut all = Vec::new();
        pointers(document, String::new(), &mut all);
        let place = chance.one(&all).clone();
        if let Some(value) = document.pointer_mut(&place) {
            spoil(value, chance);
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

fn spoil(value: &mut Value, chance: &mut Chance) {
    match value {
        Value::Object(map) if chance.once_in(2) => {
            let keys: Vec<String> = map.keys().cloned().collect();
            if !keys.is_empty() {
                map.remove(chance.one(&keys));
            }
        }
        Value::Array(list) if !list.is_empty() && chance.once_in(2) => {
            let item = chance.one(list).clone();
            let times = *chance.one(&[1, 1, 1, 2, 100, 3000]);
            list.extend(std::iter::repeat_n(item, times));
        }
        other => *other = odd_value(chance),
    }
}

fn odd_value(chance: &mut Chance) -> Value {
    let fixed = [json!(null), json!([]), json!({}), json!("x"), json!(true), json!("data:;base64,AAAA"), json!([0, 0, 0])];
    match chance.below(4) {
        0 => chance.one(&fixed).clone(),
        1 => json!(1u64 << chance.below(64)),
        2 => json!(chance.below(12)),
        _ => chance.one(&ODD_NUMBERS).parse::<serde_json::Number>().map_or(Value::Null, Value::Number),
    }
}
