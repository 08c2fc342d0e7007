use super::*;
use crate::rules::{Constraint, ObjectiveDirection};
use crate::samples;
use crate::table::{Cell, Column, ColumnRole, PointState, Row};
use proptest::prelude::*;

/// The page without styles, data and script, which are no markup; panics where the rest is not well-formed.
fn parsed(page: &str) -> String {
    let mut rest = page.strip_prefix("<!DOCTYPE html>\n").unwrap().to_owned();
    for (start, end) in [("<style>", "</style>"), ("<script", "</script>")] {
        while let Some(from) = rest.find(start) {
            let to = rest[from..].find(end).unwrap() + end.len();
            rest.replace_range(from..from + to, "");
        }
    }
    roxmltree::Document::parse(&rest).unwrap_or_else(|error| panic!("{error}: {rest}"));
    rest
}

/// Data that the script reads.
fn data_of(page: &str) -> serde_json::Value {
    let (_, rest) = page.split_once("id=\"sweep\">").unwrap();
    serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap()
}

fn shown(table: &Table) -> String {
    page(table, &PageOptions::default())
}

#[test]
fn a_page_has_its_parts_in_their_order() {
    let page = shown(&samples::device(300));
    let markup = parsed(&page);
    let ids: Vec<&str> = markup.split("<section id=\"").skip(1).filter_map(|part| part.split('"').next()).collect();
    assert_eq!(ids, ["scatter", "front", "sensitivities", "pairs", "parallel", "failures"]);
    assert!(markup.contains("300 points, 4 failed. "), "{markup}");
    assert!(markup.contains("meet quality.psnr_db &gt;= 18. "));
    assert!(markup.contains("deadlock: `shaded` is full"));
    assert!(markup.contains("All 296 completed points are drawn."));
    assert_eq!(markup.matches("class=\"map\"").count(), 9);
}

#[test]
fn the_policy_allows_this_script_and_no_other() {
    let page = shown(&samples::device(30));
    let (_, rest) = page.split_once("script-src &#39;sha256-").unwrap();
    let code = page.rsplit_once("<script>").unwrap().1.split_once("</script>").unwrap().0;
    assert_eq!(rest.split_once("&#39;").unwrap().0, BASE64_STANDARD.encode(Sha256::digest(code)));
    assert_eq!(page.matches("<script").count(), 2);
    for text in ["http:", "https:", "@import", "url(", "javascript:", "style=", "onclick"] {
        assert!(!page.contains(text), "{text}");
    }
}

#[test]
fn names_are_escaped_wherever_they_stand() {
    let bad = "</script>\"'/><script>alert('x')</script>&";
    let mut table = samples::device(30);
    table.title = bad.into();
    table.columns.iter_mut().for_each(|column| (column.name, column.unit) = (format!("{}{bad}", column.name), bad.into()));
    table.constraints[0].column = table.columns[1].name.clone();
    table.rows.iter_mut().for_each(|row| {
        row.id += bad;
        row.picture = Some(bad.into());
        row.cells[6] = Cell::Text(bad.into());
        row.state = if row.state == PointState::Ok { PointState::Ok } else { PointState::Failed(bad.into()) };
    });
    let page = page(&table, &PageOptions { files: vec![(bad.into(), bad.into())], ..PageOptions::default() });
    parsed(&page);
    assert_eq!((page.matches("<script").count(), page.matches("</script").count()), (2, 2));
    assert_eq!(data_of(&page)["rows"][0]["picture"], bad);
}

/// The script moves points back to the positions at which Rust has drawn them.
#[test]
fn the_script_has_the_positions_that_are_drawn() {
    let page = shown(&samples::device(300));
    let data = data_of(&page);
    let number = |value: &serde_json::Value| value.as_f64().unwrap();
    let [left, top, width, height] = [0, 1, 2, 3].map(|at| number(&data["box"][at]));
    let (x, y) = (&data["columns"][0]["at"], &data["columns"][1]["at"]);
    let markup = parsed(&page);
    let points = markup.split_once("<g id=\"points\">").unwrap().1.split_once("</g>").unwrap().0;
    let of = |point: &str, name: &str| -> f64 {
        point.split_once(&format!(" {name}=\"")).unwrap().1.split('"').next().unwrap().parse().unwrap()
    };
    let points: Vec<&str> = points.split("<circle class=\"point").skip(1).collect();
    assert_eq!((points.len(), data["rows"].as_array().unwrap().len()), (296, 296));
    for (row, point) in points.into_iter().enumerate() {
        assert!((of(point, "cx") - (left + number(&x[row]) / 1e4 * width)).abs() < 0.01);
        assert!((of(point, "cy") - (top + (1.0 - number(&y[row]) / 1e4) * height)).abs() < 0.01);
    }
}

