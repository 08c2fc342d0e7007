//! Basrelief: graphics processor (104)
