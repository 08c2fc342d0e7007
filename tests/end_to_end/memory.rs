//! Small inputs that expand into large data are refused with the limit in the error. The program never ends by a signal, even
//! with little address space.

use crate::support::{Outcome, PROGRAM, Place, finish};
use basrelief_signals::Lighting;
use basrelief_trace::{BeginCommand, MaterialDefinition, TraceCommand as Line, TraceForm, TraceWriter};
use image::{DynamicImage, ImageFormat};
use std::fs::{self, File};
use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::process::{Command, Stdio};
use std::thread;

/// Runs a command line with this address space \[MiB\]. A program that requests more ends by a signal.
fn run(place: &Place, megabytes: u32, line: &str) -> Outcome {
    let limited = place.command(line);
    let mut shell = Command::new("sh");
    let limit = format!("ulimit -v {} && exec \"$0\" \"$@\"", megabytes << 10);
    shell.arg("-c").arg(limit).arg(PROGRAM).args(limited.get_args());
    finish(shell.current_dir(place.path("")).stdin(Stdio::null()))
}

/// Writes a trace of a few kilobytes that defines materials with names of this size \[MiB\].
fn write_names(place: &Place, name: &str, materials: u32, size: usize) {
    let form = TraceForm::for_file_name(name).expect("a display list");
    let mut writer = TraceWriter::new(File::create(place.path(name)).expect("created"), form).expect("a writer");
    writer.write(&Line::Begin(BeginCommand::new(8, 8))).expect("written");
    for id in 0..materials {
        writer
            .write(&Line::Material(MaterialDefinition {
                id,
                name: "n".repeat(size << 20),
                base_color: [1.0; 4],
                normal_scale: 1.0,
                lighting: Lighting::default(),
                color_texture: None,
                normal_map: None,
                double_sided: false,
            }))
            .expect("written");
    }
    writer.finish().expect("written");
    assert!(fs::metadata(place.path(name)).expect("there").len() < 100_000);
}

#[test]
fn names_of_a_trace_are_held_within_the_limit() {
    let place = Place::new();
    write_names(&place, "t.bdl.zst", 90, 15);
    let refused = |megabytes: u32, command: &str, limit: &str| {
        let outcome = run(&place, megabytes, &format!("{command} --quiet"));
        assert_eq!(outcome.code(), 1, "{command}: {}", outcome.err);
        let said = format!("{}{}", outcome.out, outcome.err);
        for part in ["t.bdl.zst: record ", &format!("over the limit of {limit}; give more with --memory-limit")] {
            assert!(said.contains(part), "{command}: {said}");
        }
    };
    refused(2048, "run t.bdl.zst", "1 GiB");
    // With a smaller limit, because reading a gibibyte takes long.
    for command in ["run t.bdl.zst", "verify t.bdl.zst", "run t.bdl.zst --functional --no-exact"] {
        refused(400, &format!("{command} --memory-limit 100MiB"), "100 MiB");
    }
    // The conversion keeps none of the names.
    write_names(&place, "short.bdl.zst", 80, 2);
    let converted = run(&place, 600, "convert short.bdl.zst short.jsonl.zst --memory-limit 150MiB");
    assert_eq!(converted.code(), 0, "{}", converted.err);
}

#[test]
fn picture_over_memory_limit_is_refused() {
    let place = Place::new();
    DynamicImage::new_luma8(8192, 8192).save_with_format(place.path("large.png"), ImageFormat::Png).expect("written");
    fs::write(place.path("m.mtl"), "newmtl a\nbump large.png\n").expect("written");
    let face = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n";
    fs::write(place.path("m.obj"), format!("mtllib m.mtl\nusemtl a\n{face}")).expect("written");
    let refused = |command: &str, limit: &str, words: &str| {
        let outcome = run(&place, 2048, &format!("{command} --quiet{limit}"));
        let error = outcome.error(1);
        assert!(error.contains("m.obj") && error.contains(&format!("over the limit of {words}")), "{command}: {error}");
    };
    // Only the default limit has room for the picture. The heights in it have not.
    refused("run m.obj", "", "1 GiB");
    for (limit, words) in [(" --memory-limit 256MiB", "256 MiB"), (" --memory-limit 1000", "1000 bytes")] {
        for command in ["run m.obj", "record m.obj --out t.bdl", "serve m.obj"] {
            refused(command, limit, words);
        }
    }
}

