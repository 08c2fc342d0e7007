//! The eleven laws of time, one module per law, each with cycles computed by hand.

mod law_10_occupancy;
mod law_11_marks;
mod law_1_fifo;
mod law_2_slots;
mod law_3_start;
mod law_4_memory;
mod law_5_cache;
mod law_6_contents;
mod law_7_control_in_band;
mod law_8_end;
mod law_9_accounting;
