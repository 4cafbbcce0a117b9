//! Commands that are asked to stop in the middle of their work.
#![cfg(target_os = "linux")]

use crate::fixture::{Fixture, disturbed, off};
use crate::{command, text};
use helfrich_std::generate::{Family, generate};
use std::fs;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

/// A hundredth of a second, in which the system counts the time of processes.
const SECOND: u64 = 100;

/// The processor time of a process so far, and whether it has ended, from the fields of its entry in `/proc`
/// behind its name.
fn time_of(id: u32) -> (u64, bool) {
    let entry = fs::read_to_string(format!("/proc/{id}/stat")).unwrap();
    let (_, fields) = entry.rsplit_once(')').unwrap();
    let fields = Vec::from_iter(fields.split_whitespace());
    let [user, system] = [11, 12].map(|field| fields[field].parse::<u64>().unwrap());
    (user + system, fields[0] == "Z")
}

/// A request to stop takes a second of processor time at most, after which nothing is left of the output. What
/// was asked for would take ten seconds and more.
#[test]
fn a_request_to_stop_is_obeyed_within_a_second() {
    let made = generate(&"sphere".parse().unwrap(), Family::Regular, 40_962, 1).unwrap();
    let noisy = disturbed(&made.positions, 1e-4);
    let file = Fixture::new("large.off", off(&noisy, made.mesh.triangles()));
    let csv = file.beside("large.csv");
    let smooth = file.beside("smooth.off");
    for arguments in [
        &["curvature", file.path(), "--csv", text(&csv)][..],
        &[
            "curvature",
            file.path(),
            "--csv",
            text(&csv),
            "--method",
            "belkin",
            "--errors",
        ],
        &["recommend", file.path(), "--json", text(&csv)],
        &["smooth", file.path(), "-o", text(&smooth)],
    ] {
        let child = command(arguments)
            .args(["--threads", "2"])
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let id = child.id();
        // The file has been read by then.
        while time_of(id).0 < SECOND {
            sleep(Duration::from_millis(10));
        }
        let (before, has_ended) = time_of(id);
        assert!(!has_ended, "{arguments:?}: it was over too soon");
        // It may have ended before `kill` has.
        Command::new("kill")
            .args(["-INT", &id.to_string()])
            .status()
            .unwrap();
        while !time_of(id).1 {
            sleep(Duration::from_millis(10));
        }
        let after = time_of(id).0 - before;
        let output = child.wait_with_output().unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(130), "{arguments:?}: {said}");
        assert!(
            after <= SECOND,
            "{arguments:?}: {after} hundredths of a second"
        );
        assert!(!said.contains("panicked"), "{said}");
        assert_eq!(file.names(), ["large.off"], "{arguments:?}");
    }
}
