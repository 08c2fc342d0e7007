//! Basrelief: normal-vector mapping unit (108)
