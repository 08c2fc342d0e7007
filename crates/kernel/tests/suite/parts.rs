//! Memory parts: their numbers compared with a second copy of the data sheets (or of the typical values of their class), and
//! their rounding at any clock.

use basrelief_kernel::parts::MOST_BURST_BYTES;
use basrelief_kernel::{MemoryConfig, MemoryPart};
use basrelief_parameters::Provenance;
use proptest::prelude::*;

fn at(part: MemoryPart, hz: u64) -> MemoryConfig {
    let mut memory = MemoryConfig { part, ..MemoryConfig::default() };
    memory.take_part(hz, |_| false).unwrap_or_else(|e| panic!("{e}"));
    memory
}

/// Nanoseconds from the data sheet or assumed: cl, rcd, rp, ras, refi, rfc. Then GB/s of a channel.
const SHEETS: &[(MemoryPart, [f64; 6], f64)] = &[
    (MemoryPart::Fpm80, [40.0, 40.0, 60.0, 80.0, 15625.0, 150.0], 0.32),
    (MemoryPart::Edo60, [30.0, 30.0, 40.0, 60.0, 15625.0, 104.0], 0.64),
    (MemoryPart::Sdr100, [30.0, 20.0, 20.0, 50.0, 15625.0, 70.0], 0.8),
    (MemoryPart::Sdr133, [22.5, 20.0, 20.0, 45.0, 15625.0, 67.5], 1.0667),
    (MemoryPart::Ddr400, [15.0, 15.0, 15.0, 40.0, 7800.0, 70.0], 3.2),
    (MemoryPart::Ddr2At667, [15.0, 15.0, 15.0, 45.0, 7800.0, 127.5], 5.3333),
    (MemoryPart::Gddr3At1400, [15.714, 15.714, 17.143, 25.714, 3900.0, 52.0], 5.6),
    (MemoryPart::Xdr3200, [15.0, 12.5, 15.0, 25.0, 3906.25, 40.0], 6.4),
];

#[test]
fn clocked_parts_match_their_sheets() {
    // At 1 GHz a cycle is a nanosecond.
    for &(part, [cl, rcd, rp, ras, refi, rfc], rate) in SHEETS {
        let m = at(part, 1_000_000_000);
        let up = |ns: f64| ns.ceil() as u32;
        assert_eq!([m.cl, m.rcd, m.rp, m.ras, m.rfc], [cl, rcd, rp, ras, rfc].map(up), "{part:?}");
        assert_eq!(m.refi, refi.floor() as u32, "{part:?}");
        let of_part = part.bytes_per_second(1_000_000_000).unwrap() / 1e9;
        assert!((of_part / rate - 1.0).abs() < 1e-4, "{part:?}: {of_part}");
    }
    let own_clock = |part: &MemoryPart| part.bytes_per_second(1) == part.bytes_per_second(2);
    let listed: Vec<MemoryPart> = SHEETS.iter().map(|sheet| sheet.0).collect();
    assert_eq!(MemoryPart::ALL.iter().copied().filter(own_clock).collect::<Vec<_>>(), listed, "a part is not in the list");
}

#[test]
fn assumed_numbers_say_so() {
    let assumed = |part: MemoryPart| -> Vec<&str> {
        let numbers = part.numbers(200_000_000, [None; 2]).unwrap_or_else(|e| panic!("{e}"));
        let is_assumed = |text: &str| text.contains("; typical of the class, not in the sheet cited (");
        numbers.iter().for_each(|n| {
            assert_eq!(matches!(n.provenance, Provenance::Assumed(_)), is_assumed(n.provenance.text()), "{n:?}");
        });
        numbers.iter().filter(|n| is_assumed(n.provenance.text())).map(|n| n.name).collect()
    };
    assert_eq!(assumed(MemoryPart::Fpm80), ["refi", "window"]);
    assert_eq!(assumed(MemoryPart::Edo60), ["rp", "refi", "rfc", "banks", "row_bytes", "window"]);
    assert_eq!(assumed(MemoryPart::Sdr100), ["cl", "refi", "banks", "row_bytes", "window"]);
    assert_eq!(assumed(MemoryPart::Sdr133), ["cl", "refi", "banks", "row_bytes", "window"]);
    assert_eq!(assumed(MemoryPart::Ddr400), ["banks", "row_bytes", "window"]);
    assert_eq!(assumed(MemoryPart::Ddr2At667), ["rtp", "wr", "wtr", "faw", "rfc", "window"]);
    assert_eq!(assumed(MemoryPart::Gddr3At1400), ["cwl", "wr", "faw", "rfc", "window"]);
    assert!(["banks", "row_bytes", "rcd", "commands_per_cycle"].iter().all(|name| assumed(MemoryPart::EdramPs2).contains(name)));
}

