//! The folder of a run: its owner, its lock, and its files, which get their final names when they are complete.
//!
//! `run.json` is created first, and the run keeps a lock on it until it ends; it is the only file that is rewritten in
//! place, because a file that replaced it would not be locked.

use super::TraceError;
use super::run_record::RunRecord;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Read, Seek, Write};
use std::path::{Path, PathBuf};

/// The record of a run, and its lock.
pub const RUN_JSON: &str = "run.json";
/// The recorded rows.
pub const TRACE_CSV: &str = "trace.csv";
/// The recorded rows by columns.
pub const TRACE_PARQUET: &str = "trace.parquet";
/// When windows of the script opened and closed.
pub const EVENTS_CSV: &str = "events.csv";
/// The description of each column of the trace.
pub const SIGNALS_JSON: &str = "signals.json";
/// The verdicts on the claims.
pub const VERDICT_JSON: &str = "verdict.json";
/// The suffix of a file's name until the file is complete.
pub const PARTIAL: &str = ".partial";

/// The plot that `lockstep plot` draws of a run.
pub const PLOT_SVG: &str = "plot.svg";
/// The same by pixels.
pub const PLOT_PNG: &str = "plot.png";

/// A longer `run.json` is none of ours.
const LONGEST_RECORD: u64 = 64 << 20;

/// The files of a run besides its record; those of an earlier run are removed before a new one begins.
const RESULTS: [&str; 7] = [TRACE_CSV, TRACE_PARQUET, EVENTS_CSV, SIGNALS_JSON, VERDICT_JSON, PLOT_SVG, PLOT_PNG];

/// A folder that this run has locked until the value is dropped.
#[derive(Debug)]
pub struct RunFolder {
    path: PathBuf,
    record: File,
}

impl RunFolder {
    /// Creates the folder, or reuses that of an earlier run, whose results are removed; other files in it stay.
    ///
    /// # Errors
    /// [`TraceError::Locked`] if another run is writing there, [`TraceError::Foreign`] if it contains files but no
    /// `run.json` of Lockstep, else [`TraceError::Io`].
    pub fn claim(path: &Path, record: &RunRecord) -> Result<Self, TraceError> {
        fs::create_dir_all(path).map_err(TraceError::io("create", path))?;
        let file_path = path.join(RUN_JSON);
        let entries = fs::read_dir(path).map_err(TraceError::io("read", path))?.count();
        let occupied = entries > 0;
        // Only a file is opened: a pipe would be waited for.
        if fs::metadata(&file_path).is_ok_and(|entry| !entry.is_file()) {
            return Err(TraceError::Foreign(path.to_owned()));
        }
        let mut options = OpenOptions::new();
        options.read(true).write(true);
        let file = match options.create(!occupied).truncate(false).open(&file_path) {
            Ok(file) => file,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Err(TraceError::Foreign(path.to_owned())),
            Err(error) => return Err(TraceError::io("open", &file_path)(error)),
        };
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => return Err(TraceError::Locked(path.to_owned())),
            Err(TryLockError::Error(error)) => return Err(TraceError::io("lock", &file_path)(error)),
        }
        let mut earlier = Vec::new();
        (&file).take(LONGEST_RECORD).read_to_end(&mut earlier).map_err(TraceError::io("read", &file_path))?;
        // A run that ended between creating and writing it leaves a `run.json` without content, and nothing else.
        let just_created = earlier.is_empty() && entries <= 1;
        if !just_created && !RunRecord::is_one(&earlier) {
            return Err(TraceError::Foreign(path.to_owned()));
        }
        let mut folder = Self { path: path.to_owned(), record: file };
        folder.remove_results()?;
        folder.note(record)?;
        Ok(folder)
    }

    /// The path of the folder.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Replaces the content of `run.json`.
    ///
    /// # Errors
    /// The file cannot be written; the error names it.
    pub fn note(&mut self, record: &RunRecord) -> Result<(), TraceError> {
        let text = record.json();
        let mut write = || {
            self.record.rewind()?;
            self.record.write_all(text.as_bytes())?;
            self.record.set_len(text.len() as u64)
        };
        write().map_err(TraceError::io("write", &self.path.join(RUN_JSON)))
    }

    /// Begins a file under its partial name.
    ///
    /// # Errors
    /// The file cannot be created; the error names it.
    pub fn begin(&self, name: &str) -> Result<PartialFile, TraceError> {
        let partial = self.path.join(format!("{name}{PARTIAL}"));
        let file = File::create(&partial).map_err(TraceError::io("create", &partial))?;
        Ok(PartialFile { file, partial, whole: self.path.join(name) })
    }

    /// Writes a complete file.
    ///
    /// # Errors
    /// The file cannot be written; the error names it.
    pub fn write(&self, name: &str, text: &str) -> Result<(), TraceError> {
        let mut file = self.begin(name)?;
        let written = file.write_all(text.as_bytes());
        file.named(written)?;
        file.finish()
    }

    fn remove_results(&self) -> Result<(), TraceError> {
        for entry in fs::read_dir(&self.path).map_err(TraceError::io("read", &self.path))? {
            let path = entry.map_err(TraceError::io("read", &self.path))?.path();
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            let whole = name.strip_suffix(PARTIAL).unwrap_or(&name);
            if RESULTS.contains(&whole) || is_call_log(whole) {
                fs::remove_file(&path).map_err(TraceError::io("remove", &path))?;
            }
        }
        Ok(())
    }
}

