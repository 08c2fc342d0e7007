//! Methods of a machine that do the same work within the same error bound.

/// Methods of a machine with configuration `S`.
#[derive(Clone, Copy, Debug)]
pub struct MethodSpecs<S: 'static> {
    /// Returns the error bound of all methods.
    pub bound: fn(&S) -> f64,
    /// Report figure with the error of a run.
    pub error: &'static str,
    /// The methods, in the order of the table. The first has no number.
    pub methods: &'static [MethodSpec<S>],
}

/// A method, which may have a number to choose.
#[derive(Clone, Copy, Debug)]
pub struct MethodSpec<S: 'static> {
    /// Returns the name of the method with this number.
    pub name: fn(u32) -> String,
    /// Returns the settings that select the method, as `KEY=VALUE`.
    pub settings: fn(u32) -> Vec<String>,
    /// Selects the method in a configuration.
    pub set: fn(&mut S, u32),
    /// Choice of the number.
    pub number: MethodNumber,
}

/// Choice of a method's number: the one with the least work among those within the error bound.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MethodNumber {
    /// The method has no number.
    Absent,
    /// The largest number: larger numbers mean less work and a larger error.
    Largest,
    /// The smallest number: smaller numbers mean less work and a larger error.
    Smallest,
}
