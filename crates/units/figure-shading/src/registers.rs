//! Registers (14), (16), (18), and the selections that they make.

use crate::ShadingMode;
use serde::{Deserialize, Serialize};

/// Values of the three registers while a polygon is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ShadingRegisters {
    /// Mode register (14), written by process 13.
    pub mode: ShadingMode,
    /// Flatness register (16), written by process 15. True if the polygon is flat.
    pub flat: bool,
    /// Specular register (18), written by process 17. True if specular reflection is not negligible and gate (51) is open.
    pub specular: bool,
}

/// A write of one of the registers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum RegisterWrite {
    /// Write of the mode register (14), by process 13.
    Mode(ShadingMode),
    /// Write of the flatness register (16), by process 15.
    Flat(bool),
    /// Write of the specular register (18), by process 17.
    Specular(bool),
}

/// Source of the brightness of a dot (claim 1).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BrightnessSelection {
    /// Mean of the sample points: process 24.
    Mean,
    /// Circuit (21).
    Linear,
    /// Circuit (21) plus circuit (50).
    LinearAndSpecular,
}

impl ShadingRegisters {
    /// Writes one of the registers.
    pub fn write(&mut self, write: RegisterWrite) {
        match write {
            RegisterWrite::Mode(mode) => self.mode = mode,
            RegisterWrite::Flat(flat) => self.flat = flat,
            RegisterWrite::Specular(specular) => self.specular = specular,
        }
    }

    /// Returns the combined selection of selectors (53) and (28) and gate (51).
    pub fn selection(self) -> BrightnessSelection {
        match self.mode {
            ShadingMode::Polyhedron => BrightnessSelection::Mean,
            ShadingMode::Brightness | ShadingMode::Normal if self.flat => BrightnessSelection::Mean,
            ShadingMode::Normal if self.specular => BrightnessSelection::LinearAndSpecular,
            ShadingMode::Brightness | ShadingMode::Normal => BrightnessSelection::Linear,
        }
    }

    /// Figure 6, steps 80 to 83: returns true if process 22 adds the specular term at the sample points. It does not if circuit
    /// (50) adds the term, which would count twice, or if the term is negligible.
    pub fn adds_specular_at_sample_points(self) -> bool {
        self.specular && self.selection() != BrightnessSelection::LinearAndSpecular
    }

    /// Returns true if the dots of process 24 go to selector (53), false if to (28).
    pub fn mean_goes_to_53(self) -> bool {
        self.mode == ShadingMode::Normal
    }
}

/// Routes of a polygon.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum PolygonRoute {
    /// Polyhedron mode: mean of the sample points.
    Polyhedron,
    /// Brightness-interpolation mode: circuit (21).
    Brightness,
    /// Normal-interpolation mode: circuits (21) and (50).
    #[default]
    Normal,
    /// Normal-interpolation mode, specular negligible: circuit (21), gate (51) closed.
    GateClosed,
    /// Flat: mean of the sample points.
    Flat,
    /// Flat, on the plane of the previous flat polygon: its brightness is reused.
    Reused,
}

impl PolygonRoute {
    /// All routes, in the order of their numbers.
    pub const ALL: [Self; 6] = [Self::Polyhedron, Self::Brightness, Self::Normal, Self::GateClosed, Self::Flat, Self::Reused];

    /// Returns the route that the registers select.
    pub fn of(registers: ShadingRegisters, reused: bool) -> Self {
        match registers.mode {
            ShadingMode::Polyhedron => Self::Polyhedron,
            _ if reused => Self::Reused,
            _ if registers.flat => Self::Flat,
            ShadingMode::Brightness => Self::Brightness,
            ShadingMode::Normal if registers.specular => Self::Normal,
            ShadingMode::Normal => Self::GateClosed,
        }
    }

    /// Returns the name in the report.
    pub fn name(self) -> &'static str {
        match self {
            Self::Polyhedron => "polyhedron",
            Self::Brightness => "brightness",
            Self::Normal => "normal",
            Self::GateClosed => "gate_closed",
            Self::Flat => "flat",
            Self::Reused => "reused",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn registers() -> impl Iterator<Item = ShadingRegisters> {
        let modes = [ShadingMode::Normal, ShadingMode::Brightness, ShadingMode::Polyhedron];
        let flags = [(false, false), (false, true), (true, false), (true, true)];
        modes.into_iter().flat_map(move |mode| flags.map(|(flat, specular)| ShadingRegisters { mode, flat, specular }))
    }

    // Claim: shade, 1, selection: Registers select the mean for flat polygons, linear brightness otherwise, and add the specular
    // term if it is visible.
    #[test]
    fn claim_1_registers_select_brightness_source() {
        use BrightnessSelection::{Linear, LinearAndSpecular, Mean};
        // Columns (flat, specular): no no, no yes, yes no, yes yes.
        let table = [
            (ShadingMode::Normal, [Linear, LinearAndSpecular, Mean, Mean]),
            (ShadingMode::Brightness, [Linear, Linear, Mean, Mean]),
            (ShadingMode::Polyhedron, [Mean, Mean, Mean, Mean]),
        ];
        for (r, expected) in registers().zip(table.iter().flat_map(|(_, row)| row)) {
            assert_eq!(r.selection(), *expected, "{r:?}");
        }
    }

    // Claim: as figure_6_steps_80_to_83_add_specular_in_process_22.
    #[test]
    fn figure_6_specular_term_counts_exactly_once() {
        for r in registers() {
            let by_50 = r.selection() == BrightnessSelection::LinearAndSpecular;
            let times = u32::from(by_50) + u32::from(r.adds_specular_at_sample_points());
            assert_eq!(times, u32::from(r.specular), "{r:?}");
        }
    }

    // Claim: as claim_1_registers_select_brightness_source.
    #[test]
    fn each_route_has_one_selection() {
        for r in registers() {
            let expected = match PolygonRoute::of(r, false) {
                PolygonRoute::Polyhedron | PolygonRoute::Flat | PolygonRoute::Reused => BrightnessSelection::Mean,
                PolygonRoute::Brightness | PolygonRoute::GateClosed => BrightnessSelection::Linear,
                PolygonRoute::Normal => BrightnessSelection::LinearAndSpecular,
            };
            assert_eq!(r.selection(), expected, "{r:?}");
        }
        for (i, route) in PolygonRoute::ALL.into_iter().enumerate() {
            assert_eq!(route as usize, i);
        }
    }
}
