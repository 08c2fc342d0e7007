//! Variants (a) to (e) of the replacement, and their memory traffic.

use crate::bump::promise::{exact, psnr};
use crate::bump::runs::{Ran, small_demo, timed};
use basrelief_kernel::stats::FigureValue;
use basrelief_signals::{Object, Scene};
use std::sync::Arc;

/// The demo `mixed` with its objects changed.
fn mixed(change: impl Fn(&mut Object)) -> Arc<Scene> {
    let mut scene = Arc::unwrap_or_clone(small_demo("mixed", 1));
    for object in &mut scene.objects {
        change(Arc::make_mut(object));
    }
    Arc::new(scene)
}

fn used(ran: &Ran) -> Vec<u64> {
    let Some(FigureValue::Counts(used)) = ran.facts.get("reference_normals_used") else { panic!("{:?}", ran.facts) };
    used.clone()
}

// Claim: bump, variant (a): Fixed tables are loaded once and stay from frame to frame.
#[test]
fn variant_a_fixed_tables_are_loaded_once() {
    let ran = timed(&small_demo("sphere", 3), &[("replacement.resident_tables", "8")]);
    assert_eq!((ran.count("code_books"), ran.count("gathered_bytes")), (0, 0));
    let levels = used(&ran).iter().filter(|n| **n > 0).count() as u64;
    assert_eq!(ran.count("vq_table_loads"), levels);
}

// Claim: bump, variant (b): A code book per polygon is slower and gives a better image.
#[test]
fn variant_b_code_book_per_polygon_is_slower_and_better() {
    let scene = small_demo("brick", 1);
    // The front end must keep up with polygons of one fragment, because it would otherwise limit so small a picture.
    let settings = |codebook| {
        [
            ("replacement.entries", "4"),
            ("replacement.codebook", codebook),
            ("geometry.multipliers", "64"),
            ("geometry.adders", "64"),
            ("geometry.dividers", "64"),
            ("geometry.square_roots", "64"),
            ("geometry.link_bytes", "256"),
            ("geometry.fetch_bytes_per_cycle", "256"),
        ]
    };
    let (fixed, own) = (timed(&scene, &settings("fixed")), timed(&scene, &settings("per_polygon")));
    assert!(own.count("code_books") > 0 && own.count("code_books") <= own.count("bump_polygons"));
    assert!(own.report.total > fixed.report.total);
    let exact = exact(&scene);
    let [own_db, fixed_db] = [&own, &fixed].map(|ran| psnr(&exact, &ran.frames));
    assert!(own_db > fixed_db + 3.0, "{own_db} {fixed_db}");
    // N' is written to memory (120), read and written back as directions, read in every further pass, and read at last: 6 bytes
    // per component triple.
    let gathered = own.count("gathered_bytes");
    assert_eq!(gathered, 6 * own.count("pseudo_normals"));
    let (books, passes) = (own.count("code_books"), own.count("clustering_passes"));
    assert!(passes > 2 * books, "more directions than entries, so that they are clustered: {books} {passes}");
    assert!(own.bytes("gathered") > 8 * gathered, "{} {gathered}", own.bytes("gathered"));
    assert_eq!(own.count("vq_table_loads"), 0);
}

// Claim: bump, variant (c): The object fixes the number of reference normals.
#[test]
fn variant_c_object_fixes_the_number_of_normals() {
    let with = |entries| timed(&mixed(|object| object.entries = Some(entries)), &[]);
    for entries in [5, 40] {
        let ran = with(entries);
        assert!(used(&ran).iter().all(|n| *n <= u64::from(entries)));
        assert_eq!(ran.count("vq_table_load_bytes"), ran.count("vq_table_loads") * 6 * u64::from(entries));
    }
}

// Claim: bump, variant (d): Bump mapping is decided per object, or by the LOD while drawing.
#[test]
fn variant_d_bump_mapping_is_decided_per_object() {
    let with = |bump| timed(&mixed(|object| object.bump = bump), &[]);
    let (off, on, by_machine) = (with(Some(false)), with(Some(true)), with(None));
    assert_eq!((off.count("bump_polygons"), off.count("bump_fragments")), (0, 0));
    assert_eq!(on.count("bump_polygons"), on.count("polygons"));
    assert!((1..by_machine.count("polygons")).contains(&by_machine.count("bump_polygons")));
    // The same surface either way, so the same coverage.
    assert_eq!(off.frames[0].covered, on.frames[0].covered);
}