/// The file name of the log of an instance's calls. Characters other than letters, digits, `_` and `-` are replaced by
/// their code points: the name stays in the folder, and no two instances share a file.
#[must_use]
pub fn call_log_name(instance: &str) -> String {
    let escaped = |letter: char| match letter {
        letter if letter.is_alphanumeric() || "_-".contains(letter) => letter.to_string(),
        other => format!("%{:X}", u32::from(other)),
    };
    format!("fmi-calls.{}.log", instance.chars().map(escaped).collect::<String>())
}

fn is_call_log(name: &str) -> bool {
    name.starts_with("fmi-calls.") && name.ends_with(".log")
}

/// A file that has its partial name until [`PartialFile::finish`].
#[derive(Debug)]
pub struct PartialFile {
    file: File,
    partial: PathBuf,
    whole: PathBuf,
}

impl PartialFile {
    /// Its path until it is complete.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.partial
    }

    /// Gives the file its final name.
    ///
    /// # Errors
    /// The file cannot be renamed; the error names it.
    pub fn finish(&self) -> Result<(), TraceError> {
        fs::rename(&self.partial, &self.whole).map_err(TraceError::io("rename", &self.partial))
    }

    /// Adds the file's name to the error of a write.
    ///
    /// # Errors
    /// The write failed.
    pub fn named(&self, written: io::Result<()>) -> Result<(), TraceError> {
        written.map_err(TraceError::io("write", &self.partial))
    }
}

