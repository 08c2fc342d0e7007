//! Damaged plans, view files, and scenes of a server.

use super::mutate;
use super::random::RandomChoice as _;
use super::samples::{HostileCase, SHORT, SampleInputs, words};
use super::server::{HostileAnswers, TILES};
use basrelief_dse::SplitMix64;

const PLANS: [&str; 3] = [
    "title = \"a\"\ninput = \"t0.jsonl\"\nmachine = \"bump\"\nmax_cycles = 20000\nobjectives = [\"cycles min\", \"psnr max\"]\n\
     constraints = [\"cycles < 100000\"]\n[axes]\nreplacement.lanes = [16, 64]\nfifo.pixels.depth = { from = 8, to = 64, factor = 2 }\n",
    "input = [\"demo:cut-plane@1\", \"t0.jsonl\"]\nmachine = \"bump\"\nmax_cycles = 20000\nobjectives = [\"cycles min\"]\n\
     [axes]\nreplacement.entries = [[256, 128], 64]\n[[zip]]\nreplacement.lanes = [1, 2]\nbrightness.levels = [2, 4]\n\
     [[exclude]]\nreplacement.lanes = 1\nreplacement.entries = 64\n[samples]\nmethod = \"latin_hypercube\"\npoints = 4\nseed = 3\n",
    "input = \"demo:corridor\"\nmachine = \"texel\"\nmax_cycles = 20000\nobjectives = [{ figure = \"cycles\", goal = \"min\" }]\n\
     [view]\nsize = \"32x24\"\nturn = \"10,20\"\n[config.texel]\nmethod = \"adaptive\"\n[axes]\ntexel.error_bound = { from = 0.25, to = 1, step = 0.25 }\n",
];
const VIEWS: [&str; 3] = [
    "[[views]]\norbit = 30\nturn = [1, 2]\nzoom = 1.5\n[[views]]\nlight = [0, 0, 1]\nlight_orbit = 45\n",
    "views = [{ at_ms = 0 }, { at_ms = 200, orbit = 40 }, { at_ms = 500, orbit = 80 }]\n",
    "{\"views\": [\n{\"camera\": {\"view_projection\": [1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1], \"to_light\": [0,0,1], \"to_viewer\": [0,0,1]}},\n\
     {\"turn\": [3, 4]}\n]}\n",
];

/// Damages a text, and in one of four cases its bytes.
fn spoiled(text: &str, random: &mut SplitMix64) -> Vec<u8> {
    let mut bytes = mutate::text(text, random).into_bytes();
    if random.once_in(4) {
        mutate::bytes(&mut bytes, random);
    }
    bytes
}

/// Creates a damaged plan.
pub(super) fn plan(sources: &SampleInputs, random: &mut SplitMix64) -> HostileCase {
    let plan = spoiled(random.one::<&str>(&PLANS), random);
    let trace = ("t0.jsonl".to_owned(), sources.trace().as_bytes().to_vec());
    let line = match random.below(8) {
        0 => "explore p.toml --budget 3 --out out",
        1 => "sweep p.toml --list",
        _ => "sweep p.toml --threads 1 --no-pictures --out out",
    };
    HostileCase::of_files(vec![("p.toml".into(), plan), trace], words(line))
}

/// Creates a damaged list of views.
pub(super) fn views(random: &mut SplitMix64) -> HostileCase {
    let views = spoiled(random.one::<&str>(&VIEWS), random);
    let machine = random.one(&["defer", "bump", "texel", "shade"]);
    let line = format!("demo --machine {machine} --size 32x24 {SHORT} --views v.toml");
    HostileCase::of_files(vec![("v.toml".into(), views)], words(&line))
}

/// Creates a damaged scene of a server, or in one of eight cases damaged tiles.
pub(super) fn scene(sources: &SampleInputs, random: &mut SplitMix64) -> HostileCase {
    let (mut scene, mut seed) = (sources.scene().to_vec(), 0);
    if random.once_in(8) {
        seed = random.next_u64() | 1;
    } else {
        mutate::bytes(&mut scene, random);
    }
    let line = format!("run --from SERVER --wait 0 --size 32x24 {SHORT} {TILES} --set path.requests=1");
    HostileCase { served: Some(HostileAnswers { scene, seed }), ..HostileCase::of_files(vec![], words(&line)) }
}
