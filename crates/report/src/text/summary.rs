//! The first screen: cycles, picture quality, memory traffic and hardware, one line each.

use crate::model::{Hardware, Report};
use crate::number::{decimal, real, thousands};
use crate::work::work;
use basrelief_kernel::HardwareKind;
use basrelief_reference::QualityMetrics;

/// Returns the lines of the summary, for complete and incomplete runs.
pub(super) fn lines(report: &Report) -> Vec<String> {
    [cycles(report), quality(report), traffic(report), hardware(report)].into_iter().flatten().collect()
}

/// `n` of something, and by `per` how much of it for each fragment.
fn per_work_item(n: u64, per: &str, report: &Report) -> String {
    let work = work(report);
    let Some(each) = (work.count > 0).then(|| n as f64 / work.count as f64) else { return String::new() };
    format!(", {} {per} {}", decimal(each, 2), work.one)
}

/// Returns the frames to divide totals by, and the words behind the quotient.
fn per_frame(report: &Report) -> (u64, &'static str) {
    report.averaged_frames().map_or((1, ""), |frames| (frames, " per frame"))
}

fn cycles(report: &Report) -> Option<String> {
    let cycles = report.cycles.as_ref()?;
    let (all, (frames, each)) = (report.frame_cycles(), per_frame(report));
    let (least, most) = (cycles.frames.iter().min(), cycles.frames.iter().max());
    let range = least.zip(most).filter(|(least, most)| least < most && !each.is_empty() && report.pictures() == frames);
    let range = range.map_or(String::new(), |(least, most)| format!(" ({} to {})", thousands(*least), thousands(*most)));
    let hz = report.clock_hz();
    let time = hz.map_or(String::new(), |hz| {
        format!("; {} ms{each} at {} MHz", decimal(1000.0 * all as f64 / frames as f64 / hz, 3), real(hz / 1e6))
    });
    let term = report.cycles_term();
    Some(format!("{} {term}{each}{range}{}{time}", thousands(all / frames), per_work_item(all, "per", report)))
}

fn quality(report: &Report) -> Option<String> {
    let quality = report.quality.as_ref()?;
    if let frames @ 1.. = quality.frames.len() {
        let (min, max, mean) = (quality.min, quality.max, quality.mean);
        return Some(format!(
            "Worst and mean of {frames} frames: {:.2} and {:.2} dB PSNR, SSIM {:.4} and {:.4}, FLIP {:.4} and {:.4} against the \
             reference images",
            min.psnr_db, mean.psnr_db, min.ssim, mean.ssim, max.flip, mean.flip
        ));
    }
    let QualityMetrics { psnr_db, ssim, flip } = quality.last;
    Some(format!("{psnr_db:.2} dB PSNR, SSIM {ssim:.4}, FLIP {flip:.4} against the reference image"))
}

fn traffic(report: &Report) -> Option<String> {
    let bytes = report.memory_bytes()?;
    let (frames, each) = per_frame(report);
    Some(format!("{} bytes of memory traffic{each}{}", thousands(bytes / frames), per_work_item(bytes, "per", report)))
}

fn hardware(report: &Report) -> Option<String> {
    let of = |is: &dyn Fn(&&Hardware) -> bool, size: fn(&Hardware) -> u64| {
        report.hardware.iter().filter(is).map(size).fold(0, u64::saturating_add)
    };
    let bits = of(&|h| !h.kind.computes(), Hardware::bits);
    let counted =
        HardwareKind::ALL.into_iter().filter(|kind| kind.computes()).map(|kind| (kind, of(&|h| h.kind == kind, |h| h.count)));
    let name = |kind: HardwareKind, n| if n == 1 { kind.to_string().trim_end_matches('s').to_owned() } else { kind.to_string() };
    let counted = counted.filter(|(_, n)| *n > 0).map(|(kind, n)| format!(", {} {}", thousands(n), name(kind, n)));
    let area = report.hardware_area().map_or_else(String::new, |area| format!("{} gate equivalents; ", thousands(area.area_ge)));
    // A trace holds the polygons of the geometry processor.
    let without = if report.input.kind == "trace" { "; without the geometry processor, which the trace replaces" } else { "" };
    let counted = counted.collect::<String>();
    (!report.hardware.is_empty()).then(|| format!("{area}{} bits of storage{counted}{without}", thousands(bits)))
}
