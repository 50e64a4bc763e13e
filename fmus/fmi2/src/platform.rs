//! The folders of an archive with the libraries of this platform.

/// The folders below `binaries/` with libraries for this platform, FMI 2.0's name first; empty if the platform has no
/// name.
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
