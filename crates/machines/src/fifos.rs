//! The FIFOs of a machine, each named in one place.

/// Declares the FIFOs of a machine in the order of its block diagram, each with what it carries, its token and the slots that it
/// has where nothing else is configured:
///
/// ```text
/// fifos! {
///     /// FIFOs of the machine.
///     pub struct FifoConfigs, Fifos {
///         /// Rasterizer to z-test: fragments.
///         fragments: Flow<Stamp<Fragment>> = 32,
///     }
/// }
/// ```
///
/// From that line follow the parameters `fifo.fragments.depth` and `fifo.fragments.latency` (the first struct), the FIFO itself
/// (a field of the second, made by its `new`), and the name by which reports and drawings call it.
macro_rules! fifos {
    ($(#[doc = $about:literal])* pub struct $configs:ident, $fifos:ident {
        $($(#[doc = $doc:literal])* $name:ident : $token:ty = $slots:literal,)*
    }) => {
        basrelief_parameters::parameter_groups! {
            $(#[doc = $about])*
            pub struct $configs {
                $($(#[doc = $doc])* $name: basrelief_kernel::FifoConfig = $crate::fifos::slots($slots),)*
            }
        }

        $(#[doc = $about])*
        #[derive(Clone, Debug)]
        pub(super) struct $fifos {
            $($(#[doc = $doc])* pub(super) $name: basrelief_kernel::Fifo<$token>,)*
        }

        impl $fifos {
            /// All of them, empty, as configured; `widths` are those of their tokens.
            pub(super) fn new(config: &$configs, widths: &basrelief_signals::SignalWidths) -> Self {
                Self { $($name: $crate::fifos::fifo(stringify!($name), &config.$name, widths),)* }
            }
        }
    };
}
pub(crate) use fifos;

use basrelief_kernel::{Fifo, FifoConfig, Label};
use basrelief_signals::{BitWidth, SignalWidths};

/// A FIFO as configured.
pub(crate) fn fifo<T: BitWidth>(name: &str, config: &FifoConfig, widths: &SignalWidths) -> Fifo<T> {
    let fifo = Fifo::new(name, config.depth as usize, u64::from(config.latency));
    fifo.carrying(T::bits(widths)).labelled(|token: &T| Label(token.attribution().into()))
}

/// What configures a FIFO of `depth` slots.
pub(crate) fn slots(depth: u32) -> FifoConfig {
    FifoConfig { depth, ..FifoConfig::default() }
}
