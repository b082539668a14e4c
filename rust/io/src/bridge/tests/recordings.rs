//! Tests of recordings: the frames in them, and the files and directories that they make.

use super::*;
use std::path::Path;

/// A directory that is not there yet.
fn directory(name: &str) -> PathBuf {
    let name = format!("mavwire-bridge-{name}-{}", std::process::id());
    let directory = std::env::temp_dir().join(name);
    let _ = std::fs::remove_dir_all(&directory);
    directory
}

fn into(directory: &Path) -> Recording {
    let directory = directory.to_owned();
    let flush_interval = Duration::from_millis(1);
    Recording { directory, max_bytes: None, max_age: None, flush_interval }
}

fn told(bridge: &Bridge) -> RecordingStats {
    bridge.stats().expect("it runs").recording.expect("it records")
}

/// Sends a frame and waits until it is written.
fn write(bridge: &Bridge, frame: Vec<u8>) {
    let before = told(bridge).records;
    bridge.send(&frame).unwrap();
    wait_for("the record", || told(bridge).records > before);
}

/// The logs without their first timestamps, by the system of the first frame.
fn logged(directory: &Path) -> Vec<Vec<u8>> {
    let entries = std::fs::read_dir(directory).unwrap().map(|entry| entry.unwrap().path());
    let mut logs: Vec<Vec<u8>> =
        entries.map(|path| std::fs::read(path).unwrap()[8..].to_vec()).collect();
    logs.sort_by_key(|log| log[5]);
    logs
}

#[test]
fn recordings_hold_what_passed_without_signatures() {
    let directory = directory("contents");
    let bridge = start(Some(Recording { max_bytes: Some(1), ..into(&directory) }));
    let mut signed = heartbeat(2, 0);
    signed[2] = frame::IFLAG_SIGNED;
    let register = mavwire_core::x25::checksum(&signed[1..19]);
    let checksum = mavwire_core::x25::push(register, 50).to_le_bytes();
    signed[19..21].copy_from_slice(&checksum);
    signed.extend([9; 13]);
    let key = frame_of(255, 256, 0, &[7; 42], 71);
    for frames in [heartbeat(1, 0), [key, signed].concat()] {
        let before = bridge.stats().unwrap().recording.unwrap().records;
        bridge.send(&frames).unwrap();
        wait_for("the record", || bridge.stats().unwrap().recording.unwrap().records > before);
    }
    let recorded = bridge.stats().unwrap().recording.unwrap();
    assert_eq!((recorded.files, recorded.records, recorded.dropped), (2, 2, 0));
    bridge.stop();
    assert_eq!(logged(&directory), [heartbeat(1, 0), heartbeat(2, 0)]);
    std::fs::remove_dir_all(&directory).unwrap();
}

#[test]
fn a_log_that_is_old_enough_is_followed_by_a_new_one() {
    let directory = directory("age");
    let max_age = Some(Duration::from_nanos(1));
    let bridge = start(Some(Recording { max_age, ..into(&directory) }));
    (1..=3).for_each(|sysid| write(&bridge, heartbeat(sysid, 0)));
    assert_eq!(told(&bridge).files, 3);
    bridge.stop();
    assert_eq!(logged(&directory), [1, 2, 3].map(|sysid| heartbeat(sysid, 0)));
    std::fs::remove_dir_all(&directory).unwrap();
}

#[test]
fn where_no_new_log_can_be_begun_the_old_one_goes_on() {
    let directory = directory("moved");
    let elsewhere = directory.with_extension("elsewhere");
    let _ = std::fs::remove_dir_all(&elsewhere);
    let bridge = start(Some(Recording { max_bytes: Some(1), ..into(&directory) }));
    write(&bridge, heartbeat(1, 0));
    std::fs::rename(&directory, &elsewhere).unwrap();
    write(&bridge, heartbeat(1, 1));
    let stats = told(&bridge);
    assert_eq!((stats.files, stats.dropped), (1, 0));
    assert!(stats.error.is_some(), "and it is told");
    std::fs::rename(&elsewhere, &directory).unwrap();
    write(&bridge, heartbeat(2, 2));
    assert_eq!((told(&bridge).files, told(&bridge).error), (2, None));
    bridge.stop();
    let [first, second] = &logged(&directory)[..] else { panic!("two logs") };
    assert_eq!((first.len(), &second[..]), (2 * 21 + 8, &heartbeat(2, 2)[..]));
    std::fs::remove_dir_all(&directory).unwrap();
}

#[test]
fn a_bridge_that_received_nothing_leaves_no_log_behind() {
    let directory = directory("empty");
    let bridge = start(Some(into(&directory)));
    assert!(told(&bridge).path.exists());
    bridge.stop();
    assert_eq!(std::fs::read_dir(&directory).unwrap().count(), 0);
    std::fs::remove_dir_all(&directory).unwrap();
}
