//! Command lines that make little sense.

use super::mutate::ODD_NUMBERS;
use super::random::RandomChoice as _;
use super::settings::setting;
use basrelief_dse::SplitMix64;
use basrelief_sim::{MACHINES, MachineInfo};

/// Command lines, with `FILE` for a trace and `MODEL` for a model.
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
    "run --from http://127.0.0.1:1/ --wait 0",
];

const OPTIONS: [&str; 30] = [
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
    "--timeline t.pftrace --units replacement --from-cycle N",
    "--waves w.fst --to-cycle N",
    "--requests r.csv",
    "--requests-format dramsim3",
    "--dump spans s.jsonl",
    "--dump tiles s.jsonl",
    "--memory-limit 100KiB",
    "--memory-limit N",
    "--camera FILE",
];

/// Returns a command line.
pub fn command_line(random: &mut SplitMix64) -> Vec<String> {
    let mut words: Vec<String> = random.one(&COMMANDS).split(' ').map(str::to_owned).collect();
    let simulates = ["run", "demo"].contains(&words[0].as_str());
    if simulates {
        // Small and short, unless the following options override it.
        words.extend(["--max-cycles", *random.one(&["100", "50000", "200000"]), "--out", "out"].map(str::to_owned));
        if words.iter().any(|w| w == "MODEL") || words[0] == "demo" {
            words.extend(["--size", "32x24"].map(str::to_owned));
        }
    }
    for _ in 0..random.below(3) {
        words.extend(random.one(&OPTIONS).split(' ').map(str::to_owned));
    }
    if simulates || random.once_in(4) {
        let machine = machine_of(&words);
        for _ in 0..random.below(3) {
            let (key, value) = setting(machine, random);
            words.extend(["--set".to_owned(), format!("{key}={value}")]);
        }
    }
    if random.once_in(8) {
        words.remove(random.below(words.len()));
    }
    let number = |word: String, random: &mut SplitMix64| word.replace('N', random.one::<&str>(&ODD_NUMBERS));
    words.into_iter().map(|w| if w.contains('N') { number(w, random) } else { w }).collect()
}

/// Returns the machine that these words select, or the first machine if they name none.
fn machine_of(words: &[String]) -> &'static MachineInfo {
    let named = words.iter().skip_while(|word| *word != "--machine").nth(1);
    named.and_then(|name| MachineInfo::named(name).ok()).unwrap_or(&MACHINES[0])
}
