//! The sample traces.

use crate::support::{Place, workspace};

#[test]
fn sample_traces_verify_with_both_engines() {
    let place = Place::new();
    let said = place.ok(&format!("verify {}", workspace().join("traces").display())).out;
    assert!(said.lines().count() >= 6, "{said}");
}
