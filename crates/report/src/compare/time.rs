//! Clocks and frame times of two runs. Cycles of different clocks last differently long, so only times compare such runs.

use crate::model::Report;
use crate::number::{change_in_words, decimal, real};

/// Clocks of two timed runs.
pub(super) enum Clocks {
    /// Both run at the same clock, or neither report states one.
    Same,
    /// Clocks of A and B \[Hz\].
    Differ([f64; 2]),
    /// B states no clock.
    OnlyInA,
    /// A states no clock.
    OnlyInB,
}

impl Clocks {
    pub(super) fn of(a: &Report, b: &Report) -> Self {
        match (a.clock_hz(), b.clock_hz()) {
            (Some(a), Some(b)) if a != b => Self::Differ([a, b]),
            (Some(_), None) => Self::OnlyInA,
            (None, Some(_)) => Self::OnlyInB,
            _ => Self::Same,
        }
    }

    /// Returns the sentences about time. `None` if cycles alone compare the runs.
    pub(super) fn sentences(&self, a: &Report, b: &Report) -> Option<String> {
        let [hz_a, hz_b] = match self {
            Self::Same => return None,
            Self::OnlyInA => return Some("B states no clock, so times cannot be compared.".into()),
            Self::OnlyInB => return Some("A states no clock, so times cannot be compared.".into()),
            Self::Differ(hz) => hz.map(|hz| real(hz / 1e6)),
        };
        let clocks = format!("The clock is {hz_a} MHz in A and {hz_b} MHz in B");
        Some(match a.frame_ms().zip(b.frame_ms()) {
            Some((before, after)) => {
                let change = if before > 0.0 { format!(" ({})", change_in_words(after / before - 1.0)) } else { String::new() };
                format!("A frame takes {} ms in A and {} ms in B{change}. {clocks}.", decimal(before, 3), decimal(after, 3))
            }
            None => format!("{clocks}, so equal cycles are different times."),
        })
    }
}

#[cfg(test)]
mod tests {
    use crate::compare::compare;
    use crate::model::Report;
    use crate::samples::{balanced, before_and_after, functional, set_clock};

    fn at(hz: u64) -> Report {
        let mut report = balanced();
        set_clock(&mut report, hz);
        report
    }

    fn explanation(a: &Report, b: &Report) -> String {
        compare(a, b, None).explanation
    }

    #[test]
    fn time_comes_before_cycles_if_clocks_differ() {
        let said = explanation(&balanced(), &at(20_000_000));
        let wanted = "A frame takes 2.500 ms in A and 25.000 ms in B (+900 %). The clock is 200 MHz in A and 20 MHz in B. Both runs \
                      take 1,000,000 render cycles.";
        assert_eq!(said, wanted);
        let (a, b) = before_and_after();
        assert!(!explanation(&a, &b).contains(" ms "), "one clock needs no time");
    }

    #[test]
    fn machines_with_different_clocks_are_compared_in_time() {
        let other = Report { machine: "texel".into(), ..at(50_000_000) };
        let said = explanation(&balanced(), &other);
        assert!(
            said.starts_with("The machines differ: ") && said.contains(" A frame takes 2.500 ms in A and 10.000 ms in B"),
            "{said}"
        );
    }

    #[test]
    fn runs_without_frames_state_both_clocks() {
        let mut cut = at(100_000_000);
        cut.outcome.kind = crate::model::OutcomeKind::Limit;
        cut.cycles.as_mut().unwrap().frames.clear();
        let said = explanation(&balanced(), &cut);
        let end =
            " The clock is 200 MHz in A and 100 MHz in B, so equal cycles are different times. Both runs take 1,000,000 cycles.";
        assert!(said.starts_with("B did not finish (limit).") && said.ends_with(end), "{said}");
    }

    #[test]
    fn missing_clock_is_reported() {
        let mut bare = balanced();
        bare.config.as_object_mut().unwrap().remove("clock");
        assert!(explanation(&balanced(), &bare).starts_with("B states no clock, so times cannot be compared. Both runs"));
        assert!(explanation(&bare, &balanced()).starts_with("A states no clock"));
        assert!(!explanation(&bare, &Report { warnings: vec![], ..bare.clone() }).contains("clock"));
    }

    #[test]
    fn functional_runs_have_no_time_to_compare() {
        let mut slow = functional();
        set_clock(&mut slow, 20_000_000);
        assert!(explanation(&functional(), &slow).starts_with("Both runs are functional"));
        assert!(explanation(&balanced(), &slow).starts_with("One run is functional"));
    }
}
