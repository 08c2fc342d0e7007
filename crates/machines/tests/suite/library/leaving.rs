//! User input at given times.

use basrelief_machines::defer::{DeferConfig, RunAhead};

/// Two views of three pictures each, at intervals of a millisecond, with two tiles before each picture.
fn ahead() -> RunAhead {
    let pictures = (0..6).map(|i| (100_000, i % 3 == 2)).collect();
    let came = (0..6).flat_map(|i| [100_000 * i + 30_000, 100_000 * i + 60_000]).collect();
    RunAhead { pictures, came, tiles: vec![6, 6] }
}

fn left_at(ms: &[f64]) -> DeferConfig {
    let mut config = DeferConfig::default();
    config.defer.left_at_ms = ms.to_vec();
    config.never_left(2)
}

// Claim: as user_times_become_stable_tile_counts_475.
#[test]
fn view_is_left_before_the_first_tile_that_is_late() {
    let at = |ms: &[f64]| left_at(ms).left_once_more(&ahead()).map(|next| next.defer.left_at_tile);
    assert_eq!(at(&[0.0]), Some(vec![1, 0]));
    assert_eq!(at(&[0.3]), Some(vec![2, 0]), "the first has just come");
    assert_eq!(at(&[0.99]), Some(vec![3, 0]), "after the tiles of the first picture");
    assert_eq!(at(&[2.59]), Some(vec![6, 0]));
    assert_eq!(at(&[2.6]), None, "all tiles have arrived, so the view is complete");
    assert_eq!(at(&[1.5, 9.0]), Some(vec![4, 0]), "one after the other");
    assert_eq!(at(&[]), None);
}

// Claim: as user_times_become_stable_tile_counts_475.
#[test]
fn next_view_begins_when_the_user_turns_to_it() {
    let config = left_at(&[7.0, 8.0]);
    let ms = |cycles: &[u64]| cycles.iter().map(|c| *c as f64 / 1e5).collect::<Vec<_>>();
    assert_eq!(ms(&config.shown_at(&ahead().pictures)), [1.0, 2.0, 3.0, 8.0, 9.0, 10.0], "4 ms are idle");
    assert_eq!(config.left_once_more(&ahead()).unwrap().defer.left_at_tile, [0, 3], "1 ms into the second view");
    assert_eq!(ms(&left_at(&[2.0]).shown_at(&ahead().pictures)), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0], "or later");
}