#[test]
fn ddr_400_at_its_own_clock_equals_its_sheet() {
    let m = at(MemoryPart::Ddr400, 200_000_000);
    assert_eq!([m.cl, m.cwl, m.rcd, m.rp, m.ras], [3, 1, 3, 3, 8]);
    assert_eq!([m.rtp, m.wr, m.wtr, m.rrd, m.faw], [4, 3, 2, 2, 0]);
    assert_eq!([m.refi, m.rfc, m.burst_bytes, m.burst_cycles, m.banks, m.row_bytes], [1560, 14, 64, 4, 4, 2048]);
    // For a rate without a whole number of bytes per cycle, the burst differs from the part's own.
    let burst = |part| at(part, 200_000_000).burst_bytes / at(part, 200_000_000).burst_cycles;
    assert_eq!([MemoryPart::Ddr2At667, MemoryPart::Gddr3At1400, MemoryPart::Xdr3200].map(burst), [28, 28, 32]);
    let commands = |part| at(part, 200_000_000).commands_per_cycle;
    let parts = [MemoryPart::Sdr133, MemoryPart::Ddr400, MemoryPart::Gddr3At1400, MemoryPart::Xdr3200, MemoryPart::Sram];
    assert_eq!(parts.map(commands), [1, 1, 3, 2, 0], "commands per cycle: whole ones, and at least one");
    let window = |part| at(part, 200_000_000).window;
    let parts = [MemoryPart::Fpm80, MemoryPart::Sdr133, MemoryPart::Gddr3At1400, MemoryPart::Ideal];
    assert_eq!(parts.map(window), [4, 8, 16, 256]);
    // The part does not change the parameters of the board.
    let board = MemoryConfig::default();
    assert_eq!([m.channels, m.channel_bytes, m.window, m.cap, m.outstanding], [1, 256, 16, 16, 8]);
    assert_eq!([board.channels, board.channel_bytes, board.window, board.cap, board.outstanding], [1, 256, 16, 16, 8]);
}

#[test]
fn on_chip_parts_follow_the_device_clock() {
    for hz in [25_000_000, 147_456_000, 200_000_000] {
        let (edram, sram) = (at(MemoryPart::EdramPs2, hz), at(MemoryPart::Sram, hz));
        assert_eq!([edram.burst_bytes, edram.burst_cycles], [128, 1]);
        assert_eq!([sram.burst_bytes, sram.burst_cycles, sram.cl, sram.rcd, sram.refi], [16, 1, 1, 0, 0]);
    }
    // The Graphics Synthesizer: 1,024 bits at 147.456 MHz are 19 GB/s.
    assert!((MemoryPart::EdramPs2.bytes_per_second(147_456_000).unwrap() - 18.874e9).abs() < 1e6);
}

#[test]
fn ideal_part_has_no_latency_at_any_clock() {
    for hz in [1, 200_000_000, 100_000_000_000] {
        let m = at(MemoryPart::Ideal, hz);
        let times = [m.cl, m.cwl, m.rcd, m.rp, m.ras, m.wr, m.wtr, m.rrd, m.faw, m.refi, m.rfc];
        assert_eq!((times, m.channels, m.burst_cycles), ([0; 11], 64, 1));
    }
}

