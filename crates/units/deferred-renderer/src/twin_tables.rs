//! Contents of set-up registers (452) that twins of units in SystemVerilog need.

use crate::TexturePage;
use crate::page::PyramidLayer;
use basrelief_kernel::UnitTable;

/// Returns the tables of a page: its size in texels of the finest layer with the reciprocals, by axis, and its layers.
pub(crate) fn of_page(page: &TexturePage) -> [UnitTable; 2] {
    let sizes = page.size().into_iter().chain(page.inverse());
    let size = sizes.map(|number| vec![number.to_bits().into()]).collect();
    let layers = page.layers.iter().map(of_layer).collect();
    [
        UnitTable { name: format!("size.{}", page.number), bits: 32, entries: size },
        UnitTable { name: format!("layers.{}", page.number), bits: 96, entries: layers },
    ]
}

/// Returns width, height, tile pitch (138) and rows of tiles, 16 bits each from the lowest on, and the tile base (140).
fn of_layer(layer: &PyramidLayer) -> Vec<u64> {
    let sides = [layer.size[0], layer.size[1], layer.pitch, layer.rows];
    vec![(0..).zip(sides).map(|(i, side)| u64::from(side) << (16 * i)).sum(), layer.base.into()]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::page::PyramidCut;
    use basrelief_signals::{Image, Texture};

    #[test]
    fn tables_hold_sizes_and_layers_of_a_page() {
        let image = Image { width: 200, height: 100, texels: vec![] };
        let texture = Texture { levels: vec![image], ..Texture::default() };
        let page = TexturePage::new(3, &texture, PyramidCut::default(), 0);
        let [size, layers] = of_page(&page);
        assert_eq!((size.name.as_str(), layers.name.as_str()), ("size.3", "layers.3"));
        assert_eq!(size.entries, [200.0_f32, 100.0, 1.0 / 200.0, 1.0 / 100.0].map(|n| vec![u64::from(n.to_bits())]));
        assert_eq!(layers.entries, [[0x1_0001_0019_0032, 0], [0x1_0002_0032_0064, 1], [0x2_0004_0064_00c8, 3]]);
    }
}
