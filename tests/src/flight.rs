//! A running `lockstep` program: its output so far, signals to it and to its stepping process, and its result.

use crate::program::{Said, command};
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus};
use std::thread::sleep;
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// Time limit for every wait, long enough for a busy machine.
const PATIENCE: Duration = Duration::from_secs(30);
const LOOK_AGAIN: Duration = Duration::from_millis(5);

/// Waits for a condition.
///
/// # Panics
/// If the condition is not met in time.
pub fn until(what: &str, mut condition: impl FnMut() -> bool) {
    let began = Instant::now();
    while !condition() {
        assert!(began.elapsed() < PATIENCE, "{what}: not within {PATIENCE:?}");
        sleep(LOOK_AGAIN);
    }
}

/// A started `lockstep` process with its own folder for temporary files; killed when dropped.
#[derive(Debug)]
pub struct Flight {
    process: Child,
    /// Folder of the files with its standard output and error, and of its temporary files.
    home: TempDir,
}

#[allow(clippy::unwrap_used, reason = "a test that cannot look after its run has failed")]
impl Flight {
    /// Starts `lockstep` in a folder.
    ///
    /// # Panics
    /// If it cannot be started.
    #[must_use]
    pub fn start(folder: &Path, arguments: &[&str]) -> Self {
        Self::of(command(folder, arguments))
    }

    /// Starts a command that becomes `lockstep` in the end, such as a shell with `exec`.
    ///
    /// # Panics
    /// If it cannot be started.
    #[must_use]
    pub fn of(mut command: Command) -> Self {
        let home = tempfile::tempdir().unwrap();
        let temporary = home.path().join("tmp");
        fs::create_dir(&temporary).unwrap();
        let [out, err] = ["out", "err"].map(|name| File::create(home.path().join(name)).unwrap());
        let process = command.env("TMPDIR", temporary).stdout(out).stderr(err).spawn().unwrap();
        Self { process, home }
    }

    /// Its process id.
    #[must_use]
    pub fn id(&self) -> u32 {
        self.process.id()
    }

    /// The process id of its stepping process, once there is one.
    ///
    /// # Panics
    /// If there is none in time.
    #[must_use]
    pub fn stepping_process(&self) -> u32 {
        self.children(1)[0]
    }

    /// The process ids of its children, once there are `count` of them.
    ///
    /// # Panics
    /// If there are not `count` children in time.
    #[must_use]
    pub fn children(&self, count: usize) -> Vec<u32> {
        let mut found = Vec::new();
        until("processes of the run", || {
            found = processes().into_iter().filter(|process| process.parent == self.id()).map(|p| p.id).collect();
            found.len() == count
        });
        found
    }

    /// Its standard error so far.
    ///
    /// # Panics
    /// If that cannot be read.
    #[must_use]
    pub fn said(&self) -> String {
        String::from_utf8_lossy(&fs::read(self.home.path().join("err")).unwrap()).into_owned()
    }

    /// The existing temporary folders of runs.
    ///
    /// # Panics
    /// If the folder of temporary files cannot be read.
    #[must_use]
    pub fn temporary_folders(&self) -> Vec<PathBuf> {
        fs::read_dir(self.home.path().join("tmp")).unwrap().map(|entry| entry.unwrap().path()).collect()
    }

    /// Whether it has ended.
    ///
    /// # Panics
    /// If the system does not return its status.
    pub fn is_over(&mut self) -> bool {
        self.status().is_some()
    }

    /// Waits for its end; returns its exit code and its output.
    ///
    /// # Panics
    /// If it does not end.
    pub fn end(&mut self) -> Said {
        until("the end of the run", || self.is_over());
        let out = String::from_utf8_lossy(&fs::read(self.home.path().join("out")).unwrap()).into_owned();
        Said { code: self.status().unwrap().code(), out, err: self.said() }
    }

    fn status(&mut self) -> Option<ExitStatus> {
        self.process.try_wait().unwrap()
    }
}

impl Drop for Flight {
    fn drop(&mut self) {
        // It may have ended already.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// Sends a signal, named as `kill` names it, to a process.
///
/// # Panics
/// If there is no such process.
pub fn signal(name: &str, process: u32) {
    let sent = Command::new("sh").args(["-c", &format!("kill -s {name} {process}")]).status();
    assert!(sent.is_ok_and(|status| status.success()), "SIG{name} reaches process {process}");
}

/// Whether a process is alive; a zombie is not.
#[must_use]
pub fn is_alive(process: u32) -> bool {
    processes().into_iter().any(|other| other.id == process)
}

/// A process that is alive.
struct Living {
    id: u32,
    parent: u32,
}

/// All processes that are alive, from `/proc/*/stat`: id, name in brackets, state, id of the parent.
fn processes() -> Vec<Living> {
    let living = |path: PathBuf| {
        let id = path.file_name()?.to_str()?.parse().ok()?;
        let text = fs::read_to_string(path.join("stat")).ok()?;
        let mut fields = text.rsplit_once(") ")?.1.split(' ');
        let is_dead = ["Z", "X"].contains(&fields.next()?);
        let parent = fields.next()?.parse().ok()?;
        (!is_dead).then_some(Living { id, parent })
    };
    fs::read_dir("/proc").into_iter().flatten().flatten().filter_map(|entry| living(entry.path())).collect()
}
