//! A server in a process of its own.

use std::error::Error;
use std::io::{BufRead as _, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

/// Returns the path of `basrelief` in the folder above the examples.
pub fn program() -> Result<PathBuf, Box<dyn Error>> {
    let example = std::env::current_exe()?;
    let folder = example.parent().and_then(Path::parent).ok_or("no folder above")?;
    let program = folder.join("basrelief");
    if program.exists() { Ok(program) } else { Err(format!("{}: build it first", program.display()).into()) }
}

/// A server process, killed when dropped.
pub struct Server {
    pub process: Child,
    /// Address and port of the server.
    pub address: String,
}

impl Server {
    pub fn start(program: &Path, scene: &str) -> Result<Self, Box<dyn Error>> {
        let command = ["serve", scene, "--listen", "127.0.0.1:0"];
        let mut process = Command::new(program).args(command).stdout(Stdio::piped()).spawn()?;
        let mut said = String::new();
        BufReader::new(process.stdout.take().ok_or("no output")?).read_line(&mut said)?;
        let url = said.split_whitespace().last().ok_or("no address")?;
        let address = url.trim_start_matches("http://").trim_end_matches('/').to_owned();
        Ok(Self { process, address })
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        // The process may have ended already.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}
