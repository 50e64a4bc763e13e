//! Ends a process without parent and the programs that its units started, and removes the folder that the parent would
//! have removed.

use crate::run::home::is_home;
use std::io;
use std::path::{Path, PathBuf};
use unit::{exit, process};

/// Ends this process and its group when its standard input closes, even during a call of a unit, and removes the run's
/// private folder.
/// Several processes of a run may do so at once.
pub fn end_when_orphaned(home: Option<&Path>) {
    let home = home.map(PathBuf::from);
    std::thread::spawn(move || {
        // Only the end of the input matters, not its content or an error.
        io::copy(&mut io::stdin(), &mut io::sink()).ok();
        if let Some(home) = home.filter(|home| is_home(home)) {
            // Another process may have removed it already.
            std::fs::remove_dir_all(home).ok();
        }
        process::end_own_group();
        exit::at_once(1);
    });
}
