//! The machines by name, and the configuration of any of them. A machine is a line of the list in this file and a file in
//! this folder, which says what a run needs to know of it.

mod bump;
mod defer;
mod info;
mod shade;
mod spec;
mod texel;

pub use info::{ConfigLoader, MachineInfo};
pub use spec::TileFetch;
pub(crate) use spec::{Logs, MachineSpec, PictureRecord, RunSummary};

use crate::costs::CostPoints;
use basrelief_deferred_renderer::Preview;
use basrelief_kernel::Hardware;
use basrelief_machines::bump::BumpProcessorConfig;
use basrelief_machines::defer::DeferConfig;
use basrelief_machines::shade::ShadeConfig;
use basrelief_machines::texel::TexelMachineConfig;
use basrelief_machines::{ConfigProblem, FrontConfig};
use basrelief_parameters::{Parameter, resolved};
use serde_json::Value;
use spec::ShortCut;

/// Makes all that depends on which machines there are: the configuration of any of them, the list by name, and
/// `for_machine!(config, machine => expression)`, which does the same for whichever machine is configured. (`$` is handed in
/// because a macro cannot write it into the macro that it makes.)
macro_rules! machines {
    ($d:tt $($(#[$about:meta])+ $machine:ident($config:ty),)+) => {
        /// The configuration of any machine.
        #[derive(Clone, Debug, PartialEq)]
        pub enum MachineConfig {
            $($(#[$about])+ $machine($config),)+
        }

        $(impl From<$config> for MachineConfig {
            fn from(config: $config) -> Self {
                Self::$machine(config)
            }
        })+

        /// All machines, the default one first.
        // (No constant: that would be made anew in every crate that names it, with all the functions that it refers to.)
        pub static MACHINES: &[MachineInfo] = &[$(MachineInfo::of::<$config>()),+];

        macro_rules! for_machine {
            ($d config:expr, $d machine:ident => $d body:expr) => {
                match $d config {
                    $($crate::machines::MachineConfig::$machine($d machine) => $d body,)+
                }
            };
        }
        pub(crate) use for_machine;
    };
}

machines! { $
    /// The quantized bump-mapping processor.
    Bump(BumpProcessorConfig),
    /// The figure shading device.
    Shade(ShadeConfig),
    /// The texture mapping system.
    Texel(TexelMachineConfig),
    /// The rate-limited renderer.
    Defer(DeferConfig),
}

impl Default for MachineConfig {
    fn default() -> Self {
        BumpProcessorConfig::default().into()
    }
}

impl MachineConfig {
    /// The machine.
    pub fn machine(&self) -> &'static MachineInfo {
        fn info<S: MachineSpec>(_: &S) -> &'static MachineInfo
        where
            MachineConfig: From<S>,
        {
            const { &MachineInfo::of::<S>() }
        }
        for_machine!(self, machine => info(machine))
    }

    /// All parameters, in groups as in TOML.
    pub fn to_value(&self) -> Value {
        for_machine!(self, machine => serde_json::to_value(machine)).unwrap_or_default()
    }

    /// All parameters, in the order of the block diagram, with the values they have here and where these come from.
    pub fn parameters(&self) -> Vec<Parameter> {
        for_machine!(self, machine => resolved(machine))
    }

    /// What the machine is built of, unit by unit, each before the FIFOs that it fills; then caches.
    ///
    /// # Errors
    /// Parameters, each in its range, that do not fit together.
    pub fn hardware(&self) -> Result<Vec<Hardware>, ConfigProblem> {
        for_machine!(self, machine => machine.hardware())
    }

    /// The machine as it is, without each of its short cuts in turn, and without any: names and configurations. Nothing
    /// where it has none.
    pub(crate) fn ablations(&self) -> Vec<(String, Self)> {
        for_machine!(self, machine => ablations(machine))
    }

    /// How the machine asks for tiles, where it fetches any.
    pub fn tile_fetch(&self) -> Option<TileFetch> {
        for_machine!(self, machine => machine.tile_fetch())
    }

    /// What colours pictures that are still growing, where the machine fetches tiles.
    pub fn preview(&self) -> Option<Preview> {
        for_machine!(self, machine => MachineSpec::preview(machine))
    }

    pub(crate) fn cost_points(&self) -> CostPoints {
        fn of<S: MachineSpec>(_: &S) -> CostPoints {
            S::COST_POINTS
        }
        for_machine!(self, machine => of(machine))
    }

    pub(crate) fn front(&self) -> FrontConfig {
        for_machine!(self, machine => machine.front())
    }
}

fn ablations<S: MachineSpec>(machine: &S) -> Vec<(String, MachineConfig)>
where
    MachineConfig: From<S>,
{
    if S::SHORT_CUTS.is_empty() {
        return vec![];
    }
    let without = |short_cuts: &[ShortCut<S>]| {
        let mut machine = machine.clone();
        short_cuts.iter().for_each(|(_, switch_off)| switch_off(&mut machine));
        MachineConfig::from(machine)
    };
    let each = S::SHORT_CUTS.iter().map(|one| (format!("without {}", one.0), without(&[*one])));
    let all = ("without any".into(), without(S::SHORT_CUTS));
    std::iter::once(("as configured".into(), without(&[]))).chain(each).chain([all]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exhibits::content::{ExhibitInfo, Form};
    use basrelief_scene::DEMOS;

    #[test]
    fn every_demo_is_made_for_one_machine() {
        let mut made_for: Vec<&str> = MACHINES.iter().flat_map(|m| m.demos).copied().collect();
        let mut all: Vec<&str> = DEMOS.iter().map(|d| d.name).collect();
        made_for.sort_unstable();
        all.sort_unstable();
        assert_eq!(made_for, all);
        assert_eq!(MachineInfo::of_demo("goblet@8").name, "shade");
        assert_eq!(MachineInfo::of_demo("coin").name, "bump");
    }

    #[test]
    fn an_ablation_switches_off_one_short_cut_at_a_time_and_then_all() {
        let variants = MachineConfig::from(ShadeConfig::default()).ablations();
        let off = |c: &MachineConfig| {
            let MachineConfig::Shade(c) = c else { panic!("another machine") };
            let s = &c.shortcut;
            [!s.specular_negligible.enabled, !s.flatness.enabled, !s.same_plane.enabled]
        };
        let switched: Vec<[bool; 3]> = variants.iter().map(|(_, c)| off(c)).collect();
        assert_eq!(switched, [[false; 3], [true, false, false], [false, true, false], [false, false, true], [true; 3]]);
        assert_eq!(variants[0].0, "as configured");
        assert!(MachineConfig::default().ablations().is_empty());
    }

    #[test]
    fn a_machine_is_found_by_its_name_and_configures_itself() {
        for machine in MACHINES {
            let config = MachineInfo::named(machine.name).unwrap().load("", &[]).unwrap();
            assert_eq!(config.machine().name, machine.name);
            let first = &machine.parameters()[0];
            assert_eq!(config.to_value().pointer(&format!("/{}", first.key.replace('.', "/"))), Some(&first.default));
        }
        assert_eq!(MachineConfig::default().machine().name, MACHINES[0].name);
        assert!(MachineInfo::named("lathe").unwrap_err().contains("expected bump, shade, texel, defer"));
    }

    /// Lines are asked for by name alone, and a picture's name is that of its file.
    #[test]
    fn no_two_exhibits_of_a_form_have_one_name() {
        let all: Vec<_> = MACHINES.iter().flat_map(|m| m.exhibits()).collect();
        let lines = |e: &ExhibitInfo| e.form == Form::Lines;
        for (n, one) in all.iter().enumerate() {
            let same = |other: &&ExhibitInfo| other.name == one.name && lines(other) == lines(one);
            assert_eq!(all[n..].iter().filter(same).count(), 1, "{}", one.name);
        }
    }
}
