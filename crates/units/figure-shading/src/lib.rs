//! The circuits and the microcomputer of the figure shading device (200).
//!
//! ```text
//!  host interface --transfers--> microcomputer (10) = CPU (11) + memory (12)
//!                                  | figures                |                        |                |
//!                                  v                        |                        |                |
//!                  registers (14), (16), (18)               |                        |                |
//!                                  | selections             | normals                | flat_dots      | constant_dots
//!                                  v                        v                        |                |
//!                  brightness interpolation       normal-interpolation               |                |
//!                  circuit (21)                   brightness circuit (50)            |                |
//!                   |        | interpolated         | highlights                     |                |
//!                   |        |                    gate (51)                          |                |
//!                   |        +--> adder (52) <------+ gated                          |                |
//!                   |              | sums                                            |                |
//!                   |              +--> selector (53) <------------------------------+                |
//!                   | brightness_dots    | selected                                                   |
//!                   +--------------> selector (28) <--------------------------------------------------+
//!                                        | pixels                  (finished: back to the host interface)
//!                                        v frame memory (300)
//! ```
//!
//! Per colour component `I = Ka*Ia + Is * {Kd (N.L) + Ks (N.H)^n}`. Ambient and diffuse terms are the same if brightness is
//! interpolated or if normals are. So circuit (21) interpolates these terms, circuit (50) calculates only the specular term, and
//! adder (52) sums.
//!
//! # A polygon on the wires
//!
//! The microcomputer writes the registers, which are a unit of their own ([`RegisterBank`]). Their values travel in band. A
//! [`PolygonFigure`] token runs from (10) through the registers, which store their values in it, then through (21), (52) and (53) to
//! (28), ahead of the polygon's dots. It sets each of these units. Dots follow on the path that the registers select, with an
//! [end token](FigureFlow::End) behind them. The other paths carry nothing of this polygon. So each selector knows its input, and
//! no unit waits for a circuit that was not started.
//!
//! # Degenerate polygons
//!
//! | polygon | rule |
//! |---|---|
//! | fewer than three points | the host interface drops it, and counts it |
//! | without area, points repeated | shaded normally; it has no dots, only its end |
//! | not convex, folded | a fan around its first point; pixels from [`PolygonScan`](basrelief_shading::PolygonScan); sample points are weighted within their triangle of the fan |
//! | coordinate NaN | counts as 0 |
//! | normal with a component that is not finite | counts as a normal of length zero |
//! | normal of length zero | used unchanged: N.L = N.H = 0, ambient brightness; no weight in the mean of normals; renormalised it stays zero. If normals are renormalised, the specular term is then never negligible |
//! | points of different colours | brightness is interpolated with the colours; never flat |
//! | brightness NaN | black |

mod adder;
mod brightness_interpolation;
mod config;
mod cpu;
mod dots;
mod gate;
mod host_interface;
mod illumination;
mod local_memory;
mod microcomputer;
mod normal_interpolation;
mod power;
mod register_bank;
mod registers;
mod selector_28;
mod selector_53;
mod signals;
mod widths;

pub use adder::{Adder, AdderCounters, AdderState};
pub use basrelief_signals::ShadingMode;
pub use brightness_interpolation::{BrightnessInterpolation, BrightnessInterpolationCounters, BrightnessInterpolationState};
pub use config::{
    CircuitConfig, FlatnessConfig, HostConfig, InterpolationConfig, NormalInterpolationConfig, PowerMethod, SamePlaneConfig,
    ScanConfig, ShadingConfig, ShortCutConfigs, SpecularNegligibleConfig, SpecularSkip, SumClamp,
};
pub use cpu::CpuConfig;
pub use gate::{Gate, GateCounters, GateState};
pub use host_interface::{HostInterface, HostInterfaceCounters, HostInterfaceState};
pub use illumination::ObjectIllumination;
pub use microcomputer::{CpuProcess, Microcomputer, MicrocomputerCounters, MicrocomputerState, ProcessCounters, StoredPlane};
pub use normal_interpolation::{NormalInterpolation, NormalInterpolationCounters, NormalInterpolationState};
pub use power::{PowerFunction, power};
pub use register_bank::{RegisterBank, RegisterBankCounters, RegisterBankState};
pub use registers::{BrightnessSelection, PolygonRoute, RegisterWrite, ShadingRegisters};
pub use selector_28::{Selector28, Selector28Counters, Selector28State};
pub use selector_53::{Selector53, Selector53State};
pub use signals::{FigureFlow, FinishedPolygon, NormalLoad, PolygonFigure, RegisterOrder, ShadedDot, SpecularDot, SpecularFlow};

/// Tests the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
