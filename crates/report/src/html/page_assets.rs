//! Contents of a page beside the report.

use super::parameters::ParameterRow;
use super::pictures::PagePicture;

/// Parts of a page that are not in the report.
#[derive(Clone, Debug, Default)]
pub struct PageAssets {
    /// The drawing of the machine, as in its `diagram.txt`; empty for none.
    pub diagram: String,
    /// Pictures of the last frame.
    pub pictures: Vec<PagePicture>,
    /// Parameters of the machine.
    pub parameters: Vec<ParameterRow>,
}
