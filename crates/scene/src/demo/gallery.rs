//! A hall with many large pictures.

use super::paintings::painting;
use super::pattern::{Noise, floor, scatter};
use super::stage::{DemoBuilder, DemoScene, PI, SurfaceGrid, SurfacePoint, WHOLE, append, rectangle};
use crate::camera::{Projection, Viewpoint};
use basrelief_signals::Mesh;
use glam::{DMat4, DVec3};

/// Half the length, the height, half the width of the hall, in metres.
const HALL: [f64; 3] = [10.0, 4.6, 8.0];

/// Sizes of the pictures \[texels\], taken in turn: square or not, powers of two, even and odd.
const SIZES: [[u32; 2]; 10] =
    [[700, 300], [512, 512], [300, 640], [1023, 511], [640, 480], [257, 385], [900, 600], [360, 360], [512, 1024], [800, 333]];

/// Pictures on the walls, on a block in the middle and on screens around it, most of them hidden, oblique or far from
/// wherever one stands. Walls, ceiling, frames and pillars are plain. The way around leads between the screens, always
/// with the same distance from the middle.
pub(super) fn build() -> DemoScene {
    let mut shop = DemoBuilder::default();
    let mut frames = Mesh::default();
    for (number, place) in (0..).zip(places()) {
        let size = SIZES[number as usize % SIZES.len()];
        hang(&mut shop, &mut frames, number, size, place);
    }
    let grain = Noise::new(16, 62);
    let parquet = shop.colors("parquet", [256, 256], |u, v| parquet_color(&grain, u, v));
    let floor = shop.dull("parquet", [1.0; 3], Some(parquet));
    let gold = shop.dull("gold", [0.72, 0.55, 0.22], None);
    let plaster = shop.dull("plaster", [0.80, 0.79, 0.74], None);
    let cloth = shop.dull("cloth", [0.42, 0.20, 0.22], None);
    shop.place("frames", frames, DMat4::IDENTITY, &gold);
    shop.place("floor", ground(), DMat4::IDENTITY, &floor);
    shop.place("hall", hall(), DMat4::IDENTITY, &plaster);
    shop.place("screens", screens(), DMat4::IDENTITY, &cloth);
    shop.place("pillars", pillars(), DMat4::IDENTITY, &plaster);
    let eye = DVec3::new(-2.6, 1.7, 4.4);
    let lens = Projection::Perspective { field: 1.05, near: 0.2, far: 60.0 };
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    let camera = Viewpoint::looking_at(eye, DVec3::new(1.6, 1.75, -1.0), lens).unwrap_or(Viewpoint { eye, axes, lens });
    let stage = shop.stage(camera, [0.35, 0.8, 0.5]);
    DemoScene { orbit: 360.0, ..stage }
}

/// Place of a picture: the foot of the wall below its middle, the direction out of the wall, and its maximum width in metres.
#[derive(Clone, Copy)]
struct PicturePlace {
    foot: DVec3,
    out: DVec3,
    room: f64,
}

fn places() -> Vec<PicturePlace> {
    let [length, _, width] = HALL;
    let on_wall = |foot: [f64; 2], out: DVec3| PicturePlace { foot: DVec3::new(foot[0], 0.0, foot[1]), out, room: 3.1 };
    let mut places = Vec::new();
    for k in -2..=2 {
        places.push(on_wall([4.0 * f64::from(k), -width], DVec3::Z));
        places.push(on_wall([4.0 * f64::from(k), width], DVec3::NEG_Z));
    }
    for k in [-1.5, -0.5, 0.5, 1.5] {
        places.push(on_wall([-length, 4.0 * k], DVec3::X));
        places.push(on_wall([length, 4.0 * k], DVec3::NEG_X));
    }
    for screen in SCREENS {
        let (out, across) = (screen.out(), DVec3::Y.cross(screen.out()));
        for (out, deep, room) in [(out, screen.thickness, screen.breadth), (across, screen.breadth, screen.thickness)] {
            let hung = [out, -out].map(|out| PicturePlace { foot: screen.middle() + out * (deep / 2.0), out, room: room - 0.4 });
            places.extend(hung.into_iter().filter(|place| place.room > 0.0));
        }
    }
    places
}

/// Free-standing wall.
#[derive(Clone, Copy)]
struct FreeWall {
    at: [f64; 2],
    /// From +z towards +x \[degrees\].
    turn: f64,
    breadth: f64,
    thickness: f64,
}

impl FreeWall {
    fn middle(self) -> DVec3 {
        DVec3::new(self.at[0], 0.0, self.at[1])
    }

    fn out(self) -> DVec3 {
        let angle = self.turn * PI / 180.0;
        DVec3::new(libm::sin(angle), 0.0, libm::cos(angle))
    }

    /// Its front, back and sides.
    fn mesh(self) -> Mesh {
        let mut mesh = Mesh::default();
        let out = self.out();
        let across = DVec3::Y.cross(out);
        let (deep, wide) = (out * (self.thickness / 2.0), across * (self.breadth / 2.0));
        for [out, half] in [[deep, wide], [wide, -deep], [-deep, -wide], [-wide, deep]] {
            let corner = self.middle() + out - half + DVec3::Y * SCREEN_HEIGHT;
            append(&mut mesh, rectangle(corner, half * 2.0, DVec3::NEG_Y * SCREEN_HEIGHT, WHOLE));
        }
        let corner = self.middle() + DVec3::Y * SCREEN_HEIGHT - deep - wide;
        append(&mut mesh, rectangle(corner, wide * 2.0, deep * 2.0, WHOLE));
        mesh
    }
}

