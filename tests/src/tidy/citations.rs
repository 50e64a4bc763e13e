//! Checks that every `Author & Author (Year)` in `models` has an entry in `models/REFERENCES.md`.

use std::path::Path;

pub(super) fn findings(root: &Path) -> std::io::Result<Vec<String>> {
    let references = std::fs::read_to_string(root.join("models/REFERENCES.md")).unwrap_or_default();
    let mut findings = Vec::new();
    for path in super::files_below(root, &root.join("models"), "rs")? {
        let text = std::fs::read_to_string(root.join(&path))?;
        for (index, line) in text.lines().enumerate() {
            for citation in citations(line).into_iter().filter(|citation| !references.contains(citation.as_str())) {
                let place = format!("{}:{}", path.display(), index + 1);
                findings.push(format!("{place}: `{citation}` has no entry in models/REFERENCES.md"));
            }
        }
    }
    Ok(findings)
}

/// The citations of a line: capitalised names, joined by `&`, before a year in parentheses.
fn citations(line: &str) -> Vec<String> {
    let mut citations = Vec::new();
    for (at, _) in line.match_indices('(') {
        let year = line[at + 1..].get(..5).filter(|year| year.ends_with([')', ','])).map(|year| &year[..4]);
        let Some(year) = year.filter(|year| year.bytes().all(|byte| byte.is_ascii_digit())) else { continue };
        let is_name = |word: &&str| {
            let plain = word.len() > 1 && word.chars().all(|c| c.is_alphanumeric() || c == '-');
            *word == "&" || (plain && word.starts_with(char::is_uppercase))
        };
        let mut names: Vec<_> = line[..at].split_whitespace().rev().take_while(is_name).collect();
        names.reverse();
        if !names.is_empty() {
            citations.push(format!("{} ({year})", names.join(" ")));
        }
    }
    citations
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_a_year_are_a_citation() {
        assert_eq!(citations("//! a law, after Geng & Chulin (2016), eq. 25"), ["Geng & Chulin (2016)"]);
        assert_eq!(citations("//! Bouabdallah (2007), table 1; f(1234)"), ["Bouabdallah (2007)"]);
        assert_eq!(citations("//! Source: Geng & Chulin (2016)"), ["Geng & Chulin (2016)"]);
        assert_eq!(citations("let x = f(2016);"), Vec::<String>::new());
    }
}
