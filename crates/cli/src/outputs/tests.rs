//! Checks of outputs against each other and against inputs.

use super::*;
use std::fs;

#[test]
fn outputs_never_share_a_file() {
    let base = tempfile::tempdir().unwrap();
    let at = |name: &str| base.path().join(name);
    fs::create_dir_all(at("o/in")).unwrap();
    let check = |names: [&str; 2]| {
        let paths = names.map(at);
        check_distinct(&at("o"), &[("--timeline", &paths[0]), ("--dump", &paths[1])])
    };
    for names in [["t", "d"], ["o/t", "o/d.jsonl"], ["report.json", "image.png"], ["o/in/report.json", "o/in/d"]] {
        assert_eq!(check(names), Ok(()), "{names:?}");
    }
    for own in ["o/report.json", "o/./report.csv", "./o/image.png", "o/in/../report.json", "o//tiles.png"] {
        assert!(check([own, "d"]).unwrap_err().starts_with("--timeline: "), "{own}");
        assert!(check(["t", own]).unwrap_err().contains("of this run in --out"), "{own}");
    }
    assert!(check(["o/run.recording", "d"]).is_err());
    assert_eq!(check_distinct(&at("o"), &[("--recording", &at("o/run.recording"))]), Ok(()), "of the same run, however long");
    for twice in [["t", "t"], ["t", "./t"], ["o/x", "o/in/../x"], ["none/x", "none//./x"]] {
        assert!(check(twice).unwrap_err().contains("is also the output of"), "{twice:?}");
    }
}

#[cfg(unix)]
#[test]
fn linked_folder_counts_as_its_target() {
    let base = tempfile::tempdir().unwrap();
    fs::create_dir(base.path().join("o")).unwrap();
    std::os::unix::fs::symlink("o", base.path().join("link")).unwrap();
    let (out, link) = (base.path().join("o"), base.path().join("link"));
    assert!(check_distinct(&out, &[("--timeline", &link.join("report.json"))]).unwrap_err().contains("of this run"));
    assert!(check_distinct(&link, &[("--timeline", &out.join("report.json"))]).unwrap_err().contains("of this run"));
    assert!(check_distinct(&out, &[("--timeline", &link.join("x")), ("--dump", &out.join("x"))]).is_err());
}

#[cfg(unix)]
#[test]
fn linked_file_counts_as_its_target() {
    let base = tempfile::tempdir().unwrap();
    let at = |name: &str| base.path().join(name);
    fs::create_dir(at("o")).unwrap();
    ["o/report.json", "x"].iter().for_each(|name| fs::write(at(name), "").unwrap());
    for (to, name) in [("o/report.json", "to-report"), ("x", "to-x"), ("../x", "o/report.csv")] {
        std::os::unix::fs::symlink(to, at(name)).unwrap();
    }
    let check = |names: [&str; 2]| {
        let paths = names.map(at);
        check_distinct(&at("o"), &[("--timeline", &paths[0]), ("--dump", &paths[1])])
    };
    assert!(check(["to-report", "d"]).unwrap_err().contains("the report.json of this run"));
    assert!(check(["o/report.csv", "d"]).unwrap_err().contains("the report.csv of this run"), "a link that the run replaces");
    assert!(check(["x", "to-x"]).unwrap_err().contains("is also the output of"));
    let read = |input: &str| check_outputs_keep_inputs(None, &[("--timeline", &at("to-x"))], &[("INPUT", &at(input))]);
    assert!(read("x").unwrap_err().contains("is an input (INPUT)") && read("to-x").is_err());
    assert_eq!((read("o/report.json"), read("none")), (Ok(()), Ok(())));
}
