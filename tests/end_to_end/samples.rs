//! The sample traces.

use crate::support::{Place, workspace};

// Claim: as recorded_trace_draws_same_images_in_all_forms.
#[test]
fn sample_traces_verify_with_both_engines() {
    let place = Place::new();
    let said = place.ok(&format!("verify {}", workspace().join("traces").display())).out;
    assert!(said.lines().count() >= 6, "{said}");
}
