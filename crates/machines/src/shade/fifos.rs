//! The FIFOs of the machine.

use crate::fifos::fifos;
use basrelief_figure_shading::{Finished, Highlights, NormalLoad, Signal};
use basrelief_frame_buffer::FrameDone;
use basrelief_signals::{Control, Draw, Flow, Pixel, Stamp};
use std::sync::Arc;

fifos! {
    /// FIFOs of the figure shading device, by name. Defaults hold full rate (law 2): latency of the producer + FIFO latency
    /// + 1, and on the way out of a unit that waits for memory its loaded latency too.
    pub struct FifoConfigs, Fifos {
        /// Host to geometry processor: triangles.
        draws: Draw = 16,
        /// Geometry processor to host interface: the display list.
        polygons: Control = 16,
        /// Host interface to microcomputer (10): what the host has sent.
        transfers: Control = 4,
        /// Microcomputer (10) to circuit (21): registers and brightness at the sample points; all control.
        figures: Signal = 4,
        /// Microcomputer (10) to circuit (50): normals at the sample points.
        normals: Arc<NormalLoad> = 4,
        /// Process 24 to selector (53): dots of flat polygons.
        flat_dots: Signal = 16,
        /// Process 24 to selector (28): dots in polyhedron mode.
        constant_dots: Signal = 16,
        /// Circuit (21) to adder (52): dots in normal-interpolation mode, all control.
        interpolated: Signal = 16,
        /// Circuit (21) to selector (28): dots in brightness-interpolation mode.
        brightness_dots: Signal = 16,
        /// Circuit (50) to gate (51): specular brightness of dots.
        highlights: Highlights = 64,
        /// Gate (51) to adder (52).
        gated: Highlights = 16,
        /// Adder (52) to selector (53).
        sums: Signal = 16,
        /// Selector (53) to selector (28).
        selected: Signal = 16,
        /// Selector (28) to the depth test, or to the frame memory (300) without it.
        pixels: Flow<Stamp<Pixel>> = 64,
        /// Depth test to frame memory (300).
        tested_pixels: Flow<Stamp<Pixel>> = 64,
        /// Selector (28) back to the host interface: polygons that are finished.
        finished: Finished = 2,
        /// Frame memory (300) to video output: finished frames, as many as wait for the display
        /// while drawing goes on.
        finished_frames: FrameDone = 256,
    }
}
