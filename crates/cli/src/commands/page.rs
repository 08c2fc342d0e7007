//! `basrelief page`: the simulator in a browser.

use crate::args::PageArgs;
use crate::error::{Done, Failure, print};
use crate::interrupt;
use crate::outputs::PartialFile;
use crate::remote::Site;
use std::fs;
use std::path::{Path, PathBuf};

/// What `web/build` makes.
const FILES: [&str; 5] = ["index.html", "page.css", "page.js", "worker.js", "basrelief.wasm"];
const STANDALONE: &str = "standalone.html";

/// Serves the page until it is interrupted, or writes it as one file.
pub fn page(args: &PageArgs, quiet: bool) -> Done {
    let folder = folder(args.folder.as_deref())?;
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
    let mut site = Site::default();
    for name in FILES {
        site.offer(name, &read(&folder, name)?);
    }
    let (address, server) = site.listen(args.listen).map_err(Failure::Bad)?;
    interrupt::say("stopped serving");
    if !quiet {
        print(&format!("The page is at http://{address}/ - stop it with Ctrl-C\n"))?;
    }
    server.join().map_err(|e| Failure::Bad(format!("{address}: {e}")))
}

fn read(folder: &Path, name: &str) -> Done<Vec<u8>> {
    let path = folder.join(name);
    fs::read(&path).map_err(Failure::file(&path, "be read"))
}

/// The folder with the page: the one that is named, or `page` beside this program or one folder up, where a build puts it.
fn folder(named: Option<&Path>) -> Done<PathBuf> {
    if let Some(folder) = named {
        return Ok(folder.into());
    }
    let program = std::env::current_exe().map_err(Failure::bad)?;
    let beside = program.ancestors().skip(1).take(2).map(|folder| folder.join("page"));
    beside.into_iter().find(|folder| folder.join(FILES[0]).is_file()).ok_or_else(|| {
        Failure::Bad("the page is not built yet: `web/build` builds it, in the folder that basrelief was built in; or name it with --folder".into())
    })
}
