//! Lifetimes of the most expensive polygons.

use super::markup::{Html, el};
use super::svg::{label, px, stacked_rects, svg};
use super::units::{STATES, legend};
use crate::model::PolygonCost;
use crate::model::Report;
use crate::number::thousands;

/// Maximum number of shown polygons.
const MOST: usize = 40;
/// Width of the drawing, room for the names left of it and for the cycles below; from one row to the next, and how much of it is filled.
const WIDTH: f64 = 900.0;
const LEFT: f64 = 150.0;
const BELOW: f64 = 18.0;
const ROW: f64 = 13.0;
const FILLED: f64 = 10.0;

/// Draws a bar for each of the most expensive polygons, in their order, from its first step to its last. The bar is divided like the
/// cycles of the polygon, and frames are marked. Empty for a report without costs.
pub(super) fn draw(report: &Report) -> Html {
    let (Some(costs), Some(cycles)) = (&report.costs, &report.cycles) else { return Html::default() };
    let mut shown: Vec<&PolygonCost> = costs.polygons.iter().filter(|p| p.to > p.from).take(MOST).collect();
    shown.sort_by_key(|p| (p.from, p.frame, p.polygon));
    if shown.is_empty() {
        return Html::default();
    }
    let height = ROW * shown.len() as f64;
    let across = |cycle: u64| LEFT + (WIDTH - LEFT) * cycle as f64 / cycles.total.max(1) as f64;
    let ends = cycles.frames.iter().scan(0, |end, frame| {
        *end += frame;
        Some(*end)
    });
    let frames = ends.map(|end| el("path", &[("class", "axis"), ("d", &format!("M{} 0 V{}", px(across(end)), px(height)))], []));
    let bars = shown.iter().enumerate().flat_map(|(row, p)| {
        let (y, from, to) = (row as f64 * ROW, across(p.from), across(p.to));
        let name = format!("frame {}, polygon {}", p.frame + 1, p.polygon);
        let life = [from, y + 1.0, (to - from).max(1.0), FILLED];
        [label("end", LEFT - 6.0, y + FILLED, &name), stacked_rects(&breakdown_parts(p, &name), p.breakdown.cycles, life)]
    });
    let numbers = [label("start", LEFT, height + 14.0, "cycle 0"), label("end", WIDTH, height + 14.0, &thousands(cycles.total))];
    let says = format!("Lifetimes of the {} most expensive polygons, over {} cycles", shown.len(), thousands(cycles.total));
    let shapes = frames.chain(bars).chain(numbers).collect();
    let drawing = svg("lives", (WIDTH, height + BELOW), &says, "xMinYMid meet", shapes);
    let states = STATES.into_iter().filter(|(class, _)| *class != "done");
    [legend(states), drawing].into_iter().collect()
}

/// Cycle breakdown of a polygon.
fn breakdown_parts(p: &PolygonCost, name: &str) -> Vec<(&'static str, String, u64)> {
    let label = |what: &str| format!("{name}, cycles {} to {}, {what}", thousands(p.from), thousands(p.to));
    let spent = [
        ("busy", p.breakdown.busy),
        ("memory", p.breakdown.memory),
        ("starved", p.breakdown.starved),
        ("blocked", p.breakdown.blocked),
    ];
    spent.into_iter().map(|(class, cycles)| (class, label(class), cycles)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::CycleBreakdown;
    use crate::samples;

    #[test]
    fn polygon_bars_span_lifetimes_in_order() {
        let mut report = samples::balanced();
        assert_eq!(draw(&report).into_text(), "", "no costs, no drawing");
        report.costs = samples::costed().costs;
        let total = report.cycles.as_ref().unwrap().total;
        let spent = CycleBreakdown { cycles: 4, busy: 3, memory: 1, ..CycleBreakdown::default() };
        let polygon = |polygon, from, to| PolygonCost { polygon, from, to, breakdown: spent, ..PolygonCost::default() };
        let polygons = vec![polygon(7, total / 2, total), polygon(8, 0, total / 4), polygon(9, 0, 0)];
        report.costs.as_mut().unwrap().polygons = polygons;
        let text = draw(&report).into_text();
        let places = ["polygon 8<", "polygon 7<"].map(|name| text.find(name).unwrap());
        assert!(places[0] < places[1], "{text}");
        // A quarter of 750, of which three quarters at work; half, from the middle on.
        assert!(text.contains("class=\"busy\" x=\"150\" y=\"1\" width=\"140.62\""), "{text}");
        assert!(text.contains("class=\"memory\" x=\"806.25\" y=\"14\" width=\"93.75\""), "{text}");
        assert!(!text.contains("polygon 9"), "it has no cycle");
    }
}