#[test]
fn given_numbers_override_the_part() {
    let mut m = MemoryConfig { part: MemoryPart::Sdr133, cl: 9, burst_bytes: 32, ..MemoryConfig::default() };
    m.take_part(200_000_000, |name| ["cl", "burst_bytes"].contains(&name)).unwrap();
    // 32 bytes are four clocks of 7.5 ns. A bank may be precharged after them.
    assert_eq!([m.cl, m.burst_bytes, m.burst_cycles, m.rtp, m.rcd], [9, 32, 6, 6, 4]);
    // If no whole number of cycles is near, the time is rounded up.
    let mut m = MemoryConfig { part: MemoryPart::Gddr3At1400, burst_bytes: 64, ..MemoryConfig::default() };
    m.take_part(200_000_000, |name| name == "burst_bytes").unwrap();
    assert_eq!([m.burst_bytes, m.burst_cycles, m.rtp], [64, 3, 3]);
    let mut m = MemoryConfig { part: MemoryPart::Sdr100, burst_bytes: 64, burst_cycles: 4, ..MemoryConfig::default() };
    m.take_part(200_000_000, |name| name.starts_with("burst")).unwrap();
    assert_eq!([m.burst_bytes, m.burst_cycles, m.rtp], [64, 4, 4]);
    let mut m = MemoryConfig { row_bytes: 512, ..MemoryConfig::default() };
    m.take_part(1, |_| false).unwrap();
    assert_eq!(m, MemoryConfig { row_bytes: 512, ..MemoryConfig::default() }, "custom fills nothing");
}

#[test]
fn unfit_clock_names_fitting_clock_and_parts() {
    let mut m = MemoryConfig { part: MemoryPart::Ddr400, ..MemoryConfig::default() };
    let before = m.clone();
    let error = m.take_part(3_000_000, |_| false).unwrap_err().to_string();
    assert_eq!(m, before);
    for part in ["ddr-400 does not fit a clock of 3 MHz", "3.2 GB/s", "11.9 MHz or more", "fpm-80, edo-60", "ideal"] {
        assert!(error.contains(part), "`{part}` is not in: {error}");
    }
    let mut edram = MemoryConfig { part: MemoryPart::EdramPs2, ..MemoryConfig::default() };
    let error = edram.take_part(77, |_| false).unwrap_err().to_string();
    assert!(error.contains("a refresh every 0 cycles leaves no time"), "{error}");
    let error = m.take_part(100_000_000_000, |_| false).unwrap_err().to_string();
    assert!(error.contains("`cl` is 1500, expected 0..=1024 cycles"), "{error}");
}

#[test]
fn every_number_has_name_and_source() {
    for &part in MemoryPart::ALL {
        assert_eq!(serde_json::to_value(part).unwrap(), part.name());
        for number in part.numbers(200_000_000, [None; 2]).unwrap_or_else(|e| panic!("{e}")) {
            assert!(!matches!(number.provenance, Provenance::Stated(_)) && number.provenance.text().len() > 20, "{number:?}");
        }
    }
    assert!(MemoryPart::Custom.numbers(1, [None; 2]).unwrap().is_empty() && MemoryPart::Custom.about().is_none());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    /// Rounding keeps its promise at any clock. No time is shorter than in the data sheet or more than a cycle longer, refreshes
    /// are at least as frequent, and the peak rate is within 5 %.
    #[test]
    fn rounding_keeps_times_long_enough_and_rate_within_5_percent(
        hz in 10_000_000_u64..=1_000_000_000,
        sheet in prop::sample::select(SHEETS),
    ) {
        let (part, [cl, rcd, rp, ras, refi, rfc], _) = sheet;
        let mut m = MemoryConfig { part, ..MemoryConfig::default() };
        let rate = part.bytes_per_second(hz).unwrap() / hz as f64;
        if let Err(unfit) = m.take_part(hz, |_| false) {
            prop_assert!(rate * 0.95 > f64::from(MOST_BURST_BYTES), "{unfit}");
            return Ok(());
        }
        let period = 1e9 / hz as f64;
        for (cycles, ns) in [(m.cl, cl), (m.rcd, rcd), (m.rp, rp), (m.ras, ras), (m.rfc, rfc)] {
            let took = f64::from(cycles) * period;
            prop_assert!(took > ns - 0.001 && took < ns + period + 0.001, "{part:?}: {took} for {ns} ns");
        }
        prop_assert!(f64::from(m.refi) * period <= refi);
        let peak = f64::from(m.burst_bytes) / f64::from(m.burst_cycles);
        prop_assert!((peak / rate - 1.0).abs() <= 0.05 + 1e-9, "{part:?}: {peak} for {rate} bytes per cycle");
        prop_assert!(m.refi > m.rfc + m.rcd && m.row_bytes >= m.burst_bytes);
    }
}
