//! `basrelief serve`: offers a scene to renderers elsewhere.

use super::record::write_list;
use crate::args::ServeArgs;
use crate::error::{Done, Failure, print};
use crate::input::{self, Input, demo_of};
use crate::interrupt;
use crate::progress::Progress;
use crate::remote::{Limits, PolygonList, TileService, hex};
use basrelief_display_list::{Encoding, Form};
use basrelief_input::{Budget, Growing};
use basrelief_session::{MachineConfig, begin_of, hold_textures};
use basrelief_signals::{Image, Material, Object, Scene, Texture};
use sha2::{Digest as _, Sha256};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Serves until it is interrupted.
pub fn serve(args: &ServeArgs, budget: &Budget, quiet: bool) -> Done {
    if !args.listen.ip().is_loopback() && !args.public {
        return Err(Failure::Usage(format!(
            "--listen {}: others could read the scene there; say --public if they may",
            args.listen
        )));
    }
    let Input::Scene(scene) = input::open(&args.input, &args.view, budget)? else {
        return Err(Failure::Usage(format!("{}: is a display list; serve takes a model or demo:NAME", args.input.display())));
    };
    let scene = scene.scene();
    let (config, _) = input::config(&args.machine, demo_of(&args.input), budget)?;
    // Black ones, and the layers that are asked for: kept to the end of the program.
    hold_textures(scene, 2, budget).map_err(Failure::within(&scene.name))?.keep();
    let polygons = PolygonList::default();
    let served = TileService::new(polygons.clone(), textures(scene), &hash_of_textures(scene));
    let (address, server) = served.listen(args.listen, Limits::default()).map_err(Failure::Bad)?;
    interrupt::say("stopped serving");
    if !quiet {
        print(&format!("Serving {} at http://{address}/\n", scene.name))?;
    }
    // Many frames take long; tiles are served in the meantime.
    polygons.offer(list_of(scene, &config, budget, quiet)?);
    server.join().map_err(|e| Failure::Bad(format!("{address}: {e}")))
}

/// The list of polygons, counted to the end of the program.
fn list_of(scene: &Scene, config: &MachineConfig, budget: &Budget, quiet: bool) -> Done<Vec<u8>> {
    let mut polygons = Growing::new(budget, "a display list");
    let form = Form { encoding: Encoding::Binary, compressed: true };
    let progress = Progress::new(None, "commands", quiet);
    write_list(&without_texels(scene), config, &mut polygons, (form, begin_of(scene)), vec![], (progress, budget))?;
    let (polygons, held) = polygons.into_parts();
    // Once more as it is served.
    budget.take(polygons.len() as u64, "a display list").map_err(Failure::within(&scene.name))?.keep();
    held.keep();
    Ok(polygons)
}

fn textures(scene: &Scene) -> impl Iterator<Item = Arc<Texture>> + '_ {
    scene.objects.iter().filter_map(|o| o.material.color_texture.clone())
}

/// SHA-256 of all textures, in hexadecimal.
fn hash_of_textures(scene: &Scene) -> String {
    let all: BTreeMap<u32, Arc<Texture>> = textures(scene).map(|t| (t.id, t)).collect();
    let mut hash = Sha256::new();
    for (id, texture) in all {
        hash.update(id.to_le_bytes());
        if let Some(image) = texture.levels.first() {
            hash.update(image.width.to_le_bytes());
            hash.update(image.height.to_le_bytes());
            image.texels.iter().for_each(|texel| hash.update(texel));
        }
    }
    hex(hash)
}

/// The scene with plain textures in place of its own: the list then tells their sizes, and which are the same picture, and takes no
/// room for them.
fn without_texels(scene: &Scene) -> Arc<Scene> {
    let mut materials: BTreeMap<u32, Arc<Material>> = BTreeMap::new();
    let mut plain = PlainTextures::default();
    let mut object = |object: &Arc<Object>| {
        let material = materials.entry(object.material.id).or_insert_with(|| {
            let color_texture = object.material.color_texture.as_ref().map(|t| plain.of(t));
            Arc::new(Material { color_texture, normal_map: None, ..Material::clone(&object.material) })
        });
        Arc::new(Object { material: Arc::clone(material), ..Object::clone(object) })
    };
    Arc::new(Scene { objects: scene.objects.iter().map(&mut object).collect(), ..scene.clone() })
}

/// Textures of one colour each, which is the number of the picture: two of them are equal where the pictures are.
#[derive(Default)]
struct PlainTextures {
    /// The first texture of each picture.
    pictures: Vec<Arc<Texture>>,
    plain: BTreeMap<u32, Arc<Texture>>,
}

impl PlainTextures {
    fn of(&mut self, texture: &Arc<Texture>) -> Arc<Texture> {
        if let Some(plain) = self.plain.get(&texture.id) {
            return Arc::clone(plain);
        }
        let number = self.pictures.iter().position(|known| known.levels.first() == texture.levels.first());
        let number = number.unwrap_or_else(|| {
            self.pictures.push(Arc::clone(texture));
            self.pictures.len() - 1
        });
        let [r, g, b, ..] = (number as u32).to_le_bytes();
        let image = |i: &Image| Image { texels: vec![[r, g, b, 255]; i.texels.len()], ..*i };
        let levels = texture.levels.iter().map(image).collect();
        let plain = Arc::new(Texture { levels, name: texture.name.clone(), ..**texture });
        self.plain.insert(texture.id, Arc::clone(&plain));
        plain
    }
}
