//! Files of `velodyne_sync`: what is written is read.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use nalgebra::Vector3;
use posecut_nclt_sensors::velodyne::{Hit, read_hits, time_of_name, write_hits};
use proptest::prelude::*;

proptest! {
    #[test]
    fn written_hits_are_read_within_half_a_step(
        hits in prop::collection::vec((prop::array::uniform3(-99.0..200.0), any::<u8>(), 0_u8..32), 1..50),
    ) {
        let hits: Vec<Hit> = hits
            .into_iter()
            .map(|(point, intensity, laser)| Hit { point: Vector3::from(point), intensity, laser })
            .collect();
        let mut bytes = Vec::new();
        write_hits(&hits, &mut bytes).unwrap();
        let read = read_hits("a", &bytes).unwrap();
        prop_assert_eq!(read.len(), hits.len());
        for (one, other) in hits.iter().zip(&read) {
            prop_assert!((one.point - other.point).amax() <= 0.0025 + 1e-9);
            prop_assert_eq!((one.intensity, one.laser), (other.intensity, other.laser));
        }
    }
}

#[test]
fn a_record_has_the_published_layout() {
    let mut bytes = Vec::new();
    let hit = Hit { point: Vector3::new(2.0, -100.0, 0.005), intensity: 7, laser: 31 };
    write_hits(&[hit], &mut bytes).unwrap();
    // '<HHHBB' of 20400, 0, 20001, 7, 31.
    assert_eq!(bytes, [0xb0, 0x4f, 0, 0, 0x21, 0x4e, 7, 31]);
}

#[test]
fn cut_and_empty_files_are_refused() {
    let said = read_hits("velodyne_sync/5.bin", &[0; 19]).unwrap_err().to_string();
    assert!(said.starts_with("velodyne_sync/5.bin, record 3: has 3 of 8 bytes"), "{said}");
    assert!(read_hits("5.bin", &[]).unwrap_err().to_string().starts_with("5.bin: it is empty"));
}

#[test]
fn files_are_named_by_their_time() {
    assert_eq!(time_of_name("1326030975726043.bin"), Some(1_326_030_975_726_043));
    assert_eq!(time_of_name("notes.txt"), None);
}
