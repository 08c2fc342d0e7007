//! `basrelief page`: the simulator in a browser.

use crate::args::PageArgs;
use crate::error::{CommandError, CommandResult, print};
use crate::interrupt;
use crate::outputs::PartialFile;
use basrelief_tile_server::server::StaticFiles;
use std::fs;
use std::path::{Path, PathBuf};

/// Files of the page besides its HTML.
const FILES: [&str; 4] = ["page.css", "page.js", "worker.js", "basrelief.wasm"];
/// Compressed files of a build, best first: content coding and file extension.
const PACKED: [(&str, &str); 2] = [("br", "br"), ("gzip", "gz")];
const PAGE: &str = "index.html";
/// The viewer: the page for the scene of its server.
const VIEWER: &str = "viewer.html";
const STANDALONE: &str = "standalone.html";

/// Serves the page until interrupted, or writes it as one file.
pub fn page(args: &PageArgs, quiet: bool) -> CommandResult {
    let folder = folder(args.folder.as_deref(), PAGE)?.ok_or_else(|| {
        CommandError::BadInput(
            "the page is not built; run `web/build` in the source folder, or name its output with --folder".into(),
        )
    })?;
    if let Some(path) = &args.export {
        let page = read(&folder, STANDALONE)?;
        return PartialFile::write_whole(path, &page).map_err(CommandError::at_file(path, "be written"));
    }
    if !args.listen.ip().is_loopback() && !args.public {
        return Err(CommandError::Usage(format!(
            "--listen {}: other computers could use the page; add --public to allow this",
            args.listen
        )));
    }
    let (address, server) =
        site(&folder, PAGE)?.with_host_names(args.allow_host.clone()).listen(args.listen).map_err(CommandError::BadInput)?;
    interrupt::set_message("server stopped");
    if !quiet {
        print(&format!("Page: http://{address}/ (stop with Ctrl-C)\n"))?;
    }
    server.join().map_err(|e| CommandError::BadInput(format!("{address}: {e}")))
}

/// Returns the viewer from the given folder or the default one; `None` if it is not built.
pub fn viewer(named: Option<&Path>) -> CommandResult<Option<StaticFiles>> {
    folder(named, VIEWER)?.map(|folder| site(&folder, VIEWER)).transpose()
}

/// Returns the files of this page.
fn site(folder: &Path, page: &str) -> CommandResult<StaticFiles> {
    let mut site = StaticFiles::default();
    for (offered, name) in std::iter::once((PAGE, page)).chain(FILES.map(|name| (name, name))) {
        site.offer(offered, &read(folder, name)?, compressed_forms(folder, name)?);
    }
    Ok(site)
}

/// Returns the existing compressed forms of a file.
fn compressed_forms(folder: &Path, name: &str) -> CommandResult<Vec<(&'static str, Vec<u8>)>> {
    let forms = PACKED.map(|(encoding, end)| (encoding, format!("{name}.{end}")));
    let there = forms.into_iter().filter(|(_, name)| folder.join(name).is_file());
    there.map(|(encoding, name)| Ok((encoding, read(folder, &name)?))).collect()
}

fn read(folder: &Path, name: &str) -> CommandResult<Vec<u8>> {
    let path = folder.join(name);
    fs::read(&path).map_err(CommandError::at_file(&path, "be read"))
}

/// Returns the folder with this page: the given one, or `page` beside this program or one folder up; `None` if absent.
fn folder(named: Option<&Path>, page: &str) -> CommandResult<Option<PathBuf>> {
    if let Some(folder) = named {
        return Ok(Some(folder.into()));
    }
    let program = std::env::current_exe().map_err(CommandError::bad_input)?;
    Ok(program.ancestors().skip(1).take(2).map(|folder| folder.join("page")).find(|folder| folder.join(page).is_file()))
}
