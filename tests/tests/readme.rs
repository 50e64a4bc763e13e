//! The README is correct: its first steps work outside the repository, its script is one of `scenarios/`, and its
//! commands exist.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::fs;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use tests::program::{Said, lockstep, repository, run};

/// The text below a heading, up to the next one.
fn section(heading: &str) -> String {
    let readme = fs::read_to_string(repository().join("README.md")).unwrap();
    let (_, below) = readme.split_once(&format!("\n## {heading}\n")).unwrap_or_else(|| panic!("## {heading}"));
    below.split("\n## ").next().unwrap_or_default().to_owned()
}

/// The first code block in a language below a heading.
fn block(heading: &str, language: &str) -> String {
    let section = section(heading);
    let (_, code) = section.split_once(&format!("```{language}\n")).unwrap_or_else(|| panic!("```{language}"));
    code.split("```").next().unwrap_or_default().to_owned()
}

/// Runs a shell line as a user with `lockstep` installed would.
fn typed(line: &str, folder: &PathBuf) -> Said {
    let path = std::env::var_os("PATH").unwrap_or_default();
    let programs = lockstep().parent().map(PathBuf::from).into_iter().chain(std::env::split_paths(&path));
    let mut shell = Command::new("sh");
    shell.args(["-e", "-c", line]).current_dir(folder).stdin(Stdio::null());
    shell.env("PATH", std::env::join_paths(programs).unwrap()).env_remove("CARGO_TARGET_DIR");
    shell.output().unwrap().into()
}

#[test]
fn the_first_unit_and_script_in_five_minutes_work_outside_the_repository() {
    let home = tempfile::tempdir().unwrap();
    let mut folder = home.path().to_path_buf();
    for line in block("Your first unit and your first script in five minutes", "sh").lines() {
        let line = line.split_once(" # ").map_or(line, |(command, _)| command).trim();
        if let Some(into) = line.strip_prefix("cd ") {
            folder = folder.join(into);
            continue;
        }
        let said = typed(line, &folder);
        assert_eq!(said.code, Some(0), "{line}\n{}{}", said.out, said.err);
    }
    let archive = folder.join("target/fmus/my_lag.fmu");
    assert!(fs::read(&archive).is_ok_and(|bytes| bytes.starts_with(b"PK")), "{}", archive.display());
    assert!(folder.join("runs/my_lag/plot.svg").is_file());
}

#[test]
fn the_readme_is_correct_about_isolated_and_continued_runs() {
    let lines = [block("A process for each instance", "sh"), block("Saving and continuing", "sh")].concat();
    let said: Vec<_> = lines.lines().map(|line| typed(line, &repository())).collect();
    for (line, said) in lines.lines().zip(&said) {
        assert_eq!(said.code, Some(0), "{line}\n{}{}", said.out, said.err);
    }
    let expected = lines.lines().find_map(|line| line.split_once("# ")).unwrap().1;
    assert_eq!(said[2].out.trim(), expected);
    let [whole, continued] = ["first_flight", "continued"]
        .map(|run| fs::read_to_string(repository().join("runs").join(run).join("trace.csv")).unwrap());
    let later = continued.split_once('\n').unwrap().1;
    assert!(later.lines().count() == 8800 && whole.ends_with(later));
}

#[test]
fn no_line_of_the_readme_is_a_placeholder() {
    let readme = fs::read_to_string(repository().join("README.md")).unwrap();
    let is_placeholder = |line: &&str| line.len() > 2 && line.chars().all(|letter| letter.is_ascii_uppercase());
    assert_eq!(readme.lines().filter(is_placeholder).collect::<Vec<_>>(), Vec::<&str>::new());
}

#[test]
fn the_first_script_of_the_readme_is_the_one_that_the_tests_run() {
    let script = fs::read_to_string(repository().join("scenarios/breeze.scn")).unwrap();
    assert_eq!(block("The first script to read", "scn"), script);
}

#[test]
fn every_command_is_in_the_table_and_every_command_of_the_table_exists() {
    let commands = section("Commands");
    let rows = commands.lines().filter_map(|row| row.strip_prefix("| `lockstep ")?.split_once("` |"));
    let rows: Vec<_> = rows.map(|(command, text)| (command.split(' ').next().unwrap_or(command), text)).collect();
    let help = run(&repository(), &["--help"]).out;
    let (_, listed) = help.split_once("\nCommands:\n").unwrap();
    let listed: Vec<_> = listed
        .lines()
        .take_while(|line| !line.is_empty())
        .filter_map(|line| line.strip_prefix("  ").filter(|name| !name.starts_with(' '))?.split(' ').next())
        .filter(|name| *name != "help")
        .collect();
    assert_eq!(rows.iter().map(|(command, _)| *command).collect::<Vec<_>>(), listed);
    for (command, text) in rows {
        let help = run(&repository(), &[command, "--help"]).out;
        for option in text.split('`').filter(|word| word.starts_with("--") && *word != "--help") {
            let option = option.split(' ').next().unwrap_or(option);
            // `--live[=<ENDPOINT>]` is an option whose value is optional.
            let is_listed = [" ", "\n", "["].iter().any(|after| help.contains(&format!("{option}{after}")));
            assert!(is_listed, "{command} {option}");
        }
    }
}
