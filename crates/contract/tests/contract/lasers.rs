//! The whole way from the files of an NCLT session's laser scanner to judged landmark edges.

use posecut_contract::succeed;

#[test]
fn a_session_with_laser_scans_finds_its_way_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("2012-01-22");
    let session = path.to_str().unwrap();
    succeed("simulate", &["--length", "300", "--route", "return", "--hokuyo", "5", "-o", session], b"");
    let sigmas = ["--sigma-translation", "0.1", "--sigma-rotation", "0.02"];
    let graph = succeed("ingest", &[&[session, "--keep-every", "5"][..], &sigmas].concat(), b"");
    let records = folder.path().join("scans");
    let file = records.to_str().unwrap();
    let without =
        succeed("ingest", &[&[session, "--keep-every", "5", "--scans", file][..], &sigmas].concat(), b"");
    // Fewer words than by default find the same edges in this little session, in three quarters of the time.
    let options = ["--radius", "30", "--vocabulary", "50"];
    let found = succeed("recognize", &options, &graph);
    let same = succeed("recognize", &[&options[..], &["--scans", file]].concat(), &without);
    let landmarks = |bytes: &[u8]| -> Vec<String> {
        let text = String::from_utf8(bytes.to_vec()).unwrap();
        text.lines().filter(|line| line.contains("\"agreement\"")).map(str::to_owned).collect()
    };
    assert_eq!(landmarks(&found), landmarks(&same), "scans in the graph and in a file say the same");
    let judged = succeed("verify", &[], &found);
    let all = landmarks(&judged);
    let rejected = all.iter().filter(|line| line.contains("\"verify_verdict\":\"rejected\"")).count();
    assert!(all.len() >= 60 && 2 * rejected < all.len(), "{rejected} of {} rejected", all.len());
}
