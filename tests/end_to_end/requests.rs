//! `--requests`: the requests to the memories.

use crate::support::{Place, workspace};
use std::collections::BTreeMap;
use std::fs;

const CORRIDOR: &str = "demo corridor --size 48x36 --quiet";

/// Returns the fields of each line after the header.
fn lines(text: &str) -> Vec<Vec<&str>> {
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some("cycle,memory,client,operation,address,bytes"));
    lines.map(|line| line.split(',').collect()).collect()
}

#[test]
fn both_engines_write_the_same_requests() {
    let place = Place::new();
    for (name, line) in [("texel", CORRIDOR), ("bump", "run PATCH --size 48x36 --quiet --frames 2 --orbit 30")] {
        for engine in ["timed", "ticked"] {
            place.ok(&format!("{line} --no-exact --engine {engine} --requests {name}-{engine}.csv"));
            // In a run that is cut short, requests that have arrived are served completely.
            let cut = place.run(&format!("{line} --no-exact --engine {engine} --max-cycles 1500 --requests cut-{engine}.csv"));
            assert_eq!(cut.code(), 1, "{}", cut.err);
        }
        assert_eq!(place.text(&format!("{name}-timed.csv")), place.text(&format!("{name}-ticked.csv")), "{name}");
        let cut = place.text("cut-timed.csv");
        assert_eq!(cut, place.text("cut-ticked.csv"), "{name}");
        assert!(lines(&cut).len() > 10 && cut.len() < place.text(&format!("{name}-timed.csv")).len(), "{name}");
    }
}

#[test]
fn outputs_named_zst_are_compressed() {
    let place = Place::new();
    for ending in ["", ".zst"] {
        place.ok(&format!("{CORRIDOR} --no-exact --requests all.csv{ending} --timeline t.pftrace{ending}"));
    }
    for name in ["all.csv", "t.pftrace"] {
        let compressed = place.bytes(&format!("{name}.zst"));
        assert!(zstd::decode_all(&*compressed).unwrap() == place.bytes(name), "{name}");
    }
}

#[test]
fn all_requests_are_written_once_in_arrival_order() {
    let place = Place::new();
    place.ok(&format!("{CORRIDOR} --requests all.csv"));
    let text = place.text("all.csv");
    let (mut counted, mut bytes, mut sections) = (BTreeMap::new(), BTreeMap::new(), Vec::<(&str, u64)>::new());
    for line in lines(&text) {
        let [cycle, memory, client, operation, _, size] = line[..] else { panic!("{line:?}") };
        let cycle: u64 = cycle.parse().expect("a cycle");
        *counted.entry((memory, client, operation)).or_insert(0_u64) += 1;
        *bytes.entry((memory, client, operation)).or_insert(0_u64) += size.parse::<u64>().expect("bytes");
        match sections.last_mut().filter(|(of, _)| *of == memory) {
            Some((_, last)) => assert!(cycle >= std::mem::replace(last, cycle), "{memory} goes back to {cycle}"),
            None => sections.push((memory, cycle)),
        }
    }
    assert_eq!(sections.iter().map(|(memory, _)| *memory).collect::<Vec<_>>(), ["texture", "depth", "pixel"]);
    let report = place.report("out");
    for (memory, m) in report["memories"].as_object().expect("memories") {
        // Flips and waits for the display move no data, so the list of requests leaves them out.
        for (client, c) in
            m["clients"].as_object().expect("clients").iter().filter(|(client, _)| !["flip", "hold"].contains(&client.as_str()))
        {
            for (operation, requests, moved) in [("read", "reads", "read_bytes"), ("write", "writes", "write_bytes")] {
                let of = |counts: &BTreeMap<_, u64>| counts.get(&(memory.as_str(), client.as_str(), operation)).copied();
                let told = |field: &str| c[field].as_u64().unwrap_or_else(|| panic!("{memory} {client} {field}"));
                assert_eq!([of(&counted), of(&bytes)].map(Option::unwrap_or_default), [requests, moved].map(told), "{client}");
            }
        }
    }
}

/// Run of a quad of 6 x 6 pixels, with four lines each of depth and colour. It sets every parameter that affects the requests.
const QUAD: &str = "run quad.dl.jsonl --machine shade --quiet --set display.enabled=false --set depth.clear_flags=false \
    --set depth.write_lines=8 --set frame_buffer.write_lines=8 --set cache.depth.line_bytes=64 --set memory.frame.channels=1 \
    --set memory.frame.burst_bytes=32 --set memory.frame.burst_cycles=2 --set memory.frame.cl=3 --set memory.frame.cwl=1 \
    --set memory.frame.rcd=3 --set memory.frame.refi=0 --set memory.frame.outstanding=16";

