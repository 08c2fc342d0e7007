//! Display-list source: the replay of a recorded display list.

use crate::config::{CommandArrival, DisplayListConfig};
use crate::link::{POLYGON_BYTES, PolygonLink};
use basrelief_kernel::stats::UnitStats;
use basrelief_kernel::{Demand, MemoryPorts, Step, Unit};
use basrelief_signals::Control;
use serde::{Deserialize, Serialize};
use std::fmt::Display;

/// Counters of the display-list source.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct DisplayListSourceCounters {
    /// Commands delivered.
    pub commands: u64,
    /// Polygons on the link \[bytes\].
    pub polygon_bytes: u64,
}

/// State of the display-list source between steps. Its position in the list is the number of commands delivered.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct DisplayListSourceState {
    /// Start of the next step if nothing had ever blocked the source \[cycles\].
    pub elapsed: u64,
    /// Counters.
    pub counters: DisplayListSourceCounters,
}

/// Latest accepted recorded cycle. A damaged list must not overflow the time of a run.
const LATEST: u64 = 1 << 62;

/// A command, and the cycle at which it is due.
type DueCommand = (Control, u64);

/// Display-list source: replays a display list instead of the geometry processor (102). The list is an iterator of commands, each
/// with the cycle of its unblocked delivery if known.
///
/// Polygons use the same link, with the same cost, as polygons from a geometry processor. With `arrival = recorded`, commands are
/// delivered at their recorded cycles if nothing blocks. A blockage delays all following commands, as it would delay the geometry
/// processor. A command without a cycle, or with a past cycle, is due when it has passed the link. With `asap` all commands are.
/// An error in the list ends the run with its message.
#[derive(Clone, Debug)]
pub struct DisplayListSource<I> {
    /// Parameters.
    pub config: DisplayListConfig,
    /// State between steps.
    pub state: DisplayListSourceState,
    link: PolygonLink,
    commands: I,
    /// Next command, fetched ahead. A unit declares its end from its own state, and a step's occupancy depends on the next
    /// command.
    next: Option<Result<DueCommand, String>>,
}

impl<I, E> DisplayListSource<I>
where
    I: Iterator<Item = Result<(Control, Option<u64>), E>>,
    E: Display,
{
    /// Creates a source that replays these commands over this link.
    pub fn new(config: DisplayListConfig, link: PolygonLink, commands: I) -> Self {
        Self::resumed(config, link, commands, DisplayListSourceState::default())
    }

    /// Creates a source that continues from `state` with the same commands. It skips the delivered ones.
    pub fn resumed(config: DisplayListConfig, link: PolygonLink, commands: I, state: DisplayListSourceState) -> Self {
        let mut source = Self { config, link, state, commands, next: None };
        let delivered = usize::try_from(state.counters.commands).unwrap_or(usize::MAX);
        let command = source.commands.nth(delivered);
        // A resumed source has been occupied until the next command was due.
        source.next = source.due(command, |on_link| if delivered == 0 { on_link - 1 } else { state.elapsed });
        source
    }

    /// Returns a command and its due cycle. `brought` returns the cycle at which a command with this many cycles on the link has
    /// arrived.
    fn due(
        &self,
        command: Option<Result<(Control, Option<u64>), E>>,
        brought: impl Fn(u64) -> u64,
    ) -> Option<Result<DueCommand, String>> {
        let due = |(control, arrival): (Control, Option<u64>)| {
            let brought = brought(self.link.cycles(self.link.bytes(&control)));
            let recorded = if self.config.arrival == CommandArrival::Recorded { arrival.unwrap_or(0).min(LATEST) } else { 0 };
            (control, recorded.max(brought))
        };
        command.map(|command| command.map(due).map_err(|e| e.to_string()))
    }
}

