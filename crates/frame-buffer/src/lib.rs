//! Basrelief: frame buffer (126) and video output
