//! The FIFOs of the machine.

use crate::fifos::fifos;
use basrelief_deferred_renderer::tokens::{CellFlow, ExpandedTile, MarkFlow, Order, Parcel, PassFlow, Request, Round};
use basrelief_frame_buffer::FrameDone;
use basrelief_signals::{Control, Draw, Flow, Fragment, PictureFlow, Stamp};

fifos! {
    /// FIFOs of the rate-limited renderer, by name. Defaults hold full rate (law 2): latency of the producer + FIFO latency
    /// + 1, and on the way out of a unit that waits for memory its loaded latency too. That of tiles on the path has as many
    /// slots as there may be requests in flight: `path.requests`.
    pub struct FifoConfigs, Fifos {
        /// Host to geometry processor: triangles.
        draws: Draw = 16,
        /// Geometry processor to server (110): the display list, in its polygon memory (112).
        polygons: Control = 16,
        /// Server (110) to path: what it sends.
        parcels: Parcel = 4,
        /// Path to rasterizer: polygons.
        mesh: Control = 16,
        /// Expander to texture-data memory (130): tiles.
        expanded: ExpandedTile = 2,
        /// Rasterizer to z-test: fragments.
        fragments: Flow<Stamp<Fragment>> = 32,
        /// Z-test to the making of cells: fragments in front.
        tested_fragments: Flow<Stamp<Fragment>> = 64,
        /// To reference buffer (126): cells.
        cells: CellFlow = 32,
        /// Reference buffer (126) to identification (461): blocks of cells.
        marking: PassFlow = 8,
        /// Reference buffer (126) to final rasterization (463, 472): blocks of cells.
        colouring: PassFlow = 8,
        /// Identification (461) to tile load lists (136): tiles to mark.
        marks: MarkFlow = 16,
        /// Final rasterization (472) to tile load lists (136): tiles that would improve the picture.
        improvements: MarkFlow = 16,
        /// Tile load lists (136) to server (110): requests.
        requests: Request = 8,
        /// Tile load lists (136) to texture-data memory (130): what becomes of tiles.
        orders: Order = 16,
        /// Tile load lists (136) to reference buffer (126): whether another round follows.
        rounds: Round = 2,
        /// Final rasterization to pixel buffer (124): blocks of pixels.
        pixels: PictureFlow = 16,
        /// Pixel buffer (124) to server (110): the last picture of a frame is shown.
        shown: () = 2,
        /// Pixel buffer (124) to video output: finished pictures, as many as wait for the display
        /// while drawing goes on.
        finished_frames: FrameDone = 256,
    }
}