impl<I, E> Unit for DisplayListSource<I>
where
    I: Iterator<Item = Result<(Control, Option<u64>), E>>,
    E: Display,
{
    basrelief_kernel::unit_info!("replays a recorded display list in place of host and geometry processor");
    type In = ();
    type Out = Option<Control>;

    fn demand(&self) -> Demand {
        if self.next.is_some() { Demand::Nothing } else { Demand::Finished }
    }

    fn step(&mut self, (): (), traffic: &mut MemoryPorts) -> Step<Self::Out> {
        let (control, now) = match self.next.take() {
            Some(Ok(command)) => command,
            Some(Err(message)) => {
                traffic.fault(message);
                return Step::after(0, None);
            }
            None => return Step::after(0, None),
        };
        let following = self.commands.next();
        self.next = self.due(following, |on_link| now + on_link);
        self.state.counters.commands += 1;
        self.state.counters.polygon_bytes += self.link.bytes(&control);
        // Each step starts when its command is due. Only the first starts at 0, and its latency makes up for it.
        let start = self.state.elapsed;
        let end = if let Some(Ok((_, next))) = &self.next { *next } else { now + 1 };
        self.state.elapsed = end;
        Step::after(now - start, Some(control)).busy(end - start)
    }

    fn is_empty(&self) -> bool {
        self.next.is_none()
    }

    fn report_stats(&self, stats: &mut UnitStats) {
        stats.figure("display_list_commands", self.state.counters.commands, "commands", "Commands of the display list");
        stats.figure("polygon_bytes", self.state.counters.polygon_bytes, "bytes", POLYGON_BYTES);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use basrelief_signals::{LightingStage, Polygon, Vertex, VertexAttributes};
    use std::sync::Arc;

    const LINK: PolygonLink = PolygonLink {
        bytes_per_cycle: 16,
        taken: VertexAttributes { lit: LightingStage::Nowhere, normal_maps: false, textures: false },
    };

    /// Returns the unblocked delivery cycles of commands without bytes that have these recorded cycles.
    fn delivered(arrival: CommandArrival, recorded: &[Option<u64>]) -> Vec<u64> {
        delivered_over(LINK, arrival, &Control::FrameEnd, recorded)
    }

    fn delivered_over(link: PolygonLink, arrival: CommandArrival, control: &Control, recorded: &[Option<u64>]) -> Vec<u64> {
        let commands = recorded.iter().map(|a| Ok::<_, String>((control.clone(), *a)));
        let mut source = DisplayListSource::new(DisplayListConfig { arrival }, link, commands);
        let (mut free, mut all) = (0, Vec::new());
        while source.demand() == Demand::Nothing {
            let step = source.step((), &mut MemoryPorts::default());
            assert!(step.out.is_some() && step.occupancy >= 1);
            all.push(free + step.latency);
            free += step.occupancy;
        }
        all
    }

    #[test]
    fn recorded_commands_arrive_at_their_cycles() {
        let at = |recorded: &[Option<u64>]| delivered(CommandArrival::Recorded, recorded);
        assert_eq!(at(&[Some(32), Some(33), Some(50), Some(1000)]), [32, 33, 50, 1000]);
        assert_eq!(at(&[None, None, Some(50), None, Some(52)]), [0, 1, 50, 51, 52]);
        assert_eq!(at(&[Some(9), Some(3), Some(9), Some(20)]), [9, 10, 11, 20]);
        assert_eq!(at(&[Some(7)]), [7]);
        assert_eq!(delivered(CommandArrival::Asap, &[Some(32), None, Some(1000)]), [0, 1, 2]);
    }

    #[test]
    fn replayed_polygon_occupies_link_like_a_new_one() {
        let vertices = vec![Vertex::default(); 3];
        let polygon = Polygon { vertices, material: Arc::default(), object: 0, lod: 0, bump: false, arrival: 0 };
        let polygon = Control::Polygon(Arc::new(polygon));
        // A head of three words and three positions of four: 60 bytes.
        let at = |bytes_per_cycle, arrival, recorded: &[Option<u64>]| {
            delivered_over(PolygonLink { bytes_per_cycle, ..LINK }, arrival, &polygon, recorded)
        };
        assert_eq!(at(60, CommandArrival::Asap, &[None; 3]), [0, 1, 2]);
        assert_eq!(at(16, CommandArrival::Asap, &[None; 3]), [3, 7, 11]);
        assert_eq!(at(16, CommandArrival::Recorded, &[Some(5), Some(6), Some(20), None]), [5, 9, 20, 24]);
        let lit = VertexAttributes { lit: LightingStage::InMachine, ..LINK.taken };
        assert_eq!(delivered_over(PolygonLink { taken: lit, ..LINK }, CommandArrival::Asap, &polygon, &[None; 2]), [5, 11]);
    }

    #[test]
    fn error_in_list_ends_run_with_its_message() {
        for good in 0..3 {
            let list = (0..good).map(|_| Ok((Control::FrameEnd, None))).chain([Err("line 7: truncated")]);
            let mut source = DisplayListSource::new(DisplayListConfig::default(), LINK, list);
            for _ in 0..good {
                assert!(source.step((), &mut MemoryPorts::default()).out.is_some());
            }
            assert_eq!(source.demand(), Demand::Nothing);
            let mut traffic = MemoryPorts::default();
            assert_eq!(source.step((), &mut traffic).out, None);
            assert!(format!("{traffic:?}").contains("line 7: truncated"));
            assert_eq!(source.demand(), Demand::Finished);
            assert!(source.is_empty());
        }
    }

    #[test]
    fn absurd_cycles_do_not_overflow() {
        let absurd = [Some(u64::MAX), Some(u64::MAX), None];
        assert_eq!(delivered(CommandArrival::Recorded, &absurd), [LATEST, LATEST + 1, LATEST + 2]);
    }
}
