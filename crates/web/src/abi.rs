//! What the worker calls: three functions and the memory; and three functions of the worker that are called meanwhile. `wasm-bindgen`
//! was rejected: for six calls it would bring a program of its own, of exactly its version, to be built ahead of the page.
#![allow(unsafe_code, reason = "a name to be called by, or to call by, counts as unsafe; nothing behind it is")]

use crate::{Desk, Got, Outside, Parcel};
use std::cell::RefCell;
use std::rc::Rc;

#[link(wasm_import_module = "page")]
unsafe extern "C" {
    /// Gets what is at an address: how many bytes the answer has, a [`Parcel`]. The address is read here, and no further.
    safe fn get(address: *const u8, length: usize, fresh: bool) -> usize;
    /// Puts that answer here; there is room for it.
    safe fn take(answer: *mut u8);
    /// Shows a picture that lies here.
    safe fn show(parcel: *const u8, length: usize);
}

/// The worker.
#[derive(Debug)]
struct Worker;

impl Outside for Worker {
    fn get(&self, address: &str, fresh: bool) -> Result<Got, String> {
        let mut answer = vec![0; get(address.as_ptr(), address.len(), fresh)];
        take(answer.as_mut_ptr());
        let Parcel { json, rest } = Parcel::read(&answer)?;
        match json["error"].as_str() {
            Some(error) => Err(error.into()),
            None => Ok(Got {
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
    desk: Desk,
    inbox: Vec<u8>,
    outbox: Vec<u8>,
}

impl Default for Mail {
    fn default() -> Self {
        Self { desk: Desk::within(Rc::new(Worker)), inbox: Vec::new(), outbox: Vec::new() }
    }
}

thread_local! {
    static MAIL: RefCell<Mail> = RefCell::default();
}

/// Room for a question of so many bytes: where it is to be written.
#[unsafe(no_mangle)]
pub extern "C" fn inbox(length: usize) -> *mut u8 {
    MAIL.with_borrow_mut(|mail| {
        mail.inbox.clear();
        mail.inbox.resize(length, 0);
        mail.inbox.as_mut_ptr()
    })
}

/// Answers the question in the inbox: how many bytes the answer has.
#[unsafe(no_mangle)]
pub extern "C" fn answer() -> usize {
    MAIL.with_borrow_mut(|mail| {
        let Mail { desk, inbox, outbox } = mail;
        *outbox = desk.answer(inbox);
        outbox.len()
    })
}

/// Where the answer lies, until the next question.
#[unsafe(no_mangle)]
pub extern "C" fn outbox() -> *const u8 {
    MAIL.with_borrow(|mail| mail.outbox.as_ptr())
}