/// Without `--memory-limit`, the program stays within the address space that the system grants, even if it is small.
#[cfg(target_os = "linux")]
#[test]
fn address_space_limit_never_ends_in_signal() {
    let place = Place::new();
    DynamicImage::new_luma8(8192, 8192).save_with_format(place.path("large.png"), ImageFormat::Png).expect("written");
    fs::write(place.path("m.mtl"), "newmtl a\nmap_Kd large.png\n").expect("written");
    let triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl a\nf 1/1 2/1 3/1\n";
    fs::write(place.path("m.obj"), format!("mtllib m.mtl\n{triangle}")).expect("written");
    write_names(&place, "t.bdl.zst", 90, 15);
    for megabytes in [160, 200, 300, 400, 600] {
        for (line, file) in [("run m.obj --size 16x12", "m.obj"), ("run t.bdl.zst", "t.bdl.zst")] {
            let outcome = run(&place, megabytes, &format!("{line} --quiet"));
            let error = outcome.error(1);
            assert!(error.starts_with(file) && error.contains("(`ulimit -v`)"), "{megabytes} MiB: {line}: {error}");
        }
    }
    for (machine, size, megabytes) in [("bump", "4096x2048", 300), ("defer", "2048x1024", 300), ("shade", "1024x768", 200)] {
        let line = format!("demo cut-plane@1 --machine {machine} --functional --quiet");
        let error = run(&place, megabytes, &format!("{line} --size {size}")).error(1).to_owned();
        let said = format!("images of {} pixels", size.replace('x', " x "));
        assert!(error.contains(&said) && error.contains("(`ulimit -v`)"), "{megabytes} MiB: {size}: {error}");
        assert_eq!(run(&place, megabytes, &format!("{line} --size 320x240")).code(), 0, "{machine}, {megabytes} MiB");
    }
}

#[test]
fn data_of_server_stays_within_memory_limit() {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = listener.local_addr().expect("an address");
    let endless = |mut stream: TcpStream| {
        let _ = stream.read(&mut [0; 4096]);
        let _ = write!(stream, "HTTP/1.1 200 OK\r\netag: \"{}\"\r\nconnection: close\r\n\r\n", "0".repeat(64));
        while stream.write_all(&[0; 1 << 16]).is_ok() {}
    };
    thread::spawn(move || listener.incoming().flatten().for_each(|stream| drop(thread::spawn(move || endless(stream)))));
    let place = Place::new();
    let outcome = run(&place, 1024, &format!("run --from http://{address}/ --quiet --memory-limit 64MiB"));
    let error = outcome.error(1);
    assert!(error.contains("/scene/64x64/raw: needs") && error.contains("over the limit of 64 MiB"), "{error}");
    assert!(!error.contains("attempt"), "asked for once: {error}");
}

#[test]
fn other_files_are_read_within_the_limit() {
    let place = Place::new();
    fs::write(place.path("c.toml"), "a=1\n".repeat(1 << 18)).expect("written");
    fs::write(place.path("c.json"), format!("[{}1]", "1,".repeat(1 << 20))).expect("written");
    for line in [
        "demo --config c.toml",
        "demo --camera c.json",
        "compare c.json c.json",
        "demo --config /dev/zero",
        "compare /dev/zero c.json",
        "run c.json",
    ] {
        let outcome = run(&place, 1024, &format!("{line} --memory-limit 20MiB"));
        let error = outcome.error(1);
        if line != "run c.json" {
            assert!(error.contains("over the limit of 20 MiB; give more with --memory-limit"), "{line}: {error}");
        }
    }
}

#[test]
fn pictures_of_a_trace_count_against_limit() {
    let place = Place::new();
    let mut writer =
        TraceWriter::new(File::create(place.path("t.jsonl")).expect("created"), TraceForm::default()).expect("a writer");
    writer.write(&Line::Begin(BeginCommand::new(4096, 2048))).expect("written");
    writer.finish().expect("written");
    let error = place.run("run t.jsonl --memory-limit 100MiB --quiet");
    let error = error.error(1);
    assert!(error.contains("t.jsonl: line 1: needs 408 MiB for images of 4096 x 2048 pixels"), "{error}");
}

#[test]
fn wrong_memory_limit_is_refused() {
    let place = Place::new();
    for wrong in ["0", "many", "1GB", "-1"] {
        let outcome = place.run(&format!("demo --memory-limit={wrong}"));
        assert_eq!(outcome.code(), 2, "{wrong}");
        assert!(outcome.err.contains("such as 4GiB"), "{wrong}: {}", outcome.err);
    }
}
