//! Basrelief: what travels on the wires of the machines