impl Write for PartialFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::super::run_record::tests::record;
    use super::*;

    #[test]
    fn a_new_folder_has_a_record_with_the_state_running_before_any_other_file() {
        let home = tempfile::tempdir().unwrap();
        let folder = RunFolder::claim(&home.path().join("runs/a"), &record()).unwrap();
        let text = fs::read_to_string(folder.path().join(RUN_JSON)).unwrap();
        assert!(text.contains("\"state\": \"running\""), "{text}");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_folder_in_use_is_refused_until_its_run_ends() {
        let home = tempfile::tempdir().unwrap();
        let first = RunFolder::claim(home.path(), &record()).unwrap();
        let refused = RunFolder::claim(home.path(), &record()).unwrap_err();
        assert!(matches!(refused, TraceError::Locked(_)), "{refused}");
        assert!(refused.help().unwrap().contains("--out"));
        drop(first);
        RunFolder::claim(home.path(), &record()).unwrap();
    }

    #[test]
    fn a_folder_with_other_files_is_refused_and_not_changed() {
        let others = [("thesis.tex", "words"), (RUN_JSON, "{\"of\": \"another tool\"}"), (RUN_JSON, "")];
        for (name, text) in others {
            let home = tempfile::tempdir().unwrap();
            fs::write(home.path().join(name), text).unwrap();
            fs::write(home.path().join(TRACE_CSV), "numbers of another tool").unwrap();
            let refused = RunFolder::claim(home.path(), &record()).unwrap_err();
            assert!(matches!(refused, TraceError::Foreign(_)), "{refused}");
            assert_eq!(fs::read_to_string(home.path().join(name)).unwrap(), text);
            assert_eq!(fs::read_dir(home.path()).unwrap().count(), 2);
        }
    }

    #[test]
    fn a_record_that_is_no_file_is_refused_at_once() {
        let home = tempfile::tempdir().unwrap();
        let made = std::process::Command::new("mkfifo").arg(home.path().join(RUN_JSON)).status();
        assert!(made.is_ok_and(|status| status.success()));
        let refused = RunFolder::claim(home.path(), &record()).unwrap_err();
        assert!(matches!(refused, TraceError::Foreign(_)), "{refused}");
        fs::remove_file(home.path().join(RUN_JSON)).unwrap();
        fs::create_dir(home.path().join(RUN_JSON)).unwrap();
        assert!(matches!(RunFolder::claim(home.path(), &record()).unwrap_err(), TraceError::Foreign(_)));
    }

    #[test]
    fn an_empty_record_alone_is_what_a_run_leaves_that_ended_at_once() {
        let home = tempfile::tempdir().unwrap();
        fs::write(home.path().join(RUN_JSON), "").unwrap();
        RunFolder::claim(home.path(), &record()).unwrap();
    }

    #[test]
    fn results_of_an_earlier_run_are_removed_and_files_added_by_the_user_stay() {
        let home = tempfile::tempdir().unwrap();
        drop(RunFolder::claim(home.path(), &record()).unwrap());
        for name in ["trace.csv", "trace.parquet", "fmi-calls.quad.log.partial", "trace.csv.partial", "notes.txt"] {
            fs::write(home.path().join(name), "old").unwrap();
        }
        let _folder = RunFolder::claim(home.path(), &record()).unwrap();
        let mut names: Vec<_> = fs::read_dir(home.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
        names.sort();
        assert_eq!(names, ["notes.txt", "run.json"]);
    }

    #[test]
    fn the_call_log_of_an_instance_stays_in_the_folder_and_has_a_unique_name() {
        let names = ["quad", "edge[1]", "../a", "é %2E"].map(call_log_name);
        let expected = ["quad", "edge%5B1%5D", "%2E%2E%2Fa", "é%20%252E"].map(|name| format!("fmi-calls.{name}.log"));
        assert_eq!(names, expected);
        assert!(names.iter().all(|name| is_call_log(name)));
    }

    #[test]
    fn a_file_gets_its_final_name_when_it_is_complete() {
        let home = tempfile::tempdir().unwrap();
        let folder = RunFolder::claim(home.path(), &record()).unwrap();
        let mut file = folder.begin(TRACE_CSV).unwrap();
        file.write_all(b"time\n").unwrap();
        assert!(home.path().join("trace.csv.partial").exists() && !home.path().join(TRACE_CSV).exists());
        file.finish().unwrap();
        assert_eq!(fs::read(home.path().join(TRACE_CSV)).unwrap(), b"time\n");
        assert!(!home.path().join("trace.csv.partial").exists());
    }

    #[test]
    fn a_shorter_record_leaves_nothing_of_a_longer_one() {
        let home = tempfile::tempdir().unwrap();
        let mut long = record();
        long.scenario = "x".repeat(5000);
        let mut folder = RunFolder::claim(home.path(), &long).unwrap();
        folder.note(&record()).unwrap();
        assert_eq!(fs::read_to_string(home.path().join(RUN_JSON)).unwrap(), record().json());
    }

    #[test]
    fn an_error_of_the_system_names_the_file() {
        let home = tempfile::tempdir().unwrap();
        let folder = RunFolder::claim(home.path(), &record()).unwrap();
        let error = folder.begin("no/such/folder.csv").unwrap_err().to_string();
        assert!(error.starts_with("cannot create ") && error.contains("no/such/folder.csv.partial: "), "{error}");
    }
}
