//! Basrelief: the machines: wiring and configuration
