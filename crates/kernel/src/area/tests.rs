use super::*;
use crate::CacheConfig;
use crate::stats::UnitStats;

fn model(operators: Operators) -> AreaModel {
    AreaModel { area: AreaConfig::default(), operators, hz: 100_000_000 }
}

fn ge(piece: &Hardware) -> f64 {
    model(Operators::default()).of(piece).area_ge
}

fn logic(kind: HardwareKind, width: impl Into<crate::OperandWidth>) -> f64 {
    model(Operators::default()).of(&Hardware::new("u", kind, "", 1, width)).logic_ge
}

/// Rows of tools/area/area.csv, column ge_generic.
#[test]
fn formulas_agree_with_measured_blocks() {
    let near = |formula: f64, measured: f64, percent: f64| {
        assert!((formula / measured - 1.0).abs() < percent / 100.0, "{formula} instead of {measured}");
    };
    near(logic(HardwareKind::Multiplier, 16), 2576.1, 4.0);
    near(logic(HardwareKind::Multiplier, crate::OperandWidth::fixed(16, 8)), 1163.3, 3.0);
    near(logic(HardwareKind::Adder, 32), 260.0, 1.0);
    near(logic(HardwareKind::Multiplier, crate::OperandWidth::SINGLE), 5210.2, 1.0);
    near(logic(HardwareKind::Adder, crate::OperandWidth::SINGLE), 1527.8, 1.0);
    let divider = Hardware { digits_per_cycle: 4, ..Hardware::new("u", HardwareKind::Divider, "", 1, 24) };
    near(ge(&divider), 2193.8, 5.0);
    // Whole FIFOs.
    let control = blocks::fifo_control(&AreaConfig::default(), 64);
    near(control, 339.5, 2.0);
}

#[test]
fn wider_factor_and_floating_point_change_the_area() {
    let [narrow, square] = [(9, 8), (9, 9)].map(|(w, v)| logic(HardwareKind::Multiplier, crate::OperandWidth::fixed(w, v)));
    assert!(narrow < square);
    let [fixed, single] = [logic(HardwareKind::Adder, 32), logic(HardwareKind::Adder, crate::OperandWidth::SINGLE)];
    assert!(single > 5.0 * fixed, "{single} {fixed}");
}

#[test]
fn pipelined_operator_has_registers_and_iterative_one_none() {
    let multiplier = Hardware::new("u", HardwareKind::Multiplier, "", 3, 16);
    let registers = |latency, interval| {
        let multiply = OperatorConfig::new(latency, interval);
        model(Operators { multiply, ..Operators::default() }).of(&multiplier).register_bits
    };
    assert_eq!([registers(4, 1), registers(1, 1), registers(4, 4)], [3 * 32 * 4, 3 * 32, 0]);
}

#[test]
fn operators_of_integers_have_their_latencies() {
    let float = OperatorConfig::new(9, 1);
    let slow = model(Operators { multiply: float.clone(), add: float, ..Operators::default() });
    let registers = |kind, width: crate::OperandWidth| slow.of(&Hardware::new("u", kind, "", 1, width)).register_bits;
    let of =
        |kind| [crate::OperandWidth::from(16).of_integers(), crate::OperandWidth::from(16)].map(|width| registers(kind, width));
    assert_eq!(of(HardwareKind::Multiplier), [32, 9 * 32]);
    assert_eq!(of(HardwareKind::Adder), [17, 9 * 17]);
    // Three products of 32 bits, and sums of 32, 33 and 34.
    assert_eq!(of(HardwareKind::InnerProduct)[0], 3 * 32 + 32 + 33 + 34);
}

#[test]
fn shorter_interval_of_divider_costs_more() {
    let divider = Hardware::new("u", HardwareKind::Divider, "", 1, 24);
    let of = |interval| model(Operators { divide: OperatorConfig::new(24, interval), ..Operators::default() }).of(&divider);
    let [slow, fast, pipelined] = [24, 7, 1].map(|interval| of(interval).area_ge);
    assert!(slow < fast && 2.0 * fast < pipelined, "{slow} {fast} {pipelined}");
}

#[test]
fn shorter_interval_of_power_unit_costs_more() {
    let of = |width: crate::OperandWidth, interval| {
        let power = OperatorConfig::new(1024, interval);
        model(Operators { power, ..Operators::default() }).of(&Hardware::new("u", HardwareKind::Power, "", 1, width)).logic_ge
    };
    let ascending = [1024, 64, 22, 7, 4].map(|interval| of(crate::OperandWidth::SINGLE, interval));
    assert!(ascending.is_sorted_by(|slow, fast| slow < fast), "{ascending:?}");
    // 24 digits: 72 of three products, 2 of them in each of 64 cycles.
    assert_eq!(ascending[1], 5000.0 * 2.25 * (0.476 + 0.472 * 2.0 / 24.0));
    assert_eq!([1, 2].map(|interval| of(crate::OperandWidth::SINGLE, interval)), [5000.0 * 2.25; 2]);
    // Rows of tools/area/area.csv: 8 and 2 digits per cycle.
    for (interval, measured) in [(6, 3533.1), (24, 2677.1)] {
        assert!((of(16.into(), interval) / measured - 1.0).abs() < 0.02, "{interval}");
    }
}