#[test]
fn drawn_points_are_bounded() {
    let mut table = samples::device(10_000);
    let all = shown(&table);
    assert!(all.contains("1,821 of 9,717 others, at equal distances in the plan"));
    // The legend has four circles, the cursor is one.
    assert_eq!(all.matches("<circle").count(), data::MOST_ROWS + 5);
    // Every point on the front, by a stair of 10,000 steps.
    table.constraints.clear();
    for (at, row) in table.rows.iter_mut().enumerate() {
        row.state = PointState::Ok;
        row.cells[0] = Cell::Whole(at as u64);
        row.cells[1] = Cell::Whole(at as u64);
    }
    let stair = shown(&table);
    assert!(stair.contains("1,000 of 10,000 Pareto-optimal points"));
    assert_eq!(stair.matches("<circle").count(), 1_000 + 4);
    for page in [all, stair] {
        assert!(page.len() < 2_000_000, "{}", page.len());
        assert!(page.matches('<').count() < 30_000, "{}", page.matches('<').count());
    }
}

/// Elements of a page that begin with this text, up to the end of their tag.
fn tags<'a>(page: &'a str, start: &'a str) -> impl Iterator<Item = &'a str> {
    page.split(start).skip(1).filter_map(|rest| rest.split('>').next())
}

#[test]
fn ties_of_front_are_counted_and_named() {
    let mut table = samples::device(30);
    assert!(!shown(&table).contains(">ties<"));
    let best = crate::front(&table)[0];
    let twin = Row { id: "twin".into(), ..table.rows[best].clone() };
    table.rows.push(twin);
    let page = shown(&table);
    assert!(page.contains(" One more point equals a Pareto-optimal point in every objective.") && page.contains(">ties</th>"));
    let rows = data_of(&page)["rows"].clone();
    let ranks: Vec<_> = rows.as_array().unwrap().iter().filter(|row| row["tie"] == true).map(|row| &row["id"]).collect();
    assert_eq!(ranks, ["twin"]);
    table.rows.push(Row { id: "third".into(), ..table.rows[best].clone() });
    assert!(shown(&table).contains(" 2 more points equal a Pareto-optimal point in every objective."));
}

#[test]
fn third_objective_is_the_first_colour() {
    let page = shown(&samples::device(30));
    let colour = page.split_once("<select id=\"colour\">").unwrap().1.split_once("</select>").unwrap().0;
    assert!(colour.contains("<option value=\"2\" selected=\"selected\">memories.bytes [bytes]</option>"), "{colour}");
    let mut table = samples::device(30);
    table.columns[2].role = ColumnRole::Figure;
    let page = shown(&table);
    let colour = page.split_once("<select id=\"colour\">").unwrap().1.split_once("</select>").unwrap().0;
    assert!(colour.contains("<option value=\"\" selected=\"selected\">Pareto front</option>"), "{colour}");
}

#[test]
fn default_point_is_drawn_and_marked() {
    let table = samples::device(9_000);
    // A point that thinning leaves out.
    let all = shown(&table);
    let ordinary = table.rows.iter().filter(|row| row.state == PointState::Ok).find(|row| !all.contains(&row.id)).unwrap();
    let page = page(&table, &PageOptions { defaults: vec![ordinary.id.clone()], ..PageOptions::default() });
    // One in the plot, one in the legend.
    assert_eq!(tags(&page, "<circle class=\"point").filter(|tag| tag.contains(" default\"")).count(), 2);
    let rows = data_of(&page)["rows"].as_array().unwrap().clone();
    let marked: Vec<_> = rows.iter().filter(|row| row["default"] == true).map(|row| row["id"].clone()).collect();
    assert_eq!(marked, [ordinary.id.as_str()]);
    assert!(page.contains("default: as in the plan without its axes"));
    assert!(!all.contains("default: as in the plan without its axes"));
}

#[test]
fn decibels_have_two_decimals() {
    let page = shown(&samples::device(300));
    let data = data_of(&page);
    let place = data["names"].as_array().unwrap().iter().position(|name| name == "quality.psnr_db [dB]").unwrap();
    for row in data["rows"].as_array().unwrap() {
        let text = row["values"][place].as_str().unwrap();
        assert_eq!(text.split_once('.').map(|(_, decimals)| decimals.len()), Some(2), "{text}");
    }
    let headline = page.split_once("<dt>highest quality.psnr_db [dB]</dt><dd>").unwrap().1.split('<').next().unwrap();
    assert_eq!(headline.split_once('.').map(|(_, decimals)| decimals.len()), Some(2), "{headline}");
}

#[test]
fn hashes_are_folded_away() {
    let table = samples::device(300);
    let markup = parsed(&shown(&table));
    let visible = markup.split("<details>").map(|part| part.split_once("</details>").map_or(part, |(_, rest)| rest));
    let texts: String =
        visible.flat_map(|part| part.split('<').filter_map(|tag| tag.split_once('>'))).map(|(_, text)| text).collect();
    let told: Vec<&str> = table.rows.iter().map(|row| &row.id[..10]).filter(|id| texts.contains(id)).collect();
    assert!(told.is_empty(), "{told:?}");
}

#[test]
fn axes_of_the_scatter_are_named_by_direction() {
    let page = shown(&samples::device(30));
    for name in ["horizontal axis", "vertical axis", "colour"] {
        assert!(page.contains(&format!("<label>{name} <select")), "{name}");
    }
}

