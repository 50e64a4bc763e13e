//! The keys of a run; names of instances are encoded as chunks of keys.

use std::fmt::Write as _;

/// The key of a run's state.
#[must_use]
pub fn live(run: &str) -> String {
    format!("lockstep/{run}/live")
}

/// The key of the values of an instance.
#[must_use]
pub fn values(run: &str, instance: &str) -> String {
    format!("lockstep/{run}/live/{}", chunk(instance))
}

/// The key of the query for what the values of an instance are.
#[must_use]
pub fn schema(run: &str, instance: &str) -> String {
    format!("lockstep/{run}/schema/{}", chunk(instance))
}

/// A name as one chunk of a key. Characters that a key cannot hold are percent-encoded; so is a leading `@`, which would
/// exclude the chunk from wildcards. A key has no empty chunk, so the empty name is a lone `%`, which no encoding gives.
fn chunk(name: &str) -> String {
    if name.is_empty() {
        return "%".to_owned();
    }
    let mut chunk = String::with_capacity(name.len());
    for (at, letter) in name.char_indices() {
        if matches!(letter, '%' | '*' | '$' | '?' | '#' | '/') || (at == 0 && letter == '@') {
            let _ = write!(chunk, "%{:02X}", u32::from(letter));
        } else {
            chunk.push(letter);
        }
    }
    chunk
}

#[cfg(test)]
mod tests {
    use super::*;
    use zenoh::key_expr::KeyExpr;

    fn decoded(chunk: &str) -> String {
        if chunk == "%" {
            return String::new();
        }
        let mut parts = chunk.split('%');
        let mut name = parts.next().unwrap_or_default().to_owned();
        for part in parts {
            let (digits, rest) = part.split_at(2);
            name.push(char::from(u8::from_str_radix(digits, 16).unwrap()));
            name.push_str(rest);
        }
        name
    }

    #[test]
    fn plain_names_of_scripts_are_not_changed_in_keys() {
        for name in ["quad", "wing[1].body", "plant.'der(x)'"] {
            assert_eq!(values("0f", name), format!("lockstep/0f/live/{name}"));
        }
        assert_eq!(schema("0f", "a/b*?"), "lockstep/0f/schema/a%2Fb%2A%3F");
    }

    proptest::proptest! {
        #[test]
        fn every_name_decodes_to_itself_and_is_one_chunk_that_wildcards_match(name in "[@*$?#/%a-c\\PC]{0,8}") {
            assert_eq!(decoded(&chunk(&name)), name);
            let key = KeyExpr::try_from(values("0f", &name)).unwrap();
            assert!(KeyExpr::try_from("lockstep/*/live/*").unwrap().includes(&key), "{key}");
            assert!(!key.is_wild(), "{key}");
        }
    }
}
