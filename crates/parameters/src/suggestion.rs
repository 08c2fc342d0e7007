//! The known name that a mistyped name probably means.

use crate::edit_distance;

/// Returns the known name, dotted or not, that is nearest to the `given` one, if any is near. Of equally near names it prefers the one whose
/// parts begin with the given parts, then the one that is nearest as a whole.
pub fn nearest<'a>(given: &str, known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let near = known.filter_map(|k| Some(((distance(given, k)?, changed_parts(given, k), edit_distance(given, k)), k)));
    near.min_by_key(|(order, _)| *order).map(|(_, k)| k)
}

/// Returns the number of parts of a known name that do not begin with the given part at the same place.
fn changed_parts(given: &str, known: &str) -> usize {
    given.split('.').zip(known.split('.')).filter(|(given, known)| !known.starts_with(given)).count()
}

/// Returns the edit distance between the `given` name and a `known` name or its group; `None` if more than half of the name or of its
/// last part differs, because such a suggestion would mislead. An equal last part has a bonus, because users forget groups more often
/// than they mistype.
fn distance(given: &str, known: &str) -> Option<usize> {
    let last = |name: &str| name.rsplit('.').next().unwrap_or_default().to_owned();
    let is_near = |edits: usize, of: &str| 2 * edits <= of.len();
    let group = known.split('.').take(given.split('.').count()).collect::<Vec<_>>().join(".");
    let end = last(given);
    // The rest of a name may be missing.
    let has_near_end = |name: &str| last(name).starts_with(&end) || is_near(edit_distance(&end, &last(name)), &end);
    let by_end = 1 + 2 * edit_distance(&end, &last(known));
    let all = [(edit_distance(given, known), known), (edit_distance(given, &group), &group), (by_end, known)];
    let near = all.into_iter().filter(|(edits, name)| is_near(*edits, given) && has_near_end(name));
    near.map(|(edits, _)| edits).min()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn name_with_the_given_beginning_is_preferred() {
        let known = ["clients.held.bytes", "clients.colour_read.bytes", "clients.z_write.bytes", "clients.z_read.bytes"];
        assert_eq!(nearest("clients.z.bytes", known.into_iter()), Some("clients.z_read.bytes"));
    }
}
