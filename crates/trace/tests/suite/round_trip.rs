//! Reading, writing and converting between forms loses nothing.

use crate::common::*;
use basrelief_input::MemoryPool;
use basrelief_signals::{Control, Frame, ObjectInfo, ShadingMode, ShadingSettings, Texture};
use basrelief_trace::*;
use proptest::prelude::*;
use std::sync::Arc;

/// Returns true if both are equal to the bit. Unlike with `==`, -0 differs from 0.
fn same(a: &impl std::fmt::Debug, b: &impl std::fmt::Debug) -> bool {
    format!("{a:?}") == format!("{b:?}")
}

fn commands(bytes: &[u8]) -> Vec<TraceCommand> {
    open(bytes, &MemoryPool::default()).unwrap().collect::<Result<_, _>>().unwrap()
}

fn converted(bytes: &[u8], form: TraceForm) -> Vec<u8> {
    let mut out = Vec::new();
    convert(bytes, &mut out, form, &MemoryPool::default()).unwrap();
    out
}

/// Returns a line of a trace as it counts for the hash of the input.
fn without_texels(line: &str) -> String {
    let (head, data) = match line.split_once(r#","data":""#) {
        Some((head, data)) if line.starts_with(r#"{"texture""#) => (head, data),
        _ => return line.into(),
    };
    let (_, tail) = data.split_once('"').unwrap();
    format!("{head}{tail}")
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn recording_resolves_to_equal_controls(controls in controls(), form in 0..4usize) {
        let resolved = resolve(&record(&controls, TraceForm::ALL[form]).unwrap()).unwrap();
        prop_assert!(same(&resolved, &controls));
    }

    #[test]
    fn conversion_between_all_forms_is_lossless(controls in controls(), from in 0..4usize, to in 0..4usize) {
        let original = record(&controls, TraceForm::ALL[from]).unwrap();
        let there = converted(&original, TraceForm::ALL[to]);
        prop_assert!(same(&commands(&there), &commands(&original)));
        prop_assert_eq!(converted(&there, TraceForm::ALL[from]), original);
    }

    #[test]
    fn recorded_trace_has_hash_of_its_input(controls in controls(), form in 0..4usize) {
        let replayed = resolve(&record(&controls, TraceForm::ALL[form]).unwrap()).unwrap();
        prop_assert_eq!(hash(&replayed), hash(&controls));
        let text = String::from_utf8(record(&controls, TraceForm::default()).unwrap()).unwrap();
        let kept = text.split_inclusive('\n').filter(|line| !line.starts_with(r#"{"end""#)).map(without_texels);
        prop_assert_eq!(Digest::of(kept.collect::<String>().as_bytes()), hash(&controls));
    }

    #[test]
    fn settings_survive_both_encodings(value in setting()) {
        let mut expectation = ExpectedResults::default();
        expectation.config.insert("replacement.entries".into(), value);
        for form in TraceForm::ALL {
            let mut recorder = TraceRecorder::new(Vec::new(), form, BeginCommand::new(8, 8)).unwrap();
            for control in resolve(SAMPLE.as_bytes()).unwrap() {
                recorder.record(&control).unwrap();
            }
            let bytes = recorder.finish(vec![expectation.clone()]).unwrap();
            let mut resolver = TraceResolver::new(bytes.as_slice(), NoFiles, &MemoryPool::default()).unwrap();
            prop_assert!(resolver.by_ref().all(|item| item.is_ok()));
            let [placed] = resolver.expectations() else { panic!("one expectation") };
            prop_assert!(same(&placed.results, &expectation));
        }
    }
}

/// Sets the textures that the first frame declares.
fn declaring(mut controls: Vec<Control>, textures: Vec<Arc<Texture>>) -> Vec<Control> {
    let Some(Control::Frame(frame)) = controls.first_mut() else { panic!("a list begins with a frame") };
    *frame = Arc::new(Frame { textures, ..Frame::clone(frame) });
    controls
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn declared_textures_are_recorded_without_a_use(
        controls in controls(), a in texture(90, false), b in texture(70, false), form in 0..4usize,
    ) {
        let controls = declaring(controls, vec![a, b]);
        let trace = record(&controls, TraceForm::ALL[form]).unwrap();
        let resolved = resolve(&trace).unwrap();
        prop_assert!(same(&resolved, &controls));
        prop_assert_eq!(hash(&resolved), hash(&controls));
        let commands = commands(&trace);
        let names: Vec<&str> = commands.iter().map(TraceCommand::name).filter(|name| *name != "shading").take(4).collect();
        prop_assert_eq!(names, ["begin", "texture", "texture", "frame"]);
    }
}

#[test]
fn shading_settings_survive_every_form() {
    let plain = resolve(SAMPLE.replacen(r#""width":8,"height":8"#, r#""width":64,"height":48"#, 1).as_bytes()).unwrap();
    let said = ShadingSettings { mode: Some(ShadingMode::Brightness), ia: Some(0.5), is: Some(-0.0) };
    let shaded: Vec<Control> = plain
        .iter()
        .map(|control| match control {
            Control::Frame(frame) => Control::Frame(Arc::new(Frame { shading: said, ..Frame::clone(frame) })),
            Control::Object(object) => {
                let shading = ShadingSettings { mode: Some(ShadingMode::Polyhedron), ..ShadingSettings::default() };
                Control::Object(Arc::new(ObjectInfo { shading, ..ObjectInfo::clone(object) }))
            }
            other => other.clone(),
        })
        .collect();
    for form in TraceForm::ALL {
        assert!(same(&resolve(&record(&shaded, form).unwrap()).unwrap(), &shaded));
        let names = |controls: &[Control]| -> Vec<&str> {
            commands(&record(controls, form).unwrap()).iter().map(TraceCommand::name).filter(|name| *name == "shading").collect()
        };
        assert_eq!((names(&plain).len(), names(&shaded).len()), (0, 2));
    }
    assert_ne!(hash(&plain), hash(&shaded));
    let text = String::from_utf8(record(&shaded, TraceForm::default()).unwrap()).unwrap();
    assert!(text.contains(r#"{"shading":{"mode":"brightness","ia":0.5,"is":-0.0}}"#), "{text}");
    assert!(text.contains(r#"{"shading":{"mode":"polyhedron"}}"#), "{text}");
}

#[test]
fn textures_defined_inside_a_frame_are_declared_with_none() {
    let texture = |id| {
        format!(
            r#"{{"texture":{{"id":{id},"name":"t","kind":"color","sampler":{{"wrap":["repeat","repeat"],"filter":"nearest"}},"width":1,"height":1,"levels":1,"offset":0,"sha256":"{}","data":"AAAAAA=="}}}}"#,
            Digest::of(&[0; 4])
        )
    };
    let frame = |index| {
        format!(
            r#"{{"frame":{{"index":{index},"camera":{{"view_projection":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1],"to_light":[0,0,1],"to_viewer":[0,0,1]}},"lights":[{{"directional":{{"to_light":[0,0,1],"intensity":1}}}}]}}}}"#
        )
    };
    let end = r#"{"frame_end":{}}"#.to_owned();
    let begin = r#"{"begin":{"format":"basrelief-display-list","version":1,"width":4,"height":4,"generator":"by hand"}}"#;
    let list = [
        begin.into(),
        texture(3),
        frame(0),
        texture(5),
        end.clone(),
        texture(4),
        frame(1),
        end,
        r#"{"end":{"commands":8}}"#.into(),
    ];
    let resolved = resolve((list.join("\n") + "\n").as_bytes()).unwrap();
    let declared = |control: &Control| match control {
        Control::Frame(frame) => Some(frame.textures.iter().map(|t| t.id).collect::<Vec<_>>()),
        _ => None,
    };
    assert_eq!(resolved.iter().filter_map(declared).collect::<Vec<_>>(), [[3], [4]]);
}

fn setting() -> impl Strategy<Value = ParameterValue> {
    let scalar = prop_oneof![
        any::<bool>().prop_map(ScalarValue::Bool),
        any::<i64>().prop_map(ScalarValue::Integer),
        any::<f64>().prop_filter("finite", |x| x.is_finite()).prop_map(ScalarValue::Number),
        any::<String>().prop_map(ScalarValue::Text),
    ];
    prop_oneof![
        scalar.clone().prop_map(ParameterValue::One),
        proptest::collection::vec(scalar, 0..4).prop_map(ParameterValue::List)
    ]
}

#[test]
fn canonical_sample_survives_every_form() {
    for form in TraceForm::ALL {
        let bytes = sample_as(form);
        assert_eq!(String::from_utf8(converted(&bytes, TraceForm::default())).unwrap(), SAMPLE);
        assert_eq!(commands(&bytes), commands(SAMPLE.as_bytes()));
    }
}

#[test]
fn first_bytes_identify_the_form() {
    let heads = TraceForm::ALL.map(|form| sample_as(form)[..4].to_vec());
    assert_eq!(heads, [b"{\"be".to_vec(), vec![0x28, 0xb5, 0x2f, 0xfd], b"\x89BDL".to_vec(), vec![0x28, 0xb5, 0x2f, 0xfd]]);
}

#[test]
fn expectations_are_there_after_the_end() {
    let mut resolver = TraceResolver::new(SAMPLE.as_bytes(), NoFiles, &MemoryPool::default()).unwrap();
    assert_eq!((resolver.begin().width, resolver.begin().height), (8, 8));
    assert!(resolver.by_ref().all(|item| item.is_ok()));
    let [placed] = resolver.expectations() else { panic!("one expectation") };
    assert_eq!(placed.place.to_string(), format!("line {}", SAMPLE.lines().count() - 1));
    let expectation = &placed.results;
    assert_eq!(expectation.cycles, Some(100));
    assert_eq!(expectation.config["replacement.entries"].to_string(), "[256, 128]");
    assert_eq!(expectation.memories["graphics"]["z"].write_bytes, 64);
}

#[test]
fn texels_may_lie_in_a_file_beside_the_trace() {
    let mut inline = commands(SAMPLE.as_bytes());
    let mut taken = Vec::new();
    for command in &mut inline {
        if let TraceCommand::Texture(texture) = command {
            texture.file = Some(format!("texels/{}.raw", texture.id));
            taken.push(texture.data.take().unwrap().0);
        }
    }
    let mut writer = TraceWriter::new(Vec::new(), TraceForm::default()).unwrap();
    inline.iter().for_each(|command| writer.write(command).unwrap());
    let beside = writer.finish().unwrap();
    let files = |cut: usize| {
        let taken = taken.clone();
        move |name: &str| -> std::io::Result<Box<dyn std::io::Read>> {
            let i = ["texels/0.raw", "texels/1.raw"].iter().position(|known| *known == name).unwrap();
            Ok(Box::new(std::io::Cursor::new(taken[i][cut..].to_vec())))
        }
    };
    let controls: Result<Vec<_>, _> =
        TraceResolver::new(beside.as_slice(), files(0), &MemoryPool::default()).unwrap().map(|i| i.map(|i| i.0)).collect();
    assert_eq!(controls.unwrap(), resolve(SAMPLE.as_bytes()).unwrap());
    let short = TraceResolver::new(beside.as_slice(), files(1), &MemoryPool::default()).unwrap().find_map(Result::err).unwrap();
    assert!(short.to_string().contains("texture.file: holds 15 bytes, expected 16"), "{short}");
    let none = TraceResolver::new(beside.as_slice(), NoFiles, &MemoryPool::default()).unwrap().find_map(Result::err).unwrap();
    assert_eq!((none.kind, none.path.as_str()), (ErrorKind::Io, "texture.file"));
    let moved = |cut: usize| {
        let (mut out, form) = (Vec::new(), TraceForm::default());
        convert_with_texels(beside.as_slice(), &mut out, form, &MemoryPool::default(), files(cut)).map(|_| out)
    };
    assert_eq!(moved(0).unwrap(), converted(SAMPLE.as_bytes(), TraceForm::default()));
    assert_eq!(moved(1).unwrap_err().to_string(), short.to_string());
}

/// Returns a binary trace in the older form without meshes: the record of each object lacks its last byte.
fn without_meshes(trace: &[u8]) -> Vec<u8> {
    let (mut out, mut rest) = (trace[..12].to_vec(), &trace[12..]);
    while let Some((length, after)) = rest.split_first_chunk() {
        let (record, next) = after.split_at(u32::from_le_bytes(*length) as usize);
        let is_object = TraceCommand::NAMES[usize::from(record[0])] == "object";
        let kept = &record[..record.len() - usize::from(is_object)];
        assert!(!is_object || record.ends_with(&[0]), "no mesh");
        out.extend((kept.len() as u32).to_le_bytes());
        out.extend(kept);
        rest = next;
    }
    out
}

#[test]
fn object_record_without_mesh_sizes_is_read() {
    let trace = sample_as(TraceForm { encoding: TraceEncoding::Binary, compressed: false });
    let older = without_meshes(&trace);
    assert!(older.len() < trace.len());
    assert!(same(&commands(&older), &commands(&trace)));
}
