//! `basrelief serve`: serves a scene to renderers elsewhere.

use super::page::viewer;
use crate::args::ServeArgs;
use crate::error::{CommandError, CommandResult, print};
use crate::global::GlobalOptions;
use crate::input;
use crate::interrupt;
use basrelief_input::MemoryPool;
use basrelief_scene::{SceneSubject, ViewOptions};
use basrelief_signals::Texture;
use basrelief_sim::reserve_textures;
use basrelief_tile_server::protocol::{hash_of_picture, pack};
use basrelief_tile_server::server::{SceneService, ServerLimits, index_page};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Serves until interrupted.
pub fn serve(args: &ServeArgs, global: &GlobalOptions) -> CommandResult {
    interrupt::set_message("server stopped");
    if !args.listen.ip().is_loopback() && !args.public {
        return Err(CommandError::Usage(format!(
            "--listen {}: other computers could read the scene; add --public to allow this",
            args.listen
        )));
    }
    let Some(subject) = input::open_subject(&args.input, global)? else {
        return Err(CommandError::Usage(format!("{}: is a trace; expected a model or demo:NAME", args.input.display())));
    };
    let within = CommandError::in_input(subject.name());
    let path = subject.name().to_owned();
    // The MIP levels stay in memory until the end of the program.
    let unseen = subject.seen(&ViewOptions::default()).map_err(CommandError::bad_input)?;
    reserve_textures(&unseen, 1, &global.budget).map_err(&within)?.keep_forever();
    let textures = textures(&subject);
    let subject = subject.without_path();
    let scene = compressed_scene(&subject, &global.budget)?;
    let viewer = viewer(args.folder.as_deref())?;
    let page = index_page(&subject, &textures, viewer.is_some());
    let served = SceneService::new(scene, page, textures).with_viewer(viewer.unwrap_or_default());
    let served = served.with_host_names(args.allow_host.clone());
    let served = args.allow_origin.iter().fold(served, |served, origin| served.with_allowed_origin(origin));
    let (address, server) = served.listen(args.listen, ServerLimits::default()).map_err(CommandError::BadInput)?;
    if !global.quiet {
        print(&format!("Serving {path} at http://{address}/\n"))?;
    }
    server.join().map_err(|e| CommandError::BadInput(format!("{address}: {e}")))
}

/// Returns the compressed scene; its memory stays reserved until the end of the program.
fn compressed_scene(subject: &SceneSubject, budget: &MemoryPool) -> CommandResult<Vec<u8>> {
    let within = CommandError::in_input(subject.name());
    let scene = subject.to_bytes(&mut hash_of_picture).map_err(|e| within(e.to_string()))?;
    let _whole = budget.try_reserve(scene.len() as u64, "a scene to be served").map_err(|e| within(e.to_string()))?;
    let packed = pack(&scene);
    budget.try_reserve(packed.len() as u64, "a scene to be served").map_err(|e| within(e.to_string()))?.keep_forever();
    Ok(packed)
}

/// Returns all colour textures, each once.
fn textures(subject: &SceneSubject) -> Vec<Arc<Texture>> {
    let all = subject.objects().iter().filter_map(|o| o.material.color_texture.clone());
    all.map(|texture| (texture.id, texture)).collect::<BTreeMap<_, _>>().into_values().collect()
}
