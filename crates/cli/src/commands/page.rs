//! `basrelief page`: the simulator in a browser.

use crate::args::PageArgs;
use crate::error::{Done, Failure, print};
use crate::interrupt;
use crate::outputs::PartialFile;
use basrelief_tile_server::server::StaticFiles;
use std::fs;
use std::path::{Path, PathBuf};

/// What both forms of the page are made of, beside the page itself.
const FILES: [&str; 4] = ["page.css", "page.js", "worker.js", "basrelief.wasm"];
/// Compressed forms that a build puts beside them, the best first: how they are compressed, and how their names end.
const PACKED: [(&str, &str); 2] = [("br", "br"), ("gzip", "gz")];
const PAGE: &str = "index.html";
/// The same page, which draws what the server offers that it comes from.
const VIEWER: &str = "viewer.html";
const STANDALONE: &str = "standalone.html";

/// Serves the page until it is interrupted, or writes it as one file.
pub fn page(args: &PageArgs, quiet: bool) -> Done {
    let folder = folder(args.folder.as_deref(), PAGE)?.ok_or_else(|| {
        Failure::Bad("the page is not built yet: `web/build` builds it, in the folder that basrelief was built in; or name it with --folder".into())
    })?;
    if let Some(path) = &args.export {
        let page = read(&folder, STANDALONE)?;
        return PartialFile::write_whole(path, &page).map_err(Failure::file(path, "be written"));
    }
    if !args.listen.ip().is_loopback() && !args.public {
        return Err(Failure::Usage(format!(
            "--listen {}: others could use the page there; say --public if they may",
            args.listen
        )));
    }
    let (address, server) = site(&folder, PAGE)?.listen(args.listen).map_err(Failure::Bad)?;
    interrupt::say("stopped serving");
    if !quiet {
        print(&format!("The page is at http://{address}/ - stop it with Ctrl-C\n"))?;
    }
    server.join().map_err(|e| Failure::Bad(format!("{address}: {e}")))
}

/// The viewer as a site, from the folder that is named, or where a build puts it; none where it is not built.
pub fn viewer(named: Option<&Path>) -> Done<Option<StaticFiles>> {
    folder(named, VIEWER)?.map(|folder| site(&folder, VIEWER)).transpose()
}

/// A site whose first page this is.
fn site(folder: &Path, page: &str) -> Done<StaticFiles> {
    let mut site = StaticFiles::default();
    for (offered, name) in std::iter::once((PAGE, page)).chain(FILES.map(|name| (name, name))) {
        site.offer(offered, &read(folder, name)?, packed(folder, name)?);
    }
    Ok(site)
}

/// The compressed forms of a file that are there.
fn packed(folder: &Path, name: &str) -> Done<Vec<(&'static str, Vec<u8>)>> {
    let forms = PACKED.map(|(encoding, end)| (encoding, format!("{name}.{end}")));
    let there = forms.into_iter().filter(|(_, name)| folder.join(name).is_file());
    there.map(|(encoding, name)| Ok((encoding, read(folder, &name)?))).collect()
}

fn read(folder: &Path, name: &str) -> Done<Vec<u8>> {
    let path = folder.join(name);
    fs::read(&path).map_err(Failure::file(&path, "be read"))
}

/// The folder with this page: the one that is named, or `page` beside this program or one folder up, where a build puts it; none where
/// there is none.
fn folder(named: Option<&Path>, page: &str) -> Done<Option<PathBuf>> {
    if let Some(folder) = named {
        return Ok(Some(folder.into()));
    }
    let program = std::env::current_exe().map_err(Failure::bad)?;
    Ok(program.ancestors().skip(1).take(2).map(|folder| folder.join("page")).find(|folder| folder.join(page).is_file()))
}
