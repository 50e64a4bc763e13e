//! Tests of the reader: encodings, tolerance, rejections, and arbitrary bytes.

use std::fs;
use std::path::Path;

use proptest::prelude::*;

use super::*;
use crate::description::check::check;
use crate::description::write::write;
use crate::description::{Kind, NamingConvention};

const GOOD: &str = include_str!("../../../corpus/description/tank.xml");

/// Test target for arbitrary bytes: nothing panics, and a description that was read is equal after writing and reading.
fn survives(bytes: &[u8]) -> Result<(), TestCaseError> {
    let Ok((model, _)) = read(bytes) else { return Ok(()) };
    let _ = check(&model);
    let (again, _) = read(write(&model).as_bytes()).map_err(|finding| TestCaseError::fail(finding.to_string()))?;
    // Compared as text, since NaN does not equal itself.
    let bare = |model| format!("{:?}", crate::description::write::tests::without_positions(model));
    prop_assert_eq!(bare(model), bare(again));
    Ok(())
}

/// A summary of the description or the reason why it cannot be read, then each finding.
fn outcome(bytes: &[u8]) -> String {
    match read(bytes) {
        Err(finding) => format!("refused\n  {finding}\n"),
        Ok((model, mut findings)) => {
            findings.extend(check(&model));
            let description = model.description.map_or(String::new(), |text| format!(", \"{text}\""));
            let head = format!("{}{description}, {} variables\n", model.model_name, model.variables.len());
            findings.iter().fold(head, |shown, finding| format!("{shown}  {finding}\n"))
        }
    }
}

#[test]
fn every_file_of_the_corpus_reads_as_before() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus/description");
    let mut files: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    let mut shown = String::new();
    for file in files {
        let bytes = fs::read(&file).unwrap();
        survives(&bytes).unwrap();
        shown += &format!("{}: {}", file.file_name().unwrap().display(), outcome(&bytes));
    }
    insta::assert_snapshot!(shown);
}

#[test]
fn a_valid_description_is_read_completely() {
    let (model, findings) = read(GOOD.as_bytes()).unwrap();
    assert_eq!(findings, []);
    assert_eq!(model.variable_naming_convention, NamingConvention::Structured);
    let level = &model.variables[model.variable("level").unwrap()];
    assert_eq!((level.position.line, level.position.column), (61, 5));
    let Kind::Real(rate) = &model.variables[7].kind else { panic!("der(level) is a Real") };
    assert_eq!(rate.derivative, model.variable("level"));
    let height = &model.variables[model.variable("height").unwrap()];
    assert_eq!(model.unit_of(height), Some("m"));
    assert_eq!(model.items_of(&model.variables[2])[1].name, "on");
    assert_eq!(model.unit("degC").unwrap().base, crate::units::parse("degC").ok());
    assert_eq!(model.structure.outputs[2].dependencies, None);
    assert_eq!(model.structure.outputs[3].dependencies, Some(vec![]));
    assert_eq!(model.structure.outputs[1].dependencies, Some(vec![1, 6]));
}

#[test]
fn any_usual_encoding_is_read() {
    let file = |encoding: &str| {
        format!(
            "<?xml version = '1.0' encoding = '{encoding}'?>\n<fmiModelDescription fmiVersion='2.0' modelName='Höhe €'/>"
        )
    };
    let name = |bytes: &[u8]| read(bytes).map(|(model, _)| model.model_name);
    let latin = |encoding| -> Vec<u8> {
        let byte = |letter: char| if letter == '€' { 0x80 } else { u8::try_from(u32::from(letter)).unwrap() };
        file(encoding).chars().map(byte).collect()
    };
    let wide = |mark: [u8; 2], bytes: fn(u16) -> [u8; 2]| -> Vec<u8> {
        mark.into_iter().chain(file("UTF-16").encode_utf16().flat_map(bytes)).collect()
    };
    let expected = Ok("Höhe €".to_owned());
    assert_eq!(name(file("UTF-8").as_bytes()), expected);
    assert_eq!(name(format!("\u{FEFF}{}", file("utf-8")).as_bytes()), expected);
    assert_eq!(name(&latin("ISO-8859-1")), expected);
    assert_eq!(name(&latin("windows-1252")), expected);
    assert_eq!(name(&wide([0xFF, 0xFE], u16::to_le_bytes)), expected);
    assert_eq!(name(&wide([0xFE, 0xFF], u16::to_be_bytes)), expected);
}

#[test]
fn bytes_that_are_not_the_declared_encoding_are_a_finding_at_their_position() {
    let bytes = b"<?xml version='1.0' encoding='UTF-8'?>\n<fmiModelDescription modelName='H\xF6he' fmiVersion='2.0'/>";
    let (model, findings) = read(bytes).unwrap();
    assert_eq!(model.model_name, "Höhe");
    let expected =
        "2:34: error[XML]: byte 0xf6 is not UTF-8, the file's encoding; it is read as windows-1252 from the start";
    assert_eq!(findings[0].to_string(), expected);
}

