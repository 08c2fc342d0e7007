//! Checks of the order of commands. [`Order`] holds for every stream of commands; machines rely on [`Nesting`].

use crate::command::Command;
use crate::error::Fault;

/// `begin` first and once, `end` last with the right count.
#[derive(Debug, Default)]
pub(crate) struct Order {
    count: u64,
    ended: bool,
}

impl Order {
    pub(crate) fn accept(&mut self, command: &Command) -> Result<(), Fault> {
        match command {
            _ if self.ended => return Err(Fault::new("", "stands after `end`; nothing may follow it")),
            Command::Begin(_) if self.count > 0 => {
                return Err(Fault::new("", "stands a second time; expected once, as the first command"));
            }
            Command::Begin(_) => {}
            _ if self.count == 0 => return Err(Fault::new("", "stands first; expected `begin`")),
            Command::End(end) if end.commands != self.count => {
                let message =
                    format!("is {}, but {} commands stand before it: some are lost or doubled", end.commands, self.count);
                return Err(Fault::new("commands", message));
            }
            Command::End(_) => self.ended = true,
            _ => {}
        }
        self.count += 1;
        Ok(())
    }

    /// Commands accepted so far.
    pub(crate) fn count(&self) -> u64 {
        self.count
    }

    /// Returns true if `end` was read.
    pub(crate) fn ended(&self) -> bool {
        self.ended
    }
}

/// Frames hold objects hold polygons; frames are counted from 0; arrivals never fall.
#[derive(Debug, Default)]
pub(crate) struct Nesting {
    frames: u32,
    in_frame: bool,
    object: Option<u32>,
    arrival: u64,
    /// The pending command `shading` or `importance`, which concerns the next command.
    ahead: Option<&'static str>,
}

impl Nesting {
    /// Checks that `shading` and `importance`, in this order, precede their frame or object directly.
    fn fits_ahead(&mut self, command: &Command) -> Result<(), Fault> {
        let expected = match (self.ahead.take(), command) {
            (None, _) | (Some(_), Command::Object(_)) => return Ok(()),
            (Some("shading"), Command::Frame(_) | Command::Importance(_)) => return Ok(()),
            (Some("shading"), _) => "stands behind `shading`; expected the `frame` or `object` that this is said of",
            (Some(_), _) => "stands behind `importance`; expected the `object` that this is said of",
        };
        Err(Fault::new("", expected))
    }

    pub(crate) fn accept(&mut self, command: &Command) -> Result<(), Fault> {
        self.fits_ahead(command)?;
        match command {
            Command::Shading(_) | Command::Importance(_) => {
                self.ahead = Some(command.name());
                Ok(())
            }
            Command::Frame(frame) => self.open_frame(frame.index),
            Command::Object(object) => {
                self.object = Some(object.id);
                self.inside()
            }
            Command::Criterion(_) => self.inside(),
            Command::Polygon(polygon) => self.draw(polygon.object, polygon.arrival),
            Command::FrameEnd(_) => {
                self.inside()?;
                (self.in_frame, self.object) = (false, None);
                Ok(())
            }
            Command::Expect(_) | Command::End(_) if self.in_frame => {
                Err(Fault::new("", "stands inside a frame; expected `frame_end` before it"))
            }
            Command::End(_) if self.frames == 0 => Err(Fault::new("", "no frame before it: nothing to draw")),
            _ => Ok(()),
        }
    }

    fn open_frame(&mut self, index: u32) -> Result<(), Fault> {
        if self.in_frame {
            return Err(Fault::new("", "stands inside a frame; expected `frame_end` before it"));
        }
        if index != self.frames {
            return Err(Fault::new("index", format!("is {index}, expected {}: frames are counted from 0", self.frames)));
        }
        self.frames += 1;
        self.in_frame = true;
        Ok(())
    }

    /// Returns true if a frame is open.
    pub(crate) fn in_frame(&self) -> bool {
        self.in_frame
    }

    fn inside(&self) -> Result<(), Fault> {
        if self.in_frame {
            return Ok(());
        }
        Err(Fault::new("", "stands outside a frame; expected `frame` before it"))
    }

    fn draw(&mut self, object: u32, arrival: u64) -> Result<(), Fault> {
        self.inside()?;
        if self.object != Some(object) {
            let current = self.object.map_or("there is none".into(), |id| format!("it is {id}"));
            return Err(Fault::new(
                "object",
                format!("is {object}, expected the current object, and {current}: put `object` before its polygons"),
            ));
        }
        if arrival < self.arrival {
            return Err(Fault::new("arrival", format!("is {arrival}, before the {} of an earlier polygon", self.arrival)));
        }
        self.arrival = arrival;
        Ok(())
    }
}
