//! `--tile-cache`.

use super::*;
use std::fs;
use std::path::{Path, PathBuf};

/// Opens a cache for one server, whatever its port.
fn cache(folder: &Path) -> TileCache {
    cache_for(folder, "http://a.example/")
}

fn cache_for(folder: &Path, url: &str) -> TileCache {
    TileCache::open(folder, url, write_atomically).unwrap()
}

fn write_atomically(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    let mut file = tempfile::NamedTempFile::new_in(path.parent().unwrap())?;
    file.write_all(bytes)?;
    file.persist(path).map(drop).map_err(|error| error.error)
}

fn files(folder: &Path) -> Vec<PathBuf> {
    fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect()
}

// Claim: as image_from_server_equals_image_from_file.
#[test]
fn cache_keeps_tiles_of_lost_server() {
    let folder = tempfile::tempdir().unwrap();
    let kept = || Some(store_in(cache(folder.path())));
    let (url, _) = faulty(3, |_| ResponseFault::None);
    let (tile, error) = all(&mut tiles(&url, 1, kept())).unwrap_err();
    assert_eq!(tile, 3);
    assert!(error.contains("tile 3"), "{error}");
    let (url, count) = faulty(u32::MAX, |_| ResponseFault::None);
    assert_eq!(all(&mut tiles(&url, 2, kept())).unwrap(), expected());
    assert_eq!(count.load(Ordering::SeqCst), page().tiles() - 3, "only the rest");
    let (url, count) = faulty(u32::MAX, |_| ResponseFault::None);
    assert_eq!(all(&mut tiles(&url, 2, kept())).unwrap(), expected());
    assert_eq!(count.load(Ordering::SeqCst), 0, "all there");
}

// Claim: as image_from_server_equals_image_from_file.
#[test]
fn undecodable_tile_is_not_cached() {
    for fault in [ResponseFault::Undecodable, ResponseFault::OtherSize, ResponseFault::Corrupt] {
        let folder = tempfile::tempdir().unwrap();
        let (url, _) = faulty(u32::MAX, move |_| fault);
        all(&mut tiles(&url, 1, Some(store_in(cache(folder.path()))))).unwrap_err();
        assert_eq!(files(folder.path()), Vec::<PathBuf>::new(), "{fault:?}");
    }
}

// Claim: as image_from_server_equals_image_from_file.
#[test]
fn damaged_cache_file_is_removed_and_fetched_again() {
    let folder = tempfile::tempdir().unwrap();
    let (url, _) = faulty(u32::MAX, |_| ResponseFault::None);
    all(&mut tiles(&url, 2, Some(store_in(cache(folder.path()))))).unwrap();
    let kept_files = files(folder.path());
    let (damaged, wrong, cut) = (&kept_files[0], &kept_files[1], &kept_files[2]);
    let mut bytes = fs::read(damaged).unwrap();
    *bytes.last_mut().unwrap() ^= 1;
    fs::write(damaged, bytes).unwrap();
    fs::write(wrong, [hash_of(b"no tile").as_bytes(), b"no tile"].concat()).unwrap();
    fs::write(cut, "short").unwrap();
    for file in [damaged, wrong, cut] {
        let name = file.file_name().unwrap().to_str().unwrap();
        let tile = name.split_once('-').unwrap().1.replace('-', "/");
        assert_eq!(cache(folder.path()).get(&tile, 1 << 20, |_| Err("no tile".into())), None);
        assert!(!file.exists(), "{tile}");
    }
    let (url, count) = faulty(u32::MAX, |_| ResponseFault::None);
    assert_eq!(all(&mut tiles(&url, 2, Some(store_in(cache(folder.path()))))).unwrap(), expected());
    assert_eq!(count.load(Ordering::SeqCst), 3, "those three");
    assert_eq!(files(folder.path()).len(), kept_files.len());
}

#[test]
fn two_runs_can_share_a_cache() {
    let folder = tempfile::tempdir().unwrap();
    let runs: Vec<_> = (0..2)
        .map(|_| {
            let kept = store_in(cache(folder.path()));
            thread::spawn(move || {
                let (url, _) = faulty(u32::MAX, |_| ResponseFault::None);
                all(&mut tiles(&url, 4, Some(kept))).unwrap()
            })
        })
        .collect();
    for run in runs {
        assert_eq!(run.join().unwrap(), expected());
    }
    assert_eq!(files(folder.path()).len() as u32, page().tiles());
}

#[test]
fn unwritable_cache_is_reported_and_costs_no_tile() {
    let folder = tempfile::tempdir().unwrap();
    let cache = cache(folder.path());
    fs::remove_dir_all(folder.path()).unwrap();
    let kept = store_in(cache);
    let (url, _) = faulty(u32::MAX, |_| ResponseFault::None);
    assert_eq!(all(&mut tiles(&url, 2, Some(kept.clone()))).unwrap(), expected());
    assert!(kept.failed.get().is_some_and(|why| !why.is_empty()));
}

#[test]
fn servers_do_not_share_cached_tiles() {
    let folder = tempfile::tempdir().unwrap();
    let [a, b] = ["http://a.example/", "http://a.example:8080/"].map(|url| cache_for(folder.path(), url));
    a.put("tile/x/64x64/raw/0", b"a").unwrap();
    assert_eq!(a.get("tile/x/64x64/raw/0", 9, |_| Ok(())).as_deref(), Some(&b"a"[..]));
    assert_eq!(b.get("tile/x/64x64/raw/0", 9, |_| Ok(())), None);
}
