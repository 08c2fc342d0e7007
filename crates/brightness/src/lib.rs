//! Basrelief: brightness fetch unit (112)
