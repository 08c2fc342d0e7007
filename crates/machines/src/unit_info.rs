//! The boxes of a block diagram, in words.

/// A box of the block diagram.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UnitInfo {
    /// Name in the report.
    pub name: &'static str,
    /// The patent's reference numeral; empty where the patent has no such box.
    pub numeral: &'static str,
    /// What it does.
    pub role: &'static str,
    /// Where its code is.
    pub code: &'static str,
}

/// A row of the table.
pub(crate) const fn unit(name: &'static str, numeral: &'static str, role: &'static str, code: &'static str) -> UnitInfo {
    UnitInfo { name, numeral, role, code }
}

/// The tests of a machine's table: `checks_the_table!(Machine, [config, ...])`. Its stages are those that are wired under any of
/// these configurations, whichever way in.
#[cfg(test)]
macro_rules! checks_the_table {
    ($machine:ident, [$($config:expr),+]) => {
        use $crate::unit_info::tests::{code_is_there, diagram_is_complete, names_the_stages};
        use $crate::{SceneFront, TraceFront};

        fn all() -> Vec<basrelief_kernel::StageTopology> {
            let mut all = Vec::new();
            for config in [$($config),+] {
                let scene = SceneFront::new(std::iter::empty::<basrelief_signals::Draw>(), &config);
                all.extend(basrelief_kernel::topology(&mut $machine::new(scene, &config).unwrap()));
                let trace = std::iter::empty::<Result<(basrelief_signals::Control, Option<u64>), String>>();
                let trace = TraceFront::new(trace, &config);
                all.extend(basrelief_kernel::topology(&mut $machine::new(trace, &config).unwrap()));
            }
            all
        }

        #[test]
        fn the_table_names_exactly_the_stages_that_are_wired() {
            names_the_stages(UNITS, &all());
        }

        #[test]
        fn the_diagram_shows_every_fifo_every_client_and_every_numeral() {
            diagram_is_complete(DIAGRAM, UNITS, &all());
        }

        #[test]
        fn the_code_is_where_the_table_says() {
            code_is_there(UNITS);
        }
    };
}
#[cfg(test)]
pub(crate) use checks_the_table;

#[cfg(test)]
pub(crate) mod tests {
    use super::UnitInfo;
    use basrelief_kernel::StageTopology;
    use std::collections::BTreeSet;
    use std::path::Path;

    /// The table names exactly the stages that are wired.
    pub(crate) fn names_the_stages(units: &[UnitInfo], stages: &[StageTopology]) {
        let wired: BTreeSet<&str> = stages.iter().map(|s| s.name.as_str()).collect();
        let named: BTreeSet<&str> = units.iter().map(|u| u.name).collect();
        assert_eq!(wired, named);
    }

    /// The diagram shows every FIFO, every client and every numeral.
    pub(crate) fn diagram_is_complete(diagram: &str, units: &[UnitInfo], stages: &[StageTopology]) {
        for stage in stages {
            for name in stage.inputs.iter().chain(&stage.outputs).chain(&stage.clients) {
                assert!(diagram.contains(name.as_str()), "{name}");
            }
        }
        for unit in units.iter().filter(|u| !u.numeral.is_empty()) {
            assert!(diagram.contains(&format!("({})", unit.numeral)), "{}", unit.name);
        }
    }

    /// The code is where the table says.
    pub(crate) fn code_is_there(units: &[UnitInfo]) {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        for unit in units {
            assert!(root.join(unit.code).exists(), "{}", unit.code);
        }
    }
}
