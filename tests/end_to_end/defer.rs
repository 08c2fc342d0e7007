//! The rate-limited renderer: what it writes, and a server on a real path.

use crate::support::{Place, is_valid, picture};
use serde_json::Value;
use std::fs;
use std::io::{BufRead, BufReader};
use std::process::{Child, Stdio};

const SMALL: &str = "--size 64x48 --quiet --set tile.width=8 --set tile.height=8";

fn lines(place: &Place, name: &str) -> Vec<Value> {
    place.text(name).lines().map(|l| serde_json::from_str(l).unwrap_or_else(|e| panic!("{name}: {e}: {l}"))).collect()
}

fn image(place: &Place, out: &str) -> String {
    place.report(out)["image"][0]["sha256"].as_str().expect("a hash").to_owned()
}

#[test]
fn it_writes_pictures_of_each_round_the_layer_depth_the_tile_map_and_both_dumps() {
    let place = Place::new();
    let dumps = "--dump reference-buffer buffer.jsonl --dump tiles tiles.jsonl";
    place.ok(&format!("demo gallery {SMALL} --set defer.mode=progressive {dumps} --out p"));
    let report = place.report("p");
    is_valid(&report, &place);
    let rounds = report["device"]["picture_round"].as_array().expect("rounds").len();
    assert!(rounds >= 2, "{rounds}");
    let names = place.names("p");
    let expected = (0..rounds).map(|n| format!("image-round-{n}.png"));
    assert!(expected.chain(["layer-depth.png".into(), "tiles.png".into()]).all(|n| names.contains(&n)), "{names:?}");
    let last = picture(&place.path(&format!("p/image-round-{}.png", rounds - 1)));
    assert_eq!(last, picture(&place.path("p/image.png")));
    let pixels = lines(&place, "buffer.jsonl");
    assert_eq!(pixels.len() as u64, report["device"]["pixels_textured"].as_u64().unwrap_or(0) / rounds as u64);
    let keys = |value: &Value| value.as_object().expect("an object").keys().cloned().collect::<Vec<_>>();
    assert_eq!(keys(&pixels[0]).len(), 6);
    let tiles = lines(&place, "tiles.jsonl");
    let loaded = tiles.iter().filter(|t| t["state"] == "loaded").count() as u64;
    assert_eq!(Some(loaded), report["device"]["tiles_loaded"].as_u64());
    assert_eq!(keys(&tiles[0]).len(), 6);
    place.ok(&format!("demo gallery {SMALL} --out b"));
    assert_eq!(image(&place, "p"), image(&place, "b"), "progressive ends with the picture of best resolution");
}

#[test]
fn a_progressive_picture_that_is_the_best_at_once_is_a_round_too() {
    let place = Place::new();
    place.ok("demo gallery --size 64x48 --quiet --set defer.mode=progressive --out p");
    assert_eq!(place.report("p")["device"]["picture_round"], serde_json::json!([0]));
    assert_eq!(picture(&place.path("p/image-round-0.png")), picture(&place.path("p/image.png")));
}

#[test]
fn both_engines_and_the_functional_model_agree() {
    let place = Place::new();
    let line = format!("demo gallery {SMALL} --frames 2 --set path.bits_per_second=30000000000 --set path.latency_us=1");
    place.ok(&format!("{line} --out timed"));
    place.ok(&format!("{line} --out ticked --engine ticked"));
    place.ok(&format!("{line} --out functional --functional --no-exact"));
    let [timed, ticked] = ["timed", "ticked"].map(|out| crate::support::without_host(place.report(out)));
    assert_eq!(timed.to_string(), ticked.to_string());
    assert_eq!(timed["image"], place.report("functional")["image"]);
}

#[test]
fn a_dump_that_there_is_none_of_is_refused() {
    let place = Place::new();
    let refused = |line: &str| place.run(line).error(2).to_owned();
    assert!(refused("demo sphere --dump tiles t.jsonl").contains("--machine defer has"));
    assert!(refused("demo gallery --dump everything t.jsonl").contains("expected spans, reference-buffer, tiles"));
    assert!(place.names("").is_empty());
}

/// A server, ended with the test.
struct Server(Child, String);

impl Server {
    fn start(place: &Place, line: &str) -> Self {
        let mut child = place.command(line).stdout(Stdio::piped()).spawn().expect("the program starts");
        let mut said = String::new();
        BufReader::new(child.stdout.take().expect("a pipe")).read_line(&mut said).expect("a line");
        let url = said.split_whitespace().last().unwrap_or_default().to_owned();
        assert!(url.starts_with("http://127.0.0.1:"), "{said}");
        Self(child, url)
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        // It may have ended.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

#[test]
fn a_picture_from_a_server_is_that_from_the_file_to_the_bit() {
    let place = Place::new();
    let settings = "--set tile.width=8 --set tile.height=8 --quiet";
    place.ok(&format!("demo gallery {SMALL} --out file"));
    let server = Server::start(&place, "serve demo:gallery --size 64x48 --listen 127.0.0.1:0");
    for more in ["", "--set tile.encoding=png", "--set defer.mode=progressive --set path.requests=3", "--tile-cache kept"] {
        place.ok(&format!("run --from {} {settings} {more} --out remote", server.1));
        assert_eq!(image(&place, "remote"), image(&place, "file"), "{more}");
    }
    let url = server.1.clone();
    drop(server);
    let gone = place.run(&format!("run --from {url} {settings} --out nothing"));
    assert!(gone.error(1).contains("/polygons"), "{}", gone.err);
    assert!(!place.names("").contains(&"nothing".to_owned()));
}

#[test]
fn tiles_kept_from_other_texels_are_not_taken() {
    let place = Place::new();
    let model = "mtllib m.mtl\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nusemtl m\nf 1/1 2/2 3/3\n";
    fs::write(place.path("m.obj"), model).expect("written");
    fs::write(place.path("m.mtl"), "newmtl m\nKd 1 1 1\nmap_Kd t.png\n").expect("written");
    let drawn = [[200, 0, 0], [0, 0, 200]].map(|colour| {
        image::RgbImage::from_pixel(16, 16, image::Rgb(colour)).save(place.path("t.png")).expect("written");
        let server = Server::start(&place, "serve m.obj --size 32x24 --listen 127.0.0.1:0");
        place.ok(&format!("run --from {} --tile-cache kept --quiet --out remote", server.1));
        place.ok("run m.obj --machine defer --size 32x24 --quiet --out file");
        assert_eq!(image(&place, "remote"), image(&place, "file"), "{colour:?}");
        image(&place, "file")
    });
    assert_ne!(drawn[0], drawn[1]);
}

#[test]
fn who_may_read_is_said_aloud_and_what_does_not_fit_together_is_refused() {
    let place = Place::new();
    let refused = |line: &str| place.run(line).error(2).to_owned();
    assert!(refused("serve demo:gallery --listen 0.0.0.0:0").contains("--public"));
    assert!(refused("run --from http://127.0.0.1:1/ --machine bump").contains("only machine `defer`"));
    assert!(refused("run --from http://127.0.0.1:1/ --compare-methods").contains("--compare-methods"));
    assert!(refused("run --from http://127.0.0.1:1/ --size 8x8").contains("the server has the view"));
    assert!(refused("run --from ftp://x").contains("expected http://ADDRESS:PORT/"));
    assert!(refused("run PATCH --tile-cache x").contains("--from"));
}
