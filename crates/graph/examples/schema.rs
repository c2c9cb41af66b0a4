//! Prints the JSON Schema of the format, for `make documentation`.

fn main() {
    #[expect(clippy::print_stdout, reason = "this is what the program says")]
    {
        println!("{}", posecut_graph::schema());
    }
}
