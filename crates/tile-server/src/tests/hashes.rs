//! Tiles are checked against the hashes that the scene states.

use super::*;
use crate::protocol::{ReceivedScene, pack, scene_path, unpack};
use crate::server::ServerLimits;
use basrelief_scene::SceneSubject;
use std::path::Path;

/// Returns a texture of the same picture size with other texels.
fn other_texture() -> Arc<Texture> {
    let texels = vec![[9, 9, 9, 255]; 200 * 90];
    Arc::new(Texture { levels: vec![Image { width: 200, height: 90, texels }], ..Texture::clone(&texture()) })
}

/// Starts a server that listens to nobody else.
fn honest_server() -> String {
    let scene = SceneSubject::demo("cut-plane@1").unwrap().to_bytes(&mut hash_of_picture).unwrap();
    let (address, _) = serving_scene(pack(&scene)).listen(([127, 0, 0, 1], 0).into(), ServerLimits::default()).unwrap();
    format!("http://{address}")
}

/// Starts a server that sends the scene and, if `lists` is false, the lists of the honest one, and tiles of another picture with valid
/// ETags under the honest addresses.
fn lying_server(lists: bool) -> String {
    let (listener, url, _) = listening();
    let served = [served(), SceneService::new(b"scene".to_vec(), String::new(), [other_texture()])];
    let pictures = [texture(), other_texture()].map(|texture| hex(&hash_of_picture(&texture)));
    thread::spawn(move || {
        for mut stream in listener.incoming().flatten() {
            let mut lines = BufReader::new(stream.try_clone().unwrap()).lines().map_while(Result::ok);
            let Some(first) = lines.next() else { continue };
            while lines.next().is_some_and(|line| !line.is_empty()) {}
            let path = first.split(' ').nth(1).unwrap_or("/");
            let lies = path.starts_with("/tile/") || lists;
            let response = served[usize::from(lies)].respond_to(&path.replace(&pictures[0], &pictures[usize::from(lies)]));
            let body = response.map(|response| [&response.body[..], &response.tail].concat()).unwrap_or_default();
            let (length, hash) = (body.len(), hash_of(&body));
            let head = format!("HTTP/1.1 200 x\r\nContent-Length: {length}\r\nETag: \"{hash}\"\r\nConnection: close\r\n\r\n");
            // The client may have given up and closed the connection.
            let _ = stream.write_all(&[head.as_bytes(), &body].concat());
        }
    });
    url
}

/// Returns the hashes in the scene of the honest server.
fn scene_hashes() -> GroupHashes {
    let url = honest_server();
    let (_, body, _) = new_fetcher(&url, PATIENT).scene(&scene_path(PNG), |_| ()).unwrap();
    let ReceivedScene { hashes, .. } = unpack(&body, &url, &MemoryPool::default()).unwrap();
    hashes
}

fn checked_tiles(url: &str, hashes: GroupHashes, tiles_per_request: u32, kept: Option<TileStore>) -> RemoteTiles {
    RemoteTiles::new(new_fetcher(url, PATIENT), fetch(2, tiles_per_request), hashes, kept, Arc::new(NoProgress))
}

fn cache(folder: &Path, url: &str) -> Option<TileStore> {
    let write = |path: &Path, bytes: &[u8]| std::fs::write(path, bytes);
    Some(store_in(TileCache::open(folder, url, write).unwrap()))
}

#[test]
fn tiles_of_honest_server_pass_hash_check() {
    for tiles_per_request in [1, 64] {
        assert_eq!(all(&mut checked_tiles(&honest_server(), scene_hashes(), tiles_per_request, None)).unwrap(), expected());
    }
}

