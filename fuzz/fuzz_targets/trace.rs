//! Traces of all forms: no input may panic, hang or allocate out of proportion. A resolved trace can be recorded, and converts
//! into every form and back.

#![no_main]

use basrelief_input::MemoryPool;
use basrelief_trace::{TraceForm, NoFiles, TraceRecorder, TraceResolver, convert};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let mut canonical = Vec::new();
    if convert(bytes, &mut canonical, TraceForm::default(), &MemoryPool::default()).is_err() {
        return;
    }
    for form in TraceForm::ALL {
        let (mut there, mut back) = (Vec::new(), Vec::new());
        convert(canonical.as_slice(), &mut there, form, &MemoryPool::default()).expect("a valid trace converts");
        convert(there.as_slice(), &mut back, TraceForm::default(), &MemoryPool::default()).expect("a converted trace converts");
        assert!(back == canonical, "{form:?} lost something");
    }
    let Ok(resolver) = TraceResolver::new(bytes, NoFiles, &MemoryPool::default()) else { return };
    let begin = resolver.begin().clone();
    let Ok(controls) = resolver.collect::<Result<Vec<_>, _>>() else { return };
    let mut recorder = TraceRecorder::new(Vec::new(), TraceForm::default(), begin).expect("a valid begin");
    for (control, _) in &controls {
        recorder.record(control).expect("what resolves can be recorded");
    }
    recorder.finish(Vec::new()).expect("what resolves can be recorded");
});
