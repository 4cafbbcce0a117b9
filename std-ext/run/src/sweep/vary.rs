//! Keys that vary in a sweep: `KEY=VALUE,VALUE,…`.

use std::str::FromStr;

/// A key of a scene and the values that it takes: `surface.0.bending.method=meyer,juelicher`.
///
/// Commas inside brackets, braces and quotation marks are parts of a value:
/// `surface.0.elasticity={law="skalak",shear_modulus=1},{law="neo-hookean",shear_modulus=1}` are two.
/// Each value is what [`Overrides`](crate::scene::Overrides) take.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Vary {
    /// The path of the key.
    pub key: String,
    /// One or more different texts.
    pub values: Vec<String>,
}

/// A text without the form `KEY=VALUE,VALUE,…`.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum VarySyntaxError {
    /// There is no key, or no value.
    #[error(
        "`{text}` varies nothing: write path.to.key=value,value, as in \
         surface.0.bending.method=meyer,juelicher"
    )]
    Nothing {
        /// The text.
        text: String,
    },
    /// A value between commas is empty.
    #[error("`{text}`: value {number} is empty: commas stand between values only")]
    Empty {
        /// The text.
        text: String,
        /// Its number, from 1.
        number: usize,
    },
    /// Two values are the same.
    #[error("`{text}`: the value `{value}` is there twice: once is enough")]
    Repeated {
        /// The text.
        text: String,
        /// The value.
        value: String,
    },
    /// A bracket, a brace or a quotation mark has no counterpart.
    #[error("`{text}`: `{mark}` has no counterpart")]
    Unbalanced {
        /// The text.
        text: String,
        /// The mark.
        mark: char,
    },
}

impl FromStr for Vary {
    type Err = VarySyntaxError;

    fn from_str(text: &str) -> Result<Self, VarySyntaxError> {
        let nothing = || VarySyntaxError::Nothing {
            text: text.to_owned(),
        };
        let (key, rest) = text.split_once('=').ok_or_else(nothing)?;
        if key.trim().is_empty() || rest.trim().is_empty() {
            return Err(nothing());
        }
        let mut values: Vec<String> = Vec::new();
        let parts = split(rest).map_err(|mark| VarySyntaxError::Unbalanced {
            text: text.to_owned(),
            mark,
        })?;
        for (at, value) in parts.into_iter().map(str::trim).enumerate() {
            let text = text.to_owned();
            if value.is_empty() {
                let number = at + 1;
                return Err(VarySyntaxError::Empty { text, number });
            }
            if values.iter().any(|other| other == value) {
                let value = value.to_owned();
                return Err(VarySyntaxError::Repeated { text, value });
            }
            values.push(value.to_owned());
        }
        Ok(Self {
            key: key.trim().to_owned(),
            values,
        })
    }
}

/// The parts between top-level commas, or the unbalanced mark.
fn split(text: &str) -> Result<Vec<&str>, char> {
    let mut parts = Vec::new();
    let mut start = 0;
    // What closes what is open, innermost last; what is quoted, and by which mark.
    let mut open: Vec<(char, char)> = Vec::new();
    let mut quote = None;
    let mut escaped = false;
    for (at, c) in text.char_indices() {
        if let Some(mark) = quote {
            // As in TOML: backslashes escape between double marks alone.
            if escaped {
                escaped = false;
            } else if c == '\\' && mark == '"' {
                escaped = true;
            } else if c == mark {
                quote = None;
            }
            continue;
        }
        match c {
            '"' | '\'' => quote = Some(c),
            '[' => open.push((c, ']')),
            '{' => open.push((c, '}')),
            ']' | '}' => match open.pop() {
                Some((_, close)) if close == c => {}
                _ => return Err(c),
            },
            ',' if open.is_empty() => {
                parts.push(&text[start..at]);
                start = at + 1;
            }
            _ => {}
        }
    }
    if let Some(mark) = quote.or_else(|| open.last().map(|&(mark, _)| mark)) {
        return Err(mark);
    }
    parts.push(&text[start..]);
    Ok(parts)
}

/// The ends of the keys' paths, as short as tells them apart: `method` for
/// `surface.0.bending.method`.
pub(super) fn short_keys(vary: &[Vary]) -> Vec<String> {
    let end = |key: &str, segments: usize| {
        let all = Vec::from_iter(key.split('.'));
        all[all.len().saturating_sub(segments)..].join(".")
    };
    let mut keys = Vec::with_capacity(vary.len());
    for (at, Vary { key, .. }) in vary.iter().enumerate() {
        let others = || vary.iter().enumerate().filter(|&(other, _)| other != at);
        let most = key.split('.').count();
        let alone = |segments: &usize| {
            let own = end(key, *segments);
            others().all(|(_, other)| end(&other.key, *segments) != own)
        };
        let segments = (1..=most).find(alone).unwrap_or(most);
        keys.push(end(key, segments));
    }
    keys
}

