//! The examples run and print the documented text.
#![allow(dead_code, reason = "each example has a `main`, which prints the text")]

#[path = "../../examples/pipeline.rs"]
mod pipeline;
#[path = "../../examples/shared_memory.rs"]
mod shared_memory;
#[path = "../../examples/visitor.rs"]
mod visitor;

#[test]
fn pipeline() {
    // Squares start at 1, 4, 7, 10. The last square is visible and popped at 10 + 2 + 1.
    assert_eq!(
        pipeline::text(),
        "[0, 1, 4, 9] in 14 cycles\n\
         source busy  4, starved  0, blocked 5, done 5\n\
         square busy 12, starved  1, blocked 0, done 1\n\
         sink   busy  4, starved 10, blocked 0, done 0\n"
    );
}

#[test]
fn shared_memory() {
    // Steps are 1 cycle apart, and the line arrives long after the last step. There is one miss, and the other look-ups are
    // merged with it.
    assert_eq!(
        shared_memory::text(),
        "table: 1 reads, 0 writes, 1 bursts\n\
         log: 0 reads, 8 writes, 8 bursts\n\
         cache: 0 hits, 1 misses, 7 merged\n"
    );
}

#[test]
fn visitor() {
    assert_eq!(
        visitor::text(),
        "[source] --numbers-->\n\
         --numbers--> [fork] --even--> --odd-->\n\
         --even--> [even sink]\n\
         --odd--> [odd sink]\n"
    );
}
