//! Waiting for memory: rate of look-ups.

use crate::common::machine_runs::most_arrivals;
use basrelief_machines::texel::TexelMachineConfig;

#[test]
fn misses_arrive_at_the_rate_of_look_ups() {
    let most = |rate| most_arrivals::<TexelMachineConfig>("brick", &[("cache.texture.lookups_per_cycle", rate)], "texel_read");
    assert_eq!([most("1"), most("2")], [1, 2]);
}
