//! Basrelief: glTF and OBJ import, cameras, demo scenes