/// Requests of [`QUAD`]: depth lines are cleared by writes, read and written, and colours are written at the end of the frame.
const GOLDEN: &str = "\
0x10002000 WRITE 29
0x10002020 WRITE 29
0x10002040 WRITE 30
0x10002060 WRITE 30
0x10002080 WRITE 31
0x100020a0 WRITE 31
0x100020c0 WRITE 32
0x100020e0 WRITE 32
0x10002000 READ 2521
0x10002020 READ 2521
0x10002080 READ 2545
0x100020a0 READ 2545
0x100020c0 READ 2617
0x100020e0 READ 2617
0x10002040 READ 2689
0x10002060 READ 2689
0x10002080 WRITE 2819
0x100020a0 WRITE 2819
0x10002000 WRITE 2820
0x10002020 WRITE 2820
0x10002040 WRITE 2821
0x10002060 WRITE 2821
0x100020c0 WRITE 2822
0x100020e0 WRITE 2822
0x80 WRITE 2824
0xa0 WRITE 2824
0x0 WRITE 2825
0x20 WRITE 2825
0x40 WRITE 2826
0x60 WRITE 2826
0xc0 WRITE 2827
0xe0 WRITE 2827
";

fn with_quad() -> Place {
    let place = Place::new();
    fs::copy(workspace().join("crates/sim/src/quad.dl.jsonl"), place.path("quad.dl.jsonl")).expect("copied");
    place
}

#[test]
fn dramsim3_trace_equals_reviewed_one() {
    let place = with_quad();
    place.ok(&format!("{QUAD} --requests t --requests-format dramsim3 --requests-memory frame"));
    assert_eq!(place.text("t"), GOLDEN);
}

#[test]
fn foreign_trace_formats_hold_aligned_bursts() {
    let place = with_quad();
    for format in ["csv", "dramsim3", "ramulator", "ramulator2"] {
        place.ok(&format!("{QUAD} --requests {format} --requests-format {format} --requests-memory frame"));
    }
    let csv = place.text("csv");
    let all = lines(&csv);
    let [mut dramsim3, mut ramulator, mut ramulator2] = [const { String::new() }; 3];
    for line in &all {
        let [cycle, _, _, operation, address, bytes] = line[..] else { panic!("{line:?}") };
        let [address, bytes] = [address, bytes].map(|n| n.parse::<u64>().expect("a number"));
        for burst in (address / 32..(address + bytes).div_ceil(32)).map(|n| n * 32) {
            let (word, letter, name) = if operation == "read" { ("READ", "R", "LD") } else { ("WRITE", "W", "ST") };
            dramsim3 += &format!("0x{burst:x} {word} {cycle}\n");
            ramulator += &format!("0x{burst:x} {letter}\n");
            ramulator2 += &format!("{name} 0x{burst:x}\n");
        }
    }
    assert_eq!(place.text("dramsim3"), dramsim3);
    assert_eq!(place.text("ramulator"), ramulator);
    assert_eq!(place.text("ramulator2"), ramulator2);
    let clients = &place.report("out")["memories"]["frame"]["clients"];
    let bursts = clients.as_object().expect("clients").values();
    let bursts = bursts.map(|c| c["bursts"].as_u64().expect("bursts")).sum::<u64>();
    assert_eq!(dramsim3.lines().count() as u64, bursts);
    assert!(bursts > all.len() as u64, "nothing was split");
}

#[test]
fn unsupported_request_formats_are_refused() {
    let place = Place::new();
    let refused = |more: &str| {
        let refused = place.run(&format!("{CORRIDOR} {more}"));
        let error = refused.error(2).to_owned();
        assert!(place.names("").is_empty(), "{more}: {:?}", place.names(""));
        error
    };
    for format in ["dramsim3", "ramulator", "ramulator2"] {
        let error = refused(&format!("--requests t --requests-format {format}"));
        assert!(error.starts_with(&format!("--requests-format {format}: ")), "{error}");
        assert!(error.contains("--requests-memory: texture, depth, pixel\n"), "{error}");
    }
    let error = refused("--requests t --requests-memory graphics");
    assert!(error.starts_with("--requests-memory: machine `texel` has no memory `graphics`; expected texture, depth, pixel"));
    assert!(refused("--requests -").starts_with("--requests: standard output is reserved for the report"));
    assert!(refused("--requests-memory texture").contains("--requests <FILE>"));
    assert!(refused("--requests-format dramsim3").contains("--requests <FILE>"));
    for other in ["--functional", "--ablate", "--compare-methods"] {
        assert!(refused(&format!("--requests t {other}")).contains("cannot be used with"), "{other}");
    }
    assert!(refused("--requests t --timeline ./t").contains("is also the output of"));
    assert!(refused("--requests out/report.json").contains("of this run in --out"));
}

#[test]
fn one_memory_is_written_through_a_link() {
    let place = Place::new();
    place.ok(&format!("{CORRIDOR} --requests one.csv --requests-memory depth"));
    place.ok(&format!("{CORRIDOR} --requests all.csv"));
    let (all, one) = (place.text("all.csv"), place.text("one.csv"));
    let depth: Vec<_> = lines(&all).into_iter().filter(|line| line[1] == "depth").collect();
    assert_eq!(lines(&one), depth);
    if cfg!(unix) {
        std::os::unix::fs::symlink(place.path("one.csv"), place.path("link.csv")).expect("a link");
        place.ok(&format!("{CORRIDOR} --requests link.csv"));
        assert!(place.path("link.csv").is_symlink() && place.text("one.csv") == all);
    }
    assert_eq!(
        place.names("out"),
        ["difference.png", "displacement.png", "divisions.png", "image.png", "reference.png", "report.json", "run.recording"]
    );
}
