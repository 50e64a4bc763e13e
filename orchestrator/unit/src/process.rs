//! What the program asks of the system for itself and for the processes below it.

use std::collections::BTreeSet;
use std::ffi::{CString, c_int};
use std::os::unix::ffi::OsStrExt;
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use std::{fs, io, ptr, thread};

/// Whether this process adopts orphans; until then it has no processes but those that it started and waits for.
static ADOPTS: AtomicBool = AtomicBool::new(false);

/// Makes writes beyond the limit of a file's size (`ulimit -f`) fail like those to a full disk. Otherwise SIGXFSZ would end
/// the process. The processes that this one starts inherit it.
pub fn survive_file_size_limit() {
    // SAFETY: takes plain numbers; no handler runs in this process.
    unsafe { libc::signal(libc::SIGXFSZ, libc::SIG_IGN) };
}

/// Whether this process may map so many more bytes (`ulimit -v`). Nothing is mapped afterwards.
#[must_use]
pub fn has_address_space(bytes: usize) -> bool {
    let flags = libc::MAP_PRIVATE | libc::MAP_ANONYMOUS | libc::MAP_NORESERVE;
    // SAFETY: without an address hint the system chooses an unused range, which nothing accesses.
    let start = unsafe { libc::mmap(ptr::null_mut(), bytes, libc::PROT_NONE, flags, -1, 0) };
    // SAFETY: this is exactly the range that was mapped.
    start != libc::MAP_FAILED && unsafe { libc::munmap(start, bytes) } == 0
}

/// Whether this user may have so many more threads and processes (`ulimit -u`). They are started and end at once.
#[must_use]
pub fn may_start(threads: usize) -> bool {
    const STACK_BYTES: usize = 16 << 10;
    let begun = Mutex::new(());
    thread::scope(|scope| {
        // They wait until all are there, or one could not be started.
        let _held = begun.lock();
        let start = |_| thread::Builder::new().stack_size(STACK_BYTES).spawn_scoped(scope, || drop(begun.lock()));
        (0..threads).map(start).all(|started| started.is_ok())
    })
}

/// Whether the file system of a folder forbids to load libraries from it (`noexec`).
#[must_use]
pub fn forbids_libraries(folder: &Path) -> bool {
    let Ok(folder) = CString::new(folder.as_os_str().as_bytes()) else { return false };
    // SAFETY: all bits zero are a valid `statvfs`.
    let mut system: libc::statvfs = unsafe { std::mem::zeroed() };
    // SAFETY: the path ends with a zero, and the call writes to `system` only.
    let found = unsafe { libc::statvfs(folder.as_ptr(), &raw mut system) } == 0;
    found && system.f_flag & libc::ST_NOEXEC != 0
}

/// Whether this process ignores a signal: `nohup` starts programs so that they ignore SIGHUP.
#[must_use]
pub fn is_ignored(signal: c_int) -> bool {
    // SAFETY: all bits zero are a valid `sigaction`.
    let mut action: libc::sigaction = unsafe { std::mem::zeroed() };
    // SAFETY: without a new action the call writes the present one to `action`, and changes nothing.
    unsafe { libc::sigaction(signal, ptr::null(), &raw mut action) == 0 && action.sa_sigaction == libc::SIG_IGN }
}

/// How long a process of a run may be stopped: shorter than it may be without a sign of life, as there is no doubt about it.
pub const LONGEST_STOP: Duration = Duration::from_secs(1);

/// Whether a process of this user is stopped, by a signal or by a debugger. False where the system does not report it.
#[must_use]
pub fn is_stopped(process: u32) -> bool {
    let state = state_and_parent(Path::new(&format!("/proc/{process}"))).map(|(state, _)| state);
    matches!(state, Some('T' | 't'))
}

/// The state of the process whose folder in `/proc` this is, and the id of its parent.
fn state_and_parent(process: &Path) -> Option<(char, u32)> {
    let text = fs::read(process.join("stat")).ok()?;
    let text = String::from_utf8_lossy(&text);
    // The second field is the name in parentheses, which may contain any character.
    let mut fields = text.rsplit_once(')')?.1.split_whitespace();
    Some((fields.next()?.parse().ok()?, fields.next()?.parse().ok()?))
}

/// Makes this process the parent of each process below it whose own parent ends, so that [`Descendants`] finds it.
///
/// # Errors
/// The system does not have it.
fn adopt_orphans() -> io::Result<()> {
    let enabled: libc::c_ulong = 1;
    // SAFETY: takes plain numbers.
    if unsafe { libc::prctl(libc::PR_SET_CHILD_SUBREAPER, enabled) } != 0 {
        return Err(io::Error::last_os_error());
    }
    ADOPTS.store(true, Ordering::Relaxed);
    Ok(())
}

