//! `posecut-oracle`.

fn main() -> std::process::ExitCode {
    posecut_oracle::cli::main()
}
