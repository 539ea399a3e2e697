//! A full or hanging disk does not stop the hand; the recording reports the missing part.

use super::faults::NO_HURRY;
use crate::rig::{QUARTER, Rig, Running, Setup};
use crate::skip::not_permitted;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

/// A file system in an image file.
struct Disk {
    place: PathBuf,
}

/// Runs a program and returns whether it succeeded.
fn does(program: &str, arguments: &[&str]) -> bool {
    let output = Command::new(program).args(arguments).output();
    output.is_ok_and(|output| output.status.success())
}

fn text(path: &Path) -> &str {
    path.to_str().expect("a path in UTF-8")
}

impl Disk {
    /// Mounts a file system in `folder`, or returns `None` if not permitted.
    fn mount(folder: &Path) -> Option<Self> {
        let (image, place) = (folder.join("disk.img"), folder.join("disk"));
        let file = std::fs::File::create(&image).expect("a file");
        file.set_len(64 << 20).expect("its size");
        std::fs::create_dir(&place).expect("a folder");
        let made = does("mkfs.ext4", &["-q", "-F", text(&image)])
            && does("mount", &["-o", "loop", text(&image), text(&place)]);
        let disk = made.then_some(Self { place })?;
        // Freezing must be permitted, too.
        (disk.freeze(true) && disk.freeze(false)).then_some(disk)
    }

    fn freeze(&self, on: bool) -> bool {
        let how = if on { "--freeze" } else { "--unfreeze" };
        does("fsfreeze", &[how, text(&self.place)])
    }
}

impl Drop for Disk {
    fn drop(&mut self) {
        self.freeze(false);
        does("umount", &["--lazy", text(&self.place)]);
    }
}

/// Runs `test` on a moving hand whose output folder `run` is on a frozen disk. Skips the test if not permitted.
fn on_a_frozen_disk(setup: Setup, test: impl FnOnce(&mut Rig, &mut Running, &Disk)) {
    let folder = setup.folder.clone();
    let Some(disk) = Disk::mount(&folder) else {
        not_permitted("a hanging disk requires `mkfs.ext4`, `fsfreeze` and permission to mount");
        return;
    };
    std::os::unix::fs::symlink(folder.join("disk"), folder.join("run")).expect("a link");
    let mut rig = setup.start();
    let mut hand = rig.moving_hand(&["--flush-interval=0.05"]);
    assert!(disk.freeze(true));
    test(&mut rig, &mut hand, &disk);
}

#[test]
fn hanging_disk_leaves_a_gap_and_does_not_stop_the_hand() {
    let setup = Setup::new("link-frozen-disk").with(&[NO_HURRY]).at(QUARTER);
    on_a_frozen_disk(setup, |rig, hand, disk| {
        hand.wait_for("recording: the disk accepts no data");
        assert!(disk.freeze(false));
        hand.wait_for("recording: resumed");
        hand.signal("INT");
        let (status, said) = hand.wait();
        assert_eq!(status, Some(1), "{said}");
        assert!(said.contains("the recording is partial"), "{said}");
        let recording = rig.setup.recording();
        assert!(!recording.gaps.is_empty() && !recording.complete);
        // The loop kept its period: the first step after the gap is later by the missing duration.
        let gap = recording.gaps[0];
        let after = recording.task[gap.steps_before].stamp;
        assert!(after > gap.missing.end && gap.missing.end > gap.missing.start);
    });
}

#[test]
fn hanging_disk_stops_the_hand_if_configured() {
    let stop = "control.on_recording_failure=stop";
    let setup = Setup::new("link-disk-stops")
        .with(&[NO_HURRY, stop])
        .at(QUARTER);
    on_a_frozen_disk(setup, |_, hand, disk| {
        hand.wait_for("the hand was stopped: recording: the disk accepts no data");
        assert!(disk.freeze(false));
        let (status, said) = hand.wait();
        assert_eq!(status, Some(1), "{said}");
    });
}

#[test]
fn program_waits_for_a_hanging_disk_for_a_limited_time() {
    let setup = Setup::new("link-disk-end").with(&[NO_HURRY]).at(QUARTER);
    on_a_frozen_disk(setup, |rig, hand, disk| {
        hand.wait_for("recording: the disk accepts no data");
        hand.signal("INT");
        // The process ends only once the disk responds, but it has printed everything before.
        hand.wait_for("the recording is partial");
        assert!(hand.said().contains("has no end record"), "{}", hand.said());
        assert!(disk.freeze(false));
        let (status, said) = hand.wait();
        assert_eq!(status, Some(1), "{said}");
        assert!(!rig.setup.recording().complete);
    });
}

/// The system rejects writes beyond a file size limit, like a full disk.
#[test]
fn full_disk_ends_the_recording_but_not_the_hand() {
    let mut rig = Setup::new("link-full-disk")
        .with(&[NO_HURRY])
        .at(QUARTER)
        .start();
    let mut hand = rig.setup.hand_with_files_up_to(300);
    hand.wait_for("the hand continues without recording");
    std::thread::sleep(Duration::from_millis(300));
    hand.signal("INT");
    let (status, said) = hand.wait();
    assert_eq!(status, Some(1), "{said}");
    assert!(said.contains("the recording is partial"), "{said}");
    let recording = rig.setup.recording();
    assert!(!recording.complete && !recording.task.is_empty());
    rig.world.signal("INT");
    let (status, world) = rig.world.wait();
    assert_eq!(status, Some(0), "{world}");
}
