//! Random settings of a machine.

use proptest::prelude::*;

/// Settings, as in `--set`.
pub type Settings = Vec<(String, String)>;

/// Alternatives, the default first. An alternative is a list of settings.
pub type Axis = &'static [&'static [(&'static str, &'static str)]];

/// One alternative of each axis.
pub fn choices(axes: &'static [Axis]) -> impl Strategy<Value = Settings> {
    let choice: Vec<_> = axes.iter().map(|axis| (0..axis.len()).prop_map(move |i| axis[i])).collect();
    choice.prop_map(|chosen| chosen.into_iter().flatten().map(|&(key, value)| (key.to_owned(), value.to_owned())).collect())
}

/// One alternative of each axis, and depths and latencies of these FIFOs, from 1 slot.
pub fn choices_and_fifos(axes: &'static [Axis], fifos: &'static [&'static str]) -> impl Strategy<Value = Settings> {
    let depth = prop::option::of(prop_oneof![Just(1u32), Just(2), 3u32..=64]);
    let latency = prop_oneof![3 => Just(1u32), 1 => 2u32..9];
    let fifos = prop::collection::vec((depth, latency), fifos.len()).prop_map(move |all| -> Settings {
        let set = |(name, (depth, latency)): (&&str, (Option<u32>, u32))| {
            let depth = depth.map(|d| (format!("fifo.{name}.depth"), d.to_string()));
            let latency = (latency > 1).then(|| (format!("fifo.{name}.latency"), latency.to_string()));
            depth.into_iter().chain(latency)
        };
        fifos.iter().zip(all).flat_map(set).collect()
    });
    (choices(axes), fifos).prop_map(|(mut settings, fifos)| {
        settings.extend(fifos);
        settings
    })
}

/// Borrows the settings for the loader.
pub fn borrowed(settings: &Settings) -> Vec<(&str, &str)> {
    settings.iter().map(|(key, value)| (key.as_str(), value.as_str())).collect()
}
