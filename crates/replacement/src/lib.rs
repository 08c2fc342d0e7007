//! Basrelief: normal-vector replacement unit (110)
