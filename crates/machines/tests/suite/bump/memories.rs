//! Memories: order of ports, address map, and warnings.

use crate::bump::runs::{config, small_demo, timed};
use basrelief_machines::bump::warnings;
use basrelief_signals::{Pixel, Stamp, layout, lines, quantization_memory};

#[test]
fn ports_are_numbered_from_the_end_of_the_pipeline() {
    let ran = timed(&small_demo("golf-ball", 1), &[]);
    let ports = |memory: &str| -> Vec<String> {
        let memory = ran.report.memories.iter().find(|m| m.name == memory).expect("a memory of this name");
        memory.ports.iter().map(|p| p.client.clone()).collect()
    };
    assert_eq!(ports("normal_map"), ["texels"]);
    assert_eq!(ports("quantization"), ["clut_read", "clut_build", "tables", "gathered"]);
    assert_eq!(ports("graphics"), ["pixel_write", "scan_out", "flip", "color_texels", "held", "z_read", "z_write"]);
}

#[test]
fn surfaces_in_one_memory_do_not_overlap() {
    for [width, height] in [[4096, 4096], [4097, 4095], [16_384, 1024], [1024, 16_384], [16_384, 1], [1, 16_384]] {
        assert!(layout::fits(width, height));
        // Colours and depths have 4 bytes at most, lines have 16 pixels.
        let bytes = lines::<Stamp<Pixel>>(width, height) * 64;
        assert!(bytes <= layout::COLOR_BUFFER_STRIDE, "{width} x {height}");
        assert!(layout::Z_BUFFER + bytes <= layout::COLOR_TEXTURES, "{width} x {height}");
    }
    assert!(layout::color_buffer(1) + layout::COLOR_BUFFER_STRIDE <= layout::Z_BUFFER);
    assert!(layout::color_buffer(2) > 2 * layout::HELD_RESULTS);
    assert!((0..8).all(|buffer| layout::color_buffer(buffer) + layout::COLOR_BUFFER_STRIDE <= layout::color_buffer(buffer + 1)));
    const { assert!(layout::COLOR_TEXTURES < layout::HELD_RESULTS) };
    assert!(quantization_memory::vq_table(8) <= quantization_memory::CLUTS);
    let cluts = 8 * quantization_memory::clut_stride(65_536, 4);
    assert!(quantization_memory::CLUTS + cluts <= quantization_memory::OTHER_TABLES);
}

#[test]
fn colour_and_depth_of_a_pixel_lie_in_different_banks() {
    let memory = config(&[]).memory.graphics;
    // Law 4: the channels take the bytes in turn.
    let stripe = u64::from(memory.channel_bytes * memory.channels);
    let in_channel =
        |address: u64| address / stripe * u64::from(memory.channel_bytes) + address % u64::from(memory.channel_bytes);
    let bank = |address: u64| in_channel(address) / u64::from(memory.row_bytes) % u64::from(memory.banks);
    for (line, buffer) in (0..10_000).flat_map(|line| [(line, 0), (line, 1)]) {
        let color = layout::color_buffer(buffer) + line * 64;
        assert_ne!(bank(color), bank(layout::Z_BUFFER + line * 64), "line {line} of buffer {buffer}");
    }
}

#[test]
fn slow_fifos_small_stamps_and_needless_tables_warn() {
    let scene = small_demo("golf-ball", 1);
    let said = |settings: &[(&str, &str)]| warnings(&config(settings), &timed(&scene, settings).facts);
    assert_eq!(said(&[]), [""; 0], "defaults hold full rate");
    let slow = said(&[("fifo.shaded.depth", "2")]);
    assert!(slow.len() == 1 && slow[0].contains("fifo.shaded.depth = 2 allows 2 tokens in"), "{slow:?}");
    let small = said(&[("memory.graphics.outstanding", "8")]);
    assert!(small.len() == 1 && small[0].starts_with("stamps have 2 instead of 4 fragments"), "{small:?}");
    let few = said(&[("brightness.levels", "3")]);
    assert!(few.len() == 1 && few[0].contains("VQ tables, but the unit holds 2"), "{few:?}");
    let needless = said(&[("replacement.entries", "16384")]);
    assert!(needless.iter().any(|w| w.contains("claim 3 requires fewer entries")), "{needless:?}");
}
