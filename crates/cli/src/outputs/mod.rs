//! Output files: [`basrelief_outputs`] writes them, and checks here keep them apart from each other and from inputs.

mod distinct;
mod earlier;
#[cfg(test)]
mod tests;

pub use basrelief_outputs::{OutputFolder, PartialFile, remove_all, remove_remains};
pub use distinct::{OF_A_RUN, REPORT, RUN_RECORDING, check_distinct, check_outputs_keep_inputs, not_stdout, recording_in};
pub use earlier::earlier_files;
