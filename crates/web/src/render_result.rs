//! Content of an answer.

use crate::connection::ServerConnection;
use crate::draft::DraftPicture;
use crate::host_page::HostPage;
use crate::message::Message;
use basrelief_reference::{RgbPicture, metrics};
use basrelief_report::Report;
use basrelief_report::html::sections;
use basrelief_scene::DEMOS;
use basrelief_sim::{AuxContent, AuxForm, AuxOutput, AuxOutputInfo, FramePictures, MACHINES, MachineInfo, Observer, page_assets};
use basrelief_timeline::UtilizationTimeline;
use serde_json::{Value, json};
use std::rc::Rc;

/// Lists the machines with their units and parameters, and the demos.
pub(crate) fn catalogue() -> Value {
    let machines: Vec<Value> = MACHINES.iter().map(machine).collect();
    let demos: Vec<Value> = DEMOS
        .iter()
        .map(|demo| json!({ "name": demo.name, "about": demo.about, "machine": MachineInfo::of_demo(demo.name).name }))
        .collect();
    json!({ "version": env!("CARGO_PKG_VERSION"), "machines": machines, "demos": demos })
}

/// Returns the main parameters of a machine, which the page shows before its hundred other parameters.
fn main_parameters(machine: &str) -> &'static [&'static str] {
    match machine {
        "bump" => &[
            "replacement.entries",
            "replacement.lanes",
            "brightness.levels",
            "brightness.bits",
            "fifo.fragments.depth",
            "memory.graphics.part",
        ],
        "shade" => &["shade.mode", "shortcut.flatness.enabled", "shortcut.same_plane.enabled", "memory.frame.part"],
        "texel" => &["texel.method", "texel.error_bound", "cache.texture.sets", "memory.texture.part"],
        "defer" => &["defer.mode", "tile.width", "tile.encoding", "path.bits_per_second"],
        _ => &[],
    }
}

fn machine(machine: &MachineInfo) -> Value {
    let parameters = machine.default_config().described();
    let unit = |unit: &basrelief_machines::UnitInfo| json!({ "name": unit.name, "numeral": unit.numeral, "role": unit.role });
    let units: Vec<Value> = machine.units().iter().map(unit).collect();
    json!({ "name": machine.name, "fetches": machine.fetches_tiles, "about": machine.about, "demos": machine.demos, "main": main_parameters(machine.name), "units": units, "parameters": parameters })
}

/// Pictures of a run: those of the last frame, and the last picture of each auxiliary output.
#[derive(Default)]
pub(crate) struct RenderResult {
    machine: Option<RgbPicture>,
    exact: Option<RgbPicture>,
    exhibits: Vec<(AuxOutputInfo, RgbPicture)>,
    /// Receiver of intermediate pictures.
    rounds: Option<RoundViewer>,
    draft: Option<DraftPicture>,
    /// Number of the last frame.
    frame: u32,
}

/// Shows intermediate pictures, but only after a request to the server. Without a request the final image follows at once, and
/// an intermediate picture would flicker.
pub(crate) struct RoundViewer {
    path: Rc<ServerConnection>,
    page: Rc<dyn HostPage>,
    /// Requests before the run.
    before: u64,
}

impl RoundViewer {
    pub(crate) fn new(path: Rc<ServerConnection>, page: Rc<dyn HostPage>) -> Self {
        let before = path.totals().requests;
        Self { path, page, before }
    }

    fn show(&self, picture: &RgbPicture) {
        if self.path.totals().requests > self.before {
            let mut message = Message::default();
            message.json = append_sketch(&mut message, picture);
            self.page.show(message.into_bytes());
        }
    }
}

fn append_sketch(message: &mut Message, picture: &RgbPicture) -> Value {
    let at = message.append(&picture.to_rgba());
    json!({ "at": at, "width": picture.width, "height": picture.height })
}

impl Observer for RenderResult {
    fn frame(&mut self, pictures: &FramePictures<'_>) -> Result<(), String> {
        self.frame = pictures.index as u32;
        self.machine = Some(pictures.machine.clone());
        self.exact = pictures.exact.map(|(exact, _)| exact.clone());
        Ok(())
    }

