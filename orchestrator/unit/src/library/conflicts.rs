//! Libraries that two units need under one name: the system's loader gives both the one that was loaded first.

use std::path::PathBuf;

/// A library that a unit uses although it is not the one that it would get in a process of its own.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Conflict {
    /// The name under which the unit needs it.
    pub needed: String,
    /// The file that it uses.
    pub used: PathBuf,
    /// Its own file of that name; `None` if it would get the system's.
    pub own: Option<PathBuf>,
}

#[cfg(all(target_os = "linux", target_env = "gnu", target_pointer_width = "64"))]
pub(super) use linux::{conflicts_of, note_program};

#[cfg(not(all(target_os = "linux", target_env = "gnu", target_pointer_width = "64")))]
mod unknown {
    use super::Conflict;
    use std::ffi::c_void;
    use std::path::Path;

    pub(in super::super) fn note_program() {}

    pub(in super::super) fn conflicts_of(_: *mut c_void, _: &Path) -> Vec<Conflict> {
        Vec::new()
    }
}

#[cfg(not(all(target_os = "linux", target_env = "gnu", target_pointer_width = "64")))]
pub(super) use unknown::{conflicts_of, note_program};

#[cfg(all(target_os = "linux", target_env = "gnu", target_pointer_width = "64"))]
mod linux {
    use super::Conflict;
    use std::ffi::{CStr, CString, OsStr, c_char, c_void};
    use std::fs;
    use std::os::unix::ffi::OsStrExt;
    use std::path::{Path, PathBuf};
    use std::ptr;
    use std::sync::OnceLock;

    /// The public part of glibc's `struct link_map`.
    #[repr(C)]
    struct LinkMap {
        address: usize,
        name: *const c_char,
        dynamic: *const Dynamic,
        next: *const LinkMap,
        previous: *const LinkMap,
    }

    /// `Elf64_Dyn`
    #[repr(C)]
    #[derive(Clone, Copy)]
    struct Dynamic {
        tag: i64,
        value: usize,
    }

    const END: i64 = 0;
    const NEEDED: i64 = 1;
    const STRINGS: i64 = 5;

    /// The libraries of this program: each process of a run has them, so that `--isolate` changes nothing.
    static PROGRAM: OnceLock<Vec<PathBuf>> = OnceLock::new();

    /// Takes note of the libraries that are loaded before any unit.
    pub(in super::super) fn note_program() {
        PROGRAM.get_or_init(|| {
            // SAFETY: without a name this returns a handle of the program itself, whose map is the first of all.
            let map = unsafe { link_map(libc::dlopen(ptr::null(), libc::RTLD_LAZY)) };
            loaded(map).into_iter().map(path).collect()
        });
    }

    /// The libraries that the files of a unit need and get from elsewhere; `handle` is that of the unit's own library.
    pub(in super::super) fn conflicts_of(handle: *mut c_void, folder: &Path) -> Vec<Conflict> {
        // SAFETY: the handle is that of a loaded library.
        let own = unsafe { link_map(handle) };
        let of_unit = loaded(own).into_iter().filter(|map| path(map).starts_with(folder));
        let mut needed: Vec<_> = of_unit.flat_map(needed_by).collect();
        needed.sort();
        needed.dedup();
        needed.iter().filter_map(|name| conflict(name, folder)).collect()
    }

    fn conflict(name: &CStr, folder: &Path) -> Option<Conflict> {
        let used = loaded_as(name)?;
        if used.starts_with(folder) || PROGRAM.get().is_some_and(|program| program.contains(&used)) {
            return None;
        }
        let own = find(folder, OsStr::from_bytes(name.to_bytes()));
        let differs = match &own {
            Some(own) => fs::read(own).ok() != fs::read(&used).ok(),
            // All units of a run are unpacked side by side.
            None => folder.parent().is_some_and(|units| used.starts_with(units)),
        };
        differs.then(|| Conflict { needed: name.to_string_lossy().into_owned(), used, own })
    }

    /// The file that is loaded under this name.
    fn loaded_as(name: &CStr) -> Option<PathBuf> {
        // SAFETY: the name is a text, and nothing is loaded that is not loaded already.
        let handle = unsafe { libc::dlopen(name.as_ptr(), libc::RTLD_LAZY | libc::RTLD_NOLOAD) };
        if handle.is_null() {
            return None;
        }
        // SAFETY: the handle is valid; it is closed after its last use, and the library stays loaded by its first handle.
        unsafe {
            let found = link_map(handle).as_ref().map(path);
            libc::dlclose(handle);
            found
        }
    }

    /// # Safety
    /// The handle is NULL or that of a loaded library.
    unsafe fn link_map(handle: *mut c_void) -> *const LinkMap {
        let mut map: *const LinkMap = ptr::null();
        if !handle.is_null() {
            // SAFETY: guaranteed by the caller; the request stores a pointer.
            unsafe { libc::dlinfo(handle, libc::RTLD_DI_LINKMAP, (&raw mut map).cast()) };
        }
        map
    }

    /// All loaded libraries, beginning with any of them. They stay loaded: a unit that unloads one while another is loaded
    /// breaks the loader's own rules.
    fn loaded<'a>(any: *const LinkMap) -> Vec<&'a LinkMap> {
        let mut maps = Vec::new();
        // SAFETY: each pointer is NULL or leads to an entry of the loader's list.
        unsafe {
            let mut first = any;
            while let Some(previous) = first.as_ref().map(|map| map.previous).filter(|previous| !previous.is_null()) {
                first = previous;
            }
            while let Some(map) = first.as_ref() {
                maps.push(map);
                first = map.next;
            }
        }
        maps
    }

    fn path(map: &LinkMap) -> PathBuf {
        if map.name.is_null() {
            return PathBuf::new();
        }
        // SAFETY: the loader keeps the name as long as the library is loaded.
        let name = Path::new(OsStr::from_bytes(unsafe { CStr::from_ptr(map.name) }.to_bytes()));
        fs::canonicalize(name).unwrap_or_else(|_| name.to_path_buf())
    }

    /// The names under which a library needs others.
    fn needed_by(map: &LinkMap) -> Vec<CString> {
        let (mut offsets, mut strings) = (Vec::new(), 0);
        let mut at = map.dynamic;
        // SAFETY: the dynamic section of a loaded library is an array that ends with the tag `END`.
        while let Some(&Dynamic { tag, value }) = unsafe { at.as_ref() }.filter(|entry| entry.tag != END) {
            match tag {
                NEEDED => offsets.push(value),
                STRINGS => strings = value,
                _ => {}
            }
            // SAFETY: as above.
            at = unsafe { at.add(1) };
        }
        // An address that was not relocated is none.
        if strings < map.address {
            return Vec::new();
        }
        let text = |offset: usize| ptr::with_exposed_provenance::<c_char>(strings + offset);
        // SAFETY: the loader has replaced the table's offset in the file by its address, and the names are texts in it.
        offsets.into_iter().map(|offset| unsafe { CStr::from_ptr(text(offset)) }.to_owned()).collect()
    }

    /// A file of this name in a folder or one below it.
    fn find(folder: &Path, name: &OsStr) -> Option<PathBuf> {
        let entries: Vec<_> = fs::read_dir(folder).ok()?.flatten().collect();
        let here = entries.iter().find(|entry| entry.file_name() == name).map(fs::DirEntry::path);
        here.filter(|path| path.is_file()).or_else(|| {
            let folders = entries.iter().filter(|entry| entry.file_type().is_ok_and(|kind| kind.is_dir()));
            folders.map(fs::DirEntry::path).find_map(|folder| find(&folder, name))
        })
    }
}
