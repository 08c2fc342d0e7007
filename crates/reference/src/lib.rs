//! Basrelief: exact pictures and picture metrics
