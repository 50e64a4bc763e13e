//! The private folder of a run, with unpacked units, boards and sockets. Only its user can enter it.
//!
//! A run keeps a lock on a file in its folder. The system releases the lock when the process ends, however it ends, so a
//! later run knows which folders are left over, and removes them.

use super::interruption;
use std::fs::{self, File, Permissions};
use std::os::unix::fs::{MetadataExt, PermissionsExt};
use std::path::{Path, PathBuf};
use std::{env, io};

/// How the name of a private folder begins.
const PREFIX: &str = "lockstep-";
/// The file that is locked. It gets this name when it is locked already.
const LOCK: &str = "lockstep.lock";
const UNLOCKED: &str = "lockstep.unlocked";
const SET_BY_OWNER_ONLY: u32 = 0o1000;
const WRITABLE_FOR_ALL: u32 = 0o002;

/// A private folder; removed when dropped.
#[derive(Debug)]
pub struct Home {
    path: PathBuf,
    /// Locked until dropped; `None` where the file system has no locks.
    _lock: Option<File>,
}

impl Home {
    /// Makes a folder below `TMPDIR`, and removes those that runs have left there which were killed.
    ///
    /// # Errors
    /// The folder cannot be made.
    pub fn make() -> io::Result<Self> {
        let root = std::path::absolute(env::temp_dir())?;
        let home = interruption::homes(|homes| {
            let made = tempfile::Builder::new().prefix(PREFIX).tempdir_in(&root)?;
            // The mode of a new folder depends on the process's umask.
            fs::set_permissions(made.path(), Permissions::from_mode(0o700))?;
            let lock = lock(made.path())?;
            let path = made.keep();
            homes.push(path.clone());
            io::Result::Ok(Self { path, _lock: lock })
        })?;
        remove_left_over(&root, fs::metadata(&home.path)?.uid());
        Ok(home)
    }

    /// Its absolute path.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Whether other users can replace it by a folder of their own, although they cannot enter it.
    #[must_use]
    pub fn is_replaceable(&self) -> bool {
        let mode = self.path.parent().and_then(|root| fs::metadata(root).ok()).map_or(0, |root| root.mode());
        mode & WRITABLE_FOR_ALL != 0 && mode & SET_BY_OWNER_ONLY == 0
    }
}

impl Drop for Home {
    fn drop(&mut self) {
        interruption::homes(|homes| {
            // A failure is not reported: the next run tries again.
            fs::remove_dir_all(&self.path).ok();
            homes.retain(|home| *home != self.path);
        });
    }
}

fn lock(home: &Path) -> io::Result<Option<File>> {
    let file = File::create_new(home.join(UNLOCKED))?;
    if file.try_lock().is_err() {
        return Ok(None);
    }
    fs::rename(home.join(UNLOCKED), home.join(LOCK))?;
    Ok(Some(file))
}

/// Whether the last part of a path is the name of a private folder.
#[must_use]
pub fn is_home(folder: &Path) -> bool {
    folder.file_name().is_some_and(|name| name.to_string_lossy().starts_with(PREFIX))
}

/// Removes the private folders of a user whose run is gone. What cannot be removed stays.
fn remove_left_over(root: &Path, user: u32) {
    for entry in fs::read_dir(root).into_iter().flatten().flatten() {
        let home = entry.path();
        let own = |path: &Path| fs::symlink_metadata(path).ok().filter(|metadata| metadata.uid() == user);
        let lock = home.join(LOCK);
        if is_home(&home)
            && own(&home).is_some_and(|metadata| metadata.is_dir())
            && own(&lock).is_some_and(|metadata| metadata.is_file())
            && let Ok(lock) = File::open(lock)
            && lock.try_lock().is_ok()
        {
            fs::remove_dir_all(&home).ok();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_folder_with_the_name_of_a_private_one_is_one() {
        assert!(is_home(Path::new("/tmp/lockstep-x7Q")));
        assert!(!is_home(Path::new("/tmp")) && !is_home(Path::new("/")) && !is_home(Path::new("/home/lockstep/runs")));
    }

    #[test]
    fn a_folder_is_removed_when_nothing_holds_its_lock() {
        let root = tempfile::tempdir().unwrap();
        let user = fs::metadata(root.path()).unwrap().uid();
        let [killed, running, foreign] = ["lockstep-killed", "lockstep-running", "lockstep-notes"].map(|name| {
            let path = root.path().join(name);
            fs::create_dir(&path).unwrap();
            path
        });
        drop(lock(&killed).unwrap());
        let _held = lock(&running).unwrap();
        remove_left_over(root.path(), user + 1);
        assert!(killed.exists(), "it belongs to another user");
        remove_left_over(root.path(), user);
        assert!(!killed.exists() && running.exists() && foreign.exists());
    }
}
