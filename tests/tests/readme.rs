//! The README is correct: its first steps work outside the repository, its script is one of `scenarios/`, and its
//! commands exist. The page about the language is correct: its scripts run and print what stands below them, and its
//! fragments have no mistakes.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use tests::program::{Said, lockstep, repository, run, unit_builds};

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
    shell.env("XDG_CACHE_HOME", unit_builds());
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
    assert_eq!(folder, home.path().join("my_units"));
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
fn what_the_comparison_with_other_tools_names_as_shown_exists() {
    let page = fs::read_to_string(repository().join("docs/compare.md")).unwrap();
    let shown = page.split_once("\n## What shows the statements").unwrap().1.split("\n## ").next().unwrap();
    let quoted: Vec<_> = shown.split('`').skip(1).step_by(2).map(|text| text.replace('\n', "")).collect();
    let files: Vec<_> = quoted.iter().filter(|text| text.ends_with(".rs") || text.ends_with(".py")).collect();
    let texts: Vec<_> =
        files.iter().map(|file| fs::read_to_string(repository().join(file)).unwrap_or_default()).collect();
    assert!(files.len() > 15 && texts.iter().all(|text| !text.is_empty()), "{files:?}");
    let is_function = |text: &&String| text.chars().all(|letter| letter == '_' || letter.is_ascii_alphanumeric());
    for function in quoted.iter().filter(is_function) {
        let defined = [format!("fn {function}("), format!("def {function}(")];
        let found = texts.iter().any(|text| defined.iter().any(|definition| text.contains(definition)));
        assert!(found, "`{function}` is in none of {files:?}");
    }
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

/// A fenced block of the page about the language.
struct Fenced {
    language: String,
    text: String,
    /// The text between it and the block before it.
    above: String,
}

impl Fenced {
    /// The name of the file that the block shows, if the line above ends with it.
    fn file(&self) -> Option<&str> {
        self.above.trim_end().strip_suffix("`:")?.rsplit('`').next().filter(|name| name.contains('.'))
    }
}

fn blocks_about_the_language() -> Vec<Fenced> {
    let page = fs::read_to_string(repository().join("docs/language.md")).unwrap();
    let parts: Vec<_> = page.split("```").collect();
    let block = |pair: &[&str]| {
        let (language, text) = pair[1].split_once('\n').unwrap();
        Fenced { language: language.to_owned(), text: text.to_owned(), above: pair[0].to_owned() }
    };
    parts.chunks_exact(2).map(block).collect()
}

/// Writes the files that the page shows, and a script beside them.
fn beside_the_files(blocks: &[Fenced], folder: &Path, script: &str) -> String {
    for block in blocks {
        if let Some(name) = block.file() {
            fs::write(folder.join(name), &block.text).unwrap();
        }
    }
    let path = folder.join("x.scn");
    fs::write(&path, script).unwrap();
    path.display().to_string()
}

#[test]
fn each_script_about_the_language_has_no_mistake_and_prints_the_verdicts_below_it() {
    let blocks = blocks_about_the_language();
    let folder = tempfile::tempdir().unwrap();
    let [in_folder, out] = ["", "out"].map(|name| folder.path().join(name).display().to_string());
    let mut verdicts = 0;
    for (at, block) in blocks.iter().enumerate().filter(|(_, block)| block.language == "scn") {
        let script = beside_the_files(&blocks, folder.path(), &block.text);
        let checked = run(&repository(), &["check", &script]);
        assert_eq!(checked.code, Some(0), "{}\n{}", block.text, checked.err);
        let said = run(&repository(), &["run", &script, "--out", &out]);
        let below = blocks.get(at + 1).filter(|below| below.language == "text" && below.file().is_none());
        let below = below.map_or("", |below| below.text.as_str());
        assert_eq!(said.code, Some(u8::from(below.contains("FAILED")).into()), "{}\n{}", block.text, said.err);
        let printed = said.out.replace(&in_folder, "");
        let missing = below.lines().find(|line| !printed.lines().any(|printed| printed == *line));
        assert_eq!(missing, None, "{printed}");
        verdicts += below.lines().count();
    }
    assert!(verdicts > 7, "{verdicts} lines of verdicts were compared");
}

#[test]
fn each_fragment_about_the_language_has_no_mistake_below_the_lines_that_the_page_names() {
    let blocks = blocks_about_the_language();
    let folder = tempfile::tempdir().unwrap();
    let lines = blocks.iter().find(|block| block.text.starts_with("scenario \"Fragments\"")).unwrap();
    let fragments: Vec<_> = blocks.iter().filter(|block| block.language == "scn-fragment").collect();
    assert!(fragments.len() > 7, "{} fragments", fragments.len());
    for fragment in fragments {
        let script = beside_the_files(&blocks, folder.path(), &format!("{}{}", lines.text, fragment.text));
        let checked = run(&repository(), &["check", &script]);
        assert_eq!(checked.code, Some(0), "{}\n{}", fragment.text, checked.err);
    }
}

#[test]
fn each_link_of_the_page_about_the_language_leads_somewhere() {
    let page = fs::read_to_string(repository().join("docs/language.md")).unwrap();
    let headings = page.lines().filter_map(|line| line.strip_prefix("## "));
    let anchors: Vec<_> = headings.map(|heading| heading.to_lowercase().replace(' ', "-")).collect();
    for link in page.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
        let leads_somewhere = match link.strip_prefix('#') {
            Some(anchor) => anchors.iter().any(|known| known == anchor),
            None => repository().join("docs").join(link).is_file(),
        };
        assert!(leads_somewhere, "{link}");
    }
}
