//! Valid archives, refused archives, and arbitrary bytes.

use super::survey::{MAX_BYTES, MAX_ENTRIES, MAX_RATIO, RATIO_FREE_BYTES};
use super::*;
use std::io::{Cursor, Write};
use std::os::unix::fs::PermissionsExt;
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

const XML: &str = r#"<fmiModelDescription fmiVersion="2.0" modelName="a" guid="b"/>"#;

/// An archive with a description and these files.
fn archive(files: &[(&str, &[u8])]) -> Vec<u8> {
    write(|archive| {
        for (name, contents) in files {
            archive.start_file(*name, SimpleFileOptions::default()).unwrap();
            archive.write_all(contents).unwrap();
        }
    })
}

fn write(more: impl FnOnce(&mut ZipWriter<Cursor<Vec<u8>>>)) -> Vec<u8> {
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    archive.start_file(DESCRIPTION, SimpleFileOptions::default()).unwrap();
    archive.write_all(XML.as_bytes()).unwrap();
    more(&mut archive);
    archive.finish().unwrap().into_inner()
}

/// An archive with a description and one file that is not compressed.
fn stored(name: &str, contents: &[u8]) -> Vec<u8> {
    write(|archive| {
        let stored = SimpleFileOptions::default().compression_method(zip::CompressionMethod::Stored);
        archive.start_file(name, stored).unwrap();
        archive.write_all(contents).unwrap();
    })
}

/// Replaces all occurrences of some bytes by others of the same length.
fn patched(bytes: &[u8], from: &[u8], to: &[u8]) -> Vec<u8> {
    assert_eq!(from.len(), to.len());
    let mut patched = bytes.to_vec();
    let places: Vec<_> = (0..bytes.len()).filter(|&at| bytes[at..].starts_with(from)).collect();
    assert!(!places.is_empty());
    for at in places {
        patched[at..at + to.len()].copy_from_slice(to);
    }
    patched
}

fn refusal(bytes: &[u8]) -> String {
    inspect(bytes).expect_err("the archive is not refused").to_string()
}

