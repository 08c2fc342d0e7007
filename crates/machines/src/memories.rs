//! Memories of a machine: defaults, values derived from the clock, provenance, and checks.

use crate::problem::{ConfigProblem, problem};
use basrelief_kernel::parts::PartNumber;
use basrelief_kernel::{CacheConfig, MemoryConfig, MemoryPart, MemorySystem};
use basrelief_parameters::{ConfigError, Parameter, Parameters, Provenance, UserSettings};

/// Declares the memories of a machine, each with its default configuration and the provenance of the defaults. The clock converts the times
/// of memory parts to cycles:
///
/// ```text
/// memories! {
///     /// Memories of the machine.
///     pub struct MemoryConfigs at HZ {
///         /// Graphics-data memory (124).
///         graphics = MemoryConfig { part: MemoryPart::Ddr400, channels: 4, ..MemoryConfig::default() }
///             => [part: Assumed("2005"), channels: Assumed("256 bits")],
///     }
/// }
/// ```
macro_rules! memories {
    ($(#[doc = $about:literal])* pub struct $configs:ident at $hz:ident {
        $($(#[doc = $doc:literal])* $name:ident = $default:expr => [$($inner:ident: $kind:ident($why:literal)),+ $(,)?],)*
    }) => {
        basrelief_parameters::parameter_groups! {
            $(#[doc = $about])*
            pub struct $configs {
                $($(#[doc = $doc])* $name: basrelief_kernel::MemoryConfig = $default.at($hz) => [$($inner: $kind($why)),+],)*
            }
        }

        impl $configs {
            /// Returns all memories, by name.
            pub(crate) fn each(&self) -> Vec<(&'static str, &basrelief_kernel::MemoryConfig)> {
                vec![$((stringify!($name), &self.$name)),*]
            }

            fn each_mut(&mut self) -> Vec<(&'static str, &mut basrelief_kernel::MemoryConfig)> {
                vec![$((stringify!($name), &mut self.$name)),*]
            }
        }
    };
}
pub(crate) use memories;

/// Configuration of a machine with memories.
pub(crate) trait HasMemories: Parameters {
    /// Returns the clock frequency \[Hz\].
    fn hz(&self) -> u64;
    /// Returns all memories, by name.
    fn memories(&self) -> Vec<(&'static str, &MemoryConfig)>;
    /// Returns all memories for modification, by name.
    fn memories_mut(&mut self) -> Vec<(&'static str, &mut MemoryConfig)>;
}

/// Implements [`HasMemories`] for a configuration with the fields `clock` and `memory`.
macro_rules! memories_of {
    ($config:ty) => {
        impl $crate::memories::HasMemories for $config {
            fn hz(&self) -> u64 {
                self.clock.hz
            }

            fn memories(&self) -> Vec<(&'static str, &basrelief_kernel::MemoryConfig)> {
                self.memory.each()
            }

            fn memories_mut(&mut self) -> Vec<(&'static str, &mut basrelief_kernel::MemoryConfig)> {
                self.memory.each_mut()
            }
        }
    };
}
pub(crate) use memories_of;

/// Adds a client with its own cache, whose look-ups take several cycles (law 5). Returns the client's number.
pub(crate) fn add_cached_client(
    memories: &mut MemorySystem,
    name: &str,
    memory: usize,
    outstanding: u32,
    cache_name: &str,
    cache: &CacheConfig,
) -> usize {
    let client = memories.add_cached_client(name, memory, outstanding, cache_name, cache);
    memories.spread_look_ups(client);
    client
}

/// Fills in the values of memory parts at the machine's clock ([`Parameters::complete`]).
pub(crate) fn complete<C: HasMemories>(config: &mut C, given: &UserSettings<'_>) -> Result<(), ConfigError> {
    let hz = config.hz();
    for (name, memory) in config.memories_mut() {
        let unfit = memory.take_part(hz, |field| given.contains(&format!("memory.{name}.{field}")));
        unfit.map_err(|unfit| ConfigError::Unfit { key: format!("memory.{name}.part"), message: unfit.to_string() })?;
    }
    Ok(())
}

/// Adds the data sheets of memory parts to the provenance of parameters ([`Parameters::explain`]).
pub(crate) fn explain<C: HasMemories>(config: &C, table: &mut [Parameter]) {
    let default = C::default();
    let parts = default.memories().into_iter().map(|(_, memory)| memory.part);
    for ((name, memory), by_default) in config.memories().into_iter().zip(parts) {
        let group = format!("memory.{name}.");
        let numbers = MemoryNumbers::new(memory, config.hz(), by_default);
        let of_it = table.iter_mut().filter_map(|p| p.key.strip_prefix(&group).map(str::to_owned).map(|field| (field, p)));
        for (field, parameter) in of_it {
            if let Some(provenance) = numbers.provenance(&field, parameter) {
                parameter.provenance = provenance;
            }
        }
    }
}

/// A memory with the numbers of its part.
pub(crate) struct MemoryNumbers<'a> {
    memory: &'a MemoryConfig,
    by_default: MemoryPart,
    /// Numbers of the part alone; `None` if it does not fit the clock.
    sheet: Option<Vec<PartNumber>>,
    /// Numbers of the part with the memory's burst.
    with_burst: Vec<PartNumber>,
    /// Numbers of the default part, if the memory has none.
    of_default: Vec<PartNumber>,
}

impl<'a> MemoryNumbers<'a> {
    pub(crate) fn new(memory: &'a MemoryConfig, hz: u64, by_default: MemoryPart) -> Self {
        let part = memory.part;
        let sheet = part.numbers(hz, [None; 2]).ok();
        let beside = |name: &str, value: u32| {
            let differs = sheet.iter().flatten().any(|number| number.name == name && number.value != value);
            differs.then_some(value)
        };
        let burst = [beside("burst_bytes", memory.burst_bytes), beside("burst_cycles", memory.burst_cycles)];
        let with_burst = part.numbers(hz, burst).unwrap_or_default();
        let of_default = if part == MemoryPart::Custom { by_default.numbers(hz, [None; 2]).unwrap_or_default() } else { vec![] };
        Self { memory, by_default, sheet, with_burst, of_default }
    }

    /// Returns the number that the part gives a field, with the burst of the memory.
    fn of_part(&self, field: &str) -> Option<&PartNumber> {
        let numbers = if field.starts_with("burst") { self.sheet.as_ref()? } else { &self.with_burst };
        numbers.iter().find(|number| number.name == field)
    }

    /// Returns the value that a field has because of the part, if no value is given.
    pub(crate) fn value_of_part(&self, field: &str) -> Option<u32> {
        match field {
            "channel_bytes" if self.memory.part != MemoryPart::Custom => Some(self.memory.burst_bytes),
            _ => self.of_part(field).map(|number| number.value),
        }
    }

    /// Returns the provenance of a field; `None` if it does not depend on the memory part.
    fn provenance(&self, field: &str, parameter: &Parameter) -> Option<Provenance> {
        let part = self.memory.part;
        if field == "part" {
            let chosen = parameter.provenance.text();
            return part.about().map(|about| Provenance::Assumed(format!("{chosen}. {}: {about}", part.name()).into()));
        }
        if field == "channel_bytes" && self.value_of_part(field).is_some_and(|value| parameter.default == value) {
            return Some(Provenance::Derived("the burst size, because a burst lies in one channel".into()));
        }
        self.sheet.as_ref()?;
        let Some(number) = self.of_part(field) else {
            let by_default = self.of_default.iter().any(|number| number.name == field);
            return by_default.then(|| {
                let default = self.by_default.name();
                let text = format!("set by the user or by default; no memory part is selected (the default part is {default})");
                Provenance::Assumed(text.into())
            });
        };
        if parameter.default == number.value {
            return Some(number.provenance.clone());
        }
        let text = format!("set by the user; the memory part has {}: {}", number.value, number.provenance.text());
        Some(Provenance::Assumed(text.into()))
    }
}

/// Checks the assumptions of law 4 for each memory.
pub(crate) fn check_memories<C: HasMemories>(config: &C) -> Result<(), ConfigProblem> {
    config.memories().into_iter().try_for_each(|(name, memory)| check_memory(name, memory))
}

fn check_memory(name: &str, m: &MemoryConfig) -> Result<(), ConfigProblem> {
    let wrong = |field: &str, message: String| problem(&format!("memory.{name}.{field}"), message);
    let MemoryConfig { refi, rfc, rcd, row_bytes, channel_bytes, burst_bytes, .. } = *m;
    if refi > 0 && refi <= rfc + rcd {
        return wrong(
            "refi",
            format!(
                "is {refi}, but after a refresh an activation waits for rfc = {rfc} cycles and its data for rcd = {rcd}; set it to {} or more, or to 0 for no refresh",
                rfc + rcd + 1
            ),
        );
    }
    if row_bytes < burst_bytes {
        return wrong(
            "row_bytes",
            format!(
                "is {row_bytes}, but a burst lies in one row and has {burst_bytes} bytes; set it to {burst_bytes} or more, or burst_bytes to less"
            ),
        );
    }
    if m.channels > 1 && channel_bytes < burst_bytes {
        return wrong(
            "channel_bytes",
            format!(
                "is {channel_bytes}, but a burst lies in one channel and has {burst_bytes} bytes; set it to {burst_bytes} or more, or burst_bytes to less"
            ),
        );
    }
    Ok(())
}
