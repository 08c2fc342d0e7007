//! What the worker calls: three functions and the memory. `wasm-bindgen` was rejected: for three calls it would bring a program of
//! its own, of exactly its version, to be built ahead of the page.
#![allow(unsafe_code, reason = "a name to be called by counts as unsafe; nothing behind it is")]

use crate::Desk;
use std::cell::RefCell;

#[derive(Default)]
struct Mail {
    desk: Desk,
    inbox: Vec<u8>,
    outbox: Vec<u8>,
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
