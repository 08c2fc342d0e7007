//! A hostile server: the scene of a case, and tiles and lists of an honest server, some of them damaged.

use super::mutate;
use super::random::random_of;
use basrelief_input::MemoryPool;
use basrelief_scene::SceneSubject;
use basrelief_tile_server::protocol::{GroupHashes, ReceivedScene, etag_of, hash_of_picture, pack, unpack};
use basrelief_tile_server::server::{SceneService, ServerLimits};
use std::collections::BTreeMap;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;

/// Address of the scene that the client requests: small tiles, so that a small picture has many.
const SCENE: &str = "/scene/8x8/raw";
/// Options of the client that requests this scene.
pub const TILES: &str = "--set tile.width=8 --set tile.height=8";

/// Answers of the server in one case.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HostileAnswers {
    /// The scene without compression.
    pub scene: Vec<u8>,
    /// Selects the damaged answers among the others; 0 damages none.
    pub seed: u64,
}

/// A sample scene, as the server sends it.
#[derive(Clone, Debug)]
pub struct SampleScene {
    /// The scene without compression.
    pub plain: Vec<u8>,
    hashes: GroupHashes,
    honest: SocketAddr,
}

impl SampleScene {
    /// Starts an honest server of a model.
    ///
    /// # Errors
    /// The model cannot be read, or no server can be started.
    pub fn load(model: &Path) -> Result<Self, String> {
        let (subject, held) = SceneSubject::load_path_with(model, &Default::default()).map_err(|e| e.to_string())?;
        held.keep_forever();
        let textures: BTreeMap<u32, _> =
            subject.objects().iter().filter_map(|o| o.material.color_texture.clone()).map(|t| (t.id, t)).collect();
        let plain = subject.to_bytes(&mut hash_of_picture).map_err(|e| e.to_string())?;
        let service = SceneService::new(pack(&plain), String::new(), textures.into_values());
        let (honest, _server) = service.listen(([127, 0, 0, 1], 0).into(), ServerLimits::default())?;
        let scene = asked(honest, SCENE).map_err(|e| e.to_string())?;
        let ReceivedScene { hashes, .. } = unpack(&scene, "the sample", &MemoryPool::default())?;
        Ok(Self { plain, hashes, honest })
    }

    /// Returns the body of an answer.
    fn body(&self, path: &str, answers: &HostileAnswers) -> Vec<u8> {
        let mut random = path.bytes().fold(random_of(answers.seed, 0, 0), |mut r, byte| random_of(r.next_u64(), byte.into(), 0));
        if path == SCENE {
            return [pack(&answers.scene), self.hashes.to_bytes()].concat();
        }
        let mut body = asked(self.honest, path).unwrap_or_default();
        if answers.seed != 0 && !body.is_empty() && random.below(8) == 0 {
            mutate::bytes(&mut body, &mut random);
        }
        body
    }
}

/// Returns the body of the answer of an honest server.
fn asked(at: SocketAddr, path: &str) -> std::io::Result<Vec<u8>> {
    let mut stream = TcpStream::connect(at)?;
    write!(stream, "GET {path} HTTP/1.0\r\n\r\n")?;
    let mut answer = Vec::new();
    stream.read_to_end(&mut answer)?;
    let end = answer.windows(4).position(|end| end == b"\r\n\r\n").unwrap_or(answer.len() - 4);
    Ok(answer.split_off(end + 4))
}

/// A listening hostile server. Its port stays the same in all cases, because a second run must have equal messages.
#[derive(Clone, Debug)]
pub struct HostileServer {
    address: SocketAddr,
    answers: Arc<Mutex<HostileAnswers>>,
}

impl HostileServer {
    /// Starts the server.
    ///
    /// # Errors
    /// No port is free.
    pub fn start(sample: SampleScene) -> Result<Self, String> {
        let listener = TcpListener::bind("127.0.0.1:0").map_err(|e| e.to_string())?;
        let address = listener.local_addr().map_err(|e| e.to_string())?;
        let answers: Arc<Mutex<HostileAnswers>> = Arc::default();
        let shared = Arc::clone(&answers);
        thread::spawn(move || {
            for stream in listener.incoming().flatten() {
                let answers = shared.lock().unwrap_or_else(PoisonError::into_inner).clone();
                // A client that has closed needs no answer.
                let _ = answer(stream, &sample, &answers);
            }
        });
        Ok(Self { address, answers })
    }

    /// Returns the URL.
    pub fn url(&self) -> String {
        format!("http://{}/", self.address)
    }

    /// Sets the answers of the next runs.
    pub fn set(&self, answers: &HostileAnswers) {
        *self.answers.lock().unwrap_or_else(PoisonError::into_inner) = answers.clone();
    }
}

fn answer(mut stream: TcpStream, sample: &SampleScene, answers: &HostileAnswers) -> std::io::Result<()> {
    let mut lines = BufReader::new(stream.try_clone()?).lines().map_while(Result::ok);
    let first = lines.next().unwrap_or_default();
    while lines.next().is_some_and(|line| !line.is_empty()) {}
    let body = sample.body(first.split(' ').nth(1).unwrap_or("/"), answers);
    let (length, tag) = (body.len(), etag_of(&body));
    let head = format!("HTTP/1.1 200 OK\r\ncontent-length: {length}\r\netag: {tag}\r\nconnection: close\r\n\r\n");
    stream.write_all(&[head.as_bytes(), &body].concat())
}
