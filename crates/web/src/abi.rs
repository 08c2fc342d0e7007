//! Interface to the worker: three exported functions and the memory, and three imported functions for use during an answer.
//! `wasm-bindgen` was rejected. For six functions it needs a separate tool of exactly its own version before the page is built.
#![allow(unsafe_code, reason = "a name to be called by, or to call by, counts as unsafe; nothing behind it is")]

use crate::{HostPage, Message, PageResponse, SimulationService};
use std::cell::RefCell;
use std::rc::Rc;

#[link(wasm_import_module = "page")]
unsafe extern "C" {
    /// Fetches an address and returns the length of the response, a [`Message`]. Reads exactly `length` bytes of the address.
    safe fn get(address: *const u8, length: usize, fresh: bool) -> usize;
    /// Copies the response to this buffer, which must have room for it.
    safe fn take(answer: *mut u8);
    /// Shows the picture in this buffer.
    safe fn show(message: *const u8, length: usize);
}

/// The worker.
#[derive(Debug)]
struct Worker;

impl HostPage for Worker {
    fn get(&self, address: &str, fresh: bool) -> Result<PageResponse, String> {
        let mut answer = vec![0; get(address.as_ptr(), address.len(), fresh)];
        take(answer.as_mut_ptr());
        let Message { json, rest } = Message::read(&answer)?;
        match json["error"].as_str() {
            Some(error) => Err(error.into()),
            None => Ok(PageResponse {
                status: json["status"].as_u64().and_then(|status| status.try_into().ok()).unwrap_or_default(),
                tag: json["tag"].as_str().unwrap_or_default().into(),
                body: rest,
            }),
        }
    }

    fn show(&self, picture: Vec<u8>) {
        show(picture.as_ptr(), picture.len());
    }
}

struct Mail {
    service: SimulationService,
    inbox: Vec<u8>,
    outbox: Vec<u8>,
}

impl Default for Mail {
    fn default() -> Self {
        Self { service: SimulationService::with_page(Rc::new(Worker)), inbox: Vec::new(), outbox: Vec::new() }
    }
}

thread_local! {
    static MAIL: RefCell<Mail> = RefCell::default();
}

/// Allocates a question of `length` bytes and returns its address.
#[unsafe(no_mangle)]
pub extern "C" fn inbox(length: usize) -> *mut u8 {
    MAIL.with_borrow_mut(|mail| {
        mail.inbox.clear();
        mail.inbox.resize(length, 0);
        mail.inbox.as_mut_ptr()
    })
}

/// Answers the question in the inbox and returns the length of the answer.
#[unsafe(no_mangle)]
pub extern "C" fn answer() -> usize {
    MAIL.with_borrow_mut(|mail| {
        let Mail { service, inbox, outbox } = mail;
        *outbox = service.answer(inbox);
        outbox.len()
    })
}

/// Returns the address of the answer, which is valid until the next question.
#[unsafe(no_mangle)]
pub extern "C" fn outbox() -> *const u8 {
    MAIL.with_borrow(|mail| mail.outbox.as_ptr())
}
