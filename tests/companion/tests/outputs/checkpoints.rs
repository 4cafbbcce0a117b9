//! Checkpoints: states of runs.
#![expect(
    clippy::unwrap_used,
    reason = "what fails in a helper fails the test that called it"
)]

use super::{TIME, bits};
use helfrich_std::checkpoint::{self, CheckpointProblem, Fingerprint};
use helfrich_std::io::sha256;
use helfrich_tests::meshes::cases;
use proptest::prelude::*;
use serde::de::DeserializeOwned;
use serde::ser::{Serialize, SerializeTuple, Serializer};
use std::path::Path;
use std::{fs, io};
use tempfile::TempDir;

/// State with all kinds of data that runs store.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
struct State {
    time: f64,
    steps: u64,
    positions: Vec<[f64; 3]>,
    names: Vec<String>,
    previous: Option<Vec<f64>>,
}

fn state() -> State {
    State {
        time: TIME,
        steps: 1 << 40,
        positions: vec![
            [1.0 / 3.0, -0.0, f64::MIN_POSITIVE / 2.0],
            [1e300, 0.1, -7.0],
        ],
        names: vec!["bending".into(), "Fläche".into()],
        previous: Some(vec![f64::INFINITY, f64::from_bits(0x7ff8_0000_dead_beef)]),
    }
}

#[track_caller]
fn refused<D: DeserializeOwned>(path: &Path, scene: Fingerprint) -> CheckpointProblem {
    let error = checkpoint::read::<D>(path, scene).err().unwrap();
    let message = error.to_string();
    assert!(
        message.starts_with(&path.display().to_string()),
        "{message}"
    );
    assert!(!message.contains('\n'), "{message}");
    error.problem
}

#[test]
fn a_checkpoint_keeps_every_bit() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("checkpoint");
    let scene = Fingerprint::of("scene");
    checkpoint::write(&path, scene, &0_u8).unwrap();
    checkpoint::write(&path, scene, &state()).unwrap();
    let found: State = checkpoint::read(&path, scene).unwrap();
    let number = |state: &State| {
        let previous = state.previous.clone().unwrap();
        let all = [&[state.time], state.positions.as_flattened(), &previous].concat();
        bits(&all)
    };
    assert_eq!(number(&found), number(&state()));
    assert_eq!((found.steps, found.names), (state().steps, state().names));
    // No temporary file is left in the folder.
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 1);
}

#[test]
fn a_checkpoint_that_cannot_be_written_leaves_the_last_one() {
    struct Refuses;
    impl Serialize for Refuses {
        fn serialize<S: Serializer>(&self, _: S) -> Result<S::Ok, S::Error> {
            Err(serde::ser::Error::custom("no"))
        }
    }
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("checkpoint");
    let scene = Fingerprint::of("scene");
    checkpoint::write(&path, scene, &17_u8).unwrap();
    let error = checkpoint::write(&path, scene, &Refuses).unwrap_err();
    assert!(matches!(error.problem, CheckpointProblem::NotEncodable(_)));
    assert_eq!(checkpoint::read::<u8>(&path, scene).unwrap(), 17);
    let error = checkpoint::write(&folder.path().join("no/checkpoint"), scene, &1).unwrap_err();
    assert!(matches!(error.problem, CheckpointProblem::Inaccessible(_)));
}

#[test]
fn every_truncation_bit_flip_and_extension_is_refused() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("checkpoint");
    let scene = Fingerprint::of("scene");
    checkpoint::write(&path, scene, &state()).unwrap();
    let good = fs::read(&path).unwrap();
    for length in 0..good.len() {
        fs::write(&path, &good[..length]).unwrap();
        match refused::<State>(&path, scene) {
            CheckpointProblem::NotACheckpoint => assert_eq!(length, 0),
            CheckpointProblem::Truncated { found, expected } => {
                assert_eq!(found, length as u64);
                assert!(length < 60 || expected == good.len() as u64);
            }
            other => panic!("{length}: {other}"),
        }
    }
    let mut bytes = good.clone();
    for bit in 0..8 * good.len() {
        bytes[bit / 8] ^= 1 << (bit % 8);
        fs::write(&path, &bytes).unwrap();
        refused::<State>(&path, scene);
        bytes[bit / 8] ^= 1 << (bit % 8);
    }
    bytes.push(0);
    fs::write(&path, &bytes).unwrap();
    assert!(matches!(
        refused::<State>(&path, scene),
        CheckpointProblem::Damaged
    ));
    fs::write(&path, &good).unwrap();
    checkpoint::read::<State>(&path, scene).unwrap();
}

