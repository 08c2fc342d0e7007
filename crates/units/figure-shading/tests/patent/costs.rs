//! Costs: operations of the CPU (11), its registers, memory (12), operators of the circuits.

use crate::chain::{Config, ShadedFragment, feed, frame, operators, polygon, shade, sun};
use basrelief_figure_shading::{
    BrightnessInterpolation, CpuConfig, CpuProcess, FigureFlow, HostConfig, HostInterface, InterpolationConfig, Microcomputer,
    NormalInterpolation, NormalInterpolationConfig, RegisterBank, RegisterOrder, RegisterWrite, ShadingMode, ShadingRegisters,
};
use basrelief_kernel::{MemoryPorts, OperatorConfig, Operators, Unit};
use basrelief_signals::{Control, Light, Lighting, ObjectInfo, ShadingSettings};
use glam::Vec3;
use std::sync::Arc;

const SQUARE: [[f32; 2]; 4] = [[2.0, 2.0], [10.0, 2.0], [10.0, 10.0], [2.0, 10.0]];
const CURVED: [Vec3; 4] = [Vec3::Z, Vec3::new(0.1, 0.0, 0.995), Vec3::new(0.1, 0.1, 0.99), Vec3::new(0.0, 0.1, 0.995)];

fn shiny(n: f32) -> Lighting {
    Lighting { ka: 0.1, kd: 0.5, ks: 0.3, n }
}

fn lights(count: usize) -> Vec<Light> {
    vec![sun(Vec3::new(0.0, 0.1, 1.0)); count]
}

/// Returns a microcomputer that has its frame and has drawn these polygons.
fn drawn(config: &Config, lights: Vec<Light>, polygons: &[Control]) -> (Microcomputer, Vec<ShadedFragment>) {
    let mut unit = config.microcomputer();
    feed(&mut unit, [frame(lights)]);
    let shaded = polygons.iter().map(|p| shade(&mut unit, config, p.clone())).collect();
    (unit, shaded)
}

fn cycles(unit: &Microcomputer, process: CpuProcess) -> u64 {
    unit.state.counters.processes[process as usize].cycles
}

/// Returns the cycles of a process for a square with these normals.
fn of_square(cpu: CpuConfig, normals: [Vec3; 4], process: CpuProcess) -> u64 {
    let config = Config { cpu, ..Config::default() };
    cycles(&drawn(&config, lights(1), &[polygon(&SQUARE, &normals, shiny(50.0))]).0, process)
}

// Claim: shade, cost: Each process uses the CPU's operation table. Process 17 takes no power per polygon. Process 24 pays for each
// dot. Normalization costs cycles of (50).
#[test]
fn process_cycles_follow_cpu_table() {
    for (normals, flat) in [(CURVED, false), ([Vec3::Z; 4], true)] {
        for (process, name) in CpuProcess::ALL {
            let own = of_square(CpuConfig::default(), normals, process);
            assert_eq!(of_square(CpuConfig { scale: 40, ..CpuConfig::default() }, normals, process), 40 * own, "{name}");
            let runs = match process {
                CpuProcess::Start | CpuProcess::Transfer => !flat,
                CpuProcess::Mean | CpuProcess::SamePlane => flat,
                _ => true,
            };
            assert_eq!(own > 0, runs, "{name}");
        }
    }
    let more = |change: fn(&mut CpuConfig), normals, process| {
        let mut cpu = CpuConfig::default();
        change(&mut cpu);
        of_square(cpu, normals, process) - of_square(CpuConfig::default(), normals, process)
    };
    // Four points: three differences and two sums, three squares, a comparison, and the register.
    assert_eq!(more(|c| c.add += 1, CURVED, CpuProcess::Flatness), 4 * 5);
    assert_eq!(more(|c| c.multiply += 1, CURVED, CpuProcess::Flatness), 4 * 3);
    assert_eq!(more(|c| c.compare += 1, CURVED, CpuProcess::Flatness), 4);
    assert_eq!(more(|c| c.store += 1, CURVED, CpuProcess::Flatness), 1);
    // Colour and Kd, N.L and Is. If process 22 adds the specular term: N.H, Is, seven of the power, Ks.
    assert_eq!(more(|c| c.multiply += 1, CURVED, CpuProcess::Brightness), 4 * (4 + 4));
    assert_eq!(more(|c| c.multiply += 1, [Vec3::Z; 4], CpuProcess::Brightness), 4 * (4 + 4 + 4 + 7 + 1));
    assert_eq!(more(|c| c.square_root += 1, CURVED, CpuProcess::Mode), 1, "H of a light");
    assert_eq!(more(|c| c.divide += 1, [Vec3::Z; 4], CpuProcess::Mean), 1 + 2, "a share, and an area of each triangle");
}

