//! Bit widths of the device's tokens.

use crate::RegisterWrite;
use crate::signals::{FigureFlow, FinishedPolygon, NormalLoad, RegisterOrder, ShadedDot, SpecularDot, SpecularFlow};
use basrelief_signals::width::{CONTROL, COORDINATE, NUMBER, position, triangles};
use basrelief_signals::{Attribution, BitWidth, PixelSet, SignalWidths, WireFields};

/// Position, depth, three brightnesses.
impl BitWidth for ShadedDot {
    fn fields(token: Option<&Self>, widths: &SignalWidths, wire: &mut WireFields) {
        position(wire, token.map(|dot| [dot.x, dot.y]));
        wire.number("z", widths.depth, token.map(|dot| dot.z));
        for (i, name) in ["red", "green", "blue"].into_iter().enumerate() {
            wire.real(name, NUMBER, token.map(|dot| dot.brightness[i]));
        }
    }

    fn attribution(&self) -> Attribution {
        Attribution::Pixels(PixelSet::one(self.x, self.y))
    }
}

/// A dot, or control. Two bits distinguish them.
impl BitWidth for FigureFlow {
    fn fields(token: Option<&Self>, widths: &SignalWidths, wire: &mut WireFields) {
        let (mut dot, mut figure, mut frame) = (None, None, None);
        let kind = token.map(|flow| match flow {
            Self::Frame(of) => {
                frame = Some(of);
                0
            }
            Self::Figure(of) => {
                figure = Some(of);
                1
            }
            Self::Dot(of) => {
                dot = Some(of);
                2_u32
            }
            Self::End | Self::FrameEnd => 3,
        });
        wire.number("kind", 2, kind);
        wire.one_of(&mut [
            &mut |wire| {
                let number = figure.map(|figure| figure.polygon.object).or(frame.map(|frame| frame.index));
                wire.number("number", CONTROL, number);
                wire.setup("width", COORDINATE, frame.map(|frame| frame.width));
                wire.setup("height", COORDINATE, frame.map(|frame| frame.height));
                wire.setup("triangles", COORDINATE, figure.map(|figure| triangles(&figure.polygon)));
                wire.setup("mode", 2, figure.map(|figure| figure.registers.mode as u32));
                wire.setup("flat", 1, figure.map(|figure| figure.registers.flat));
                wire.setup("specular", 1, figure.map(|figure| figure.registers.specular));
                wire.setup("frame_end", 1, token.map(|flow| matches!(flow, Self::FrameEnd)));
            },
            &mut |wire| ShadedDot::fields(dot, widths, wire),
        ]);
    }

    fn attribution(&self) -> Attribution {
        match self {
            Self::Frame(frame) => Attribution::frame(frame),
            Self::Figure(figure) => Attribution::polygon(&figure.polygon),
            Self::Dot(dot) => dot.attribution(),
            Self::End => Attribution::Inherited,
            Self::FrameEnd => Attribution::Whole,
        }
    }
}

/// Control: a register write, or the number of the data in the registers of circuit (21).
impl BitWidth for RegisterOrder {
    fn fields(token: Option<&Self>, widths: &SignalWidths, wire: &mut WireFields) {
        let (mut flow, mut write) = (None, None);
        match token {
            Some(Self::Pass(of)) => flow = Some(of),
            Some(Self::Write(of)) => write = Some(of),
            None => {}
        }
        wire.flag("pass", token.map(|_| flow.is_some()));
        let (register, value) = write
            .map(|write| match write {
                RegisterWrite::Mode(mode) => (14, *mode as u32),
                RegisterWrite::Flat(flat) => (16, u32::from(*flat)),
                RegisterWrite::Specular(specular) => (18_u32, u32::from(*specular)),
            })
            .unzip();
        wire.one_of(&mut [
            &mut |wire| {
                wire.number("register", 5, register);
                wire.number("value", CONTROL - 5, value);
            },
            // The hardware has the number of the data in the registers of circuit (21).
            &mut |wire| {
                wire.part("flow", |wire| wire.recorded_only(|wire| FigureFlow::fields(flow, widths, wire)));
            },
        ]);
    }

    fn attribution(&self) -> Attribution {
        match self {
            Self::Write(_) => Attribution::Inherited,
            Self::Pass(signal) => signal.attribution(),
        }
    }
}

/// Position and one brightness.
impl BitWidth for SpecularDot {
    fn fields(token: Option<&Self>, _: &SignalWidths, wire: &mut WireFields) {
        position(wire, token.map(|dot| [dot.x, dot.y]));
        wire.real("brightness", NUMBER, token.map(|dot| dot.brightness));
    }

    fn attribution(&self) -> Attribution {
        Attribution::Pixels(PixelSet::one(self.x, self.y))
    }
}

impl BitWidth for SpecularFlow {
    fn fields(token: Option<&Self>, widths: &SignalWidths, wire: &mut WireFields) {
        let dot = match token {
            Some(Self::Dot(dot)) => Some(dot),
            _ => None,
        };
        wire.number(
            "kind",
            2,
            token.map(|flow| match flow {
                Self::Start { .. } => 1_u32,
                Self::Dot(_) => 2,
                Self::End => 3,
            }),
        );
        wire.one_of(&mut [
            &mut |wire| wire.flag("open", token.map(|flow| matches!(flow, Self::Start { open: true }))),
            &mut |wire| SpecularDot::fields(dot, widths, wire),
        ]);
    }

    fn attribution(&self) -> Attribution {
        match self {
            Self::Start { .. } | Self::End => Attribution::Inherited,
            Self::Dot(dot) => dot.attribution(),
        }
    }
}

/// The number of the data in the registers of circuit (50).
impl BitWidth for NormalLoad {
    fn fields(token: Option<&Self>, _: &SignalWidths, wire: &mut WireFields) {
        wire.number("number", CONTROL, token.map(|load| load.polygon.object));
        wire.setup("open", 1, token.map(|load| load.open));
        wire.setup("triangles", COORDINATE, token.map(|load| triangles(&load.polygon)));
        wire.setup("lights", COORDINATE, token.map(|load| load.illumination.lights.len() as u64));
        wire.setup("exponent", NUMBER, token.map(|load| load.illumination.lighting.n.to_bits()));
    }

    fn attribution(&self) -> Attribution {
        Attribution::polygon(&self.polygon)
    }
}

impl BitWidth for FinishedPolygon {
    fn fields(token: Option<&Self>, _: &SignalWidths, wire: &mut WireFields) {
        wire.flag("signal", token.map(|_| true));
    }
}