#[test]
fn what_else_is_wrong_with_a_checkpoint_is_said() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("checkpoint");
    let [scene, other] = ["scene", "scene "].map(Fingerprint::of);
    assert!(matches!(
        refused::<State>(&path, scene),
        CheckpointProblem::Inaccessible(error) if error.kind() == io::ErrorKind::NotFound
    ));
    checkpoint::write(&path, other, &state()).unwrap();
    assert!(matches!(
        refused::<State>(&path, scene),
        CheckpointProblem::OtherScene { found, expected } if (found, expected) == (other, scene)
    ));
    // A state of another type is refused, whether it is too short or too long.
    for (path, problem) in [
        (
            "short",
            checkpoint::write(&folder.path().join("short"), scene, &1_u8),
        ),
        (
            "long",
            checkpoint::write(&folder.path().join("long"), scene, &(state(), 1_u8)),
        ),
    ] {
        problem.unwrap();
        let problem = refused::<State>(&folder.path().join(path), scene);
        assert!(
            matches!(problem, CheckpointProblem::OtherState(_)),
            "{problem}"
        );
    }
    let good = fs::read(&path).unwrap();
    let mut bytes = good.clone();
    bytes[16] = 2;
    fs::write(&path, &bytes).unwrap();
    assert!(matches!(
        refused::<State>(&path, scene),
        CheckpointProblem::OtherFormat { found: 2 }
    ));
    fs::write(&path, "time,area\n").unwrap();
    assert!(matches!(
        refused::<State>(&path, scene),
        CheckpointProblem::NotACheckpoint
    ));
}

/// Bytes that are written unchanged as the state of a checkpoint.
struct Raw(Vec<u8>);

impl Serialize for Raw {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut tuple = serializer.serialize_tuple(self.0.len())?;
        for byte in &self.0 {
            tuple.serialize_element(byte)?;
        }
        tuple.end()
    }
}

proptest! {
    #![proptest_config(cases(32))]

    /// A list that claims more entries than there are would exhaust memory, or panic, if it were trusted.
    #[test]
    fn a_state_of_any_bytes_is_read_or_refused(
        bytes in prop::collection::vec(any::<u8>(), 0..200),
        length in any::<u64>(),
    ) {
        let folder = TempDir::new().unwrap();
        let path = folder.path().join("checkpoint");
        let scene = Fingerprint::of("");
        checkpoint::write(&path, scene, &Raw(bytes.clone())).unwrap();
        let _ = checkpoint::read::<State>(&path, scene);
        let _ = checkpoint::read::<Vec<Vec<[f64; 3]>>>(&path, scene);
        checkpoint::write(&path, scene, &(length | 1 << 32, Raw(bytes))).unwrap();
        prop_assert!(checkpoint::read::<Vec<f64>>(&path, scene).is_err());
        prop_assert!(checkpoint::read::<Vec<[f64; 3]>>(&path, scene).is_err());
        prop_assert!(checkpoint::read::<String>(&path, scene).is_err());
    }
}

/// The examples of NIST for SHA-256: messages of one block, of two, of none, and of a million letters.
#[test]
fn fingerprints_are_sha_256() {
    let million = "a".repeat(1_000_000);
    for (text, expected) in [
        (
            "abc",
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad",
        ),
        (
            "abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq",
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1",
        ),
        (
            "",
            "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855",
        ),
        (
            &million,
            "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0",
        ),
    ] {
        assert_eq!(Fingerprint::of(text).to_hex(), expected);
    }
}

/// Digests of FIPS 180-2 (2002), appendix B: messages of one block, of two, and of a million bytes, in any
/// division into parts.
#[test]
fn checksums_are_those_of_the_standard() {
    let hexadecimal = |parts: &[&[u8]]| {
        let bytes = sha256(parts).into_iter();
        bytes.map(|byte| format!("{byte:02x}")).collect::<String>()
    };
    let one = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
    let two = "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1";
    let long = "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0";
    assert_eq!(hexadecimal(&[b"abc"]), one);
    assert_eq!(hexadecimal(&[b"a", b"", b"bc"]), one);
    let text = b"abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq";
    assert_eq!(hexadecimal(&[text]), two);
    let million = vec![b'a'; 1_000_000];
    assert_eq!(hexadecimal(&[&million]), long);
    let (first, rest) = million.split_at(12_345);
    assert_eq!(hexadecimal(&[first, rest]), long);
}