#[test]
fn eight_quotient_bits_per_cycle_take_186_fo4() {
    let divider = Hardware { digits_per_cycle: 8, ..Hardware::new("u", HardwareKind::Divider, "", 1, 24) };
    assert_eq!(model(Operators::default()).of(&divider).depth_fo4, 186.0);
    let slow = AreaModel {
        hz: 50_000_000,
        area: AreaConfig { gate_length: 0.6, ..AreaConfig::default() },
        ..model(Operators::default())
    };
    assert_eq!(slow.cycle_fo4().round(), 83.0);
}

#[test]
fn each_lane_reads_a_bank_of_its_own() {
    let table = |banks| Hardware { banks, ..Hardware::new("u", HardwareKind::Table, "", 512, 48) };
    assert_eq!((table(1).port_bits(), table(64).port_bits()), (48, 3072));
    let [one, many] = [1, 64].map(|banks| model(Operators::default()).of(&table(banks)));
    assert_eq!((one.memory_bits, one.register_bits), (512 * 48, 0));
    // A bank of eight words takes the smallest macro.
    assert_eq!([one.area_ge, many.area_ge], [1.4 * 24576.0 + 450.0, 64.0 * (1.4 * 2048.0 + 450.0)]);
}

#[test]
fn ports_of_a_cache_multiply_its_area() {
    let of = |lookups_per_cycle| {
        let cache = Hardware::of_cache("c", &CacheConfig { lookups_per_cycle, ..CacheConfig::default() });
        cache.iter().map(ge).sum::<f64>()
    };
    assert_eq!(of(4), 4.0 * of(1));
    // 16 KiB with tags: (1.4 bits + 450) x ports, and comparators.
    assert!((750e3..800e3).contains(&of(4)), "{}", of(4));
}

#[test]
fn each_credit_costs_data_and_a_request() {
    let of = |credits| Hardware::of_port("p", credits, 64).iter().map(ge).sum::<f64>();
    assert!(of(64) > 1.8 * of(32) && of(32) > 32.0 * (512.0 + 40.0), "{} {}", of(32), of(64));
}

#[test]
fn more_words_never_cost_less() {
    let of = |words| ge(&Hardware { ports: 2, ..Hardware::new("u", HardwareKind::Table, "", words, 40) });
    assert!((1..200).all(|words| of(words) <= of(words + 1)));
    let few = model(Operators::default()).of(&Hardware::new("u", HardwareKind::Table, "", 4, 40));
    assert_eq!((few.memory_bits, few.register_bits), (0, 160), "flip-flops");
}

#[test]
fn wider_words_of_flags_cost_more() {
    let of = |per_cycle, finds_first| {
        let mut stats = UnitStats::default();
        let report = if finds_first { UnitStats::searched_flags } else { UnitStats::flags };
        report(&mut stats, "flags", 1 << 17, per_cycle);
        ge(&stats.all_hardware()[0])
    };
    let widths = [1, 2, 16, 64, 1024, 8192, 16_384, 65_536];
    for finds_first in [false, true] {
        let areas = widths.map(|per_cycle| of(per_cycle, finds_first));
        assert!(areas.is_sorted_by(|narrow, wide| narrow < wide), "{areas:?}");
        assert!(areas[7] > 3.0 * areas[3], "a macro has 16 words at least: {areas:?}");
    }
    // Each of two ports chooses one of 64 flags.
    assert_eq!((of(64, false) - of(1, false)).round(), 2.0 * 2.5 * 63.0);
    // Row `prio` of tools/area/area.csv.
    assert!(((of(64, true) - of(64, false)) / 210.8 - 1.0).abs() < 0.04);
}

#[test]
fn wider_words_of_a_list_cost_more() {
    let of = |per_cycle| {
        let mut stats = UnitStats::default();
        stats.searched_list("list", 1 << 16, [2, per_cycle], 6);
        ge(&stats.all_hardware()[0])
    };
    // Six ports choose one of 16 entries of 2 bits; the search has a gate per entry.
    assert_eq!((of(16) - of(1)).round(), (6.0_f64 * 2.5 * 30.0 + 3.3 * 13.9).round());
    assert!(of(1024) > 30_000.0 + of(16));
}

#[test]
fn deeper_fifo_and_longer_wire_cost_more() {
    let of = |depth, latency| ge(&Hardware::of_fifo("f", depth, 100, latency));
    assert!(of(8, 1) < of(9, 1));
    assert_eq!((of(8, 3) - of(8, 1)).round(), (2.0_f64 * 100.0 * 5.67).round());
}

#[test]
fn operations_that_share_an_operator_need_multiplexers() {
    let of = |turns| ge(&Hardware { turns, ..Hardware::new("u", HardwareKind::Multiplier, "", 2, 16) });
    // Two operators, two operands of 16 bits, two more inputs.
    assert_eq!((of(3) - of(1)).round(), 2.5 * 2.0 * 32.0 * 2.0);
    assert_eq!(of(0), of(1));
}
