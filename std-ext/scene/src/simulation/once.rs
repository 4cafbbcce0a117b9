//! Merges equal warnings about several surfaces.

use crate::scene::{Problem, SceneError};
use std::collections::BTreeSet;

/// Largest number of further surfaces that a warning names.
const NAMED: usize = 3;

/// The warnings without repetitions for other surfaces or pairs; the first warning of a kind names
/// the others. A warning about a pair in both orders is given once.
pub(super) fn said_once(warnings: Vec<SceneError>, surfaces: &[&str]) -> Vec<SceneError> {
    let message = |warning: &mut SceneError| match &mut warning.problem {
        Problem::Doubtful { message } => Some(std::mem::take(message)),
        _ => None,
    };
    let set = |warning: &mut SceneError, text: String| {
        if let Problem::Doubtful { message } = &mut warning.problem {
            *message = text;
        }
    };
    // Warnings without their messages, which are merged below.
    let mut rest = warnings;
    let texts: Vec<Option<String>> = rest.iter_mut().map(message).collect();
    let doubtful = texts.iter().flatten().cloned().collect();
    let mut kept = kept(doubtful, surfaces, false).into_iter();
    let mut said = Vec::new();
    for (mut warning, text) in rest.into_iter().zip(texts) {
        if text.is_some() {
            let Some(Some(text)) = kept.next() else {
                continue;
            };
            set(&mut warning, text);
        }
        said.push(warning);
    }
    said
}

/// Merges messages without a place. The order of a pair matters here.
pub fn messages_once(messages: Vec<String>, surfaces: &[&str]) -> Vec<String> {
    kept(messages, surfaces, true)
        .into_iter()
        .flatten()
        .collect()
}

/// A warning that was given, and the surfaces besides the first that it concerns.
struct Said {
    index: usize,
    pattern: String,
    message: String,
    subject: BTreeSet<String>,
    others: Vec<(BTreeSet<String>, String)>,
}

/// Each message in its merged form, without those that an earlier one covers. With `directed`, the
/// order of surfaces distinguishes messages.
fn kept(messages: Vec<String>, surfaces: &[&str], directed: bool) -> Vec<Option<String>> {
    let mut said: Vec<Said> = Vec::new();
    let mut kept = vec![None; messages.len()];
    for (index, message) in messages.into_iter().enumerate() {
        let pattern = pattern(&message, surfaces);
        let named = named(&message, surfaces);
        let subject = BTreeSet::from_iter(named.iter().cloned());
        let before = said.iter_mut().find(|said| said.pattern == pattern);
        let of_its_own =
            |before: &Said| named.is_empty() || (directed && before.subject == subject);
        match before {
            Some(said) if said.message == message => {}
            Some(said) if !of_its_own(said) => {
                let known = said.others.iter().any(|(other, _)| *other == subject);
                if said.subject != subject && !known {
                    said.others.push((subject, named.join(" and ")));
                }
            }
            _ => said.push(Said {
                index,
                pattern,
                message,
                subject,
                others: Vec::new(),
            }),
        }
    }
    for mut said in said {
        let others = &said.others;
        if !others.is_empty() {
            let named = others.iter().take(NAMED).map(|(_, named)| named.as_str());
            let named = Vec::from_iter(named).join(", ");
            let more = match others.len().saturating_sub(NAMED) {
                0 => String::new(),
                more => format!(" and {more} more"),
            };
            said.message
                .push_str(&format!(" (and so for {named}{more})"));
        }
        kept[said.index] = Some(said.message);
    }
    kept
}

fn quoted(name: &str) -> String {
    format!("\"{name}\"")
}

/// The surfaces that a message names, in its order.
fn named(message: &str, surfaces: &[&str]) -> Vec<String> {
    let place = |name: &&str| Some((message.find(&quoted(name))?, quoted(name)));
    let mut named = Vec::from_iter(surfaces.iter().filter_map(place));
    named.sort();
    named.into_iter().map(|(_, name)| name).collect()
}

/// A message without names of surfaces and without numbers.
fn pattern(message: &str, surfaces: &[&str]) -> String {
    let mut text = message.to_owned();
    for name in surfaces {
        text = text.replace(&quoted(name), "\"\"");
    }
    let number = |c: char| c.is_ascii_digit() || c == '.' || c == '-';
    text.split(number).collect()
}

#[cfg(test)]
mod tests {
    use super::messages_once;

    #[test]
    fn notes_of_many_surfaces_are_one() {
        let names = ["a", "b", "c", "d", "e", "f"];
        let wrinkled = |name: &str, time: f64| {
            format!(
                "from γ̇t = {time:.3}: surface \"{name}\" is wrinkled (by {} %)",
                30.0 * time
            )
        };
        let into =
            |[a, b]: [&str; 2]| format!("from γ̇t = 1.2: surface \"{a}\" has gone into \"{b}\"");
        let mut notes = Vec::from_iter(names.map(|name| wrinkled(name, 1.5)));
        notes.insert(2, into(["b", "a"]));
        notes.push(wrinkled("b", 2.0));
        notes.push(into(["a", "b"]));
        notes.push(into(["d", "c"]));
        notes.push(into(["c", "d"]));
        notes.push("the step was shortened at 3 times".to_owned());
        let said = messages_once(notes, &names);
        assert_eq!(
            said,
            [
                wrinkled("a", 1.5) + " (and so for \"b\", \"c\", \"d\" and 2 more)",
                into(["b", "a"]) + " (and so for \"d\" and \"c\")",
                into(["a", "b"]),
                "the step was shortened at 3 times".to_owned(),
            ]
        );
    }
}
