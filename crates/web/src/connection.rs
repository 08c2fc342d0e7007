//! Connection to the server of the page. Received data is cached as long as the page is open.

use crate::host_page::{HostPage, PageResponse};
use basrelief_deferred_renderer::TileFormat;
use basrelief_input::{MemoryPool, MemoryReservation};
use basrelief_tile_server::protocol::{check_hash, check_scene_status, check_status, hash_from_etag, scene_path};
use std::cell::{Cell, RefCell};
use std::collections::BTreeMap;
use std::rc::Rc;
use std::sync::Arc;

/// Attempts per request. There is no pause between attempts, because a worker cannot sleep.
const ATTEMPTS: u32 = 3;
/// Approximate memory of a cached tile beyond its bytes and its address \[bytes\].
const ENTRY: u64 = 128;

/// Totals received so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct TransferTotals {
    pub(crate) requests: u64,
    pub(crate) scene_bytes: u64,
    pub(crate) tiles: u64,
    pub(crate) tile_bytes: u64,
}

/// Connection with its cache and its totals.
#[derive(Debug)]
pub(crate) struct ServerConnection {
    page: Rc<dyn HostPage>,
    /// Address of the server, for messages.
    server: String,
    come: Cell<TransferTotals>,
    /// Received data except the scene, by address.
    kept: RefCell<BTreeMap<String, Arc<[u8]>>>,
    /// Memory reservation for `kept`.
    held: RefCell<MemoryReservation>,
}

impl ServerConnection {
    pub(crate) fn new(page: Rc<dyn HostPage>, server: &str, budget: &MemoryPool) -> Self {
        let held = RefCell::new(budget.empty_reservation());
        Self { page, server: server.into(), come: Cell::default(), kept: RefCell::default(), held }
    }

    /// Returns the address of the server, for messages.
    pub(crate) fn server(&self) -> &str {
        &self.server
    }

    pub(crate) fn totals(&self) -> TransferTotals {
        self.come.get()
    }

    pub(crate) fn count(&self, change: impl FnOnce(&mut TransferTotals)) {
        let mut come = self.come.get();
        change(&mut come);
        self.come.set(come);
    }

    /// Fetches the scene in wire format, with the hashes of tiles in this format.
    pub(crate) fn scene(&self, format: TileFormat) -> Result<Vec<u8>, String> {
        let scene = self.get_with(&scene_path(format), check_scene_status, &|_| Ok(()))?;
        self.count(|come| come.scene_bytes += scene.len() as u64);
        Ok(scene)
    }

    /// Fetches an address. Repeats the request if a check fails.
    pub(crate) fn get(&self, address: &str, check: &dyn Fn(&[u8]) -> Result<(), String>) -> Result<Vec<u8>, String> {
        self.get_with(address, check_status, check)
    }

    /// As `get`, with a check of the status.
    fn get_with(
        &self,
        address: &str,
        check_status: fn(u16) -> Result<(), String>,
        check: &dyn Fn(&[u8]) -> Result<(), String>,
    ) -> Result<Vec<u8>, String> {
        let mut attempt = 1;
        loop {
            self.count(|come| come.requests += 1);
            let got = self.page.get(address, attempt > 1);
            match got.and_then(|got| checked_body(got, check_status, check)) {
                Err(e) if attempt == ATTEMPTS => {
                    return Err(format!("{}{address}: {e} (attempt {ATTEMPTS}, and no more are made)", self.server));
                }
                Err(_) => attempt += 1,
                body => return body,
            }
        }
    }

    /// Checks a response that the page has fetched by itself, and returns its body.
    pub(crate) fn receive(&self, got: PageResponse, check: &dyn Fn(&[u8]) -> Result<(), String>) -> Result<Vec<u8>, String> {
        self.count(|come| come.requests += 1);
        checked_body(got, check_status, check)
    }

    /// Returns cached data.
    pub(crate) fn cached(&self, address: &str) -> Option<Arc<[u8]>> {
        self.kept.borrow().get(address).cloned()
    }

    /// Caches data if memory is left.
    pub(crate) fn cache(&self, address: String, body: &Arc<[u8]>) {
        let bytes = (address.len() + body.len()) as u64 + ENTRY;
        if self.held.borrow_mut().try_grow(bytes, "received data").is_ok() {
            self.kept.borrow_mut().insert(address, Arc::clone(body));
        }
    }
}

/// Returns the body of a response after a check of its status, its hash and its content.
fn checked_body(
    got: PageResponse,
    check_status: fn(u16) -> Result<(), String>,
    check: &dyn Fn(&[u8]) -> Result<(), String>,
) -> Result<Vec<u8>, String> {
    check_status(got.status)?;
    check_hash(&got.body, hash_from_etag(&got.tag)?)?;
    check(&got.body)?;
    Ok(got.body)
}
