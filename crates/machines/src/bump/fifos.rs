//! The FIFOs of the machine.

use crate::fifos::fifos;
use basrelief_frame_buffer::FrameDone;
use basrelief_signals::{Control, Draw, Flow, Fragment, Indexes, Pixel, PseudoNormals, Shaded, Stamp};

fifos! {
    /// FIFOs of the bump-mapping processor, by name. Defaults hold full rate (law 2): latency of the producer + FIFO
    /// latency + 1, and on the way out of a unit that waits for memory its loaded latency too.
    pub struct FifoConfigs, Fifos {
        /// Host to geometry processor: triangles.
        draws: Draw = 16,
        /// Geometry processor to rasterizer: the display list.
        polygons: Control = 16,
        /// Rasterizer to z-test or distributor: fragments.
        fragments: Flow<Stamp<Fragment>> = 32,
        /// Z-test to distributor, with early z.
        tested_fragments: Flow<Stamp<Fragment>> = 64,
        /// Distributor to normal-vector mapping unit: fragments of bump targets.
        bump_fragments: Flow<Stamp<Fragment>> = 16,
        /// Distributor to graphics processor: other fragments.
        plain_fragments: Flow<Stamp<Fragment>> = 64,
        /// Mapping unit to replacement unit: pseudo-normals N'.
        pseudo_normals: Flow<PseudoNormals> = 64,
        /// Replacement unit to brightness fetch unit: indexes.
        indexes: Flow<Indexes> = 32,
        /// Brightness fetch unit to graphics processor: brightness.
        shaded: Flow<Stamp<Shaded>> = 64,
        /// Graphics processor to frame buffer, or to the z-test without early z: pixels.
        pixels: Flow<Stamp<Pixel>> = 64,
        /// Z-test to frame buffer, without early z.
        tested_pixels: Flow<Stamp<Pixel>> = 64,
        /// Frame buffer to video output: finished frames, as many as wait for the display
        /// while drawing goes on.
        finished_frames: FrameDone = 256,
    }
}