#[test]
fn what_cannot_be_read_is_refused_with_a_reason() {
    let mut shown = String::new();
    let files: [&[u8]; 12] = [
        b"",
        b"PK\x03\x04",
        b"\xFF\xFE<",
        b"<?xml version='1.0' encoding='EBCDIC'?><fmiModelDescription/>",
        b"<!DOCTYPE x [<!ENTITY a 'b'>]><fmiModelDescription/>",
        b"<fmiModelDescription modelName='&secret;'/>",
        b"<fmiModelDescription><A></fmiModelDescription>",
        b"<fmiModelDescription guid='1' guid='2'/>",
        b"<fmiModelDescription fmiVersion='2.0'",
        b"<fmiBuildDescription fmiVersion='3.0'/>",
        b"<fmiModelDescription fmiVersion='1.0'/>",
        b"<fmiModelDescription fmiVersion='3.0'/>",
    ];
    for bytes in files {
        shown += &format!("{}: {}", String::from_utf8_lossy(bytes).escape_debug(), outcome(bytes));
    }
    insta::assert_snapshot!(shown);
}

#[test]
fn attributes_and_namespaces_of_tools_are_accepted() {
    let xml = GOOD.replace(
        "guid=",
        "xmlns:xsi='http://www.w3.org/2001/XMLSchema-instance' xsi:noNamespaceSchemaLocation='x.xsd' xmlns:t='urn:tool' t:x='1' guid =",
    );
    assert_ne!(xml, GOOD);
    assert_eq!(outcome(xml.as_bytes()), "Tank, 15 variables\n");
    let annotated = GOOD
        .replace("</Boolean>", "")
        .replace("<Boolean/>", "<Boolean/><Annotations><Tool name='t'><x/></Tool></Annotations>");
    assert_eq!(outcome(annotated.as_bytes()), "Tank, 15 variables\n");
}

#[test]
fn too_large_a_file_is_refused_before_it_is_parsed() {
    let refused = read(&vec![b' '; MAX_BYTES + 1]).unwrap_err();
    assert_eq!(refused.to_string(), "error[XML]: the file has 67108865 bytes; at most 67108864 are read");
}

#[test]
fn elements_may_be_nested_to_any_depth() {
    let deep = "<a>".repeat(200_000) + &"</a>".repeat(200_000);
    let xml = GOOD.replace("<Tool name=\"Lockstep\"/>", &format!("<Tool name=\"Lockstep\">{deep}</Tool>"));
    assert_eq!(outcome(xml.as_bytes()), "Tank, 15 variables\n");
}

#[test]
fn the_number_of_findings_of_a_file_is_limited() {
    let wrong = "<Extra/>".repeat(5000);
    let (_, findings) = read(GOOD.replace("<ModelVariables>", &format!("{wrong}<ModelVariables>")).as_bytes()).unwrap();
    assert_eq!(findings.len(), 1001);
    assert!(findings[1000].message.contains("left out"), "{}", findings[1000]);
}

/// One change to a text: `cut` bytes from `at` (in thousandths of its length) on are replaced by `with`.
fn change() -> impl Strategy<Value = (usize, usize, Vec<u8>)> {
    let words = prop::sample::select(vec![
        "",
        " ",
        "\"",
        "<",
        ">",
        "/>",
        "&#0;",
        "&amp;",
        "=",
        "-",
        "0",
        "4294967296",
        "1e999",
        "NaN",
        "<Real/>",
        "</Real>",
        "<!DOCTYPE a>",
        "<!--",
        "<![CDATA[",
        "index=\"0\"",
        "index=\"4294967295\"",
        "derivative=\"1\"",
        "\u{FEFF}",
        "ö",
    ]);
    let with = prop_oneof![words.prop_map(|word| word.as_bytes().to_vec()), prop::collection::vec(any::<u8>(), 0..4)];
    (0..1000_usize, 0..40_usize, with)
}

proptest! {
    #[test]
    fn no_change_to_a_valid_file_causes_a_panic(changes in prop::collection::vec(change(), 1..6)) {
        let mut bytes = GOOD.as_bytes().to_vec();
        for (at, cut, with) in changes {
            let from = bytes.len() * at / 1000;
            let to = bytes.len().min(from + cut);
            bytes.splice(from..to, with);
        }
        survives(&bytes)?;
    }

    #[test]
    fn attributes_may_hold_any_value(value in "\\PC{0,8}|-?[0-9]{1,12}(\\.[0-9]{0,4})?(e-?[0-9]{1,4})?", place in 0..200_usize) {
        let value = value.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;");
        let mut parts: Vec<&str> = GOOD.split('"').collect();
        let attributes = parts.len() / 2;
        let index = 2 * (place % attributes) + 1;
        parts[index] = &value;
        survives(parts.join("\"").as_bytes())?;
    }

    #[test]
    fn any_bytes_are_read_or_rejected(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        survives(&bytes)?;
    }
}