/// Waits for adopted processes that have ended, which would stay zombies otherwise. `is_own` names the processes that this
/// one started and waits for itself.
pub fn reap_adopted(is_own: impl Fn(u32) -> bool) {
    while ADOPTS.load(Ordering::Relaxed)
        && let Some(ended) = ended_child()
        && !is_own(ended.unsigned_abs())
    {
        reap(ended, libc::WNOHANG);
    }
}

/// A child that has ended and is not waited for yet; it stays so.
fn ended_child() -> Option<libc::pid_t> {
    // SAFETY: all bits zero are a valid `siginfo_t`.
    let mut child: libc::siginfo_t = unsafe { std::mem::zeroed() };
    let options = libc::WEXITED | libc::WNOHANG | libc::WNOWAIT;
    // SAFETY: the call writes to `child` only.
    let found = unsafe { libc::waitid(libc::P_ALL, 0, &raw mut child, options) } == 0;
    // SAFETY: `waitid` sets the field, or leaves the zero where no child has ended.
    let id = unsafe { child.si_pid() };
    (found && id != 0).then_some(id)
}

fn reap(child: libc::pid_t, options: c_int) {
    // SAFETY: takes plain numbers, and a null pointer where no status is wanted.
    unsafe { libc::waitpid(child, ptr::null_mut(), options) };
}

fn kill(process: libc::pid_t) -> bool {
    // SAFETY: takes plain numbers. A process that has ended but is not waited for keeps its number.
    unsafe { libc::kill(process, libc::SIGKILL) == 0 }
}

/// Ends this process and all others of its process group, if that is its own group: those that a unit started.
pub fn end_own_group() {
    // SAFETY: both take nothing and return a number.
    if unsafe { libc::getpgrp() == libc::getpid() } {
        kill(0);
    }
}

/// The processes below this one, which end when this value is dropped: what units started, and what these started.
/// Processes that were there before, such as those of a shell that this program replaced, are left alone.
#[derive(Debug)]
pub struct Descendants {
    spared: BTreeSet<libc::pid_t>,
}

impl Descendants {
    /// Adopts orphans from now on.
    ///
    /// # Errors
    /// The system cannot do that.
    pub fn adopt() -> io::Result<Self> {
        let spared = children().into_iter().collect();
        adopt_orphans()?;
        Ok(Self { spared })
    }
}

impl Drop for Descendants {
    fn drop(&mut self) {
        // The end of a process makes its children children of this one, which the next round finds.
        while let Some(child) = children().into_iter().find(|child| !self.spared.contains(child)) {
            if kill(child) {
                reap(child, 0);
            } else {
                // It has another user and goes on.
                self.spared.insert(child);
            }
        }
    }
}

/// How long a copy of this process may take to return from its call once the run has ended.
const COPY_RETURNS: Duration = Duration::from_millis(200);

/// Waits for copies of this process that a unit has made (fork): each ends when its call returns, and leaves a note about it.
/// One that does not return in time is left to the end of the run.
pub fn await_copies() {
    let began = Instant::now();
    while has_copy() && began.elapsed() < COPY_RETURNS {
        thread::sleep(Duration::from_millis(1));
    }
}

/// Whether a child of this process runs the same program.
fn has_copy() -> bool {
    let program = |process: &str| fs::read_link(format!("/proc/{process}/exe")).ok();
    let threads = fs::read_dir("/proc/self/task").into_iter().flatten().flatten();
    let lists = threads.filter_map(|thread| fs::read_to_string(thread.path().join("children")).ok());
    let own = program("self");
    own.is_some() && lists.into_iter().any(|children| children.split_whitespace().any(|child| program(child) == own))
}

/// The children of this process.
fn children() -> Vec<libc::pid_t> {
    let own = std::process::id();
    let child = |path: &Path| {
        let id = path.file_name()?.to_str()?.parse().ok()?;
        state_and_parent(path).is_some_and(|(_, parent)| parent == own).then_some(id)
    };
    fs::read_dir("/proc").into_iter().flatten().flatten().filter_map(|entry| child(&entry.path())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::process::Command;
    use std::thread::sleep;

    #[test]
    fn a_process_is_stopped_from_its_signal_until_it_continues() {
        let mut child = Command::new("sleep").arg("60").spawn().unwrap();
        let id = child.id();
        let signal = |name: &str| Command::new("kill").args([name, &id.to_string()]).status().unwrap();
        let becomes = |state| {
            (0..1000).any(|_| {
                is_stopped(id) == state || {
                    sleep(Duration::from_millis(5));
                    false
                }
            })
        };
        assert!(!is_stopped(id));
        signal("-STOP");
        assert!(becomes(true));
        signal("-CONT");
        assert!(becomes(false));
        child.kill().unwrap();
        child.wait().unwrap();
    }
}