/// `key=value,key=value` with letters, digits and `.`, `-`, `+`, `_`; other characters become `_`.
pub(super) fn file_name(keys: &[String], values: &[String]) -> String {
    // Folders' names have 255 bytes at most; runs have files of their own below.
    const LONGEST: usize = 200;
    let plain = |text: &str| {
        let inner = text.trim_matches(['"', '\'']);
        let kept = inner.chars().filter(|c| !c.is_whitespace());
        let plain = kept.map(|c| match c {
            '.' | '-' | '+' => c,
            c if c.is_alphanumeric() => c,
            _ => '_',
        });
        plain.collect::<String>()
    };
    let pairs = keys.iter().zip(values);
    let pairs = pairs.map(|(key, value)| format!("{}={}", plain(key), plain(value)));
    let mut name = Vec::from_iter(pairs).join(",");
    while name.len() > LONGEST {
        name.pop();
    }
    name
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn vary(text: &str) -> Vary {
        match text.parse() {
            Ok(vary) => vary,
            Err(error) => panic!("{error}"),
        }
    }

    #[test]
    fn values_are_split_at_the_commas_between_them() {
        for (text, key, values) in [
            ("a.b=1,2", "a.b", vec!["1", "2"]),
            (" a = x , y z ", "a", vec!["x", "y z"]),
            ("a=[1,2,3],[4,5,[6,7]]", "a", vec!["[1,2,3]", "[4,5,[6,7]]"]),
            (
                "a={b=1,c=\"}\"},{d='{'}",
                "a",
                vec!["{b=1,c=\"}\"}", "{d='{'}"],
            ),
            (
                r#"a="x,y","z\",w",'\'"#,
                "a",
                vec![r#""x,y""#, r#""z\",w""#, r"'\'"],
            ),
            ("a=b=1", "a", vec!["b=1"]),
        ] {
            assert_eq!(vary(text).key, key);
            assert_eq!(vary(text).values, values, "{text}");
        }
    }

    #[test]
    fn what_varies_nothing_is_refused() {
        for (text, message) in [
            ("a", "`a` varies nothing"),
            ("=1", "`=1` varies nothing"),
            ("a= ", "`a= ` varies nothing"),
            ("a=1,,2", "`a=1,,2`: value 2 is empty"),
            ("a=1,", "`a=1,`: value 2 is empty"),
            ("a=1,2,1", "`a=1,2,1`: the value `1` is there twice"),
            ("a=[1,2", "`a=[1,2`: `[` has no counterpart"),
            ("a=[1},2", "`a=[1},2`: `}` has no counterpart"),
            ("a=1],2", "`a=1],2`: `]` has no counterpart"),
            ("a=\"1,2", "`a=\"1,2`: `\"` has no counterpart"),
        ] {
            let error = text.parse::<Vary>().map_err(|error| error.to_string());
            assert!(
                error
                    .as_ref()
                    .is_err_and(|error| error.starts_with(message)),
                "{error:?}"
            );
        }
    }

    #[test]
    fn keys_are_as_short_as_tells_them_apart() {
        let keys =
            |texts: &[&str]| short_keys(&Vec::from_iter(texts.iter().map(|text| vary(text))));
        assert_eq!(
            keys(&["surface.0.bending.method=a", "surface.0.vertices=1"]),
            ["method", "vertices"]
        );
        assert_eq!(
            keys(&["surface.a.bending.modulus=1", "surface.b.bending.modulus=1"]),
            ["a.bending.modulus", "b.bending.modulus"]
        );
        assert_eq!(keys(&["rate=1", "flow.rate=1"]), ["rate", "flow.rate"]);
    }

    #[test]
    fn folders_have_names_that_every_system_takes() {
        let name = |values: &[&str]| {
            let keys = ["law".to_owned(), "a/b".to_owned()];
            file_name(
                &keys,
                &Vec::from_iter(values.iter().map(|text| (*text).to_owned())),
            )
        };
        assert_eq!(name(&["\"skalak\"", "-1.5e+3"]), "law=skalak,a_b=-1.5e+3");
        assert_eq!(
            name(&["../x", "{a = 1, b='µ'}"]),
            "law=.._x,a_b=_a_1_b__µ__"
        );
        assert!(name(&[&"é".repeat(300), "1"]).len() <= 200);
    }
}
