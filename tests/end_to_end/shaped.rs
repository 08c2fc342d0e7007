//! The modelled path against a real one of the same rate and latency.

use crate::relay::relay;
use crate::remote::Server;
use crate::support::Place;
use std::time::Duration;

/// A slow path, so that what the host takes beside it is little; the rest of the table of docs/defer.md is made by the example
/// `shaped_path`.
#[test]
fn a_modelled_path_takes_as_long_as_a_real_one_of_its_rate_and_latency() {
    let place = Place::new();
    let server = Server::start(&place, "serve demo:gallery --listen 127.0.0.1:0");
    let address = server.1.trim_start_matches("http://").trim_end_matches('/');
    let shaped = relay(address, 500_000.0, Duration::from_millis(50)).expect("a relay");
    let path = "--set path.bits_per_second=500000 --set path.latency_us=50000";
    place.ok(&format!("run --from http://{shaped}/ --size 320x240 {path} --set defer.mode=progressive --quiet --out out"));
    let report = place.report("out");
    for name in ["first_picture", "final_picture"] {
        let time = |of: &serde_json::Value, unit: &str| of[format!("{name}_{unit}")].as_f64().expect("a time");
        let (modelled, path) = (time(&report["figures"], "ms"), &report["host"]["path"]);
        let measured = time(path, "ms") - time(path, "idle_ms");
        assert!((measured / modelled - 1.0).abs() < 0.1, "{name}: modelled {modelled}, measured {measured}");
    }
}
