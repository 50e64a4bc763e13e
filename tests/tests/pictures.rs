//! Pictures of real runs: what `lockstep plot` draws of flights, and that the README's picture is what its command draws.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::fs;
use std::path::Path;
use tempfile::TempDir;
use tests::program::{Said, repository, run};

/// A hover: the vehicle starts in the air and stays there.
const HOVER: &str = "scenario \"A quadcopter hovers\"\nstep 5 ms\nstop 5 s\n\
    fmu ctrl = \"quadcopter_controller\" { effectiveness = [1, 1, 1, 1], wind_speed = 0 m/s }\n\
    fmu quad = \"quadcopter\" { position0 = [0 m, 0 m, 10 m], airborne = true, effectiveness = [1, 1, 1, 1] }\n\
    quad.state -> ctrl.state\nquad.contact -> ctrl.contact\n10 m -> ctrl.setpoint.position.z\n\
    ctrl.rotor_speed => quad.rotor_speed\nat 2 s lasting 500 ms { fault ctrl.state.position: freeze }\n\
    assert stays: always abs(quad.state.position.z - 10 m) < 5 cm\nrecord quad.state, quad.roll, quad.pitch, quad.contact\n";

/// Runs a script of the repository, or one that is written for the test, into a folder.
fn fly(home: &TempDir, script: &str, name: &str, options: &[&str]) -> Said {
    let out = home.path().join(name).display().to_string();
    run(&repository(), &[&["run", script, "--out", &out], options].concat())
}

/// Draws runs of the folder; returns the texts of the picture.
fn drawn(home: &TempDir, arguments: &[&str]) -> Vec<String> {
    let said = run(home.path(), &[&["plot"], arguments, &["--out", "drawn.svg", "--png"]].concat());
    assert_eq!((said.code, said.out.as_str()), (Some(0), "drawn.svg\ndrawn.png\n"), "{}", said.err);
    let png = fs::read(home.path().join("drawn.png")).unwrap();
    assert!(png.starts_with(b"\x89PNG") && png.len() > 20_000, "{} bytes", png.len());
    texts(&fs::read_to_string(home.path().join("drawn.svg")).unwrap())
}

/// The texts of a picture, which has shapes and texts only.
fn texts(svg: &str) -> Vec<String> {
    let document = roxmltree::Document::parse(svg).unwrap();
    let elements: Vec<_> = document.descendants().filter(roxmltree::Node::is_element).collect();
    let known = ["svg", "title", "rect", "path", "polygon", "circle", "text"];
    assert!(elements.iter().all(|element| known.contains(&element.tag_name().name())), "shapes and texts only");
    elements.iter().filter(|it| it.tag_name().name() == "text").filter_map(|it| it.text()).map(str::to_owned).collect()
}

fn has(texts: &[String], start: &str) -> bool {
    texts.iter().any(|text| text.starts_with(start))
}

#[test]
fn the_picture_of_the_readme_is_what_its_command_draws() {
    let home = tempfile::tempdir().unwrap();
    assert_eq!(fly(&home, "scenarios/first_flight.scn", "first_flight", &[]).code, Some(0));
    let readme = fs::read_to_string(repository().join("README.md")).unwrap();
    let (_, command) = readme.split_once("-- plot runs/first_flight ").unwrap();
    let (command, _) = command.split_once(" --out docs/first_flight.svg").unwrap();
    let words: Vec<_> = command.split_whitespace().filter(|word| *word != "\\").collect();
    let said = run(home.path(), &[&["plot", "first_flight"], &words[..], &["--out", "drawn.svg"]].concat());
    assert_eq!(said.code, Some(0), "{}", said.err);
    let [kept, drawn] = [repository().join("docs/first_flight.svg"), home.path().join("drawn.svg")]
        .map(|path| fs::read_to_string(path).unwrap());
    assert!(kept == drawn, "docs/first_flight.svg is not what its command draws; draw it anew");
}