// Claim: as process_cycles_follow_cpu_table.
#[test]
fn process_17_searches_limit_once_per_material() {
    let square = |n| polygon(&SQUARE, &CURVED, shiny(n));
    let config = Config::default();
    let spent = |polygons: &[Control]| cycles(&drawn(&config, lights(1), polygons).0, CpuProcess::Specular);
    let each = |n| spent(&[square(n), square(n), square(n)]) - spent(&[square(n), square(n)]);
    assert_eq!(each(2.0), each(200.0), "a comparison, whatever n");
    // Four points: three loads, an inner product and a comparison. Also H, the limit and a comparison, and the register.
    let cpu = &config.cpu;
    let inner_product = 3 * cpu.multiply + 2 * cpu.add;
    let point = 3 * cpu.load + inner_product + cpu.compare;
    assert_eq!(each(50.0), u64::from(4 * point + 4 * cpu.load + cpu.compare + cpu.store));
    let search = |n| spent(&[square(n)]) - each(n);
    assert!(search(200.0) > search(2.0) && search(2.0) > each(2.0), "{} {}", search(200.0), search(2.0));
    let changed = spent(&[square(50.0), square(40.0), square(40.0)]);
    assert_eq!(changed, search(50.0) + search(40.0) + 3 * each(50.0));
    assert_eq!(cycles(&drawn(&config, lights(3), &[square(50.0)]).0, CpuProcess::Specular), 3 * (search(50.0) + each(50.0)) - 2);
}

#[test]
fn process_17_searches_limit_on_material_change_only() {
    let square = |n| polygon(&SQUARE, &CURVED, shiny(n));
    let object = |id| {
        let (name, centre, shading) = (String::new(), [id as f32, 0.0, 0.0], ShadingSettings::default());
        Control::Object(Arc::new(ObjectInfo { id, name, centre, entries: None, bias: None, shading, mesh: None }))
    };
    let spent = |controls: &[Control]| cycles(&drawn(&Config::default(), lights(2), controls).0, CpuProcess::Specular);
    let same = spent(&[square(50.0), square(50.0)]);
    assert_eq!(spent(&[square(50.0), object(1), square(50.0)]), same, "another object, where the lights stand otherwise");
    let once = spent(&[square(50.0)]);
    let search = 2 * once - same;
    assert!(search > same - once, "{search}");
    let other = spent(&[square(40.0)]) + spent(&[square(50.0)]);
    assert_eq!(spent(&[square(50.0), object(1), square(40.0)]), other, "another material is searched for anew");
}

#[test]
fn renormalising_costs_process_17_a_normalisation() {
    let mut config = Config::default();
    let square = || [polygon(&SQUARE, &CURVED, shiny(50.0))];
    let plain = cycles(&drawn(&config, lights(1), &square()).0, CpuProcess::Specular);
    config.shading.renormalise = true;
    let renormalised = cycles(&drawn(&config, lights(1), &square()).0, CpuProcess::Specular);
    assert!(renormalised > plain + u64::from(config.cpu.square_root));
}

// Claim: as process_cycles_follow_cpu_table.
#[test]
fn process_24_pays_set_up_and_each_dot() {
    let config = Config::default();
    let flat = |side: f32| {
        let square = [[0.0, 0.0], [side, 0.0], [side, side], [0.0, side]];
        let (unit, shaded) = drawn(&config, lights(1), &[polygon(&square, &[Vec3::Z; 4], shiny(50.0))]);
        (cycles(&unit, CpuProcess::Mean), shaded[0].mean.len() as u64)
    };
    let ((small, few), (large, many)) = (flat(4.0), flat(20.0));
    let cpu = &config.cpu;
    // Three edges, address, depth, a branch. Address and depth are stored.
    assert_eq!(large - small, (many - few) * u64::from(6 * cpu.integer + 2 * cpu.store));
    let before_dots = small - few * u64::from(6 * cpu.integer + 2 * cpu.store);
    assert!(before_dots > 2 * u64::from(cpu.divide + 18 * cpu.multiply), "two triangles are set up: {before_dots}");
    let mut unit = config.microcomputer();
    unit.step(Some(frame(lights(1))), &mut MemoryPorts::default());
    let slow = Config { cpu: CpuConfig { scale: 5, ..CpuConfig::default() }, ..Config::default() };
    let occupancy = |config: &Config| {
        let mut unit = config.microcomputer();
        feed(&mut unit, [frame(lights(1))]);
        let mut step = unit.step(Some(polygon(&SQUARE, &[Vec3::Z; 4], shiny(50.0))), &mut MemoryPorts::default());
        while step.out.2.is_none() {
            step = unit.step(None, &mut MemoryPorts::default());
        }
        step.occupancy
    };
    assert_eq!((occupancy(&config), occupancy(&slow)), (8, 40), "the dot's step itself takes that long");
}

