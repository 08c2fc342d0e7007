//! The known name that a mistyped name probably means.

/// Returns the known name, dotted or not, that is nearest to the `given` one, if any is near.
pub fn nearest<'a>(given: &str, known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let near = known.filter_map(|k| Some((distance(given, k)?, k)));
    near.min_by_key(|(edits, _)| *edits).map(|(_, k)| k)
}

/// Returns the Levenshtein distance between the `given` name and a `known` name or its group; `None` if more than half of the name or of its
/// last part differs, because such a suggestion would mislead. An equal last part has a bonus, because users forget groups more often
/// than they mistype.
fn distance(given: &str, known: &str) -> Option<usize> {
    let last = |name: &str| name.rsplit('.').next().unwrap_or_default().to_owned();
    let is_near = |edits: usize, of: &str| 2 * edits <= of.len();
    let group = known.split('.').take(given.split('.').count()).collect::<Vec<_>>().join(".");
    let end = last(given);
    // The rest of a name may be missing.
    let has_near_end = |name: &str| last(name).starts_with(&end) || is_near(edits(&end, &last(name)), &end);
    let by_end = 1 + 2 * edits(&end, &last(known));
    let all = [(edits(given, known), known), (edits(given, &group), &group), (by_end, known)];
    let near = all.into_iter().filter(|(edits, name)| is_near(*edits, given) && has_near_end(name));
    near.map(|(edits, _)| edits).min()
}

fn edits(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, y) in b.iter().enumerate() {
            let next = (row[j] + 1).min(row[j + 1] + 1).min(diagonal + usize::from(x != *y));
            diagonal = std::mem::replace(&mut row[j + 1], next);
        }
    }
    row[b.len()]
}
