//! `basrelief size-fifos`: the smallest FIFOs that keep the cycles of recorded runs.

use super::tape::{failure, open, place_of};
use crate::args::SizeFifosArgs;
use crate::error::{Done, Failure, print};
use basrelief_input::Budget;
use basrelief_report::text::number::{real, thousands};
use basrelief_session::{Choice, Sizes, size_fifos as sized};
use std::fmt::Write;
use std::io::Read;
use std::path::PathBuf;

/// Finds them, and prints them.
pub fn size_fifos(args: &SizeFifosArgs, budget: &Budget) -> Done {
    let tapes: Vec<PathBuf> = args.tapes.iter().map(|tape| place_of(tape)).collect();
    let mut files = tapes.iter().map(|tape| open(tape)).collect::<Done<Vec<_>>>()?;
    let names = tapes.iter().map(|tape| tape.display().to_string()).collect::<Vec<_>>().join(", ");
    let readers = files.iter_mut().map(|file| file as &mut dyn Read).collect();
    let sizes = sized(readers, &args.within, budget).map_err(failure(&names))?;
    if args.json {
        return print(&format!("{}\n", serde_json::to_string_pretty(&sizes).map_err(Failure::bad)?));
    }
    print(&text(&sizes))
}

fn text(sizes: &Sizes) -> String {
    let mut text = format!("{}: the smallest FIFOs found that keep the cycles of the frames\n\n", sizes.machine);
    let Some((recorded, found)) = sizes.choices.split_first() else { return text };
    for choice in &sizes.choices {
        let within = choice.within_percent.map_or("as recorded".into(), |percent| format!("within {} %", real(percent)));
        let fewer = fewer(choice, recorded);
        let cycles: Vec<String> = choice.cycles.iter().map(|cycles| thousands(*cycles)).collect();
        let (slots, bits) = (thousands(choice.slots), thousands(choice.bits));
        let _ =
            writeln!(text, "{within:<14} {slots:>8} slots {bits:>12} bits  {cycles} cycles{fewer}", cycles = cycles.join(", "));
    }
    for choice in found {
        let changed = choice.depths.iter().zip(&recorded.depths).filter(|(new, old)| new.1 != old.1);
        let sets: Vec<String> = changed.map(|((name, depth), _)| format!("--set fifo.{name}.depth={depth}")).collect();
        let _ = write!(text, "\nwithin {} %: {}\n", real(choice.within_percent.unwrap_or_default()), sets.join(" "));
    }
    text
}

fn fewer(choice: &Choice, recorded: &Choice) -> String {
    if choice.within_percent.is_none() {
        return String::new();
    }
    format!("  ({:.0} % fewer slots)", 100.0 - 100.0 * choice.slots as f64 / recorded.slots.max(1) as f64)
}
