//! Command lines that make little sense.

use super::chance::Chance;
use super::mutate::ODD_NUMBERS;
use basrelief_session::MACHINES;

/// What may stand on a command line, as `FILE` a trace and as `MODEL` a model.
const COMMANDS: [&str; 12] = [
    "run FILE",
    "run MODEL",
    "demo",
    "demo coin",
    "record MODEL --out t.jsonl",
    "record demo:brick --expect --out t.bdl",
    "convert FILE t.bdl.zst",
    "verify FILE",
    "describe",
    "schema report",
    "compare FILE FILE",
    "run --from http://127.0.0.1:1/",
];

const OPTIONS: [&str; 28] = [
    "--machine shade",
    "--machine texel",
    "--machine defer",
    "--machine bump",
    "--machine none",
    "--size 24x18",
    "--size 0x1",
    "--size 16384x16384",
    "--size 1x4096",
    "--frames 3",
    "--frames 0",
    "--orbit N",
    "--light N,N,N",
    "--light-orbit N",
    "--functional",
    "--engine ticked",
    "--json",
    "--csv",
    "--no-exact",
    "--timeline t.pftrace",
    "--timeline out/image.png",
    "--requests r.csv",
    "--requests-format dramsim3",
    "--dump spans s.jsonl",
    "--dump tiles s.jsonl",
    "--memory-limit 100KiB",
    "--memory-limit N",
    "--camera FILE",
];

/// A command line.
pub fn command_line(chance: &mut Chance) -> Vec<String> {
    let mut words: Vec<String> = chance.one(&COMMANDS).split(' ').map(str::to_owned).collect();
    let simulates = ["run", "demo"].contains(&words[0].as_str());
    if simulates {
        // Small and short, unless what follows says otherwise.
        words.extend(["--max-cycles", *chance.one(&["100", "50000", "200000"]), "--out", "out"].map(str::to_owned));
        if words.iter().any(|w| w == "MODEL") || words[0] == "demo" {
            words.extend(["--size", "32x24"].map(str::to_owned));
        }
    }
    for _ in 0..chance.below(3) {
        words.extend(chance.one(&OPTIONS).split(' ').map(str::to_owned));
    }
    for _ in 0..chance.below(3) {
        words.extend(["--set".to_owned(), setting(chance)]);
    }
    if chance.once_in(8) {
        words.remove(chance.below(words.len()));
    }
    let number = |word: String, chance: &mut Chance| word.replace('N', chance.one::<&str>(&ODD_NUMBERS));
    words.into_iter().map(|w| if w.contains('N') { number(w, chance) } else { w }).collect()
}

/// A parameter of some machine, with a value near its default, at the ends of its range, or out of it.
pub fn setting(chance: &mut Chance) -> String {
    let parameters = chance.one(MACHINES).parameters();
    let parameter = chance.one(&parameters);
    let ends: Vec<&str> = parameter.range.split("..=").collect();
    let value = match chance.below(5) {
        0 => parameter.default.to_string(),
        1 => (*chance.one(&ODD_NUMBERS)).to_owned(),
        2 => (*chance.one(&["true", "[]", "[1, 2]", "\"x\"", "", "{}", "identical", "per_polygon", "after_list"])).to_owned(),
        _ => (*chance.one(&ends)).to_owned(),
    };
    format!("{}={value}", parameter.key)
}
