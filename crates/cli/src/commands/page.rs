//! `basrelief page`: the simulator in a browser.

use super::page_files::PageFiles;
use crate::args::PageArgs;
use crate::error::{CommandError, CommandResult, print};
use crate::interrupt;
use crate::outputs::PartialFile;
use basrelief_tile_server::server::StaticFiles;
use std::path::Path;

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
    if args.export.is_none() {
        interrupt::set_message("server stopped");
    }
    let files = PageFiles::find(args.folder.as_deref(), PAGE)?.ok_or_else(|| {
        CommandError::BadInput(
            "the page is not built; run `web/build` in the source folder, or name its output with --folder".into(),
        )
    })?;
    if let Some(path) = &args.export {
        let page = files.read(STANDALONE)?;
        return PartialFile::write_whole(path, &page).map_err(CommandError::at_file(path, "be written"));
    }
    if !args.listen.ip().is_loopback() && !args.public {
        return Err(CommandError::Usage(format!(
            "--listen {}: other computers could use the page; add --public to allow this",
            args.listen
        )));
    }
    let (address, server) =
        site(&files, PAGE)?.with_host_names(args.allow_host.clone()).listen(args.listen).map_err(CommandError::BadInput)?;
    if !quiet {
        print(&format!("Page: http://{address}/ (stop with Ctrl-C)\n"))?;
    }
    server.join().map_err(|e| CommandError::BadInput(format!("{address}: {e}")))
}

/// Returns the viewer from the given folder, this program or the default folder; `None` if it is not built.
pub fn viewer(named: Option<&Path>) -> CommandResult<Option<StaticFiles>> {
    PageFiles::find(named, VIEWER)?.map(|files| site(&files, VIEWER)).transpose()
}

/// Returns the files of this page.
fn site(files: &PageFiles, page: &str) -> CommandResult<StaticFiles> {
    let mut site = StaticFiles::default();
    for (offered, name) in std::iter::once((PAGE, page)).chain(FILES.map(|name| (name, name))) {
        let packed = PACKED.map(|(encoding, end)| (encoding, format!("{name}.{end}")));
        let packed = packed.into_iter().filter(|(_, name)| files.contains(name));
        let packed = packed.map(|(encoding, name)| Ok((encoding, files.read(&name)?.into_owned())));
        site.offer(offered, &files.read(name)?, packed.collect::<CommandResult<_>>()?);
    }
    Ok(site)
}
