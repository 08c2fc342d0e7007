//! Memory parts by name.

#[cfg(feature = "config")]
use super::{sheet::DataSheet, sheets};

/// Declares the parts: the enum, its names, and the sheet of each.
macro_rules! parts {
    ($($(#[$about:meta])+ $part:ident = $name:literal, $sheet:ident;)+) => {
        /// Memory part: the type of memory chips.
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
        #[cfg_attr(feature = "config", derive(schemars::JsonSchema))]
        pub enum MemoryPart {
            /// No part: numbers are set one by one.
            #[default]
            #[cfg_attr(feature = "serde", serde(rename = "custom"))]
            Custom,
            $($(#[$about])+ #[cfg_attr(feature = "serde", serde(rename = $name))] $part,)+
        }

        impl MemoryPart {
            /// All parts with a sheet, oldest first.
            pub const ALL: &[Self] = &[$(Self::$part),+];

            /// Name in a configuration.
            pub fn name(self) -> &'static str {
                match self {
                    Self::Custom => "custom",
                    $(Self::$part => $name,)+
                }
            }

            #[cfg(feature = "config")]
            pub(super) fn sheet(self) -> Option<&'static DataSheet> {
                match self {
                    Self::Custom => None,
                    $(Self::$part => Some(&sheets::$sheet),)+
                }
            }
        }
    };
}

parts! {
    /// Fast page mode DRAM of 80 ns, 1989.
    Fpm80 = "fpm-80", FPM_80;
    /// Extended data out DRAM of 60 ns, 1994.
    Edo60 = "edo-60", EDO_60;
    /// PC100, 1998.
    Sdr100 = "sdr-100", SDR_100;
    /// PC133, 1999.
    Sdr133 = "sdr-133", SDR_133;
    /// DDR400, 2003.
    Ddr400 = "ddr-400", DDR_400;
    /// DDR2-667, 2005.
    Ddr2At667 = "ddr2-667", DDR2_667;
    /// GDDR3 at 700 MHz, 2005.
    Gddr3At1400 = "gddr3-1400", GDDR3_1400;
    /// XDR at 400 MHz, 2005.
    Xdr3200 = "xdr-3200", XDR_3200;
    /// DRAM on the device's chip as in the PlayStation 2, 2000.
    EdramPs2 = "edram-ps2", EDRAM_PS2;
    /// Static RAM on the device's chip.
    Sram = "sram", SRAM;
    /// No latency, no conflicts, unbounded bus.
    Ideal = "ideal", IDEAL;
}
