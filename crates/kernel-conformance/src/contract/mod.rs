//! The unit contract: tests of the promises of every unit, on a bench around one unit.
//!
//! A unit crate states its contract once per configuration worth testing. The macro generates a module of tests:
//!
//! ```
//! use basrelief_kernel::{Demand, Step, MemoryPorts, Unit};
//! use basrelief_kernel_conformance::unit_contract;
//!
//! /// Sums its input; each step also issues a read of 8 bytes and a cached table look-up.
//! #[derive(Clone, Default)]
//! struct Sum {
//!     state: u64,
//! }
//!
//! impl Unit for Sum {
//!     type In = Option<u64>;
//!     type Out = Option<u64>;
//!     fn demand(&self) -> Demand {
//!         Demand::All
//!     }
//!     fn step(&mut self, input: Option<u64>, traffic: &mut MemoryPorts) -> Step<Option<u64>> {
//!         let token = input.unwrap_or(0);
//!         traffic.read(0, 8 * token, 8);
//!         traffic.look_up(1, 4 * token, 4);
//!         self.state += token;
//!         Step::after(2, Some(self.state)).busy(1 + token % 3)
//!     }
//!     fn largest_step(&self, client: usize) -> u32 {
//!         u32::from(client < 2)
//!     }
//! }
//!
//! unit_contract! {
//!     name: sum,
//!     unit: Sum::default(),
//!     inputs: (0..100).collect(),
//!     // One entry per memory client of the unit, in its numbering. Omit the line for a unit without clients.
//!     clients: [ClientKind::Port, ClientKind::Cache { line_bytes: 64 }],
//!     // The state is the field `state`. Write `stateless` for a unit without state.
//!     state,
//! }
//!
//! // The same contract as one call, for units that are built at run time.
//! # use basrelief_kernel_conformance::contract::{ClientKind, Contract};
//! Contract::new(Sum::default(), (0..100).collect(), |unit| unit.state, |unit, state| unit.state = state)
//!     .clients(&[ClientKind::Port, ClientKind::Cache { line_bytes: 64 }])
//!     .check_all()?;
//! # Ok::<(), basrelief_kernel_conformance::contract::ContractViolation>(())
//! ```
//!
//! The state is plain data. After every step it makes a round trip through JSON into a fresh unit, which continues. A unit of
//! another shape defines accessors: `state: |unit| unit.0.state => |unit, state| unit.0.state = state`.
//!
//! `inputs` is a `Vec` for a unit of one input, `(Vec, Vec)` for two, and `()` for a source. The tokens must form a complete run:
//! the unit pops every token, and the last token flushes every batch. Tokens need `Clone`, and emitted tokens also
//! `Debug + PartialEq`. The methods of [`Contract`] document the checks.

mod bench;
mod check;
mod client_kind;
mod ends;
mod environment;
mod subject;

#[doc(hidden)]
pub use basrelief_kernel::Unit;
pub use bench::Bench;
pub use check::{Contract, ContractViolation};
pub use client_kind::ClientKind;
pub use ends::{Back, Emitted, Front, Popped, SinkEnd, SourceEnd};
pub use environment::TestEnvironment;

/// Generates the unit contract as a module of tests, one per promise of [`Contract`](crate::contract::Contract). Requires the
/// unit's state or the word `stateless`. The [module](crate::contract) has an example.
#[macro_export]
macro_rules! unit_contract {
    (name: $name:ident, unit: $unit:expr, inputs: $inputs:expr
     $(, clients: [$($client:expr),* $(,)?])?, state $(,)?) => {
        $crate::unit_contract! {
            name: $name, unit: $unit, inputs: $inputs $(, clients: [$($client),*])?,
            state: |unit| unit.state.clone() => |unit, state| unit.state = state
        }
    };
    (name: $name:ident, unit: $unit:expr, inputs: $inputs:expr
     $(, clients: [$($client:expr),* $(,)?])?, stateless $(,)?) => {
        $crate::unit_contract! {
            name: $name, unit: $unit, inputs: $inputs $(, clients: [$($client),*])?,
            state: |_| () => |_, ()| ()
        }
    };
    (name: $name:ident, unit: $unit:expr, inputs: $inputs:expr
     $(, clients: [$($client:expr),* $(,)?])?, state: $get:expr => $set:expr $(,)?) => {
        #[cfg(test)]
        mod $name {
            #[allow(unused_imports, reason = "a contract may need nothing from around it")]
            use super::*;
            #[allow(unused_imports, reason = "a unit may have no memory client")]
            use $crate::contract::ClientKind;

            fn contract() -> $crate::contract::Contract<
                impl $crate::contract::Unit<In: $crate::contract::Popped, Out: $crate::contract::Emitted> + Clone + 'static,
            > {
                $crate::contract::Contract::new($unit, $inputs, $get, $set)
                    $(.clients(&[$($client),*]))?
            }

            $crate::unit_contract! { @tests
                reset_is_idempotent
                runs_are_deterministic
                no_token_is_lost_or_doubled
                back_pressure_changes_no_token
                steps_keep_within_largest_step
                work_after_data_is_part_of_latency
                state_round_trips
                accounting_sums_to_the_total
                engines_report_the_same
                nothing_is_left_at_the_end
            }
        }
    };
    (@tests $($check:ident)*) => {
        $(#[test]
        fn $check() {
            if let Err(broken) = contract().$check() {
                panic!("{broken}");
            }
        })*
    };
}
