//! Records of `hokuyo_30m.bin`: what is written is read, and what cannot be used is refused with its record.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use posecut_geometry::SE2;
use posecut_nclt_sensors::hokuyo::{BEAMS, RECORD};
use posecut_nclt_sensors::{Hokuyo, scaled, write_hokuyo_scan};
use proptest::prelude::*;

fn file(times: &[u64]) -> Vec<u8> {
    let mut bytes = Vec::new();
    for time in times {
        write_hokuyo_scan(*time, &[2.0, 0.0, 29.0], &mut bytes).unwrap();
    }
    bytes
}

proptest! {
    #[test]
    fn written_ranges_are_read_within_half_a_step(ranges in prop::collection::vec(0.11..29.9, BEAMS)) {
        let mut bytes = Vec::new();
        write_hokuyo_scan(7, &ranges, &mut bytes).unwrap();
        let read = Hokuyo::parse("a", &bytes).unwrap().ranges(0);
        for (one, other) in ranges.iter().zip(&read) {
            prop_assert!((one - other).abs() <= 0.0025 + 1e-9);
            prop_assert!(format!("{other}").len() <= 6, "{} has three digits", other);
        }
    }

    #[test]
    fn every_value_survives(value in any::<u16>()) {
        prop_assert_eq!(scaled::value(scaled::length(value)), value);
        prop_assert!((scaled::length(value) - (f64::from(value) * 0.005 - 100.0)).abs() < 1e-9);
    }
}

#[test]
fn a_record_has_the_published_layout() {
    // struct.pack('<Q', 5) and '<H' of (2 + 100) / 0.005 = 20400 = 0x4fb0.
    let bytes = file(&[5]);
    assert_eq!(bytes.len(), RECORD);
    assert_eq!(bytes[..10], [5, 0, 0, 0, 0, 0, 0, 0, 0xb0, 0x4f]);
}

#[test]
fn beams_begin_behind_on_the_right_and_turn_to_the_left() {
    let mut ranges = vec![0.0; BEAMS];
    // Right, forwards, left: y is to the right.
    for (beam, expected) in [(180, [0.28, 10.0]), (540, [10.28, 0.0]), (900, [0.28, -10.0])] {
        ranges.fill(0.0);
        ranges[beam] = 10.0;
        let mut bytes = Vec::new();
        write_hokuyo_scan(1, &ranges, &mut bytes).unwrap();
        let scan = Hokuyo::parse("a", &bytes).unwrap().scan(0, &SE2::new(0.0, 0.0, 0.0));
        let points: Vec<_> = scan.points().collect();
        assert_eq!(points.len(), 1);
        assert!((points[0] - nalgebra::Vector2::from(expected)).norm() < 1e-9, "{beam}: {}", points[0]);
    }
}

#[test]
fn ranges_beyond_the_sensor_are_no_returns() {
    let mut bytes = Vec::new();
    write_hokuyo_scan(1, &[0.05, 30.0, 150.0, 29.995], &mut bytes).unwrap();
    // A range of -100 m.
    bytes[8 + 2 * 4..][..2].copy_from_slice(&[0, 0]);
    let ranges = Hokuyo::parse("a", &bytes).unwrap().ranges(0);
    assert_eq!(ranges[..5], [0.0, 0.0, 0.0, 29.995, 0.0]);
}

#[test]
fn the_nearest_record_is_found_within_its_limit() {
    let bytes = file(&[10, 20, 30]);
    let hokuyo = Hokuyo::parse("a", &bytes).unwrap();
    for (time, expected) in
        [(4, None), (5, Some(0)), (15, Some(0)), (16, Some(1)), (35, Some(2)), (36, None), (30, Some(2))]
    {
        assert_eq!(hokuyo.nearest(time, 5), expected, "{time}");
    }
}

#[test]
fn a_cut_record_is_refused_with_its_number() {
    let mut bytes = file(&[1, 2]);
    bytes.truncate(RECORD + 100);
    let said = Hokuyo::parse("a/hokuyo_30m.bin", &bytes).unwrap_err().to_string();
    assert!(said.starts_with("a/hokuyo_30m.bin, record 2: has 100 of 2170 bytes"), "{said}");
    assert!(Hokuyo::parse("a", &[]).unwrap_err().to_string().contains("empty"));
}

#[test]
fn few_records_out_of_order_are_left_out_and_many_are_refused() {
    let mut times: Vec<u64> = (1..=200).collect();
    times[50] = 3;
    let bytes = file(&times);
    let hokuyo = Hokuyo::parse("a", &bytes).unwrap();
    assert_eq!((hokuyo.len(), hokuyo.out_of_order), (199, 1));
    assert!((1..hokuyo.len()).all(|index| hokuyo.time(index - 1) < hokuyo.time(index)));
    let bytes = file(&[5, 6, 4]);
    let said = Hokuyo::parse("a", &bytes).unwrap_err().to_string();
    assert!(said.starts_with("a, record 3: its time 4 does not advance"), "{said}");
    let bytes = file(&[u64::MAX]);
    assert!(Hokuyo::parse("a", &bytes).unwrap_err().to_string().starts_with("a, record 1: its time 1844"));
}