/// Returns the cycles of each step of circuit (50) for a dot.
fn dot_of_50(renormalise: bool, operators: Operators, power_pipelined: bool) -> u64 {
    let config = NormalInterpolationConfig { pipelined: power_pipelined, ..NormalInterpolationConfig::default() };
    let (_, shaded) = drawn(&Config::default().plain(), lights(1), &[polygon(&SQUARE, &CURVED, shiny(50.0))]);
    let mut unit = NormalInterpolation::new(config, renormalise, operators);
    unit.step(shaded[0].load.clone(), &mut MemoryPorts::default());
    unit.step(None, &mut MemoryPorts::default()).occupancy
}

#[test]
fn renormalising_occupies_circuit_50_for_square_root() {
    assert_eq!(dot_of_50(false, operators(), true), 1);
    assert_eq!(dot_of_50(true, operators(), true), 11, "the root is not in a pipeline");
    let slow_division = Operators { divide: OperatorConfig::new(20, 20), ..operators() };
    assert_eq!(dot_of_50(true, slow_division, true), 20);
    assert_eq!(dot_of_50(true, operators(), false), 14, "the power takes longer");
}

// Claim: shade, registers, memory (12): Registers (14), (16), (18) are written in a step each, and select. The host writes memory
// (12), the processes read it.
#[test]
fn registers_14_16_18_set_the_passing_polygon() {
    let mut unit = Config::default().microcomputer();
    let orders: Vec<RegisterOrder> = feed(&mut unit, [frame(lights(1)), polygon(&SQUARE, &CURVED, shiny(50.0))])
        .into_iter()
        .filter_map(|(order, ..)| order)
        .collect();
    let writes: Vec<_> =
        orders.iter().filter_map(|o| if let RegisterOrder::Write(write) = o { Some(*write) } else { None }).collect();
    assert_eq!(writes, [RegisterWrite::Mode(ShadingMode::Normal), RegisterWrite::Flat(false), RegisterWrite::Specular(true)]);
    let mut registers = RegisterBank::default();
    for order in orders {
        let is_write = matches!(order, RegisterOrder::Write(_));
        let step = registers.step(Some(order), &mut MemoryPorts::default());
        assert_eq!((step.occupancy, step.out.is_none()), (1, is_write));
    }
    assert_eq!(registers.state.registers, ShadingRegisters { mode: ShadingMode::Normal, flat: false, specular: true });
    let mut others = RegisterBank::default();
    others.step(Some(RegisterOrder::Write(RegisterWrite::Mode(ShadingMode::Brightness))), &mut MemoryPorts::default());
    let (_, shaded) = drawn(&Config::default(), lights(1), &[polygon(&SQUARE, &CURVED, shiny(50.0))]);
    let figure = basrelief_figure_shading::FigureFlow::Figure(shaded[0].figure.clone().expect("a figure"));
    let out = others.step(Some(RegisterOrder::Pass(figure)), &mut MemoryPorts::default()).out;
    let Some(basrelief_figure_shading::FigureFlow::Figure(figure)) = out else { panic!("it passes") };
    assert_eq!(figure.registers.mode, ShadingMode::Brightness, "what selects is the register, not what was meant");
}

/// Returns the bytes that a unit of one input reads and writes in memory (12).
fn traffic_of(unit: &mut Microcomputer, control: Control) -> [u64; 2] {
    let (mut sums, mut input) = ([0; 2], Some(control));
    loop {
        let mut traffic = MemoryPorts::default();
        unit.step(input.take(), &mut traffic);
        assert!(traffic.requests().len() as u32 <= unit.largest_step(0));
        traffic.requests().iter().for_each(|r| sums[usize::from(r.write)] += u64::from(r.bytes));
        if unit.is_empty() {
            return sums;
        }
    }
}

