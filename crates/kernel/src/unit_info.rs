//! Descriptions of units in the block diagram.

/// Purpose of a unit and path of its code. A unit states it with [`unit_info!`](crate::unit_info).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UnitInfo {
    /// Purpose, as a clause without a full stop; empty if the unit states none.
    pub purpose: &'static str,
    /// Path of the module that states it, as `module_path!` gives it.
    pub module: &'static str,
}

/// States the [`UnitInfo`] of a unit: the first line of its `impl Unit`.
///
/// ```
/// use basrelief_kernel::{Demand, MemoryPorts, Step, Unit, UnitInfo};
///
/// struct Adder;
///
/// impl Unit for Adder {
///     basrelief_kernel::unit_info!("adds the values of both inputs");
///     type In = (Option<u32>, Option<u32>);
///     type Out = Option<u32>;
///
///     fn demand(&self) -> Demand {
///         Demand::All
///     }
///
///     fn step(&mut self, (a, b): Self::In, _: &mut MemoryPorts) -> Step<Option<u32>> {
///         Step::after(1, a.zip(b).map(|(a, b)| a + b))
///     }
/// }
///
/// assert_eq!(Adder::INFO, UnitInfo { purpose: "adds the values of both inputs", module: module_path!() });
/// ```
#[macro_export]
macro_rules! unit_info {
    ($purpose:literal) => {
        const INFO: $crate::UnitInfo = $crate::UnitInfo { purpose: $purpose, module: module_path!() };
    };
}