#[test]
fn a_flight_has_a_path_to_scale_limits_and_the_worst_samples() {
    let home = tempfile::tempdir().unwrap();
    assert_eq!(fly(&home, "scenarios/first_flight.scn", "first_flight", &[]).code, Some(0));
    let texts = drawn(&home, &["first_flight", "--mark", "path.leg"]);
    for text in ["A quadcopter flies A to H", "3 of 3 claims hold", "x [m]", "y [m]", "z [m]", "A", "H", "[deg]"] {
        assert!(has(&texts, text), "{text} is not in {texts:?}");
    }
    for text in ["dist(quad.state.position, path.setpoint.position) < 0.8 m", "tracks: below 0.8", "tilts: within ±25"]
    {
        assert!(has(&texts, text), "{text} is not in {texts:?}");
    }
    assert!(has(&texts, "worst") && has(&texts, "best 0 at") && !has(&texts, "fails first"), "{texts:?}");
}

#[test]
fn a_storm_shows_what_failed_first_and_worst_and_lies_over_the_calm_flight() {
    let home = tempfile::tempdir().unwrap();
    let storm = ["--set", "mean = 25 m/s"];
    assert_eq!(fly(&home, "scenarios/first_flight.scn", "storm", &storm).code, Some(1));
    let texts = drawn(&home, &["storm"]);
    for text in ["mean = 25 m/s", "1 of 3 claims hold, failed: tracks, tilts", "fails first at 0.39 s", "worst"] {
        assert!(has(&texts, text), "{text} is not in {texts:?}");
    }
    assert_eq!(fly(&home, "scenarios/first_flight.scn", "calm", &[]).code, Some(0));
    let texts = drawn(&home, &["calm", "storm", "tracks", "--from", "2s", "--to", "20s"]);
    for text in ["thin: calm", "broad: storm (mean = 25 m/s)", "2 s to 20 s", "tracks: below 0.8"] {
        assert!(has(&texts, text), "{text} is not in {texts:?}");
    }
}

#[test]
fn a_hover_is_a_point_on_a_ground_with_numbers_and_a_fault_is_a_band() {
    let home = tempfile::tempdir().unwrap();
    let script = home.path().join("hover.scn");
    fs::write(&script, HOVER).unwrap();
    assert_eq!(fly(&home, &script.display().to_string(), "hover", &[]).code, Some(0));
    let texts = drawn(&home, &["hover"]);
    for text in
        ["A quadcopter hovers", "x [m]", "−0.4", "0.4", "stays: 9.95 to 10.05", "at 2 s: freeze", "9.95", "10.05"]
    {
        assert!(has(&texts, text), "{text} is not in {texts:?}");
    }
}

#[test]
fn what_cannot_be_drawn_is_said_with_what_is_there() {
    let home = tempfile::tempdir().unwrap();
    fs::write(home.path().join("a.csv"), "time,world.x,world.y\n0,1,2\n1,2,3\n").unwrap();
    let refused = |arguments: &[&str]| {
        let said = run(home.path(), &[&["plot", "a.csv"], arguments].concat());
        assert_eq!(said.code, Some(2), "{}", said.out);
        said.err
    };
    assert_eq!(
        refused(&["--circles", "wrld"]),
        "error: no column or group `wrld` was recorded; did you mean `world`?\nhelp: recorded are: time, world.x, world.y\n"
    );
    assert_eq!(
        refused(&["--circles", "world"]),
        "error: cannot draw `world`: it has no x and y in metres; it has world.x, world.y\n"
    );
    assert_eq!(
        refused(&["--from", "5s"]),
        "error: no row of a.csv lies between --from and --to; it has rows from 0 s to 1 s\n"
    );
    assert!(refused(&["--out", "a.pdf"]).ends_with("help: pictures are SVG or PNG: let it end in .svg or .png\n"));
    assert!(refused(&["--mesh", "none.obj"]).starts_with("error: cannot read none.obj: "));
    assert!(!Path::new(&home.path().join("a.svg")).exists(), "no picture is left");
}
