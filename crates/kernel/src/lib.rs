//! Basrelief: time, FIFOs, memories, engines and cycle accounting