const SCREEN_HEIGHT: f64 = 3.2;

/// A block in the middle, two screens beside it, and four outside of the way around, which has a radius of 5.1 m.
const SCREENS: [FreeWall; 7] = [
    FreeWall { at: [0.0, 0.0], turn: 0.0, breadth: 2.6, thickness: 2.6 },
    FreeWall { at: [3.3, 0.5], turn: 65.0, breadth: 1.8, thickness: 0.2 },
    FreeWall { at: [-3.3, -0.5], turn: 75.0, breadth: 1.8, thickness: 0.2 },
    FreeWall { at: [6.9, 4.2], turn: 60.0, breadth: 2.4, thickness: 0.2 },
    FreeWall { at: [-6.9, 4.2], turn: -35.0, breadth: 2.4, thickness: 0.2 },
    FreeWall { at: [6.9, -4.2], turn: 140.0, breadth: 2.4, thickness: 0.2 },
    FreeWall { at: [-6.9, -4.2], turn: 15.0, breadth: 2.4, thickness: 0.2 },
];

/// Hangs a picture of this many texels, as large as its place allows, and adds its frame.
fn hang(shop: &mut DemoBuilder, frames: &mut Mesh, number: u32, size: [u32; 2], place: PicturePlace) {
    const HIGHEST: f64 = 2.3;
    const MIDDLE: f64 = 1.75;
    let shape = f64::from(size[0]) / f64::from(size[1]);
    let height = HIGHEST.min(place.room / shape);
    let painting = painting(number, size[0]);
    let picture = shop.picture(&format!("picture {number}"), size, |u, v| painting.at(u, v));
    let material = shop.dull(&picture.name, [1.0; 3], Some(picture.clone()));
    let right = DVec3::Y.cross(place.out);
    let plate = |margin: f64, off: f64| {
        let (w, h) = (height * shape + 2.0 * margin, height + 2.0 * margin);
        let corner = place.foot + place.out * off - right * (w / 2.0) + DVec3::Y * (MIDDLE + h / 2.0);
        rectangle(corner, right * w, DVec3::NEG_Y * h, WHOLE)
    };
    append(frames, plate(0.07, 0.02));
    shop.place(&picture.name, plate(0.0, 0.04), DMat4::IDENTITY, &material);
}

fn ground() -> Mesh {
    let [length, _, width] = HALL;
    let uv = [[0.0, 0.0], [length, width]];
    rectangle(DVec3::new(-length, 0.0, -width), DVec3::X * (2.0 * length), DVec3::Z * (2.0 * width), uv)
}

/// The four walls, seen from inside, and the ceiling.
fn hall() -> Mesh {
    let [length, height, width] = HALL;
    let mut mesh = Mesh::default();
    for (out, reach, half) in
        [(DVec3::Z, width, length), (DVec3::NEG_Z, width, length), (DVec3::X, length, width), (DVec3::NEG_X, length, width)]
    {
        let right = DVec3::Y.cross(out);
        let corner = out * -reach - right * half + DVec3::Y * height;
        append(&mut mesh, rectangle(corner, right * (2.0 * half), DVec3::NEG_Y * height, WHOLE));
    }
    let corner = DVec3::new(-length, height, width);
    append(&mut mesh, rectangle(corner, DVec3::X * (2.0 * length), DVec3::NEG_Z * (2.0 * width), WHOLE));
    mesh
}

fn screens() -> Mesh {
    let mut mesh = Mesh::default();
    SCREENS.iter().for_each(|screen| append(&mut mesh, screen.mesh()));
    mesh
}

/// Round pillars along the long walls.
fn pillars() -> Mesh {
    let [_, height, width] = HALL;
    let mut mesh = Mesh::default();
    for (x, z) in [-6.0, -2.0, 2.0, 6.0].into_iter().flat_map(|x| [-1.0, 1.0].map(|side| (x, side * (width - 0.6)))) {
        let pillar = SurfaceGrid::open(16, 1).mesh(|s, t| {
            let (sin, cos) = (libm::sin(2.0 * PI * s), libm::cos(2.0 * PI * s));
            let normal = DVec3::new(sin, 0.0, cos);
            let position = DVec3::new(x, height * (1.0 - t), z) + normal * 0.28;
            SurfacePoint { position, normal, tangent: DVec3::new(cos, 0.0, -sin), uv: [s, t] }
        });
        append(&mut mesh, pillar);
    }
    mesh
}

/// Staves of wood in a plain pattern, eight by two to a tile.
fn parquet_color(grain: &Noise, u: f64, v: f64) -> DVec3 {
    let (x, y) = (u * 8.0, v * 2.0);
    let left = floor(x);
    let row = left as i64;
    let stave = floor(y + 0.5 * (row % 2) as f64) as i64 % 2;
    let edge = (x - left).min(left + 1.0 - x);
    let wood = DVec3::new(0.44, 0.27, 0.14).lerp(DVec3::new(0.72, 0.50, 0.29), scatter(row, stave, 61));
    wood * (0.85 + 0.15 * grain.at(u, v)) * if edge < 0.04 { 0.6 } else { 1.0 }
}
