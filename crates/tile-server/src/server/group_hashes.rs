//! The scene with the hashes of its tiles, and the lists behind these hashes.

use super::http::{CachePolicy, Response};
use super::scenes::{BYTES, BodyResult, SceneService, TiledPicture};
use crate::protocol::{
    GroupHashes, etag_of_parts, format_name, group_of, hash_of_list, hash_of_picture, hash_of_tile, parse_format, tiles_in_group,
};
use basrelief_deferred_renderer::TileFormat;
use basrelief_threads as threads;
use std::sync::{Arc, PoisonError};

/// Maximum number of formats of tiles whose hashes are cached.
const MOST_FORMATS: usize = 16;

impl SceneService {
    /// Returns the scene with the hashes of its tiles. `format` is `WIDTHxHEIGHT/ENCODING`, or the default of the machine.
    pub(crate) fn scene(&self, format: Option<&str>) -> Result<Response, (u16, String)> {
        let wrong = || (400, "expected /scene/WIDTHxHEIGHT/ENCODING\n".to_owned());
        let default = format_name(TileFormat::default());
        let format = format.unwrap_or(&default);
        let mut cached = self.hashes.lock().unwrap_or_else(PoisonError::into_inner);
        if !cached.contains_key(format) {
            let hashes: Arc<[u8]> = self.hashes_of(format)?.ok_or_else(wrong)?.to_bytes().into();
            if cached.len() >= MOST_FORMATS {
                cached.clear();
            }
            let tag = etag_of_parts(&[&self.scene, &hashes]);
            cached.insert(format.into(), (hashes, tag));
        }
        let (hashes, tag) = cached.get(format).ok_or_else(wrong)?.clone();
        Ok(Response::found(Arc::clone(&self.scene), tag, BYTES, CachePolicy::Revalidate).with_tail(hashes))
    }

    /// Computes the hashes of all groups of all pictures; `None` if the format has another form.
    fn hashes_of(&self, format: &str) -> Result<Option<GroupHashes>, (u16, String)> {
        if parse_format(format).is_none() {
            return Ok(None);
        }
        let mut hashes = GroupHashes::default();
        for (name, offered) in &self.pictures {
            let Some(cut) = self.parse_picture(&format!("{name}/{format}"))? else { return Ok(None) };
            let groups = (0..=group_of(cut.page.tiles() - 1)).collect();
            let groups = threads::par_map(groups, |group| self.list(&cut, group).map(|list| hash_of_list(&list)));
            hashes.insert(hash_of_picture(&offered.texture), groups.into_iter().collect::<Result<_, _>>()?);
        }
        Ok(Some(hashes))
    }

    /// Returns the list of the hashes of a group of tiles.
    pub(crate) fn hash_list(&self, asked: &str) -> BodyResult {
        let wrong = || (400, "expected /hashes/PICTURE/WIDTHxHEIGHT/ENCODING/GROUP\n".to_owned());
        let (cut, group) = asked.rsplit_once('/').ok_or_else(wrong)?;
        let cut = self.parse_picture(cut)?.ok_or_else(wrong)?;
        let group = group.parse::<u32>().map_err(|_| wrong())?;
        let groups = group_of(cut.page.tiles() - 1) + 1;
        if group >= groups {
            return Err((404, format!("this picture has {groups} groups of tiles\n")));
        }
        Ok((self.list(&cut, group)?, BYTES))
    }

    fn list(&self, cut: &TiledPicture<'_>, group: u32) -> Result<Vec<u8>, (u16, String)> {
        let mut list = Vec::new();
        for number in tiles_in_group(group, cut.page.tiles()) {
            let _permit = self.encoders.acquire();
            let (texels, size) = cut.texels(number);
            list.extend(hash_of_tile(cut.format, &texels, size).map_err(|e| (500, e))?);
        }
        Ok(list)
    }
}