// Claim: as variant_d_bump_mapping_is_decided_per_object.
#[test]
fn variant_d_lod_threshold_decides_while_drawing() {
    let bump = |max_lod| timed(&small_demo("brick", 1), &[("bump.max_lod", max_lod)]).count("bump_polygons");
    let rising = ["20", "28", "36", "48", "63"].map(bump);
    assert!(rising.windows(2).all(|w| w[0] < w[1]), "{rising:?}");
}

// Claim: bump, variant (e): A code book per object is better than fixed tables and worse than one per polygon.
#[test]
fn variant_e_code_book_per_object_uses_all_its_n_prime() {
    let scene = mixed(|object| object.entries = None);
    let settings = |codebook| [("replacement.entries", "16"), ("replacement.codebook", codebook)];
    let [fixed, object, polygon] = ["fixed", "per_object", "per_polygon"].map(|c| timed(&scene, &settings(c)));
    assert!((1..=scene.objects.len() as u64).contains(&object.count("code_books")));
    assert!(object.count("code_books") < polygon.count("code_books"));
    assert!(used(&object).iter().all(|n| *n <= 16));
    let passes = object.count("clustering_passes");
    assert!(passes > 16 * object.count("code_books"), "more directions than entries, so that they are clustered: {passes}");
    let exact = exact(&scene);
    let [fixed, object, polygon] = [fixed, object, polygon].map(|ran| psnr(&exact, &ran.frames));
    assert!(fixed < object && object < polygon, "{fixed} {object} {polygon}");
}

// Claim: bump, 4, 8: Only a change of light recalculates CLUTs; the report lists the cost.
#[test]
fn cluts_are_rebuilt_only_when_the_light_moves() {
    let still = timed(&small_demo("sphere", 3), &[]);
    let levels = used(&still).iter().filter(|n| **n > 0).count() as u64;
    assert_eq!(still.count("clut_rebuilds"), levels, "each level that is fetched, once");
    let circling = timed(&small_demo("coin", 3), &[]);
    assert!(circling.count("clut_rebuilds") >= 3, "its light circles");
    for ran in [still, circling] {
        // Levels of 256 entries of one byte, from reference normals of six; a power keeps its unit for 43 cycles. A cycle
        // before them reads reference normals, and a cycle after them writes entries.
        let rebuilds = ran.count("clut_rebuilds");
        assert_eq!(ran.count("clut_rebuild_bytes"), rebuilds * 256);
        assert_eq!(ran.count("clut_normal_bytes"), rebuilds * 6 * 256);
        assert_eq!(ran.count("clut_rebuild_cycles"), rebuilds * (43 * 256 + 2));
        assert_eq!(ran.bytes("clut_build"), ran.count("clut_rebuild_bytes") + ran.count("clut_normal_bytes"));
    }
}

// Claim: bump, memory: Storing indexes moves fewer bytes than full normals, including CLUTs and tables.
#[test]
fn indexes_move_fewer_bytes_than_full_normals() {
    // Indexes on the surface, reads and writes of CLUT entries, and loads of VQ tables replace the normals.
    let moved = |ran: &Ran| ran.count("index_bytes") + ran.bytes("clut_read") + ran.bytes("clut_build") + ran.bytes("tables");
    for name in ["sphere", "brick", "golf-ball"] {
        let ran = timed(&small_demo(name, 1), &[("replacement.entries", "64"), ("replacement.resident_tables", "8")]);
        assert_eq!(ran.count("index_bytes"), ran.count("searches"), "{name}");
        assert_eq!(ran.count("full_normal_bytes"), 6 * ran.count("searches"), "{name}");
        assert!(moved(&ran) < ran.count("full_normal_bytes"), "{name}: {} {}", moved(&ran), ran.count("full_normal_bytes"));
    }
}
