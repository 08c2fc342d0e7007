//! Checks of the order of commands. [`CommandOrder`] holds for every stream of commands; machines rely on [`FrameNesting`].

use crate::command::TraceCommand;
use crate::error::CommandFault;

/// `begin` first and once, `end` last with the right count.
#[derive(Debug, Default)]
pub(crate) struct CommandOrder {
    count: u64,
    ended: bool,
}

impl CommandOrder {
    pub(crate) fn accept(&mut self, command: &TraceCommand) -> Result<(), CommandFault> {
        match command {
            _ if self.ended => return Err(CommandFault::new("", "stands after `end`; nothing may follow it")),
            TraceCommand::Begin(_) if self.count > 0 => {
                return Err(CommandFault::new("", "stands a second time; expected once, as the first command"));
            }
            TraceCommand::Begin(_) => {}
            _ if self.count == 0 => return Err(CommandFault::new("", "stands first; expected `begin`")),
            TraceCommand::End(end) if end.commands != self.count => {
                let message =
                    format!("is {}, but {} commands stand before it: some are lost or doubled", end.commands, self.count);
                return Err(CommandFault::new("commands", message));
            }
            TraceCommand::End(_) => self.ended = true,
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
pub(crate) struct FrameNesting {
    frames: u32,
    in_frame: bool,
    object: Option<u32>,
    arrival: u64,
    /// The pending command `shading` or `importance`, which concerns the next command.
    ahead: Option<&'static str>,
}

impl FrameNesting {
    /// Checks that `shading` and `importance`, in this order, precede their frame or object directly.
    fn fits_ahead(&mut self, command: &TraceCommand) -> Result<(), CommandFault> {
        let expected = match (self.ahead.take(), command) {
            (None, _) | (Some(_), TraceCommand::Object(_)) => return Ok(()),
            (Some("shading"), TraceCommand::Frame(_) | TraceCommand::Importance(_)) => return Ok(()),
            (Some("shading"), _) => "stands behind `shading`; expected the `frame` or `object` that this is said of",
            (Some(_), _) => "stands behind `importance`; expected the `object` that this is said of",
        };
        Err(CommandFault::new("", expected))
    }

    pub(crate) fn accept(&mut self, command: &TraceCommand) -> Result<(), CommandFault> {
        self.fits_ahead(command)?;
        match command {
            TraceCommand::Shading(_) | TraceCommand::Importance(_) => {
                self.ahead = Some(command.name());
                Ok(())
            }
            TraceCommand::Frame(frame) => self.open_frame(frame.index),
            TraceCommand::Object(object) => {
                self.object = Some(object.id);
                self.inside()
            }
            TraceCommand::Criterion(_) => self.inside(),
            TraceCommand::Polygon(polygon) => self.draw(polygon.object, polygon.arrival),
            TraceCommand::FrameEnd(_) => {
                self.inside()?;
                (self.in_frame, self.object) = (false, None);
                Ok(())
            }
            TraceCommand::Expect(_) | TraceCommand::End(_) if self.in_frame => {
                Err(CommandFault::new("", "stands inside a frame; expected `frame_end` before it"))
            }
            TraceCommand::End(_) if self.frames == 0 => Err(CommandFault::new("", "no frame before it: nothing to draw")),
            _ => Ok(()),
        }
    }

    fn open_frame(&mut self, index: u32) -> Result<(), CommandFault> {
        if self.in_frame {
            return Err(CommandFault::new("", "stands inside a frame; expected `frame_end` before it"));
        }
        if index != self.frames {
            return Err(CommandFault::new("index", format!("is {index}, expected {}: frames are counted from 0", self.frames)));
        }
        self.frames += 1;
        self.in_frame = true;
        Ok(())
    }

    /// Returns true if a frame is open.
    pub(crate) fn in_frame(&self) -> bool {
        self.in_frame
    }

    fn inside(&self) -> Result<(), CommandFault> {
        if self.in_frame {
            return Ok(());
        }
        Err(CommandFault::new("", "stands outside a frame; expected `frame` before it"))
    }

    fn draw(&mut self, object: u32, arrival: u64) -> Result<(), CommandFault> {
        self.inside()?;
        if self.object != Some(object) {
            let current = self.object.map_or("there is none".into(), |id| format!("it is {id}"));
            return Err(CommandFault::new(
                "object",
                format!("is {object}, expected the current object, and {current}: put `object` before its polygons"),
            ));
        }
        if arrival < self.arrival {
            return Err(CommandFault::new("arrival", format!("is {arrival}, before the {} of an earlier polygon", self.arrival)));
        }
        self.arrival = arrival;
        Ok(())
    }
}