    fn aux_output(&mut self, exhibit: &AuxOutput<'_>) -> Result<(), String> {
        let (AuxContent::Picture(picture) | AuxContent::NamedPicture(_, picture)) = exhibit.content else { return Ok(()) };
        if exhibit.info.form == AuxForm::PicturePerRound {
            self.rounds.iter().for_each(|rounds| rounds.show(picture));
            self.draft.iter_mut().for_each(|draft| draft.round(exhibit.frame, picture));
            return Ok(());
        }
        self.exhibits.retain(|(info, _)| *info != exhibit.info);
        self.exhibits.push((exhibit.info, picture.clone()));
        Ok(())
    }
}

impl RenderResult {
    /// Makes an empty collection. `rounds` receives intermediate pictures.
    pub(crate) fn with_rounds(rounds: Option<RoundViewer>) -> Self {
        Self { rounds, ..Self::default() }
    }

    /// Makes an empty collection for a draft.
    pub(crate) fn with_draft(draft: DraftPicture) -> Self {
        Self { draft: Some(draft), ..Self::default() }
    }

    /// Returns an answer with the picture of a draft.
    pub(crate) fn draft(self) -> Message {
        let picture = self.draft.and_then(|draft| draft.of_frame(self.frame)).or(self.machine);
        let mut message = Message::default();
        message.json = json!({ "draft": picture.map(|picture| append_sketch(&mut message, &picture)) });
        message
    }

    /// Returns true if the page shows this auxiliary output as a picture of its own.
    pub(crate) fn is_shown(info: &AuxOutputInfo) -> bool {
        !matches!(info.form, AuxForm::Lines | AuxForm::PicturePerRound)
    }

    /// Returns the answer to a run. `command` repeats the run. `strips` holds the activity of the units and their names.
    pub(crate) fn answer(
        self,
        report: &Report,
        command: &str,
        strips: Option<(UtilizationTimeline, Vec<String>)>,
    ) -> Result<Message, String> {
        let mut message = Message::default();
        let pictures = self.pictures(&report.last_frame_suffix(), &mut message)?;
        let strips = strips.map(|(strips, names)| pack_timeline(&strips, &names, &mut message));
        let sections: Vec<Value> = sections(report, &page_assets(report)?)
            .into_iter()
            .map(|section| json!({ "id": section.id, "title": section.title, "html": section.html }))
            .collect();
        // Sent as text, because a JSON value loses the order of its keys.
        let report = message.append(report.to_json().map_err(|e| e.to_string())?.as_bytes());
        message.json = json!({
            "report": report, "command": command, "sections": sections, "pictures": pictures, "strips": strips,
        });
        Ok(message)
    }

    /// Returns an answer with the auxiliary outputs only.
    pub(crate) fn exhibits(self) -> Result<Message, String> {
        let mut message = Message::default();
        let pictures = Self { machine: None, ..self }.pictures("", &mut message)?;
        message.json = json!({ "pictures": pictures });
        Ok(message)
    }

    /// Appends the pictures to a message, and returns their descriptions, which end with `frame`.
    fn pictures(&self, frame: &str, message: &mut Message) -> Result<Vec<Value>, String> {
        let mut list = Vec::new();
        let mut add = |name: &str, about: String, picture: &RgbPicture| {
            let at = message.append(&picture.to_rgba());
            let about = about + frame;
            list.push(json!({ "name": name, "about": about, "at": at, "width": picture.width, "height": picture.height }));
        };
        if let Some(machine) = &self.machine {
            add("image", "the machine's image".into(), machine);
            if let Some(exact) = &self.exact {
                let (difference, largest) = metrics::scaled_difference(exact, machine).map_err(|e| e.to_string())?;
                add("reference", "the reference image".into(), exact);
                add("difference", format!("the difference, white where it is largest: {largest} of 255 steps"), &difference);
            }
        }
        for (info, picture) in &self.exhibits {
            add(info.name, info.about.into(), picture);
        }
        Ok(list)
    }
}

/// Packs the time line. Each column of a unit holds the shares of four states, where 255 is the whole column.
fn pack_timeline(strips: &UtilizationTimeline, names: &[String], message: &mut Message) -> Value {
    let width = strips.width();
    let share = |cycles: u64| (cycles.saturating_mul(255) / width) as u8;
    let units: Vec<Value> = strips
        .units()
        .iter()
        .zip(names)
        .map(|(columns, name)| {
            let bytes: Vec<u8> = columns.iter().flatten().map(|cycles| share(*cycles)).collect();
            json!({ "name": name, "at": message.append(&bytes) })
        })
        .collect();
    json!({ "width": width, "units": units })
}
