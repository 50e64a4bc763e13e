//! Where an archive keeps the libraries of this platform.

/// The folders below `binaries/` that hold libraries for this platform, the name by FMI 2.0 first; none if it has no name.
pub const FOLDERS: &[&str] = if cfg!(all(target_os = "linux", target_arch = "x86_64")) {
    &["linux64", "x86_64-linux"]
} else if cfg!(all(target_os = "linux", target_arch = "aarch64")) {
    &["aarch64-linux"]
} else if cfg!(all(target_os = "macos", target_arch = "x86_64")) {
    &["darwin64", "x86_64-darwin"]
} else if cfg!(all(target_os = "macos", target_arch = "aarch64")) {
    &["aarch64-darwin", "darwin64"]
} else if cfg!(all(target_os = "windows", target_arch = "x86_64")) {
    &["win64", "x86_64-windows"]
} else {
    &[]
};