#[test]
fn names_that_leave_the_folder_are_refused() {
    let with = |name: &str| refusal(&patched(&archive(&[("xxxxxxxxx", b"")]), b"xxxxxxxxx", name.as_bytes()));
    assert_eq!(with("../../../"), "archive: entry `../../../` leads out of its folder by `..`");
    assert_eq!(with("a/../../b"), "archive: entry `a/../../b` leads out of its folder by `..`");
    assert_eq!(with(r"a\..\..\b"), r"archive: entry `a\\..\\..\\b` leads out of its folder by `..`");
    assert_eq!(with("/etc/hook"), "archive: entry `/etc/hook` has an absolute path");
    assert_eq!(with(r"\\server\"), r"archive: entry `\\\\server\\` has an absolute path");
    assert_eq!(with("C:/x/yyyy"), "archive: entry `C:/x/yyyy` has a path with a drive letter");
    assert_eq!(with("a/b\0c.txt"), r"archive: entry `a/b\0c.txt` has a zero character in its name");
    assert_eq!(with("././././."), "archive: entry `././././.` has no name");
}

#[test]
fn names_that_collide_are_refused() {
    let double = patched(&archive(&[("res/a", b""), ("res/b", b"")]), b"res/b", b"res/a");
    assert_eq!(refusal(&double), "archive: two entries have the same name");
    let tidied = archive(&[("res/a", b""), ("res//a", b"")]);
    assert_eq!(refusal(&tidied), "archive: entry `res/a` is there twice");
    let cased = archive(&[("res/a", b""), ("Res/A", b"")]);
    assert_eq!(refusal(&cased), "archive: entry `Res/A` differs from `res/a` by upper and lower case only");
    let folder = archive(&[("res", b""), ("res/a", b"")]);
    assert_eq!(refusal(&folder), "archive: entry `res` is both a file and a folder");
}

#[test]
fn links_and_devices_are_refused() {
    let link = write(|archive| archive.add_symlink("link", "/etc/passwd", SimpleFileOptions::default()).unwrap());
    assert_eq!(refusal(&link), "archive: entry `link` is a link or a device; only files and folders are unpacked");
}

#[test]
fn an_implausible_compression_ratio_and_too_many_entries_are_refused() {
    let zeros = vec![0; RATIO_FREE_BYTES as usize + 1];
    let text = refusal(&archive(&[("zeros", &zeros)]));
    assert!(text.contains("`zeros` grows from") && text.ends_with(&format!("at most {MAX_RATIO} times is believed")));
    inspect(&archive(&[("zeros", &zeros[1..])])).unwrap();
    let many = write(|archive| {
        for i in 0..MAX_ENTRIES {
            archive.add_directory(format!("{i}"), SimpleFileOptions::default()).unwrap();
        }
    });
    assert_eq!(refusal(&many), format!("archive: {} entries; at most {MAX_ENTRIES} are unpacked", MAX_ENTRIES + 1));
}

#[test]
fn a_declared_size_that_differs_from_the_contents_is_refused() {
    let honest = stored("eleven", b"eleven byte");
    inspect(&honest).unwrap();
    // The archive's directory holds the compressed size, then the uncompressed one.
    let sizes = [11_u32.to_le_bytes(), 11_u32.to_le_bytes()].concat();
    for (declared, text) in [
        (10_u32, "cannot be read: File is larger than its declared uncompressed size"),
        (12, "announces 12 bytes, but holds 11"),
    ] {
        let changed = [11_u32.to_le_bytes(), declared.to_le_bytes()].concat();
        assert_eq!(refusal(&patched(&honest, &sizes, &changed)), format!("archive: entry `eleven` {text}"));
    }
    let huge = [11_u32.to_le_bytes(), u32::MAX.to_le_bytes()].concat();
    assert!(MAX_BYTES < u64::from(u32::MAX));
    assert!(refusal(&patched(&honest, &sizes, &huge)).contains("`eleven` grows from 11 to 4294967295 bytes"));
}

#[test]
fn an_archive_without_a_description_is_refused() {
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    archive.start_file("unit/ModelDescription.xml", SimpleFileOptions::default()).unwrap();
    let text = refusal(&archive.finish().unwrap().into_inner());
    assert_eq!(text, "archive: no `modelDescription.xml` at its root; there is `unit/ModelDescription.xml`");
    let empty = ZipWriter::new(Cursor::new(Vec::new())).finish().unwrap().into_inner();
    assert_eq!(refusal(&empty), "archive: no `modelDescription.xml` at its root: not an FMU");
    assert!(refusal(b"no zip at all").starts_with("archive: no readable zip archive: "));
}

#[test]
fn backslashes_and_dots_are_tolerated_with_a_warning() {
    let odd = archive(&[(r"binaries\linux64\a.so", b"x"), ("./resources/b", b"y")]);
    let (_, findings) = inspect(&odd).unwrap();
    let texts: Vec<_> = findings.iter().map(|finding| finding.message.as_str()).take(2).collect();
    assert_eq!(
        texts,
        [
            r"entry `binaries\linux64\a.so` has backslashes in its path; expected `binaries/linux64/a.so`",
            "entry `./resources/b` has empty parts in its path; expected `resources/b`",
        ]
    );
}

#[test]
fn an_entry_for_the_folder_itself_is_read_and_one_that_leaves_it_is_not() {
    let patch = |name: &str| patched(&archive(&[("xxxx", b""), ("resources/b", b"y")]), b"xxxx", name.as_bytes());
    for name in ["././", ".///"] {
        let (description, findings) = inspect(&patch(name)).unwrap();
        assert_eq!(description.guid, "b");
        let expected = format!("entry `{name}` is the folder of the unit itself; leave it out");
        assert_eq!(findings[0].message, expected);
    }
    assert_eq!(refusal(&patch("/./.")), "archive: entry `/./.` has an absolute path");
    assert_eq!(refusal(&patch("./..")), "archive: entry `./..` leads out of its folder by `..`");
    let folder = tempfile::tempdir().unwrap();
    let (fmu, into) = (folder.path().join("a.fmu"), folder.path().join("unpacked"));
    fs::write(&fmu, patch("././")).unwrap();
    unpack(&fmu, &into).unwrap();
    assert_eq!(fs::read_to_string(into.join("resources/b")).unwrap(), "y");
    let full = patched(&stored("xxxx", b"z"), b"xxxx", b"././");
    assert_eq!(refusal(&full), "archive: entry `././` is a folder with contents of its own");
}

#[test]
fn files_are_unpacked_into_a_private_folder_with_rights_for_their_owner_only() {
    let folder = tempfile::tempdir().unwrap();
    let (fmu, into) = (folder.path().join("a.fmu"), folder.path().join("unpacked"));
    let bytes = write(|archive| {
        let tool = SimpleFileOptions::default().unix_permissions(0o4777);
        archive.start_file(r"resources\tool", tool).unwrap();
        archive.write_all(b"tool").unwrap();
        archive.add_directory("empty/", SimpleFileOptions::default()).unwrap();
    });
    fs::write(&fmu, &bytes).unwrap();
    let unpacked = unpack(&fmu, &into).unwrap();
    assert_eq!(unpacked.description.model_name, "a");
    let system = std::process::Command::new("sha256sum").arg(&fmu).output().unwrap();
    assert!(unpacked.sha256.len() == 64 && system.stdout.starts_with(unpacked.sha256.as_bytes()));
    let mode = |path: &str| into.join(path).metadata().unwrap().permissions().mode() & 0o7777;
    assert_eq!((mode(""), mode("resources"), mode("empty")), (0o700, 0o700, 0o700));
    assert_eq!((mode("resources/tool"), mode(DESCRIPTION)), (0o700, 0o600));
    assert_eq!(fs::read_to_string(into.join(DESCRIPTION)).unwrap(), XML);
    // The folder exists now.
    assert!(unpack(&fmu, &into).unwrap_err().to_string().starts_with("making the folder"));
}

#[test]
fn nothing_is_left_of_an_archive_that_cannot_be_unpacked() {
    let folder = tempfile::tempdir().unwrap();
    let (fmu, into) = (folder.path().join("a.fmu"), folder.path().join("unpacked"));
    let broken = patched(&stored("b", b"contents of b"), b"contents of b", b"contents of c");
    fs::write(&fmu, broken).unwrap();
    let text = unpack(&fmu, &into).unwrap_err().to_string();
    assert!(text.contains("a.fmu: entry `b` cannot be read: "), "{text}");
    assert!(!into.exists());
    assert_eq!(examine(&fmu).unwrap_err().to_string(), text);
    assert_eq!(read_description(&fmu).unwrap().0.guid, "b");
}

#[test]
fn every_archive_of_the_corpus_is_accepted_or_refused_as_its_name_says() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/archives");
    let mut checked = 0;
    for file in fs::read_dir(folder).unwrap() {
        let path = file.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        let accepted = inspect(&fs::read(&path).unwrap()).is_ok();
        assert_eq!(accepted, name.starts_with("accepted"), "{name}");
        checked += 1;
    }
    assert!(checked >= 5, "the kept archives are there");
}

proptest::proptest! {
    #[test]
    fn a_changed_archive_is_accepted_or_refused_without_a_panic(
        changes in proptest::collection::vec((0_usize..4096, proptest::num::u8::ANY), 0..12),
        cut in proptest::option::of(0_usize..4096),
    ) {
        let mut bytes = archive(&[("binaries/linux64/a.so", b"library"), ("resources/b", &[7; 300])]);
        let length = bytes.len();
        changes.iter().for_each(|&(at, value)| bytes[at % length] = value);
        bytes.truncate(cut.map_or(length, |cut| cut % length));
        if let Err(error) = inspect(&bytes) {
            assert!(!error.to_string().is_empty());
        }
    }

    #[test]
    fn arbitrary_bytes_are_refused_without_a_panic(bytes in proptest::collection::vec(proptest::num::u8::ANY, 0..400)) {
        assert!(inspect(&bytes).is_err());
    }
}