// Claim: as registers_14_16_18_set_the_passing_polygon.
#[test]
fn host_writes_memory_12_and_processes_read_it() {
    let square = || polygon(&SQUARE, &CURVED, shiny(50.0));
    let mut host = HostInterface::new(HostConfig::default());
    let mut written = Vec::new();
    for control in [frame(lights(1)), square()] {
        let mut traffic = MemoryPorts::default();
        host.step((Some(control), None), &mut traffic);
        assert!(traffic.requests().iter().all(|r| r.write && r.client == 0));
        assert!(traffic.requests().len() as u32 <= host.largest_step(0));
        written.push(traffic.requests().iter().map(|r| u64::from(r.bytes)).sum::<u64>());
    }
    assert_eq!(written, [4 * (5 + 8), 4 * (8 + 1 + 4 * 6)], "settings and a light; coefficients, count, points and normals");
    let mut unit = Config::default().microcomputer();
    traffic_of(&mut unit, frame(lights(1)));
    traffic_of(&mut unit, square());
    // Four points: normals for 15, 17, 20 and 22, positions for 20 and 23, brightness for 23. A light for 17, 20 and 22.
    assert_eq!(traffic_of(&mut unit, square()), [4 * (4 * (4 + 2 + 1) * 3 + 3 * 8), 4 * 4 * 3]);
}

#[test]
fn cpu_fetches_operands_one_by_one_before_it_works() {
    let mut unit = Config::default().microcomputer();
    feed(&mut unit, [frame(lights(1))]);
    let mut input = Some(polygon(&SQUARE, &CURVED, shiny(50.0)));
    let (mut fetches, mut works) = (0, 0);
    while input.is_some() || !unit.is_empty() {
        let mut traffic = MemoryPorts::default();
        let step = unit.step(input.take(), &mut traffic);
        let reads = traffic.requests().iter().filter(|r| !r.write).count();
        assert_eq!(step.blocking, reads == 1, "{step:?}");
        let is_empty = matches!(step.out, (None, None, None, None));
        assert!(reads == 0 || (reads == 1 && is_empty), "no result before its operands");
        assert!(traffic.requests().len() <= unit.largest_step(0) as usize);
        fetches += reads;
        works += usize::from(!is_empty);
    }
    // Settings, light vectors, limits, and operands of processes 15, 17, 20, 22 and 23. Registers, a start, and the brightness.
    assert_eq!((fetches, works), (3 + 1 + 2 + 3 + 2 + 2, 2 + 1 + 1));
}

#[test]
fn cycles_of_cpu_are_those_of_its_operations() {
    for normals in [CURVED, [Vec3::Z; 4]] {
        let mut unit = Config::default().microcomputer();
        feed(&mut unit, [frame(lights(1))]);
        let spent = |unit: &Microcomputer| unit.state.counters.processes.iter().map(|p| p.cycles).sum::<u64>();
        let before = spent(&unit);
        let (mut input, mut occupied) = (Some(polygon(&SQUARE, &normals, shiny(50.0))), 0);
        let mut steps = 0;
        while input.is_some() || !unit.is_empty() {
            occupied += unit.step(input.take(), &mut MemoryPorts::default()).occupancy;
            steps += 1;
        }
        // A step takes at least a cycle, also if its loads are counted already.
        let exact = spent(&unit) - before;
        assert!((exact..=exact + steps).contains(&occupied), "{occupied} {exact} {steps}");
    }
}

#[test]
fn set_up_of_a_triangle_occupies_both_circuits() {
    let config = Config::default();
    let square = polygon(&SQUARE, &CURVED, shiny(50.0));
    let shaded = drawn(&config, lights(1), &[square]).1.remove(0);
    let occupancy = |multiply: u32| {
        let operators = Operators { multiply: OperatorConfig::new(2, multiply), ..operators() };
        let mut circuit = BrightnessInterpolation::new(InterpolationConfig::default(), operators);
        let figure = FigureFlow::Figure(shaded.figure.clone().unwrap());
        circuit.step(Some(figure), &mut MemoryPorts::default()).occupancy
    };
    // Two triangles of 18 products and 25 sums, beside one multiplier and one adder.
    assert_eq!([1, 2].map(occupancy), [2 * 25, 2 * 36]);
    let started = config.circuit_50().step(shaded.load, &mut MemoryPorts::default()).occupancy;
    assert_eq!(started, 2 * 21, "12 products and 21 sums without depth");
}
