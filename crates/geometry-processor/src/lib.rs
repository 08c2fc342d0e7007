//! Basrelief: geometry processor (102)