#[test]
fn lying_tile_is_an_error_that_names_it() {
    for (lists, tiles_per_request, names) in [(false, 1, "/tile/"), (false, 64, "/tile/"), (true, 1, "/tile/")] {
        let (tile, error) = all(&mut checked_tiles(&lying_server(lists), scene_hashes(), tiles_per_request, None)).unwrap_err();
        assert_eq!(tile, 0);
        assert!(error.starts_with("texture 4 (plane), layer 0, tile 0: http://") && error.contains(names), "{error}");
        assert!(error.contains("that the scene states"), "{error}");
    }
}

#[test]
fn lying_list_is_an_error_that_names_it() {
    let mut tiles = checked_tiles(&lying_server(true), scene_hashes(), 1, None);
    announce_all(&mut tiles);
    // The top tile needs no list.
    let error = tiles.tile(&page(), 1).unwrap_err();
    assert!(error.contains("/hashes/") && error.contains("not the list that the scene states"), "{error}");
}

#[test]
fn poisoned_cache_does_not_change_a_later_run() {
    let (folder, honest, liar) = (tempfile::tempdir().unwrap(), honest_server(), lying_server(true));
    // The liar states the hashes of its own tiles, so its run succeeds and fills the cache.
    let (mut hashes, lists) = (GroupHashes::default(), lists(&other_texture(), &fetch(2, 1)));
    hashes.insert(hash_of_picture(&texture()), lists.iter().map(|list| hash_of_list(list)).collect());
    assert_ne!(all(&mut checked_tiles(&liar, hashes, 1, cache(folder.path(), &liar))).unwrap(), expected());
    // The second cache has the origin of the liar, so only the hashes protect it.
    for origin in [&honest, &liar] {
        let kept = cache(folder.path(), origin);
        assert_eq!(all(&mut checked_tiles(&honest, scene_hashes(), 1, kept)).unwrap(), expected(), "{origin}");
    }
}

#[test]
fn scene_without_hash_of_a_tile_is_refused() {
    let (_, error) = all(&mut checked_tiles(&honest_server(), GroupHashes::default(), 1, None)).unwrap_err();
    assert!(error.contains("/tile/") && error.contains("not the tile that the scene states"), "{error}");
}

#[test]
fn server_without_hashes_is_refused_by_name() {
    let (listener, url, _) = listening();
    thread::spawn(move || {
        for mut stream in listener.incoming().flatten() {
            let lines = BufReader::new(stream.try_clone().unwrap()).lines().map_while(Result::ok);
            lines.take_while(|line| !line.is_empty()).for_each(drop);
            let _ = stream.write_all(b"HTTP/1.1 404 Not Found\r\nContent-Length: 0\r\nConnection: close\r\n\r\n");
        }
    });
    let error = new_fetcher(&url, PATIENT).scene("scene/64x64/raw", |_| ()).unwrap_err();
    assert!(
        error.contains("the server has no scene with hashes of tiles: use a `basrelief serve` of the same version"),
        "{error}"
    );
}

#[test]
fn every_group_of_a_large_picture_has_its_list() {
    let service = served();
    let picture = hex(&hash_of_picture(&texture()));
    let page = TexturePage::new(0, &texture(), PyramidCut { tile: [4, 4], ..PyramidCut::default() }, 0);
    let groups = group_of(page.tiles() - 1) + 1;
    assert!(groups > 10, "{groups}");
    let scene = service.scene(Some("4x4/raw")).unwrap();
    let (_, hashes, _) = GroupHashes::split(&[&scene.body[..], &scene.tail].concat(), &MemoryPool::default())
        .map(|(scene, hashes, held)| (scene.to_vec(), hashes, held))
        .unwrap();
    for group in 0..groups {
        let (list, _) = service.hash_list(&format!("{picture}/4x4/raw/{group}")).unwrap();
        assert_eq!(hashes.check_list(&picture, group, &list), Ok(()), "{group}");
    }
    assert_eq!(service.hash_list(&format!("{picture}/4x4/raw/{groups}")).unwrap_err().0, 404);
    assert_eq!(service.scene(Some("4x4/bmp")).unwrap_err().0, 400);
}
