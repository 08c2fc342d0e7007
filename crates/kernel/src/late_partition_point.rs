//! A search of sorted entries from their end.

/// As `partition_point`, in steps that double from the end, because most questions are about late entries.
pub(crate) fn late_partition_point<T>(sorted: &[T], is_before: impl Fn(&T) -> bool) -> usize {
    let (mut high, mut step) = (sorted.len(), 1);
    while high > 0 {
        let low = high.saturating_sub(step);
        if is_before(&sorted[low]) {
            return low + sorted[low..high].partition_point(is_before);
        }
        (high, step) = (low, 2 * step);
    }
    0
}

#[cfg(test)]
mod tests {
    use super::late_partition_point;

    #[test]
    fn search_from_the_end_finds_each_boundary() {
        for length in 0..40 {
            let sorted: Vec<usize> = (0..length).collect();
            for boundary in 0..=length {
                assert_eq!(late_partition_point(&sorted, |&entry| entry < boundary), boundary, "of {length}");
            }
        }
    }
}
