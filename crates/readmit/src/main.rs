//! `posecut-readmit`.

fn main() -> std::process::ExitCode {
    posecut_readmit::cli::main()
}
