//! Finds the functions of glibc because of which a library does not load on older systems.

use object::elf::SHT_DYNSYM;
use object::read::elf::{FileHeader, SectionTable, Sym};
use std::fmt;

/// The version of glibc that every library should load with: that of RHEL 8, older than Debian 11's and Ubuntu 20.04's.
const CEILING: [u32; 2] = [2, 28];

type Header = object::elf::FileHeader64<object::Endianness>;

/// A function of glibc in a version that came after 2.28.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct NewerGlibc {
    /// The function.
    pub function: String,
    /// The version, for example `2.34`.
    pub version: String,
}

/// What to tell the user about these functions of a unit's library, if there are any.
pub(crate) fn warning(unit: &str, newer: &[NewerGlibc]) -> Option<String> {
    let first = newer.first()?;
    let more = if newer.len() > 1 { format!(" and {} more", newer.len() - 1) } else { String::new() };
    Some(format!(
        "warning: unit `{unit}` needs {first}{more}: it does not load on systems with an older glibc, such as Debian 11, \
         Ubuntu 20.04 and RHEL 8, which have at least 2.28"
    ))
}

impl fmt::Display for NewerGlibc {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "`{}` of glibc {}", self.function, self.version)
    }
}

/// The functions of a library that need a glibc newer than 2.28, sorted by name; none for another format than 64-bit ELF.
///
/// # Errors
/// What is wrong with the library's tables.
pub(crate) fn newer_glibc(library: &[u8]) -> Result<Vec<NewerGlibc>, String> {
    let Ok(header) = Header::parse(library) else { return Ok(Vec::new()) };
    let read = || -> object::read::Result<Vec<NewerGlibc>> {
        let endian = header.endian()?;
        let sections = header.sections(endian, library)?;
        let symbols = sections.symbols(endian, library, SHT_DYNSYM)?;
        let Some(versions) = sections.versions(endian, library)? else { return Ok(Vec::new()) };
        let mut found = Vec::new();
        for (index, symbol) in symbols.enumerate().filter(|(_, symbol)| symbol.is_undefined(endian)) {
            let Some(version) = versions.version(versions.version_index(endian, index))? else { continue };
            let version = String::from_utf8_lossy(version.name());
            if let Some(version) = version.strip_prefix("GLIBC_").filter(|version| is_newer(version)) {
                let function = String::from_utf8_lossy(symbols.symbol_name(endian, symbol)?).into_owned();
                found.push(NewerGlibc { function, version: version.to_owned() });
            }
        }
        found.extend(unnamed(endian, library, &sections, &found)?);
        found.sort_by(|a, b| a.function.cmp(&b.function));
        Ok(found)
    };
    read().map_err(|error| format!("its symbol versions cannot be read: {error}"))
}

/// The newer versions that the library needs without naming a function of them.
fn unnamed(
    endian: object::Endianness,
    library: &[u8],
    sections: &SectionTable<'_, Header>,
    named: &[NewerGlibc],
) -> object::read::Result<Vec<NewerGlibc>> {
    let mut found = Vec::new();
    let Some((mut needs, strings_index)) = sections.gnu_verneed(endian, library)? else { return Ok(found) };
    let strings = sections.strings(endian, library, strings_index)?;
    while let Some((_, mut versions)) = needs.next()? {
        while let Some(version) = versions.next()? {
            let name = String::from_utf8_lossy(version.name(endian, strings)?);
            let Some(version) = name.strip_prefix("GLIBC_").filter(|version| is_newer(version)) else { continue };
            if named.iter().all(|known| known.version != version) {
                found.push(NewerGlibc { function: "the dynamic linker".to_owned(), version: version.to_owned() });
            }
        }
    }
    Ok(found)
}

/// Whether a version such as `2.2.5` came after the ceiling. A version without numbers is private to glibc, which promises
/// nothing of it.
fn is_newer(version: &str) -> bool {
    let numbers: Option<Vec<u32>> = version.split('.').map(|number| number.parse().ok()).collect();
    numbers.is_none_or(|numbers| numbers.get(..2).is_none_or(|first| first > &CEILING[..]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn versions_are_compared_by_number() {
        for older in ["2.2.5", "2.28", "2.4", "2.17"] {
            assert!(!is_newer(older), "{older}");
        }
        for newer in ["2.29", "2.34", "3.0", "PRIVATE", "2"] {
            assert!(is_newer(newer), "{newer}");
        }
    }

    #[test]
    fn a_warning_names_the_function_and_its_version() {
        let newer = |function: &str| NewerGlibc { function: function.to_owned(), version: "2.34".to_owned() };
        let text = warning("tank", &[newer("closefrom"), newer("open_it")]).unwrap();
        assert!(text.starts_with("warning: unit `tank` needs `closefrom` of glibc 2.34 and 1 more: it does"), "{text}");
        assert_eq!(warning("tank", &[]), None);
    }

    #[test]
    fn what_is_no_library_has_no_versions_and_what_is_damaged_is_an_error() {
        assert_eq!(newer_glibc(b"PE"), Ok(Vec::new()));
        let own = std::fs::read(std::env::current_exe().unwrap()).unwrap();
        let newer = newer_glibc(&own).unwrap();
        assert!(newer.is_sorted_by(|a, b| a.function <= b.function), "{newer:?}");
        let damaged = &own[..own.len() / 2];
        assert!(newer_glibc(damaged).is_err());
    }
}
