//! Basrelief: the display-list trace, its readers and writers
