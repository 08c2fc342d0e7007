//! Observer of tests that read recordings.

use basrelief_sim::Observer;

/// Collects the bytes of a recording.
#[derive(Default)]
pub struct CollectedRecording(pub Vec<u8>);

impl Observer for CollectedRecording {
    fn recording(&mut self, bytes: &[u8], _: bool) -> Result<(), String> {
        self.0.extend_from_slice(bytes);
        Ok(())
    }
}
