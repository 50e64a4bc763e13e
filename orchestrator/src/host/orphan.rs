//! The end of a process whose parent is gone, and of the folder that the parent would have taken away.

use crate::run::run_spec::HOME_PREFIX;
use std::io;
use std::path::{Path, PathBuf};
use unit::exit;

/// Ends this process when its standard input closes, whatever a unit is doing, and takes the run's private folder away.
/// Several processes of a run may do so at once.
pub fn end_when_orphaned(home: Option<&Path>) {
    let home = home.map(PathBuf::from);
    std::thread::spawn(move || {
        // Whatever else comes is of no interest; neither is why it ends.
        io::copy(&mut io::stdin(), &mut io::sink()).ok();
        if let Some(home) = home.filter(|home| is_home(home)) {
            // What another one has removed meanwhile is no concern.
            std::fs::remove_dir_all(home).ok();
        }
        exit::at_once(1);
    });
}

fn is_home(folder: &Path) -> bool {
    folder.file_name().is_some_and(|name| name.to_string_lossy().starts_with(HOME_PREFIX))
}

#[test]
fn only_a_private_folder_of_a_run_is_taken_away() {
    assert!(is_home(Path::new("/tmp/lockstep-x7Q")));
    assert!(!is_home(Path::new("/tmp")) && !is_home(Path::new("/")) && !is_home(Path::new("/home/lockstep/runs")));
}
