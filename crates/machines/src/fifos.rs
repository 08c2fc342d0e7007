//! Declaration of the FIFOs of a machine.

/// Declares the FIFOs of a machine in the order of the block diagram, each with a description, its token type and its default depth:
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
/// That line defines the parameters `fifo.fragments.depth` and `fifo.fragments.latency` (in the first struct), the FIFO itself (a field of
/// the second struct), and its name in reports and diagrams.
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
            /// Creates all FIFOs, empty. `widths` are the widths of the tokens.
            pub(super) fn new(config: &$configs, widths: &basrelief_signals::SignalWidths) -> Self {
                Self { $($name: $crate::fifos::fifo(stringify!($name), &config.$name, widths),)* }
            }
        }
    };
}
pub(crate) use fifos;

use basrelief_kernel::{Fifo, FifoConfig, Label, TokenField};
use basrelief_signals::{BitWidth, SignalWidths, WireField, WireFields};

/// Creates a FIFO.
pub(crate) fn fifo<T: BitWidth>(name: &str, config: &FifoConfig, widths: &SignalWidths) -> Fifo<T> {
    let fifo = Fifo::new(name, config.depth as usize, u64::from(config.latency));
    let of_tokens = *widths;
    fifo.carrying(T::bits(widths)).labelled(|token: &T| Label(token.attribution().into())).packed(
        move |token: &T| WireFields::pack(token, &of_tokens),
        move || WireFields::list::<T>(&of_tokens).into_iter().map(token_field).collect(),
    )
}

fn token_field(WireField { name, first, bits }: WireField) -> TokenField {
    TokenField { name, first, bits }
}

/// Returns the default configuration of a FIFO with this depth.
pub(crate) fn slots(depth: u32) -> FifoConfig {
    FifoConfig { depth, ..FifoConfig::default() }
}
