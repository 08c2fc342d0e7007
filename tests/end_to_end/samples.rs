//! The sample traces.

use crate::support::{Place, workspace};

#[test]
fn every_sample_trace_is_what_it_expects_with_both_engines() {
    let place = Place::new();
    let said = place.ok(&format!("verify {}", workspace().join("traces").display())).out;
    assert!(said.lines().count() >= 6, "{said}");
}
