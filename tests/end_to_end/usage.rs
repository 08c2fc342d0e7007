//! Help texts and the messages of common mistakes, compared with reviewed copies.
//!
//! `TRYCMD=overwrite cargo test -p basrelief-cli --test end_to_end usage` writes the program's current output. Review the
//! difference.

use crate::support::{PROGRAM, Place, workspace};

#[test]
fn help_and_messages_are_as_reviewed() {
    trycmd::TestCases::new()
        .register_bin("basrelief", std::path::Path::new(PROGRAM))
        .env("COLUMNS", "100")
        .case(workspace().join("tests/usage/*.trycmd"))
        .case(workspace().join("crates/cli/README.md"));
}

const COMMANDS: [&str; 7] = ["demo", "run", "resimulate", "size-fifos", "sweep", "compare", "completions"];

#[test]
fn completions_and_manual_name_commands_and_options() {
    let place = Place::new();
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = place.ok(&format!("completions {shell}")).out;
        for name in COMMANDS.iter().chain(&["memory-limit", "no-pictures"]) {
            assert!(script.contains(name), "{shell}: {name}");
        }
    }
    let manual = place.ok("man").out;
    assert!(
        manual.contains(".TH basrelief 1") && COMMANDS.iter().all(|name| manual.contains(&name.replace('-', "\\-"))),
        "{manual}"
    );
    let of_run = place.ok("man run").out;
    assert!(of_run.contains(".TH basrelief-run 1") && of_run.contains("\\-\\-max\\-cycles"), "{of_run}");
    assert!(place.run("man runs").error(2).contains("`runs` is no command; expected one of demo, run,"));
}

#[test]
fn bash_completes_an_option() {
    let place = Place::new();
    let script = place.ok("completions bash").out;
    let typed =
        r#"COMP_WORDS=(basrelief sweep --no-pic); COMP_CWORD=2; _basrelief basrelief --no-pic sweep; echo "${COMPREPLY[@]}""#;
    std::fs::write(place.path("typed.sh"), format!("{script}\n{typed}\n")).unwrap();
    let completed = std::process::Command::new("bash").arg(place.path("typed.sh")).output().unwrap();
    assert_eq!(String::from_utf8(completed.stdout).unwrap().trim(), "--no-pictures");
}

#[test]
fn colours_follow_option_and_environment() {
    let place = Place::new();
    let coloured = |line: &str, no_color: &str| {
        let mut command =
            place.command(&format!("{line} demo golf-ball --size 32x24 --no-exact --no-bottlenecks --tables units"));
        let output = command.env("NO_COLOR", no_color).output().unwrap();
        assert!(output.status.success());
        String::from_utf8(output.stdout).unwrap().contains("\u{1b}[1m")
    };
    assert!(coloured("--color always", "") && coloured("--color always", "1"));
    assert!(!coloured("--color auto", "") && !coloured("--color never", "") && !coloured("", ""));
    let refused = |line: &str| place.run(&format!("{line} run")).err;
    assert!(refused("--color always").contains('\u{1b}') && !refused("--color never").contains('\u{1b}'));
}
