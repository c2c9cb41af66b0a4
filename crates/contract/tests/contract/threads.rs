//! Tests that the number of threads is at most that of the processors.

use crate::table::streams;

/// Regression: with a hundred thousand threads, a program never started.
#[test]
fn more_threads_than_processors_are_named_and_not_started() {
    for row in streams() {
        let output = row.run(&["--threads", "100000"]);
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{}: {said}", row.name);
        assert!(said.contains("warning: --threads 100000 exceeds the number of"), "{}: {said}", row.name);
        assert_eq!(output.stdout, row.run(&[]).stdout, "{}", row.name);
    }
}