/// Lines through one value of an axis lie beside each other, in its band, from the best to the worst.
#[test]
fn lines_are_spread_around_the_values_of_an_axis() {
    let table = samples::device(300);
    let data = data_of(&shown(&table));
    let names = |place: usize| data["columns"][place]["at"].clone();
    let axes = data["parallel"]["axes"].as_array().unwrap();
    let spread: Vec<_> = axes.iter().filter(|axis| !axis[2].is_null()).collect();
    assert_eq!(spread.len(), 2, "lanes and levels have few values: {axes:?}");
    for axis in spread {
        let values = names(axis[0].as_u64().unwrap() as usize);
        let rows = values.as_array().unwrap().iter().zip(axis[2].as_array().unwrap());
        let rows: Vec<(i64, i64)> = rows.map(|(at, spread)| (at.as_i64().unwrap(), spread.as_i64().unwrap())).collect();
        let mut places: Vec<i64> = rows.iter().map(|(_, spread)| *spread).collect();
        let mut levels: Vec<i64> = rows.iter().map(|(at, _)| *at).collect();
        for all in [&mut places, &mut levels] {
            all.sort_unstable();
            all.dedup();
        }
        assert!(places.len() > 200, "{} places of {} lines", places.len(), rows.len());
        let apart = levels.windows(2).map(|pair| pair[1] - pair[0]).min().unwrap();
        assert!(rows.iter().all(|(at, spread)| 2 * (at - spread).abs() < apart), "a line leaves the band of its value");
    }
}

#[test]
fn the_page_is_the_same_to_the_byte() {
    let hash = Sha256::digest(shown(&samples::device(300)));
    insta::assert_snapshot!("page_sha256", hash.iter().map(|byte| format!("{byte:02x}")).collect::<String>());
}

#[test]
fn constant_objective_is_stated() {
    let mut table = samples::device(300);
    table.rows.iter_mut().for_each(|row| row.cells[1] = Cell::Number(20.5));
    let page = shown(&table);
    assert!(page.contains("quality.psnr_db [dB] is 20.50 for all values of the axes."));
    assert_eq!(page.matches("class=\"map\"").count(), 6);
}

#[test]
fn tables_with_little_in_them_have_a_page() {
    let full = samples::device(30);
    let rows =
        |keep: fn(&Row) -> bool| Table { rows: full.rows.iter().filter(|row| keep(row)).cloned().collect(), ..full.clone() };
    let mut pending = full.clone();
    pending.rows.iter_mut().for_each(|row| (row.state, row.cells) = (PointState::Pending, vec![Cell::Missing; 7]));
    let mut aimless = full.clone();
    aimless.columns.iter_mut().for_each(|column| column.role = ColumnRole::Figure);
    assert!(shown(&Table::default()).contains("0 points. No objective is named"));
    assert!(shown(&rows(|row| row.state != PointState::Ok)).contains("1 point, 1 failed."));
    assert!(shown(&pending).contains("30 points, 30 not run yet."));
    assert!(shown(&aimless).contains("No objective is named"));
    for table in [Table::default(), rows(|_| false), rows(|row| row.state != PointState::Ok), pending, aimless] {
        parsed(&shown(&table));
    }
}

fn cell() -> impl Strategy<Value = Cell> {
    prop_oneof![
        any::<f64>().prop_map(Cell::Number),
        (0u64..5).prop_map(Cell::Whole),
        any::<u64>().prop_map(Cell::Whole),
        "[a-c<&\" é]{0,20}".prop_map(Cell::Text),
        Just(Cell::Missing),
    ]
}

fn table() -> impl Strategy<Value = Table> {
    let role = prop_oneof![
        Just(ColumnRole::Axis),
        Just(ColumnRole::Objective(ObjectiveDirection::Min)),
        Just(ColumnRole::Objective(ObjectiveDirection::Max)),
        Just(ColumnRole::Figure)
    ];
    let state =
        prop_oneof![4 => Just(PointState::Ok), 1 => Just(PointState::Failed("fault".into())), 1 => Just(PointState::Pending)];
    let tables = prop::collection::vec(role, 1..6).prop_flat_map(move |roles| {
        let row = (state.clone(), prop::collection::vec(cell(), roles.len()));
        (Just(roles), prop::collection::vec(row, 0..30))
    });
    tables.prop_map(|(roles, rows)| Table {
        title: "any".into(),
        columns: roles
            .iter()
            .enumerate()
            .map(|(at, &role)| Column { name: format!("c{at}"), unit: "u".into(), role, what: "".into() })
            .collect(),
        constraints: vec![Constraint { column: "c0".into(), comparison: crate::ConstraintRelation::AtMost, bound: 3.0 }],
        rows: rows
            .into_iter()
            .enumerate()
            .map(|(at, (state, cells))| Row { id: at.to_string(), state, cells, picture: None })
            .collect(),
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn any_table_has_a_page(table in table()) {
        parsed(&shown(&table));
        crate::vega(&table);
    }
}
